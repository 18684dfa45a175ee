/** Acts on the 3D view: cameras, UAVs, targets, time, saving a picture and a link. Each returns whether it was done. */

import { routeLetter } from "../domain/palette.js";
import { copyText } from "../page/clipboard.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { dateText, exactClockText, sinceText } from "../units.js";
import { CAMERA_LONG } from "./camera_bar.js";
import { linkText } from "./link.js";
import { nextOf, targetToSee } from "./state.js";
import { download, fileName, stillOf } from "./still.js";

/** @import { Player } from "../record/player.js" */
/** @import { Hands } from "./cameras/hands.js" */
/** @import { CameraMode, Rig } from "./cameras/rig.js" */
/** @import { Labels } from "./labels.js" */
/** @import { SceneLink } from "./link.js" */
/** @import { DrawnUav, FlightSource, Picture, PlacedTarget, ScenePalette, StageState } from "./types.d.ts" */

/** @typedef {ReturnType<typeof createActs>} SceneActs */
/**
 * Context of the acts.
 *
 * @typedef {object} ActsContext
 * @property {StageState} stage
 * @property {Rig} rig
 * @property {Hands} hands
 * @property {Picture} picture
 * @property {Player | null} player
 * @property {boolean} hasOwnTime whether the player is the view's own
 * @property {PlacedTarget[]} targets
 * @property {Labels} labels
 * @property {() => number} atNow
 * @property {() => DrawnUav[]} drawn what the last picture shows
 * @property {() => ScenePalette} palette
 * @property {() => void} onChange the content of a link has changed
 * @property {() => void} onClose
 * @property {(direction: number) => void} step to the next event
 * @property {() => void} showBar cameras and UAVs have changed
 */

const WHOLE_M = 150; // round a flight of one place

/** Since departure, where a flight has no date. @param {FlightSource} source @param {number} at_ms */
const sinceDeparture_s = ({ departs_ms }, at_ms) => (at_ms - (departs_ms ?? 0)) / 1_000;

/** @param {FlightSource} source @param {number} at_ms */
function timeWords(source, at_ms) {
  if (!source.hasDate) return sinceText(sinceDeparture_s(source, at_ms));
  return `${dateText(at_ms)}, ${exactClockText(at_ms)}`;
}

/**
 * "2026-09-10-091204", "95s": a moment as a part of a file's name.
 *
 * @param {FlightSource} source
 * @param {number} at_ms
 */
function timeName(source, at_ms) {
  if (!source.hasDate) return `${Math.round(sinceDeparture_s(source, at_ms))}s`;
  return new Date(at_ms).toISOString().slice(0, 19).replaceAll(":", "").replace("T", "-");
}

/** @param {FlightSource} source */
function whatFlies(source) {
  const simulated = source.routes.filter(({ isSimulated }) => isSimulated);
  if (source.isSimulated) return t("Simulated");
  if (simulated.length)
    return t("Simulated, no real aircraft: {names}.", { names: simulated.map(({ name }) => name).join(", ") });
  return source.kind === "plan" ? t("Planned, not flown") : "Spanwise";
}

/** The search part of an address that reopens this view. @param {ActsContext} context */
function linkTo({ stage: { source, chosen, target }, rig, picture, atNow }) {
  const state = rig.state();
  const place = state.mode === "free" ? picture.frame.toGeographic(state.eye) : null;
  const at_ms = source.kind !== "live" && source.hasDate ? Math.round(atNow()) : null;
  const since_s = source.kind !== "live" && !source.hasDate ? sinceDeparture_s(source, atNow()) : null;
  return linkText({
    source: { kind: source.kind, rehearsal: source.rehearsal ?? null, run: source.run ?? null },
    at_ms,
    since_s,
    uav: chosen,
    target,
    camera: { ...state, place },
  });
}

/** Fit the whole plan into the picture; returns whether there is one. @param {ActsContext} context */
function fitAll({ stage, rig, targets, drawn }) {
  const shown = drawn();
  const places = [...targets.map(({ place3d }) => place3d), ...shown.map(({ place }) => place)];
  if (!places.length) return false;
  const [x, z] = [0, 2].map((axis) => {
    const values = places.map((place) => place[axis]);
    return (Math.min(...values) + Math.max(...values)) / 2;
  });
  const radius_m = Math.max(WHOLE_M, ...places.map((place) => Math.hypot(place[0] - x, place[2] - z)));
  if (rig.mode !== "top" && !stage.isFlat) rig.setMode("orbit");
  rig.fit(radius_m);
  const subject = shown.find(({ route }) => route === stage.chosen);
  const target = targetToSee(stage.source, stage.target, subject?.task, stage.chosen);
  const orbited = rig.mode === "top" ? undefined : targets.find(({ place }) => place === target?.place)?.place3d;
  const from = orbited ?? subject?.place ?? [0, 0, 0];
  rig.offset = [x - from[0], 0, z - from[2]];
  return true;
}

