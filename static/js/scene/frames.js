/** Each picture of the view: positions at the moment, the camera, and the labels. */

import { routeLetter } from "../domain/palette.js";
import { isInForce } from "../domain/zones_in_force.js";
import { t, tn } from "../text.js";
import { heightText } from "../units.js";
import { CAMERA_LONG } from "./camera_bar.js";
import { between, lengthOf, minus } from "./cameras/vectors.js";
import { nearestTower, nearestWire, nearestZone, roomRound } from "./instruments/distances.js";
import { certaintyText, readingsOf } from "./instruments/readings.js";
import { taskOf } from "./instruments/task.js";
import { groundLabels } from "./labels.js";
import { ESTIMATED, LOST, MEASURED, momentOf } from "./sources/pieces.js";
import { reportBefore, sunTime, targetToSee } from "./state.js";

const READ_EVERY_MS = 250; // instruments while it plays
const DESCRIBE_EVERY_MS = 2_000;
const REACH_M = 3_000; // search radius of wires and towers
const PICK_PX = { uav: 26, target: 18 };
const TARGET_NAMES_M = 500; // within this distance a target shows its name besides its label
const ROUTES = 8;
const TOGETHER_M = 90;
const TOGETHER_SHARE = 0.4;

/** @import { Scene } from "../api_types.d.ts" */
/** @import { Player } from "../record/player.js" */
/** @import { Hands } from "./cameras/hands.js" */
/** @import { Pose, Rig } from "./cameras/rig.js" */
/** @import { Flight } from "./flight/drawn_flight.js" */
/** @import { Surroundings } from "./instruments/distances.js" */
/** @import { Instruments } from "./instruments/panel.js" */
/** @import { ScreenBox } from "./label_places.js" */
/** @import { Labels, SceneLabel } from "./labels.js" */
/** @import { DrawnUav, FlightRoute, FrameTime, Moment, Picture, PlacedTarget, ScenePalette, SourceTarget, StageState, Vector, Wind } from "./types.d.ts" */

/** @typedef {ReturnType<typeof createFrames>} Frames */
/**
 * Context of frames.
 *
 * @typedef {object} FramesContext
 * @property {StageState} stage
 * @property {Scene} scene
 * @property {Picture} picture
 * @property {HTMLCanvasElement} canvas
 * @property {Rig} rig
 * @property {Hands} hands
 * @property {Player | null} player
 * @property {Flight} flight
 * @property {PlacedTarget[]} targets
 * @property {Labels} labels
 * @property {Instruments} instruments
 * @property {() => ScenePalette} palette
 * @property {() => number} atNow
 * @property {() => boolean} isCalm
 * @property {Surroundings} surroundings
 * @property {() => Element[]} overlays elements over the picture
 * @property {(place: number) => boolean} choose a UAV
 * @property {(place: number) => boolean} seeTarget
 */
/**
 * What one frame shows.
 *
 * @typedef {object} Shown
 * @property {DrawnUav[]} drawn
 * @property {DrawnUav | null} subject the UAV that is followed
 * @property {SourceTarget | null} target that is selected
 * @property {Pose} pose
 * @property {Date} sun
 * @property {Wind | null} wind
 * @property {boolean} isPlaying
 */

/** Where the UAVs are at a moment. @param {FramesContext} context */
function drawnUavs({ stage: { source }, flight, targets, palette }) {
  const where = new Map(targets.map(({ place, place3d }) => [place, place3d]));

  /** @param {FlightRoute} route @param {number} at_ms @returns {Moment | null} */
  function momentAt(route, at_ms) {
    if (source.momentAt) return source.momentAt(route, at_ms);
    const moment = momentOf(route.pieces, at_ms);
    const [piece] = route.pieces;
    if (moment || !piece || source.kind === "record") return moment;
    const stands = { isInAir: false, altitude_relative_m: 0, speed_mps: 0, climb_mps: 0 }; // there until it departs
    return { ...piece.samples[0], kind: piece.kind, ...stands };
  }

  /** The last report of a route before a moment. @param {FlightRoute} route @param {Moment} moment */
  function reportOf(route, moment) {
    const report = source.kind === "live" ? route.uavNow?.measured : reportBefore(route, moment);
    if (!report?.position) return null;
    return flight.at(route, { ...moment, ...report, position: report.position, heading_deg: 0, kind: MEASURED }).place;
  }

  /** @param {number} at_ms @returns {DrawnUav[]} */
  return (at_ms) =>
    source.routes.flatMap((route) => {
      const moment = momentAt(route, at_ms);
      if (!moment) return [];
      const task = taskOf(route, moment);
      const own = flight.at(route, moment, task.target === null ? null : (where.get(task.target) ?? null));
      const report = moment.kind === ESTIMATED || moment.kind === LOST ? reportOf(route, moment) : null;
      return [{ ...own, task, report, colour: palette().routes[route.place % ROUTES], name: route.name }];
    });
}

