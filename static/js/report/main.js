/** The record of a mission: what was planned, what was flown, what came of it, and the flight once more. */

import { signInAddress } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { readPage, startChrome } from "../page/chrome.js";
import { labelsOf } from "../record/labels.js";
import { loadMission } from "../record/load.js";
import { createPlayer, SPEEDS } from "../record/player.js";
import { isOver, isUnderWay } from "../record/sentence.js";
import { eventFrom, eventsOf, spanOf } from "../record/timeline.js";
import { estimatesOf, silenceOf_ms, trackOf, tracksOf } from "../record/track.js";
import { mountSceneOpener } from "../scene/opener.js";
import { t } from "../text.js";
import { numberText } from "../units.js";
import { createDock } from "./dock.js";
import { offerFollowUp } from "./follow_up.js";
import { mountLayout } from "./layout.js";
import { drawAlerts, drawCommands, drawLegs, drawResults } from "./lists.js";
import { replayTables } from "./replay_tables.js";
import { createReportMap } from "./report_map.js";
import { drawHead, drawTargets } from "./side.js";

const AGAIN_MS = 30_000;
const KEY_STEPS = 100; // of the whole replay, by an arrow key
const NEAR_EVENT_MS = 2_000;

const page = readPage();
const layout = mountLayout();
const map = createReportMap(page, { onPick: choose });
const dock = createDock({ onChoose: choose });
const player = createPlayer({ onMove: show });
const scene = mountSceneOpener(
  () =>
    loaded && { mission: page.mission, ...(player.span() ? { record: loaded, player } : { wanted: { kind: "plan" } }) },
);
let loaded = null; // of the API
let record = null;
let routes = []; // of the record, each with its track, targets, alerts
let events = [];
let labels = new Map();
let looked = null; // place of the UAV that is looked at

function choose(place) {
  looked = looked === place ? null : place;
  show();
}

// reading

async function read() {
  try {
    take(await loadMission(page.mission));
    tellFault(null);
  } catch (error) {
    tellFault(error);
  }
  if (record && isUnderWay(record)) setTimeout(read, AGAIN_MS);
  else if (!record) setTimeout(read, AGAIN_MS);
}

function tellFault(error) {
  const fault = byId("report-fault");
  fault.hidden = error === null;
  if (error?.isSignedOut)
    fault.replaceChildren(
      icon("cloud-off"),
      h("span", {}, `${t("You have been signed out.")} `, h("a", { href: signInAddress() }, t("Sign in"))),
    );
  else if (error)
    fault.replaceChildren(
      icon("cloud-off"),
      h(
        "span",
        {},
        `${t("The record could not be read.")} ${error.message} ${t("It is tried again every half minute.")}`,
      ),
    );
}

function take(answer) {
  loaded = answer;
  record = loaded.record;
  labels = labelsOf(record.routes);
  const silence_ms = silenceOf_ms(Math.max(loaded.records.every_s ?? 0, loaded.estimates.every_s ?? 0));
  const [measured, estimated] = [tracksOf(loaded.records.features), estimatesOf(loaded.estimates.features)];
  routes = record.routes.map((route) => ({
    ...route,
    isOver: isOver(record),
    track: trackOf(measured.get(route.uav) ?? [], estimated.get(route.uav) ?? [], silence_ms),
    targets: record.targets
      .filter(({ uav }) => uav === route.place)
      .map(targetOnStrip)
      .sort((a, b) => (a.at_ms ?? Infinity) - (b.at_ms ?? Infinity)),
    alerts: loaded.alerts
      .filter(({ uav }) => uav === route.uav)
      .map(({ opened_at, level, message }) => ({ at_ms: Date.parse(opened_at), level, title: message })),
  }));
  events = eventsOf({ routes, targets: record.targets, alerts: loaded.alerts, isOver: isOver(record) });
  drawHead(record);
  drawTargets(record, labels, (place) => map.showPlace(labels.get(place).position));
  offerFollowUp(record, { canPlan: page.canFly });
  drawLegs(record, labels, lookAtLeg);
  drawAlerts(
    loaded.alerts,
    (uav) => routes.find((route) => route.uav === uav)?.name ?? "",
    (iso) => player.seek(Date.parse(iso)),
  );
  drawCommands(loaded.commands);
  drawResults(record, labels);
  map.show({ routes, targets: record.targets, labels });
  const span = spanOf(routes.map(({ track }) => track));
  player.setSpan(span);
  byId("dock").classList.toggle("without-replay", span === null);
  byId("replay-empty").hidden = span !== null;
  if (!span) return tellNothing();
  byId("replay-tables").replaceChildren(...replayTables(routes));
  routes.forEach(
    (route) => (route.alerts = route.alerts.filter(({ at_ms }) => at_ms >= span.from_ms && at_ms <= span.to_ms)),
  );
  dock.draw({ routes, span });
  renewScene();
  show();
  return undefined;
}

