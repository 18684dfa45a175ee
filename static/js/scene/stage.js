/** The 3D view of one mission in an element: picture, labels, instruments, cameras and time. Used by its own page and by panels. */

import { get, signInAddress } from "../api.js";
import { h, icon } from "../dom.js";
import { alertsInOrder, isUnanswered, pinnedAlerts } from "../domain/order.js";
import { onTheme } from "../page/theme.js";
import { createPlayer } from "../record/player.js";
import { simulatedMark } from "../simulated.js";
import { t } from "../text.js";
import { exactClockText } from "../units.js";
import { createActs } from "./acts.js";
import { createCameraBar } from "./camera_bar.js";
import { listenToHands } from "./cameras/hands.js";
import { createRig } from "./cameras/rig.js";
import { createFlatPicture } from "./flat/flat_picture.js";
import { drawFlight } from "./flight/drawn_flight.js";
import { createFrames } from "./frames.js";
import { surroundingsOf } from "./instruments/distances.js";
import { createInstruments } from "./instruments/panel.js";
import { createLabels } from "./labels.js";
import { readScenePalette } from "./palette.js";
import { createPicture } from "./picture/picture.js";
import { NoWebGL } from "./picture/view.js";
import { boxRound, placesOf } from "./sources/box.js";
import { createTimeBar } from "./time_bar.js";

/** @import { Answer } from "../api.js" */
/** @import { Alert, Scene } from "../api_types.d.ts" */
/** @import { staleWords } from "../live/stale.js" */
/** @import { LoadedMission } from "../record/load.js" */
/** @import { Player, TimeSpan } from "../record/player.js" */
/** @import { ReplayEvent } from "../record/timeline.js" */
/** @import { Flight } from "./flight/drawn_flight.js" */
/** @import { Frames } from "./frames.js" */
/** @import { SceneLink } from "./link.js" */
/** @import { TimeBar } from "./time_bar.js" */
/** @import { FlightSource, Picture, PictureOptions, PlacedTarget, ScenePalette, StageState } from "./types.d.ts" */

/** @typedef {NonNullable<Awaited<ReturnType<typeof openStage>>>} Stage */
/**
 * Options of a stage.
 *
 * @typedef {object} StageOptions
 * @property {{ id: string, name: string }} mission
 * @property {FlightSource} source
 * @property {SceneLink | null} [link]
 * @property {boolean} [isPanel] with a button that closes it
 * @property {Player | null} [player] of the surrounding page; without it the stage has its own if the source has a span
 * @property {() => number} [now_ms] of a live source
 * @property {() => void} [onChange] the content of a link has changed
 * @property {() => void} [onClose]
 * @property {() => string} [openAddress]
 * @property {() => boolean} [isWanted] whether the stage is still wanted once the terrain is read
 */

const calm = matchMedia("(prefers-reduced-motion: reduce)");
const USUAL_SPEED = 5;
const JUMP_MS = 5_000; // from one frame to the next, at JUMP_SPEED or below
const JUMP_SPEED = 20;

const NO_WEBGL = t("WebGL is missing or switched off. You see the flight from above instead.");

/**
 * How the flight is seen: in space, or from above where there is no WebGL.
 *
 * @param {HTMLElement} holder
 * @param {PictureOptions} options
 */
function pictureIn(holder, options) {
  const canvas = () => h("canvas", { class: "scene-canvas", tabindex: 0, role: "img" });
  const first = canvas();
  holder.append(first);
  try {
    return { canvas: first, picture: createPicture(holder, first, options) };
  } catch (error) {
    if (!(error instanceof NoWebGL)) throw error;
    const second = canvas(); // a canvas that was tried for WebGL offers no other context
    first.replaceWith(second);
    return { canvas: second, picture: createFlatPicture(holder, second, options) };
  }
}

const MAX_ALERTS = 3;

