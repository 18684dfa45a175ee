/** The record of a mission: planned and flown routes, results, and the replay of the flight. */

import { signInAddress } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { routeNumber } from "../domain/palette.js";
import { loadMapLibrary } from "../map/maplibre.js";
import { readPage, startChrome } from "../page/chrome.js";
import { mountFindings } from "../photos/findings_list.js";
import { mountPhotos } from "../photos/section.js";
import { labelsOf } from "../record/labels.js";
import { loadMission } from "../record/load.js";
import { createPlayer, SPEEDS } from "../record/player.js";
import { capital, isOver, isUnderWay } from "../record/sentence.js";
import { eventFrom, eventsOf, spanOf } from "../record/timeline.js";
import { estimatesOf, silenceOf_ms, trackOf, tracksOf } from "../record/track.js";
import { mountSceneOpener } from "../scene/opener.js";
import { t } from "../text.js";
import { numberText } from "../units.js";
import { mountCoverage } from "./coverage.js";
import { createDock } from "./dock.js";
import { offerClosing, offerDownloads, offerFollowUp } from "./follow_up.js";
import { mountLayout } from "./layout.js";
import { drawAlerts, drawCommands, drawIncidents, drawLegs, drawResults } from "./lists.js";
import { replayTables } from "./replay_tables.js";
import { createReportMap } from "./report_map.js";
import { drawHead, drawQuality, drawTargets } from "./side.js";

const AGAIN_MS = 30_000;
const KEY_STEPS = 100; // of the whole replay, by an arrow key
const NEAR_EVENT_MS = 2_000;
const ONE_FALL_MS = 60_000; // between the last report in the air and the words that it has crashed

/** @import { ApiError } from "../api.js" */
/** @import { Incident, MissionRecord, RecordTarget } from "../api_types.d.ts" */
/** @import { Labels } from "../record/labels.js" */
/** @import { LoadedMission } from "../record/load.js" */
/** @import { ReplayEvent } from "../record/timeline.js" */
/** @import { LookedLeg, ReplayRoute, ReportPage, StripTarget } from "./types.d.ts" */

/** @type {readonly Incident["kind"][]} */
const FALLS = ["crashed", "down"];

/** @type {ReportPage} */
const page = readPage();
const layout = mountLayout();
await loadMapLibrary();
const map = createReportMap(page, { onPick: choose, onIncident: showIncident });
const dock = createDock({ onChoose: choose });
const coverage = mountCoverage({ canPlan: page.canFly });
const player = createPlayer({ onMove: show });
const scene = mountSceneOpener(
  () =>
    loaded && { mission: page.mission, ...(player.span() ? { record: loaded, player } : { wanted: { kind: "plan" } }) },
);
/** @type {LoadedMission | null} */
let loaded = null;
/** @type {ReplayRoute[]} */
let routes = [];
/** @type {ReplayEvent[]} */
let events = [];
/** @type {Labels} */
let labels = new Map();
/** @type {number | null} place of the selected UAV */
let looked = null;

/** @param {number} place of a UAV */
function choose(place) {
  looked = looked === place ? null : place;
  show();
}

/** @param {Incident} incident */
function showIncident({ at, position }) {
  player.seek(Date.parse(at));
  if (position) map.showPlace(position);
}

/** @param {number} place of a target */
function showTarget(place) {
  const known = labels.get(place);
  if (known) map.showPlace(known.position);
}

// reading

async function read() {
  try {
    take(await loadMission(page.mission));
    showFault(null);
  } catch (error) {
    showFault(error);
  }
  if (!loaded || isUnderWay(loaded.record)) setTimeout(read, AGAIN_MS);
}

/** @param {unknown} error null: there is none any more */
function showFault(error) {
  const { isSignedOut = false, message = "" } = /** @type {Partial<ApiError>} */ (error ?? {});
  const fault = byId("report-fault");
  fault.hidden = error === null;
  if (isSignedOut)
    fault.replaceChildren(
      icon("cloud-off"),
      h("span", {}, `${t("You have been signed out.")} `, h("a", { href: signInAddress() }, t("Sign in"))),
    );
  else if (error)
    fault.replaceChildren(
      icon("cloud-off"),
      h("span", {}, `${t("The record could not be read.")} ${message} ${t("It is tried again every half minute.")}`),
    );
}

/** The record's routes with what the replay draws of them. @param {LoadedMission} loaded @returns {ReplayRoute[]} */
function replayRoutes({ record, records, estimates, alerts }) {
  const silence_ms = silenceOf_ms(Math.max(records.every_s ?? 0, estimates.every_s ?? 0));
  const [measured, estimated] = [tracksOf(records.features), estimatesOf(estimates.features)];
  return record.routes.map((route) => ({
    ...route,
    colour: routeNumber(route.place, record.mission.colours),
    isOver: isOver(record),
    track: trackOf(measured.get(route.uav ?? NaN) ?? [], estimated.get(route.uav ?? NaN) ?? [], silence_ms),
    targets: record.targets
      .filter(({ uav }) => uav === route.place)
      .map(targetOnStrip)
      .sort((a, b) => (a.at_ms ?? Infinity) - (b.at_ms ?? Infinity)),
    alerts: alerts
      .filter(({ uav }) => uav === route.uav)
      .map(({ opened_at, level, message }) => ({ at_ms: Date.parse(opened_at), level, title: message })),
  }));
}

