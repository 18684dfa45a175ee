/** The world of the 3D view: everything that stands on the ground, with sun and sky. Its interface is told in docs/scene.md. */

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
const FOG_M = [4_000, 30_000]; // begins, hides all
const FOG_SHARES = [1.1, 3]; // of what is looked at from farther away: that is never in the fog
const LINES_M = 4_000; // what is looked at from farther away has lines as strong as from here
const FLAT = { columns: 2, rows: 2, step_lon_deg: 0.1, step_lat_deg: 0.1 };
const NO_AIR = { points: new Float64Array(0), first: new Uint32Array(1), marks: new Float32Array(0) };
const NO_WIRES = {
  points: new Float64Array(0),
  first: new Uint32Array(1),
  span: new Uint32Array(0),
  isEarth: new Uint8Array(0),
};

/** quality: "high", or "low" without shadows and with little bracing. */
export function makeWorld({ frame, palette: firstPalette, quality = "high" }) {
  const group = new Group();
  const fog = new Fog(0xffffff, ...FOG_M);
  const lights = makeLights({ shadows: quality !== "low" });
  const [sky, terrain, beds, bridges, zones] = [makeSky(), makeTerrain(), makeBeds(), makeBridges(), makeZones()];
  const supports = makeSupports({ bracing: BRACING[quality] });
  const wires = screenLines({ fade: [3_500, 0.3], order: 2 });
  const edges = screenLines({ fade: [16_000, 0.5], order: 4 });
  const parts = [sky, terrain, beds, bridges, supports, wires, edges, zones];
  group.add(
    lights.group,
    supports.group,
    ...[sky, terrain, beds, bridges, zones, wires, edges].map((part) => part.mesh),
  );

  let palette = firstPalette;
  let scene = null;
  let shown = emptyShown(frame);
  let moment = new Date(Date.UTC(2026, 5, 21, 10));
  let sun = null;
  let now = null;
  let paintedNight = 0;

  function paint() {
    now = mood(palette, sun.altitude_deg);
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

  /** isNew: other things than before, not the same in other colours. */
  function paintThings({ isNew = false } = {}) {
    const own = nightPalette(palette, now.night);
    paintedNight = now.night;
    const calm = palette.isDark ? 0.72 + 0.14 * now.night : 0; // in the dark theme surfaces are darker than lines
    const near = (name, share) => new Color(own[name]).lerp(new Color(own.ground), Math.max(share, calm));
    bridges.apply(near("bridge", 0.35));
    beds.apply(near("railway", 0.62));
    beds.ties.copy(near("railway", 0.25));
    beds.dams.copy(near("railway", palette.isDark ? 0.92 : 0.8));
    zones.apply(own);
    supports.apply(own);
    const [lines, borders] = [
      joined([
        wireSegments(shown.wires, scene, own),
        railSegments(shown.rails, own),
        railWireSegments(shown.railWires, own),
        countedSegments(shown.counted.marks, own),
      ]),
      edgeSegments(shown.volumes, own),
    ];
    if (isNew) {
      wires.set(...lines);
      edges.set(...borders);
    } else {
      wires.recolour(lines[1]);
      edges.recolour(borders[1]);
    }
  }

  function tellForce() {
    const states = (scene?.zones ?? []).map(
      (zone) => isInForce(zone.schedule, moment.getTime(), frame.origin.position) !== false,
    );
    const isSame = states.every((state, number) => state === shown.volumes[number].isInForce);
    states.forEach((state, number) => (shown.volumes[number].isInForce = state));
    return !isSame;
  }

  function setSun(date) {
    moment = date;
    sun = sunAt(date, frame.origin.position);
    paint();
    const isOtherForce = tellForce();
    if (isOtherForce) zones.show(shown.volumes);
    if (isOtherForce) edges.set(...edgeSegments(shown.volumes, nightPalette(palette, now.night)));
    if (Math.abs(now.night - paintedNight) > NIGHT_STEP) paintThings();
  }

  function show(sceneData) {
    scene = sceneData;
    shown = sceneData ? shownOf(sceneData, frame) : emptyShown(frame);
    tellForce();
    terrain.show(shown.ground, frame);
    beds.show(shown.beds);
    bridges.show(shown.bridges);
    zones.show(shown.volumes);
    supports.show(sceneData?.supports ?? [], frame, shown.masts, shown.ground.heightAt);
    paintThings({ isNew: true });
  }

  sun = sunAt(moment, frame.origin.position);
  paint();
  show(null);

  return {
    group,
    fog,
    frame,
    show,
    setSun,
    setPalette(next) {
      palette = next;
      paint();
      paintThings();
    },
    update(camera, look_m = 0) {
      [fog.near, fog.far] = FOG_M.map((least_m, end) => Math.max(least_m, FOG_SHARES[end] * look_m));
      for (const own of [wires, edges]) own.reach(look_m / LINES_M);
      const hasMoved = lights.follow(camera, shown.ground.heightAt);
      if (hasMoved) supports.shadowPixel(lights.pixel_m);
      return supports.update(camera) || hasMoved;
    },
    heightAt: (x, z) => shown.ground.heightAt(x, z),
    labels: () => (scene ? labelsOf(scene, frame, shown.volumes) : []),
    get light() {
      return { phase: now.phase, ...sun };
    },
    get wires() {
      return shown.wires;
    },
    dispose() {
      lights.dispose();
      for (const part of parts) part.dispose();
      group.removeFromParent();
    },
  };
}

function emptyShown(frame) {
  const [lon, lat] = frame.origin.position;
  const flat = {
    ...FLAT,
    west_deg: lon - 0.05,
    north_deg: lat + 0.05,
    altitude_amsl_m: Array(4).fill(frame.origin.altitude_amsl_m),
  };
  return {
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

function shownOf(scene, frame) {
  const ground = makeGround(scene.ground, frame);
  const deckAt = deckUnder(scene.bridges, frame);
  const tracks = railwayTracks(scene.railways, { frame, ground, deckAt, wire_agl_m: scene.rules.rail_wire_agl_m });
  return {
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

function volumesOf({ zones, clip, rules }, frame, ground) {
  if (!zones.length) return [];
  const folds = foldsOf(ground);
  const within_m = withinFor(zones, frame, folds);
  return zones.map((zone) => zoneVolume(zone, { frame, ground, folds, clip, rules, within_m }));
}

/** Segments, tints and sizes of several kinds as one of each. */
function joined(kinds) {
  return [0, 1, 2].map((part) => {
    const whole = new Float32Array(kinds.reduce((sum, kind) => sum + kind[part].length, 0));
    let at = 0;
    for (const kind of kinds) {
      whole.set(kind[part], at);
      at += kind[part].length;
    }
    return whole;
  });
}