/** @param {Alert} alert @param {string} address of the page of the flight, which then selects its UAV */
const alertLine = ({ uav, level, message, closed_at }, address) =>
  h(
    "li",
    { class: closed_at ? "known" : level },
    icon(level === "critical" ? "octagon-alert" : level === "warning" ? "triangle-alert" : "info", "small"),
    h("a", { href: uav === null ? address : `${address}?uav=${uav}` }, message),
    closed_at && h("small", {}, t("Ended {time}.", { time: exactClockText(closed_at) })),
  );

/** Notices over the picture: on the graphics, and on a silent source. */
function createNotices() {
  const notice = h("p", { class: "scene-notice float", role: "status", hidden: true });
  const stale = h("p", { class: "scene-notice float warning", role: "status", hidden: true });
  const alerts = h("ol", { class: "scene-alerts float", "aria-label": t("Alerts"), hidden: true });
  return {
    element: h("div", { class: "scene-notices" }, notice, stale, alerts),
    overlays: [notice, stale, alerts],
    /** Pinned over the picture, the worst first. @param {Alert[]} reported of a live source @param {string} address where they are answered */
    showAlerts(reported, address) {
      const shown = alertsInOrder(pinnedAlerts(reported).filter(isUnanswered)).slice(0, MAX_ALERTS);
      const key = JSON.stringify(shown.map(({ id, revision, message }) => [id, revision, message]));
      if (alerts.dataset.key === key) return;
      alerts.dataset.key = key;
      alerts.hidden = shown.length === 0;
      alerts.replaceChildren(...shown.map((alert) => alertLine(alert, address)));
    },
    /** @param {string} title @param {string} words */
    notify(title, words) {
      notice.hidden = false;
      notice.replaceChildren(icon("info"), h("span", {}, h("strong", {}, title), ` ${words}`));
    },
    quiet() {
      notice.hidden = true;
    },
    /** Show that a live source is stale. @param {ReturnType<typeof staleWords>} summary */
    showStale(summary) {
      const words = [summary?.words, summary?.rest].filter(Boolean).join(" ");
      if (stale.dataset.words === words) return;
      stale.dataset.words = words;
      stale.hidden = !summary;
      if (!summary) return;
      stale.replaceChildren(
        icon("cloud-off"),
        h(
          "span",
          {},
          h("strong", {}, summary.words),
          summary.rest && ` ${summary.rest}`,
          summary.needsDoor && [" ", h("a", { href: signInAddress() }, t("Sign in"))],
        ),
      );
    },
  };
}

/** What kind of flight it is. @param {FlightSource} source @param {Scene} scene */
const chipsOf = (source, scene) =>
  h(
    "div",
    { class: "scene-chips" },
    source.isSimulated && simulatedMark(),
    source.kind === "plan" && h("span", { class: "chip draft" }, t("Planned, not flown")),
    source.kind === "live" && h("span", { class: "chip active" }, t("Live")),
    scene.ground.kind === "flat" && h("span", { class: "chip draft" }, t("Flat ground assumed")),
  );

/**
 * Places of the targets, at the height of their assets.
 *
 * @param {FlightSource} source
 * @param {Scene} scene
 * @param {Flight} flight
 * @returns {PlacedTarget[]}
 */
function placedTargets(source, scene, flight) {
  const heights = new Map(scene.supports.map(({ id, likely_m }) => [id, likely_m]));
  return source.targets.map((target) => ({
    ...target,
    place3d: flight.targetPlace({ position: target.position, height_m: heights.get(target.asset) ?? null }),
  }));
}

/**
 * The flight in its picture: what does not change while it is seen.
 *
 * @param {HTMLElement} holder
 * @param {FlightSource} source
 * @param {PictureOptions} options
 */
function drawStage(holder, source, options) {
  const { scene } = options;
  const { canvas, picture } = pictureIn(holder, options);
  const { frame, groundAt } = picture;
  const flight = drawFlight(source, { frame, groundAt, groundKind: scene.ground.kind });
  picture.showFlight(flight, source.routes.length, source.span?.from_ms ?? 0);
  return {
    canvas,
    picture,
    flight,
    targets: placedTargets(source, scene, flight),
    surroundings: surroundingsOf(scene, frame, picture.wires(), groundAt),
  };
}