/** @param {LoadedMission} answer */
function take(answer) {
  loaded = answer;
  const { record } = answer;
  labels = labelsOf(record.routes, record.mission.colours);
  routes = replayRoutes(answer);
  events = eventsOf({ routes, targets: record.targets, alerts: answer.alerts, isOver: isOver(record) });
  drawHead(record, showTarget);
  drawTargets(record, labels, showTarget);
  offerFollowUp(record, { canPlan: page.canFly });
  offerClosing(record, { canFly: page.canFly });
  offerDownloads(record);
  void coverage.renew(record);
  drawIncidents(record.incidents, showIncident);
  drawQuality(record);
  drawLegs(record, labels, lookAtLeg);
  drawAlerts(
    answer.alerts,
    (uav) => routes.find((route) => route.uav === uav)?.name ?? "",
    (iso) => player.seek(Date.parse(iso)),
  );
  drawCommands(answer.commands);
  drawResults(record, labels);
  map.show({ routes, targets: record.targets, labels, incidents: record.incidents });
  const span = spanOf(routes.map(({ track }) => track));
  player.setSpan(span);
  byId("dock").classList.toggle("without-replay", span === null);
  byId("replay-empty").hidden = span !== null;
  if (!span) {
    showNothing(record);
    return;
  }
  byId("replay-tables").replaceChildren(...replayTables(routes));
  for (const route of routes)
    route.alerts = route.alerts.filter(({ at_ms }) => at_ms >= span.from_ms && at_ms <= span.to_ms);
  dock.draw({ routes, span });
  renewScene(answer);
  show();
}

/**
 * Update the 3D view with the record; where it showed the plan it shows the flight from now on.
 *
 * @param {LoadedMission} answer
 */
function renewScene(answer) {
  const stage = scene.stage();
  if (!stage) return;
  if (stage.source.kind === "record") stage.renew(answer);
  else void scene.open({ takesFocus: false });
}

/** @param {RecordTarget} target @returns {StripTarget} */
const targetOnStrip = ({ place, label: name, state, reached_at }) => {
  const { label, number } = labels.get(place) ?? { label: "", number: place + 1 };
  return { place, label, number, state, at_ms: reached_at ? Date.parse(reached_at) : null, title: `${label} ${name}` };
};

/** @param {MissionRecord} record */
function showNothing(record) {
  const [title, words] = byId("replay-empty").children;
  title.textContent = isOver(record) ? t("Nothing to replay.") : t("Nothing to replay yet.");
  words.textContent = isOver(record)
    ? t("None of its UAVs reported anything while it was flown.")
    : t("What its UAVs report is drawn here as soon as they fly.");
}

/** @param {LookedLeg | null} leg */
function lookAtLeg(leg) {
  const route = leg && routes.find(({ place }) => place === leg.place);
  const within = route ? route.waypoints.filter(({ sequence }) => sequence >= leg.from && sequence <= leg.to) : [];
  map.lightLeg(within.length > 1 ? within.map(({ position }) => position) : null);
}

// replaying

/** The text on a flight that ended in a crash. @param {ReplayEvent} event */
function fallAt({ place, at_ms }) {
  const fall = loaded?.record.incidents.find(
    ({ kind, uav, at }) => uav === place && FALLS.includes(kind) && Math.abs(Date.parse(at) - at_ms) < ONE_FALL_MS,
  );
  return fall && capital(fall.message);
}

/** @param {ReplayEvent} event */
function wordsOf(event) {
  const name = routes.find(({ place }) => place === event.place)?.name ?? "";
  switch (event.kind) {
    case "take-off":
      return t("{name} takes off", { name });
    case "landing":
      return fallAt(event) ?? t("{name} lands", { name });
    case "target":
      return t("{target} reached", { target: labels.get(event.target)?.label ?? event.target + 1 });
    default:
      return [name, event.alert.message].filter(Boolean).join(": ");
  }
}

/** The latest event at a moment. @param {number} at_ms */
function eventWords(at_ms) {
  const event = events.findLast((one) => one.at_ms <= at_ms && at_ms - one.at_ms < NEAR_EVENT_MS);
  return event ? wordsOf(event) : "";
}

function show() {
  const play = byId("replay-play");
  const image = player.isPlaying ? "pause" : "play";
  if (play.dataset.image !== image) {
    play.dataset.image = image;
    play.replaceChildren(icon(image));
    play.setAttribute("aria-label", player.isPlaying ? t("Stop") : t("Play"));
    play.title = `${player.isPlaying ? t("Stop") : t("Play")} (${t("Space")})`;
  }
  byId(`speed-${player.speed}`, HTMLInputElement).checked = true;
  if (!player.span()) return;
  dock.point(player.at_ms, looked, eventWords(player.at_ms));
  map.point(player.at_ms, looked);
  scene.stage()?.point(looked);
}