/** The 3D view goes with the record; where it showed the plan it shows what is flown from now on. */
function renewScene() {
  const stage = scene.stage();
  if (!stage) return;
  if (stage.source.kind === "record") stage.renew(loaded);
  else void scene.open({ takesFocus: false });
}

const targetOnStrip = ({ place, label: name, state, reached_at }) => {
  const { label, number } = labels.get(place) ?? { label: "", number: place + 1 };
  return { place, label, number, state, at_ms: reached_at ? Date.parse(reached_at) : null, title: `${label} ${name}` };
};

function tellNothing() {
  const [title, words] = byId("replay-empty").children;
  title.textContent = isOver(record) ? t("Nothing to replay.") : t("Nothing to replay yet.");
  words.textContent = isOver(record)
    ? t("None of its UAVs reported anything while it was flown.")
    : t("What its UAVs report is drawn here as soon as they fly.");
}

function lookAtLeg(leg) {
  const route = leg && routes.find(({ place }) => place === leg.place);
  const positions = route?.waypoints
    .filter(({ sequence }) => sequence >= leg.from && sequence <= leg.to)
    .map(({ position }) => position);
  map.lightLeg(positions?.length > 1 ? positions : null);
}

// replaying

const EVENT_WORDS = {
  "take-off": ({ name }) => t("{name} takes off", { name }),
  landing: ({ name }) => t("{name} lands", { name }),
  target: (_route, { target }) => t("{target} reached", { target: labels.get(target)?.label ?? target + 1 }),
  alert: ({ name }, { alert }) => [name, alert.message].filter(Boolean).join(": "),
};

function eventWords(at_ms) {
  const event = events.findLast((one) => one.at_ms <= at_ms && at_ms - one.at_ms < NEAR_EVENT_MS);
  if (!event) return "";
  const route = routes.find(({ place }) => place === event.place) ?? { name: "" };
  return EVENT_WORDS[event.kind](route, event);
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
  byId(`speed-${player.speed}`).checked = true;
  if (!player.span()) return;
  dock.point(player.at_ms, looked, eventWords(player.at_ms));
  map.point(player.at_ms, looked);
  scene.stage()?.point(looked);
}

function step(direction) {
  if (!player.span()) return false;
  player.stop();
  const event = eventFrom(
    events.filter(({ at_ms }) => at_ms >= player.span().from_ms && at_ms <= player.span().to_ms),
    player.at_ms,
    direction,
  );
  player.seek(event?.at_ms ?? (direction > 0 ? player.span().to_ms : player.span().from_ms));
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
slider.addEventListener("pointermove", (event) => slider.hasPointerCapture(event.pointerId) && drag(event));
slider.addEventListener("keydown", (event) => {
  const span = player.span();
  if (!span || event.ctrlKey || event.metaKey || event.altKey) return;
  const step_ms = Math.max(1_000, (span.to_ms - span.from_ms) / KEY_STEPS);
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

const isOnControl = ({ target }) => target instanceof Element && target.closest("button, a, summary, select") !== null;

startChrome({
  bindings: [
    {
      keys: [" "],
      words: t("Play, stop"),
      act: (event) => (isOnControl(event) || !player.span() ? false : (player.toggle(), true)),
    },
    { keys: [","], words: t("Previous event"), act: () => step(-1) },
    { keys: ["."], words: t("Next event"), act: () => step(1) },
    { keys: ["<"], words: t("Slower"), act: () => player.changeSpeed(-1) },
    { keys: [">"], words: t("Faster"), act: () => player.changeSpeed(1) },
    ...Array.from({ length: 8 }, (_, index) => ({
      keys: [`${index + 1}`],
      words: index ? undefined : t("Choose UAV A to H (1 to 8)"),
      act: () => (routes[index] ? (choose(routes[index].place), true) : false),
    })),
    { keys: ["f"], words: t("Fit what was flown"), act: () => map.fit() },
    { keys: ["+", "="], words: t("Zoom in"), act: () => map.zoom(1) },
    { keys: ["-"], words: t("Zoom out"), act: () => map.zoom(-1) },
    { keys: ["["], words: t("Fold the side"), act: () => layout.fold("side") },
    { keys: ["]"], words: t("Fold the dock"), act: () => layout.fold("dock") },
    ...map.bindings,
    scene.binding,
    { keys: ["escape"], act: () => (looked === null ? map.closeTop() : (choose(looked), true)) },
  ],
});

await Promise.all([map.ready, read()]);
show();
document.documentElement.dataset.loaded = "true";