/** The view's own player, where the source has a span. @param {FlightSource} source @param {() => void} onMove */
function ownPlayer({ span }, onMove) {
  if (!span) return null;
  const player = createPlayer({ onMove });
  player.speed = USUAL_SPEED;
  player.setSpan(span);
  return player;
}

/** Create a check whether the time has jumped since the last call. @param {Player} player */
function jumpsOf(player) {
  /** @type {number | null} */
  let last_ms = null;
  return () => {
    const hasJumped =
      last_ms !== null && Math.abs(player.at_ms - last_ms) > JUMP_MS * Math.max(1, player.speed / JUMP_SPEED);
    last_ms = player.at_ms;
    return hasJumped;
  };
}

/**
 * Open the view in an element that has a size; null where it is no longer wanted.
 *
 * @param {HTMLElement} root
 * @param {StageOptions} options
 * @throws {ApiError}
 */
export async function openStage(root, options) {
  const scene = await readScene(options.source);
  return (options.isWanted?.() ?? true) ? mountStage(root, scene, options) : null;
}

/** @param {HTMLElement} root @param {Scene} scene @param {StageOptions} options */
function mountStage(root, scene, options) {
  const { mission, source, link = null, isPanel = false, player: hostPlayer = null, now_ms = Date.now } = options;
  const { onChange = () => {}, onClose = () => {}, openAddress = () => "" } = options;
  const palette = readScenePalette(source.colours);
  const holder = h("div", { class: "scene-picture" });
  const notices = createNotices();
  /** @type {Frames | null} */
  let frames = null;
  root.replaceChildren(holder);
  const drawn = drawStage(holder, source, {
    scene,
    palette,
    draw: (time) => frames?.draw(time) ?? false,
    onLost: () =>
      notices.notify(t("The graphics have stopped."), t("They are started again as soon as the browser can.")),
    onFound: notices.quiet,
  });
  const { canvas, picture } = drawn;
  /** @type {StageState} */
  const stage = { mission, source, chosen: null, target: null, isFlat: picture.kind === "2d", now_ms };
  const rig = createRig({ isCalm: () => calm.matches });
  const labels = createLabels(holder);
  const instruments = createInstruments(source.colours);
  /** @type {TimeBar | null} */
  let bar = null;
  const player =
    hostPlayer ??
    ownPlayer(source, () => {
      moved();
      bar?.show();
    });
  const hasJumped = player && jumpsOf(player);
  function moved() {
    if (hasJumped?.()) rig.settle(); // a jump in time is one in space
    picture.request();
    if (!player?.isPlaying) onChange();
  }
  const hands = listenToHands(canvas, rig, {
    onChange() {
      picture.request();
      onChange();
    },
    onPick: (at) => frames?.pick(at),
  });
  const atNow = () => (player ? player.at_ms : now_ms());
  const look = watchLook(picture, palette, source.colours);
  const context = { ...drawn, stage, scene, rig, hands, player, labels, palette: look.palette, atNow };
  const acts = createActs({
    ...context,
    hasOwnTime: !hostPlayer,
    drawn: () => frames?.drawn() ?? [],
    onChange,
    onClose,
    step: (direction) => bar?.step(direction),
    showBar: () => cameraBar.show({ mode: rig.mode, chosen: stage.chosen, isFlat: stage.isFlat }),
  });
  const cameraBar = createCameraBar({ routes: source.routes, colours: source.colours, acts, isPanel, openAddress });
  const chips = chipsOf(source, scene);
  if (!hostPlayer && player && source.span) bar = timeBarIn(root, player, source, source.span);
  frames = createFrames({
    ...context,
    instruments,
    isCalm: () => calm.matches,
    overlays: () => [...cameraBar.element.children, ...chips.children, instruments.element, ...notices.overlays],
    choose: acts.choose,
    seeTarget: acts.seeTarget,
  });
  holder.append(notices.element, h("div", { class: "scene-over" }, cameraBar.element, chips), instruments.element);
  if (stage.isFlat) notices.notify(t("This browser draws no 3D."), NO_WEBGL);
  acts.begin(link);
  bar?.show();
  picture.request();
  return {
    ...acts,
    ...pictureActs({ ...context, source, bar }),
    source,
    showStale: notices.showStale,
    showAlerts: notices.showAlerts,
    /** For a page with its own time: the time has moved, or another UAV is selected. @param {number | null} place */
    point(place) {
      if (place !== null && place !== stage.chosen) acts.choose(place);
      moved();
    },
    dispose() {
      if (!hostPlayer) player?.stop();
      look.end();
      hands.dispose();
      picture.dispose();
      root.replaceChildren();
    },
  };
}