/** @param {number} direction 1 or -1 */
function step(direction) {
  const span = player.span();
  if (!span) return false;
  player.stop();
  const within = events.filter(({ at_ms }) => at_ms >= span.from_ms && at_ms <= span.to_ms);
  const event = eventFrom(within, player.at_ms, direction);
  player.seek(event?.at_ms ?? (direction > 0 ? span.to_ms : span.from_ms));
  return true;
}

byId("replay-speeds").append(
  ...SPEEDS.map((speed) =>
    h(
      "label",
      {},
      h("input", { type: "radio", name: "speed", id: `speed-${speed}`, onchange: () => player.setSpeed(speed) }),
      h("span", { class: "segment" }, `${numberText(speed, Number.isInteger(speed) ? 0 : 1)}×`),
    ),
  ),
);
byId("replay-play").addEventListener("click", player.toggle);
byId("replay-previous").addEventListener("click", () => step(-1));
byId("replay-next").addEventListener("click", () => step(1));

const slider = byId("replay-slider");
/** @param {PointerEvent} event */
const drag = (event) => {
  const at_ms = dock.momentAt(event.clientX);
  if (at_ms !== null) player.seek(at_ms);
};
slider.addEventListener("pointerdown", (event) => {
  if (event.button) return;
  slider.setPointerCapture(event.pointerId);
  player.stop();
  drag(event);
});
slider.addEventListener("pointermove", (event) => {
  if (slider.hasPointerCapture(event.pointerId)) drag(event);
});
slider.addEventListener("keydown", (event) => {
  const span = player.span();
  if (!span || event.ctrlKey || event.metaKey || event.altKey) return;
  const step_ms = Math.max(1_000, (span.to_ms - span.from_ms) / KEY_STEPS);
  /** @type {Record<string, number>} */
  const moments = {
    ArrowRight: player.at_ms + step_ms,
    ArrowUp: player.at_ms + step_ms,
    ArrowLeft: player.at_ms - step_ms,
    ArrowDown: player.at_ms - step_ms,
    PageUp: player.at_ms + 10 * step_ms,
    PageDown: player.at_ms - 10 * step_ms,
    Home: span.from_ms,
    End: span.to_ms,
  };
  if (!(event.key in moments)) return;
  event.preventDefault();
  player.stop();
  player.seek(moments[event.key]);
});

/** @param {Event} event */
const isOnControl = ({ target }) => target instanceof Element && target.closest("button, a, summary, select") !== null;

/** @param {KeyboardEvent} event */
function togglePlaying(event) {
  if (isOnControl(event) || !player.span()) return false;
  player.toggle();
  return true;
}

/** @param {number} index of a UAV */
function chooseAt(index) {
  const route = routes[index];
  if (route) choose(route.place);
  return route !== undefined;
}

/** Clear the selection of a UAV, or close what is open over the map. */
function leave() {
  if (looked === null) return map.closeTop();
  choose(looked);
  return true;
}

startChrome({
  bindings: [
    {
      keys: [" "],
      words: t("Play, stop"),
      act: togglePlaying,
    },
    { keys: [","], words: t("Previous event"), act: () => step(-1) },
    { keys: ["."], words: t("Next event"), act: () => step(1) },
    { keys: ["<"], words: t("Slower"), act: () => player.changeSpeed(-1) },
    { keys: [">"], words: t("Faster"), act: () => player.changeSpeed(1) },
    ...Array.from({ length: 8 }, (_, index) => ({
      keys: [`${index + 1}`],
      words: index ? undefined : t("Choose UAV A to H (1 to 8)"),
      act: () => chooseAt(index),
    })),
    { keys: ["f"], words: t("Fit what was flown"), act: () => map.fit() },
    { keys: ["+", "="], words: t("Zoom in"), act: () => map.zoom(1) },
    { keys: ["-"], words: t("Zoom out"), act: () => map.zoom(-1) },
    { keys: ["["], words: t("Fold the side"), act: () => layout.fold("side") },
    { keys: ["]"], words: t("Fold the dock"), act: () => layout.fold("dock") },
    ...map.bindings,
    scene.binding,
    { keys: ["escape"], act: leave },
  ],
});

mountPhotos(byId("report-photos-body"), {
  query: `mission=${page.mission}`,
  stated: { mission: page.mission },
  canUpload: page.canFly,
  notify(count, isMore) {
    byId("report-photos-count").textContent = count ? `${numberText(count)}${isMore ? "+" : ""}` : "";
  },
});
mountFindings(byId("report-findings"), `mission=${page.mission}`, { canPlan: page.canFly });
await Promise.all([map.ready, read()]);
show();
document.documentElement.dataset.loaded = "true";
