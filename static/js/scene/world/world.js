/** The world of the 3D view: everything that stands on the ground, with sun and sky. Its interface is described in docs/scene.md. */

import { isInForce } from "../../domain/zones_in_force.js";
import { bridgeSolid } from "../geometry/bridges.js";
import { countedAir } from "../geometry/counted.js";
import { foldsOf } from "../geometry/folds.js";
import { makeGround } from "../geometry/ground.js";
import { labelsOf } from "../geometry/labels.js";
import { railwayTracks } from "../geometry/railways.js";
import { sunAt } from "../geometry/sun.js";
import { deckUnder } from "../geometry/under_decks.js";
import { wiresOf } from "../geometry/wires.js";
import { withinFor, zoneVolume } from "../geometry/zones.js";
import { Color, Fog, Group } from "../three.js";
import { makeLights, mood, nightPalette } from "./lighting.js";
import { countedSegments, edgeSegments, railSegments, railWireSegments, wireSegments } from "./line_kinds.js";
import { screenLines } from "./lines.js";
import { makeSky } from "./sky.js";
import { makeBeds, makeBridges } from "./solids.js";
import { makeSupports } from "./supports.js";
import { makeTerrain } from "./terrain.js";
import { makeZones } from "./zones.js";

const BRACING = { high: { near_m: 900, most: 50 }, low: { near_m: 300, most: 8 } };
const NIGHT_STEP = 0.06; // things get other colours after so much of dusk
/** @type {[number, number]} */
const FOG_M = [4_000, 30_000]; // begins, hides all
const FOG_SHARES = [1.1, 3]; // of the camera's distance to its target: the target is never in the fog
const LINES_M = 4_000; // targets farther away have lines as strong as from here
const FLAT = { columns: 2, rows: 2, step_lon_deg: 0.1, step_lat_deg: 0.1 };
const NO_AIR = { points: new Float64Array(0), first: new Uint32Array(1), marks: new Float32Array(0) };
const NO_WIRES = {
  points: new Float64Array(0),
  first: new Uint32Array(1),
  span: new Uint32Array(0),
  isEarth: new Uint8Array(0),
};

/** @import { Scene } from "../../api_types.d.ts" */
/** @import { GroundLabel } from "../geometry/labels.js" */
/** @import { Ground } from "../geometry/ground.js" */
/** @import { Wires } from "../geometry/wires.js" */
/** @import { PerspectiveCamera } from "../three.js" */
/** @import { Frame, Members, Polylines, ScenePalette, Segments, Surface } from "../types.d.ts" */
/** @import { Mood, SunPlace } from "./lighting.js" */
/** @import { ShownVolume } from "./zones.js" */

/** @typedef {"high" | "low"} Quality low: without shadows and with little bracing */
/** @typedef {ReturnType<typeof makeWorld>} World */
/**
 * Drawn parts of a scene.
 *
 * @typedef {object} Shown
 * @property {Scene | null} scene
 * @property {Ground} ground
 * @property {Wires} wires
 * @property {Polylines & { marks: Float32Array }} counted
 * @property {Float32Array[]} rails
 * @property {Float32Array[]} railWires
 * @property {Members[]} masts
 * @property {Surface[]} beds
 * @property {Surface[]} bridges
 * @property {ShownVolume[]} volumes
 */

/** Create all drawn parts as parts of one group. @param {Quality} quality */
function makeParts(quality) {
  const group = new Group();
  const lights = makeLights({ shadows: quality !== "low" });
  const [sky, terrain, beds, bridges, zones] = [makeSky(), makeTerrain(), makeBeds(), makeBridges(), makeZones()];
  const supports = makeSupports({ bracing: BRACING[quality] });
  const wires = screenLines({ fade: [3_500, 0.3], order: 2 });
  const edges = screenLines({ fade: [16_000, 0.5], order: 4 });
  group.add(
    lights.group,
    supports.group,
    ...[sky, terrain, beds, bridges, zones, wires, edges].map((part) => part.mesh),
  );
  return {
    group,
    fog: new Fog(0xffffff, ...FOG_M),
    ...{ lights, sky, terrain, beds, bridges, zones, supports, wires, edges },
    dispose() {
      for (const part of [lights, sky, terrain, beds, bridges, supports, wires, edges, zones]) part.dispose();
      group.removeFromParent();
    },
  };
}
/** @typedef {ReturnType<typeof makeParts>} Parts */