/** @param {HTMLElement} root @param {Player} player @param {FlightSource} source @param {TimeSpan} span */
function timeBarIn(root, player, source, span) {
  const bar = createTimeBar({ player, source, span, eventWords: (event) => eventWords(event, source) });
  root.append(bar.element);
  new ResizeObserver(() => root.style.setProperty("--scene-time", `${bar.element.offsetHeight}px`)).observe(
    bar.element,
  );
  return bar;
}

/**
 * Apply the theme and the preference for reduced motion to the picture.
 *
 * @param {Picture} picture
 * @param {ScenePalette} firstPalette
 * @param {readonly number[]} colours of the mission
 */
function watchLook(picture, firstPalette, colours) {
  let palette = firstPalette;
  const endTheme = onTheme(() => {
    palette = readScenePalette(colours);
    picture.setPalette(palette);
  });
  const onCalm = () => picture.request();
  calm.addEventListener("change", onCalm);
  return {
    palette: () => palette,
    end() {
      endTheme();
      calm.removeEventListener("change", onCalm);
    },
  };
}

/**
 * Acts on the picture, and its updates when a source grows.
 *
 * @param {{ source: FlightSource, scene: Scene, picture: Picture, flight: Flight, player: Player | null, bar: TimeBar | null }} parts
 */
const pictureActs = ({ source, scene, picture, flight, player, bar }) => ({
  kind: picture.kind,
  request: picture.request,
  /** For measurements: figures of view.js, and the count of towers in the picture. */
  figures: () => (picture.figures ? { ...picture.figures(), towers: towersIn(picture, scene) } : null),
  /** A record has grown. @param {LoadedMission} loaded */
  renew(loaded) {
    source.renew?.(loaded);
    picture.showFlown(flight, source.span?.from_ms ?? 0);
    if (bar) player?.setSpan(source.span);
    bar?.renew();
    picture.request();
  },
  /** A live source has grown or moved. @param {boolean} hasGrown */
  refresh(hasGrown) {
    if (hasGrown) picture.showFlown(flight, source.routes[0]?.pieces[0]?.samples[0]?.at_ms ?? 0);
    picture.request();
  },
});

/** Count of towers in the picture. @param {Picture} picture @param {Scene} scene */
function towersIn({ project, size, frame }, { supports }) {
  return supports.filter(({ kind, position, ground_amsl_m, height_m }) => {
    const at =
      kind === "vertex" ? null : project(frame.toLocal(position[0], position[1], ground_amsl_m + height_m / 2));
    return at && at.x >= 0 && at.y >= 0 && at.x <= size.width && at.y <= size.height;
  }).length;
}

/** @param {FlightSource} source */
async function readScene(source) {
  const box = boxRound(placesOf(source)) ?? [0, 0, 0.01, 0.01];
  const { data } = /** @type {Answer<Scene>} */ (await get(`/scene?bbox=${box.join(",")}`));
  return data;
}

/** @param {ReplayEvent} event @param {FlightSource} source */
function eventWords(event, { routes, targets }) {
  const name = routes.find(({ place }) => place === event.place)?.name ?? "";
  switch (event.kind) {
    case "take-off":
      return t("{name} takes off", { name });
    case "landing":
      return t("{name} lands", { name });
    case "target":
      return t("{target} reached", {
        target: targets.find(({ place }) => place === event.target)?.label ?? event.target + 1,
      });
    default:
      return [name, event.alert.message].filter(Boolean).join(": ");
  }
}