/** Save the picture with a caption as a file. @param {ActsContext} context */
async function keep({ stage: { mission, source, chosen }, rig, picture, labels, palette, atNow }) {
  const uav = source.routes.find(({ place }) => place === chosen);
  const facts = [timeWords(source, atNow()), uav && `${routeLetter(uav.place)} ${uav.name}`, CAMERA_LONG[rig.mode]];
  await download(
    stillOf(
      picture.copy(),
      labels.shown(),
      [mission.name, facts.filter(Boolean).join(" · "), whatFlies(source)],
      palette(),
    ),
    fileName(mission.name, timeName(source, atNow()), rig.mode),
  );
}

/** Begin as the link states, else behind the first UAV. @param {ActsContext} context @param {SceneLink | null} wanted */
function begin({ stage, rig, picture, player, hasOwnTime, targets }, wanted) {
  const places = stage.source.routes.map(({ place }) => place);
  const { camera = null, at_ms = null, since_s = null, uav = null, target = null } = wanted ?? {};
  stage.chosen = uav !== null && places.includes(uav) ? uav : (places[0] ?? null);
  stage.target = targets.some(({ place }) => place === target) ? target : null;
  if (camera) {
    const eye = camera.place && picture.frame.toLocal(...camera.place);
    const view = stage.isFlat && camera.mode !== "top" ? null : camera.view;
    rig.restore({ mode: stage.isFlat ? "top" : camera.mode, eye, offset: camera.offset, view });
  } else if (stage.isFlat) rig.restore({ mode: "top" });
  if (!player || !hasOwnTime) return;
  if (at_ms !== null) player.seek(at_ms);
  else if (since_s !== null) player.seek((stage.source.departs_ms ?? 0) + since_s * 1_000);
}

/** @param {ActsContext} context */
export function createActs(context) {
  const { stage, rig, hands, picture, player, hasOwnTime, targets, drawn, onChange, onClose, step, showBar } = context;
  const { source } = stage;
  const places = source.routes.map(({ place }) => place);

  function changed() {
    showBar();
    picture.request();
    onChange();
    return true;
  }

  /** @param {number | null} place of a UAV */
  function choose(place) {
    if (place === null || !places.includes(place)) return false;
    stage.chosen = place;
    stage.target = null;
    rig.glide();
    return changed();
  }

  /** @param {number | null} place of a target */
  function seeTarget(place) {
    if (place === null) return false;
    stage.target = place;
    if (rig.mode === "orbit") rig.glide();
    else if (!stage.isFlat) rig.setMode("orbit");
    return changed();
  }

  const address = () => `/missions/${stage.mission.id}/3d${linkTo(context)}`;

  return {
    /** @param {CameraMode} mode */
    setCamera(mode) {
      if (stage.isFlat && mode !== "top") return false;
      rig.setMode(mode);
      return changed();
    },
    choose,
    seeTarget,
    /** @param {number} number among the UAVs */
    chooseNumber: (number) => choose(places[number] ?? null),
    /** @param {number} by */
    next: (by) => choose(nextOf(places, stage.chosen, by)),
    /** @param {number} by */
    nextTarget(by) {
      const subject = drawn().find(({ route }) => route === stage.chosen);
      const seen = stage.target ?? targetToSee(source, null, subject?.task, stage.chosen)?.place ?? null;
      const order = targets.map(({ place }) => place);
      return seeTarget(rig.mode === "orbit" ? nextOf(order, seen, by) : seen);
    },
    /** @param {number} factor */
    zoom(factor) {
      rig.zoom(factor);
      return changed();
    },
    fit: () => fitAll(context) && changed(),
    /** @param {KeyboardEvent} event */
    press: (event) => hands.press(event),
    toggle() {
      if (!player || !hasOwnTime) return false;
      player.toggle();
      return true;
    },
    /** @param {number} direction 1 or -1 */
    step(direction) {
      step(direction);
      return player !== null;
    },
    /** @param {1 | -1} direction */
    changeSpeed(direction) {
      player?.changeSpeed(direction);
      return player !== null;
    },
    keepPicture: () => keep(context),
    async copyLink() {
      await copyText(new URL(address(), location.href).href);
      toast(t("The link to this moment is copied."));
    },
    address,
    close: () => onClose(),
    /** @param {SceneLink | null} wanted */
    begin(wanted) {
      begin(context, wanted);
      showBar();
    },
  };
}