/** Instruments, labels, and the picture in a sentence. @param {FramesContext} context */
function createWriting(context) {
  const { stage, scene, picture, canvas, rig, targets, labels, instruments, surroundings, overlays } = context;
  const { source } = stage;
  const names = new Map(targets.map(({ place, label, name }) => [place, { label, name }]));
  const assets = new Set(targets.map(({ asset }) => asset)); // a target's own label names it already
  let read_ms = -Infinity;
  let described_ms = -Infinity;
  /** @type {SceneLabel[]} labels of towers, bridges and zones */
  let ground = [];
  /** @type {ScreenBox[]} of the picture that labels keep out of */
  let covered = [];

  /** @param {DrawnUav} uav @param {Date} date */
  function nearestTo({ place }, date) {
    return {
      wire: nearestWire(surroundings, place, REACH_M),
      tower: nearestTower(surroundings, place, REACH_M),
      zone: nearestZone(
        surroundings,
        place,
        ({ schedule }) => isInForce(schedule, date.getTime(), scene.origin.position) !== false,
      ),
    };
  }

  /** @param {Shown} shown */
  function read({ subject, pose, sun, wind }) {
    covered = boxesOf(canvas, overlays());
    ground = groundLabels(
      picture.labels().filter(({ kind, id }) => kind === "zone" || !assets.has(id)),
      pose.eye,
    );
    const route = source.routes.find(({ place }) => place === stage.chosen) ?? null;
    const readings = subject
      ? readingsOf(subject, { nearest: nearestTo(subject, sun), task: subject.task, wind, labels: names })
      : [];
    instruments.show(route, subject, readings, Boolean(route?.isSimulated) && !source.isSimulated);
  }

  /** @param {number} place of the route */
  const isSimulatedAt = (place) => source.routes.some((route) => route.place === place && route.isSimulated);

  /** What the picture shows, as a sentence. @param {Shown} shown */
  function describe({ drawn, subject, target }) {
    const camera = rig.mode === "orbit" && target ? `${CAMERA_LONG.orbit} ${target.label}` : CAMERA_LONG[rig.mode];
    const uav = subject
      ? `${routeLetter(subject.route)} ${subject.name}, ${t("{height} above ground", { height: heightText(subject.height_agl_m) })}, ${certaintyText(subject.moment, isSimulatedAt(subject.route))}`
      : "";
    const shown = tn(drawn.length, "{count} UAV", "{count} UAVs");
    const view = stage.isFlat ? t("View from above, without WebGL") : t("3D view");
    return [`${view}: ${shown}`, camera, uav].filter(Boolean).join("; ");
  }

  /** @param {Shown} shown @param {number} now_ms */
  return (shown, now_ms) => {
    const { drawn, pose, isPlaying } = shown;
    if (!isPlaying || now_ms - read_ms >= READ_EVERY_MS) {
      read_ms = now_ms;
      read(shown);
    }
    if (!isPlaying || now_ms - described_ms >= DESCRIBE_EVERY_MS) {
      described_ms = now_ms;
      const words = describe(shown);
      if (canvas.getAttribute("aria-label") !== words) canvas.setAttribute("aria-label", words);
    }
    const seesSubject = rig.mode !== "onboard" && rig.mode !== "chase";
    const named = drawn.filter(({ route }) => seesSubject || route !== stage.chosen);
    labels.setNight(picture.isNight());
    labels.show(
      [...named.map((uav) => uavLabel(uav, stage)), ...targets.map((one) => targetLabel(one, pose.eye)), ...ground],
      picture.project,
      picture.size,
      covered,
    );
  };
}

/**
 * Boxes of elements within the picture.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {Element[]} elements
 * @returns {ScreenBox[]}
 */
function boxesOf(canvas, elements) {
  const corner = canvas.getBoundingClientRect();
  return elements
    .map((element) => element.getBoundingClientRect())
    .filter(({ width, height }) => width > 0 && height > 0)
    .map(({ left, top, right, bottom }) => ({
      left: left - corner.left,
      top: top - corner.top,
      right: right - corner.left,
      bottom: bottom - corner.top,
    }));
}

/** @param {DrawnUav} uav @param {StageState} stage @returns {SceneLabel} */
function uavLabel({ moment, route, name, place, height_agl_m }, { source, chosen }) {
  const { kind } = moment;
  const fact = kind === MEASURED || source.kind === "plan" ? heightText(height_agl_m) : certaintyText(moment, false);
  return {
    key: `uav ${route}`,
    place: [place[0], place[1] + 0.5, place[2]],
    parts: [`${routeLetter(route)} ${name}`, fact],
    className: `uav route-${(route % ROUTES) + 1}${route === chosen ? " chosen" : ""}${kind === LOST ? " lost" : ""}`,
    weight: route === chosen ? 200 : 150,
  };
}