/**
 * Ground, sky and light of an hour.
 *
 * @param {Parts} parts
 * @param {ScenePalette} palette
 * @param {Mood} now
 * @param {SunPlace} sun
 */
function paintHour({ fog, sky, terrain, lights }, palette, now, sun) {
  fog.color.copy(now.horizon);
  sky.apply(now);
  const graticule = new Color(palette.graticule).lerp(now.line, now.night);
  terrain.apply({
    ground: now.ground,
    graticule,
    contour: graticule.clone().lerp(new Color(palette.inkSecond), palette.isDark ? 0.08 : 0.24),
  });
  lights.apply(now, sun);
}

/**
 * Paint the things on the ground.
 *
 * @param {Parts} parts
 * @param {Shown} shown
 * @param {ScenePalette} palette
 * @param {number} night 0 to 1
 * @param {{ isNew?: boolean }} [how] isNew: other things than before, not the same in other colours
 */
function paintThings(parts, shown, palette, night, { isNew = false } = {}) {
  const { beds, bridges, zones, supports, wires, edges } = parts;
  const own = nightPalette(palette, night);
  const calm = palette.isDark ? 0.72 + 0.14 * night : 0; // in the dark theme surfaces are darker than lines
  /** @param {"bridge" | "railway"} name @param {number} share */
  const near = (name, share) => new Color(own[name]).lerp(new Color(own.ground), Math.max(share, calm));
  bridges.apply(near("bridge", 0.35));
  beds.apply(near("railway", 0.62));
  beds.ties.copy(near("railway", 0.25));
  beds.dams.copy(near("railway", palette.isDark ? 0.92 : 0.8));
  zones.apply(own);
  supports.apply(own);
  const lines = joined([
    wireSegments(shown.wires, shown.scene, own),
    railSegments(shown.rails, own),
    railWireSegments(shown.railWires, own),
    countedSegments(shown.counted.marks, own),
  ]);
  const borders = edgeSegments(shown.volumes, own);
  if (isNew) {
    wires.set(...lines);
    edges.set(...borders);
  } else {
    wires.recolour(lines[1]);
    edges.recolour(borders[1]);
  }
}

/**
 * Store for each zone whether it is in force; returns whether any has changed.
 *
 * @param {Shown} shown
 * @param {Date} moment
 * @param {Frame} frame
 */
function noteForce({ scene, volumes }, moment, frame) {
  let isOther = false;
  (scene?.zones ?? []).forEach(({ schedule }, number) => {
    const state = isInForce(schedule, moment.getTime(), frame.origin.position) !== false;
    if (state !== volumes[number].isInForce) isOther = true;
    volumes[number].isInForce = state;
  });
  return isOther;
}

