/** Each picture of the view: where everything is at the moment, where the camera stands, what is written beside it. */

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
const REACH_M = 3_000; // wires and towers are looked for
const PICK_PX = { uav: 26, target: 18 };
const TARGET_NAMES_M = 500; // from where on a target has its name besides its label
const ROUTES = 8;
const TOGETHER_M = 90;
const TOGETHER_SHARE = 0.4;

/** See stage.js for what it is given; overlays(): elements that stand over the picture. → { draw({ dt_s }), pick({ x, y }), drawn(), describe() }. */
export function createFrames({
  stage,
  scene,
  picture,
  canvas,
  rig,
  hands,
  player,
  flight,
  targets,
  labels,
  instruments,
  palette,
  atNow,
  isCalm,
  surroundings,
  overlays,
  choose,
  seeTarget,
}) {
  const { source } = stage;
  const names = new Map(targets.map(({ place, label, name }) => [place, { label, name }]));
  const where = new Map(targets.map((target) => [target.place, target.place3d]));
  const assets = new Set(targets.map(({ asset }) => asset)); // a target's own label names it already
  const [longitude_deg] = scene.origin.position;
  let drawn = [];
  let read_ms = -Infinity;
  let described_ms = -Infinity;
  let ground = []; // labels of what stands on it
  let covered = []; // boxes of the picture that labels keep out of

  function momentAt(route, at_ms) {
    if (source.momentAt) return source.momentAt(route, at_ms);
    const moment = momentOf(route.pieces, at_ms);
    const first = route.pieces[0]?.samples[0];
    if (moment || !first || source.kind === "record") return moment;
    return { ...first, kind: route.pieces[0].kind, isInAir: false, altitude_relative_m: 0, speed_mps: 0, climb_mps: 0 }; // it stands there until it departs
  }

  function drawnAt(at_ms) {
    return source.routes.flatMap((route) => {
      const moment = momentAt(route, at_ms);
      if (!moment) return [];
      const task = taskOf(route, moment);
      const own = flight.at(route, moment, where.get(task.target) ?? null);
      const report = moment.kind === ESTIMATED || moment.kind === LOST ? reportOf(route, moment) : null;
      return [{ ...own, task, report, colour: palette().routes[route.place % ROUTES], name: route.name }];
    });
  }

  function reportOf(route, moment) {
    const told = source.kind === "live" ? route.uavNow?.measured : reportBefore(route, moment);
    return told?.position ? flight.at(route, { ...moment, ...told, heading_deg: 0, kind: MEASURED }).place : null;
  }

  function draw({ dt_s, now_ms }) {
    const at_ms = atNow();
    hands.advance(dt_s);
    drawn = drawnAt(at_ms);
    const subject = drawn.find(({ route }) => route === stage.chosen) ?? null;
    const target = targetToSee(source, stage.target, subject?.task, stage.chosen);
    const focus = target ? focusOf(where.get(target.place), subject) : null;
    const pose = rig.pose({ subject, focus, dt_s, groundAt: picture.groundAt });
    const away_m =
      rig.mode === "free" && subject ? lengthOf(minus(pose.eye, subject.place)) : lengthOf(minus(pose.eye, pose.look));
    const sun = sunTime(source, at_ms, longitude_deg);
    const wind = source.windAt(at_ms, subject?.height_agl_m ?? 0);
    const isPlaying = player ? player.isPlaying : source.kind === "live";
    picture.setDate(sun);
    const hidden = rig.mode === "onboard" ? stage.chosen : null;
    const room_m = stage.isFlat
      ? 0
      : roomRound(
          surroundings,
          pose.eye,
          drawn.filter(({ route }) => route !== hidden).map(({ place }) => place),
        );
    const goesOn = picture.show({
      pose,
      distance_m: Math.max(2, away_m),
      room_m,
      drawn,
      chosen: stage.chosen,
      looked: null,
      hidden,
      at_ms: source.kind === "live" ? null : at_ms,
      wind,
      dt_s: isPlaying && !isCalm() ? dt_s : 0,
    });
    write({ at_ms, subject, pose, sun, wind, isPlaying, now_ms, target });
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

  /** What is orbited: the target, with the UAV in the picture while it is at it. */
  function focusOf(place, subject) {
    return subject && lengthOf(minus(subject.place, place)) < TOGETHER_M
      ? between(place, subject.place, TOGETHER_SHARE)
      : place;
  }

  function write({ subject, pose, sun, wind, isPlaying, now_ms, target }) {
    const isDue = !isPlaying || now_ms - read_ms >= READ_EVERY_MS;
    if (isDue) {
      read_ms = now_ms;
      covered = boxesOf(overlays());
      ground = groundLabels(
        picture.labels().filter(({ kind, id }) => kind === "zone" || !assets.has(id)),
        pose.eye,
      );
      const route = source.routes.find(({ place }) => place === stage.chosen) ?? null;
      instruments.show(
        route,
        subject,
        subject
          ? readingsOf(subject, { nearest: nearestOf(subject, sun), task: subject.task, wind, labels: names })
          : [],
        Boolean(route?.isSimulated) && !source.isSimulated,
      );
    }
    if (!isPlaying || now_ms - described_ms >= DESCRIBE_EVERY_MS) {
      described_ms = now_ms;
      const words = describe(subject, target);
      if (canvas.getAttribute("aria-label") !== words) canvas.setAttribute("aria-label", words);
    }
    labels.setNight(picture.isNight());
    labels.show(
      [
        ...drawn
          .filter(({ route }) => (rig.mode !== "onboard" && rig.mode !== "chase") || route !== stage.chosen)
          .map(labelOf),
        ...targets.map((one) => targetLabel(one, pose.eye)),
        ...ground,
      ],
      picture.project,
      picture.size,
      covered,
    );
  }

  function boxesOf(elements) {
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

  function nearestOf(uav, date) {
    const keep = ({ schedule }) => isInForce(schedule, date.getTime(), scene.origin.position) !== false;
    return {
      wire: nearestWire(surroundings, uav.place, REACH_M),
      tower: nearestTower(surroundings, uav.place, REACH_M),
      zone: nearestZone(surroundings, uav.place, keep),
    };
  }

  function labelOf(uav) {
    const { kind } = uav.moment;
    const fact = kind === MEASURED || source.kind === "plan" ? heightText(uav.height_agl_m) : certaintyText(uav.moment);
    return {
      key: `uav ${uav.route}`,
      place: [uav.place[0], uav.place[1] + 0.5, uav.place[2]],
      parts: [`${routeLetter(uav.route)} ${uav.name}`, fact],
      className: `uav route-${(uav.route % ROUTES) + 1}${uav.route === stage.chosen ? " chosen" : ""}${kind === LOST ? " lost" : ""}`,
      weight: uav.route === stage.chosen ? 200 : 150,
    };
  }

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

  /** What the picture shows, as a sentence. */
  function describe(subject, target) {
    const camera = rig.mode === "orbit" && target ? `${CAMERA_LONG.orbit} ${target.label}` : CAMERA_LONG[rig.mode];
    const uav = subject
      ? `${routeLetter(subject.route)} ${subject.name}, ${t("{height} above ground", { height: heightText(subject.height_agl_m) })}, ${certaintyText(subject.moment)}`
      : "";
    const shown = tn(drawn.length, "{count} UAV", "{count} UAVs");
    const view = stage.isFlat ? t("View from above, without WebGL") : t("3D view");
    return [`${view}: ${shown}`, camera, uav].filter(Boolean).join("; ");
  }

  return {
    draw,
    drawn: () => drawn,
    pick({ x, y }) {
      const nearest = (items, reach_px) =>
        items
          .map(({ place, ...item }) => ({ ...item, at: picture.project(place) }))
          .filter(({ at }) => at && Math.hypot(at.x - x, at.y - y) < reach_px)
          .sort((a, b) => a.at.away_m - b.at.away_m)[0];
      const uav = nearest(
        drawn.map(({ place, route }) => ({ place, route })),
        PICK_PX.uav,
      );
      if (uav) return choose(uav.route);
      const target = nearest(
        targets.map(({ place3d, place }) => ({ place: place3d, number: place })),
        PICK_PX.target,
      );
      return target ? seeTarget(target.number) : false;
    },
  };
}