/** @param {PlacedTarget} target @param {Vector} eye @returns {SceneLabel} */
function targetLabel({ place, label, name, route, place3d }, eye) {
  const away_m = lengthOf(minus(place3d, eye));
  return {
    key: `target ${place}`,
    place: place3d,
    parts: [label, away_m < TARGET_NAMES_M ? name : ""],
    className: `target route-${(route % ROUTES) + 1}`,
    weight: 100 - Math.min(60, away_m / 100),
  };
}

/**
 * The point to orbit: the target, with the UAV in the picture while it is there.
 *
 * @param {Vector} place
 * @param {DrawnUav | null} subject
 */
function focusOf(place, subject) {
  return subject && lengthOf(minus(subject.place, place)) < TOGETHER_M
    ? between(place, subject.place, TOGETHER_SHARE)
    : place;
}

/**
 * The item nearest to a place of the screen, within reach.
 *
 * @template Item
 * @param {readonly Item[]} items
 * @param {(item: Item) => Vector} placeOf
 * @param {Picture} picture
 * @param {{ x: number, y: number }} at
 * @param {number} reach_px
 */
function nearestOnScreen(items, placeOf, picture, { x, y }, reach_px) {
  /** @type {{ item: Item, away_m: number } | null} */
  let nearest = null;
  for (const item of items) {
    const seen = picture.project(placeOf(item));
    if (!seen || Math.hypot(seen.x - x, seen.y - y) >= reach_px) continue;
    if (!nearest || seen.away_m < nearest.away_m) nearest = { item, away_m: seen.away_m };
  }
  return nearest?.item ?? null;
}

/** @param {FramesContext} context */
export function createFrames(context) {
  const { stage, scene, picture, rig, hands, player, targets, atNow, isCalm, surroundings } = context;
  const { source } = stage;
  const [longitude_deg] = scene.origin.position;
  const drawnAt = drawnUavs(context);
  const write = createWriting(context);
  /** @type {DrawnUav[]} */
  let drawn = [];

  /** How near the nearest thing is. @param {Pose} pose @param {number | null} hidden */
  function roomAt(pose, hidden) {
    if (stage.isFlat) return 0;
    const others = drawn.filter(({ route }) => route !== hidden).map(({ place }) => place);
    return roomRound(surroundings, pose.eye, others);
  }

  /** Draw a frame. Returns whether the next one is needed at once. @param {FrameTime} time */
  function draw({ dt_s, now_ms }) {
    const at_ms = atNow();
    hands.advance(dt_s);
    drawn = drawnAt(at_ms);
    const subject = drawn.find(({ route }) => route === stage.chosen) ?? null;
    const target = targetToSee(source, stage.target, subject?.task, stage.chosen);
    const place = targets.find((one) => one.place === target?.place)?.place3d;
    const pose = rig.pose({ subject, focus: place ? focusOf(place, subject) : null, dt_s, groundAt: picture.groundAt });
    const looked = rig.mode === "free" && subject ? subject.place : pose.look;
    const sun = sunTime(source, at_ms, longitude_deg);
    const wind = source.windAt(at_ms, subject?.height_agl_m ?? 0);
    const isPlaying = player ? player.isPlaying : source.kind === "live";
    picture.setDate(sun);
    const hidden = rig.mode === "onboard" ? stage.chosen : null;
    const goesOn = picture.show({
      pose,
      distance_m: Math.max(2, lengthOf(minus(pose.eye, looked))),
      room_m: roomAt(pose, hidden),
      drawn,
      chosen: stage.chosen,
      looked: null,
      hidden,
      at_ms: source.kind === "live" ? null : at_ms,
      wind,
      dt_s: isPlaying && !isCalm() ? dt_s : 0,
    });
    write({ drawn, subject, target, pose, sun, wind, isPlaying }, now_ms);
    const isFlying = source.kind === "live" && !isCalm() && drawn.some(({ isInAir }) => isInAir);
    return (
      goesOn ||
      (player?.isPlaying ?? false) ||
      isFlying ||
      hands.isHeld() ||
      rig.isMoving(subject) ||
      (source.isGliding?.(at_ms) ?? false)
    );
  }

  return {
    draw,
    drawn: () => drawn,
    /** A UAV or a target at a place of the picture. @param {{ x: number, y: number }} at */
    pick(at) {
      const uav = nearestOnScreen(drawn, ({ place }) => place, picture, at, PICK_PX.uav);
      if (uav) return context.choose(uav.route);
      const target = nearestOnScreen(targets, ({ place3d }) => place3d, picture, at, PICK_PX.target);
      return target ? context.seeTarget(target.place) : false;
    },
  };
}