/** @param {{ frame: Frame, palette: ScenePalette, quality?: Quality }} options */
export function makeWorld({ frame, palette: firstPalette, quality = "high" }) {
  const parts = makeParts(quality);
  const { group, fog, lights } = parts;
  let palette = firstPalette;
  let shown = emptyShown(frame);
  let moment = new Date(Date.UTC(2026, 5, 21, 10));
  let sun = sunAt(moment, frame.origin.position);
  let now = mood(palette, sun.altitude_deg);
  let paintedNight = 0;

  function paint() {
    now = mood(palette, sun.altitude_deg);
    paintHour(parts, palette, now, sun);
  }

  /** @param {{ isNew?: boolean }} [how] */
  function repaint(how) {
    paintedNight = now.night;
    paintThings(parts, shown, palette, now.night, how);
  }

  /** @param {Scene | null} scene */
  function show(scene) {
    shown = scene ? shownOf(scene, frame) : emptyShown(frame);
    noteForce(shown, moment, frame);
    parts.terrain.show(shown.ground, frame);
    parts.beds.show(shown.beds);
    parts.bridges.show(shown.bridges);
    parts.zones.show(shown.volumes);
    parts.supports.show(scene?.supports ?? [], frame, shown.masts, shown.ground.heightAt);
    repaint({ isNew: true });
  }

  paint();
  show(null);

  return {
    group,
    fog,
    frame,
    show,
    /** @param {Date} date */
    setSun(date) {
      moment = date;
      sun = sunAt(date, frame.origin.position);
      paint();
      if (noteForce(shown, moment, frame)) {
        parts.zones.show(shown.volumes);
        parts.edges.set(...edgeSegments(shown.volumes, nightPalette(palette, now.night)));
      }
      if (Math.abs(now.night - paintedNight) > NIGHT_STEP) repaint();
    },
    /** @param {ScenePalette} next */
    setPalette(next) {
      palette = next;
      paint();
      repaint();
    },
    /**
     * Update for a camera. Returns whether the next picture differs.
     *
     * @param {PerspectiveCamera} camera
     * @param {number} [look_m] distance to the target
     */
    update(camera, look_m = 0) {
      [fog.near, fog.far] = FOG_M.map((least_m, end) => Math.max(least_m, FOG_SHARES[end] * look_m));
      for (const own of [parts.wires, parts.edges]) own.reach(look_m / LINES_M);
      const hasMoved = lights.follow(camera, shown.ground.heightAt);
      if (hasMoved) parts.supports.shadowPixel(lights.pixel_m);
      return parts.supports.update(camera) || hasMoved;
    },
    /** @param {number} x @param {number} z */
    heightAt: (x, z) => shown.ground.heightAt(x, z),
    /** @returns {GroundLabel[]} */
    labels: () => (shown.scene ? labelsOf(shown.scene, frame, shown.volumes) : []),
    get light() {
      return { phase: now.phase, ...sun };
    },
    get wires() {
      return shown.wires;
    },
    dispose: () => parts.dispose(),
  };
}

/** @param {Frame} frame @returns {Shown} */
function emptyShown(frame) {
  const [lon, lat] = frame.origin.position;
  const flat = {
    ...FLAT,
    west_deg: lon - 0.05,
    north_deg: lat + 0.05,
    altitude_amsl_m: Array(4).fill(frame.origin.altitude_amsl_m),
  };
  return {
    scene: null,
    ground: makeGround(flat, frame),
    wires: NO_WIRES,
    counted: NO_AIR,
    rails: [],
    railWires: [],
    masts: [],
    beds: [],
    bridges: [],
    volumes: [],
  };
}

/** @param {Scene} scene @param {Frame} frame @returns {Shown} */
function shownOf(scene, frame) {
  const ground = makeGround(scene.ground, frame);
  const deckAt = deckUnder(scene.bridges, frame);
  const tracks = railwayTracks(scene.railways, { frame, ground, deckAt, wire_agl_m: scene.rules.rail_wire_agl_m });
  return {
    scene,
    ground,
    wires: wiresOf(scene, frame),
    counted: countedAir(scene, frame),
    rails: tracks.map(({ rails }) => rails),
    railWires: tracks.map((track) => track.wires),
    masts: tracks.map(({ masts }) => masts),
    beds: tracks.map(({ bed }) => bed),
    bridges: scene.bridges.map((bridge) => bridgeSolid(bridge, { frame, ground })),
    volumes: volumesOf(scene, frame, ground),
  };
}

/** @param {Scene} scene @param {Frame} frame @param {Ground} ground @returns {ShownVolume[]} */
function volumesOf({ zones, clip, rules }, frame, ground) {
  if (!zones.length) return [];
  const folds = foldsOf(ground);
  const within_m = withinFor(zones, frame, folds);
  return zones.map((zone) => ({
    ...zoneVolume(zone, { frame, ground, folds, clip, rules, within_m }),
    isInForce: true,
  }));
}

/** Segments, tints and sizes of several kinds as one of each. @param {readonly Segments[]} kinds @returns {Segments} */
function joined(kinds) {
  /** @param {0 | 1 | 2} part */
  const whole = (part) => {
    const all = new Float32Array(kinds.reduce((sum, kind) => sum + kind[part].length, 0));
    let at = 0;
    for (const kind of kinds) {
      all.set(kind[part], at);
      at += kind[part].length;
    }
    return all;
  };
  return [whole(0), whole(1), whole(2)];
}
