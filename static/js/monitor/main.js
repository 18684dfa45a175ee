/** The live page: all that flies, or one mission; told over the live wire, drawn at most once a frame, ages counted on. */

import { byId, h, icon } from "../dom.js";
import { ASKED as BY_HTTP, CONNECTING, GONE, LIVE, openFeed, SIGNED_OUT } from "../live/feed.js";
import { routeLetter } from "../map/palette.js";
import { readPage, startChrome } from "../page/chrome.js";
import { mountWorkbench } from "../page/workbench.js";
import { signInAddress } from "../api.js";
import { localeOf, language, t, tn } from "../text.js";
import { mountAlerts } from "./alerts_panel.js";
import { createAnnouncing } from "./announce.js";
import { mountBoard } from "./board.js";
import { mountCards } from "./cards.js";
import { commandSaid, mountCommands } from "./command_bar.js";
import { eventsOf, mountEventLog } from "./event_log.js";
import { createLiveMap } from "./live_map.js";
import { createPlans, labelsOf, placesOf, routeOf } from "./missions.js";
import { mountOffers } from "./offers.js";
import { createTracks } from "./tracks.js";
import { inOrder, viewOf } from "./uav_view.js";
import { MISSION_STATES, TARGET_STATES } from "./words.js";

const RANK = { critical: 0, warning: 1, advisory: 2 };
const narrow = matchMedia("(max-width: 1099px)");

const page = readPage();
const ui = { chosen: null, boardMission: page.mission, follows: false };
const zone = document.documentElement.dataset.timeZone || undefined;
const timeText = (iso) => new Date(iso).toLocaleTimeString(localeOf(language), { timeZone: zone });

let isAsked = false;
/** All is drawn together, once a frame at most; a page that nobody looks at is drawn by and by. */
function redraw() {
  if (isAsked) return;
  isAsked = true;
  const later = document.hidden ? (act) => setTimeout(act, 500) : requestAnimationFrame;
  later(() => {
    isAsked = false;
    draw();
  });
}

const feed = openFeed({ mission: page.mission, onChange: redraw, onState: redraw });
const plans = createPlans({ onRead: redraw });
const tracks = createTracks({ onRead: redraw });
const map = createLiveMap(page, { onChoose: choose, onMoved: () => (ui.follows = false) });
void map.ready.then(redraw);

const values = (kind) => [...feed.shown[kind].values()];
const viewFor = (uav) => viewOf(uav, feed.now_ms());
const planOf = (id) => (feed.shown.missions.has(id) ? plans.of(feed.shown.missions.get(id)) : null);
const names = (alert) => feed.shown.uavs.get(alert.uav)?.name ?? feed.shown.missions.get(alert.mission)?.name ?? t("Spanwise");
const isAirborne = (uav) => Boolean(uav.mission) && viewFor(uav).isInAir === true;
const withRoute = (uav) => ({ uav, view: viewFor(uav), route: routeOf(planOf(uav.mission), uav.place) });

const drawCards = mountCards({ onChoose: choose });
const alertsPanel = mountAlerts({ canAct: page.canFly, timeText, names, onLook: (alert) => alert.uav !== null && choose(alert.uav) });
const announce = createAnnouncing({ names });
const drawBoard = mountBoard({ onMission: (id) => ((ui.boardMission = id), redraw()), onTarget: lookAtTarget });
const drawLog = mountEventLog(byId("live-log"), timeText);
const drawOffers = mountOffers({ canAct: page.canFly, timeText, labelsFor: (mission) => labelsOf(planOf(mission), routeLetter) });
const commands = page.canFly ? mountCommands({ chosen: () => chosenUav() && withRoute(chosenUav()), flying: () => values("uavs").filter(isAirborne).map(withRoute) }) : null;

const chosenUav = () => feed.shown.uavs.get(ui.chosen) ?? null;

function choose(id) {
  if (!feed.shown.uavs.has(id)) return;
  const isAgain = ui.chosen === id;
  ui.chosen = id;
  ui.follows = true;
  const uav = chosenUav();
  ui.boardMission = uav.mission ?? ui.boardMission;
  const { position } = viewFor(uav);
  if (position && isAgain) map.look(position);
  else if (position) map.follow(position);
  redraw();
}

function lookAtTarget(place) {
  const position = placesOf(planOf(boardMission()?.id)).get(place);
  ui.follows = false;
  if (position) map.look(position);
}

/** The mission whose targets are listed. */
function boardMission() {
  const missions = values("missions");
  return missions.find(({ id }) => id === ui.boardMission) ?? missions.find(({ state }) => state === "active") ?? missions[0] ?? null;
}

function draw() {
  const now_ms = feed.now_ms();
  const [uavs, missions, alerts, given, offers] = ["uavs", "missions", "alerts", "commands", "offers"].map(values);
  tracks.take(uavs);
  const views = new Map(uavs.map((uav) => [uav.id, viewOf(uav, now_ms)]));
  const open = alerts.filter(({ closed_at, acknowledged_at }) => !closed_at && !acknowledged_at);
  const ofUav = (uav) => open.filter((alert) => alert.uav === uav.id).sort((a, b) => RANK[a.level] - RANK[b.level]);
  const ordered = inOrder(uavs, { chosen: ui.chosen, alerts, viewFor: (uav) => views.get(uav.id) });
  drawCards(
    ordered.map((uav) => {
      const plan = planOf(uav.mission);
      return {
        uav, view: views.get(uav.id), route: routeOf(plan, uav.place), labels: labelsOf(plan, routeLetter), alerts: ofUav(uav), said: commandSaid(given, uav, now_ms),
        mission: page.mission ? null : (feed.shown.missions.get(uav.mission) ?? null), isChosen: uav.id === ui.chosen,
      };
    }),
  );
  drawMap(uavs, views, missions, offers);
  alertsPanel.show(alerts);
  announce(alerts);
  drawOffers(offers);
  const shown = boardMission();
  const plan = planOf(shown?.id);
  const arrivals = new Map(uavs.filter(({ mission }) => mission === shown?.id).flatMap(({ estimated }) => (estimated?.arrivals ?? []).filter(({ target }) => target !== null).map(({ target, at }) => [target, at])));
  drawBoard({ missions, shown, labels: labelsOf(plan, routeLetter), arrivals });
  drawLog(eventsOf({ alerts, commands: given, missions, names }));
  drawHead(uavs, missions, now_ms);
  commands?.draw();
  const chosen = chosenUav();
  if (chosen && ui.follows && views.get(chosen.id).position && !map.map.getBounds().contains(views.get(chosen.id).position)) map.follow(views.get(chosen.id).position);
}

function drawMap(uavs, views, missions, offers) {
  map.showUavs(
    uavs.map((uav) => ({ uav, letter: uav.place === null ? "" : routeLetter(uav.place), view: views.get(uav.id), lines: tracks.of(uav.id), isChosen: uav.id === ui.chosen })),
    timeText,
  );
  const flown = missions.filter(({ id, state }) => id === page.mission || state === "active" || state === "dispatched").map((mission) => ({ mission, plan: plans.of(mission) })).filter(({ plan }) => plan?.plan);
  const routes = flown.flatMap(({ mission, plan }) => plan.plan.routes.map((route, sequence) => ({ id: `${mission.id} ${mission.revision}`, sequence, geometry: route.geometry })));
  const offered = offers.filter(({ state, continuation }) => state === "open" && continuation).flatMap(({ id, continuation, difference }) => offeredRoutes(id, continuation, difference));
  map.showRoutes(routes, offered);
  map.showTargets(
    flown.flatMap(({ mission, plan }) => {
      const [labels, places] = [labelsOf(plan, routeLetter), placesOf(plan)];
      return mission.targets.filter(({ place }) => labels.has(place) && places.has(place)).map(({ place, state, label: name }) => {
        const { place: uav, number } = labels.get(place);
        return { key: `${mission.id} ${place}`, place: uav, letter: routeLetter(uav), number, position: places.get(place), state, stateWords: TARGET_STATES[state].words, name, isMissed: false };
      });
    }),
  );
}

/** Routes of the mission that an offer would make, in the colours that its UAVs have now. */
function offeredRoutes(id, continuation, difference) {
  const plan = plans.of({ id: continuation, revision: id });
  const places = new Map((difference.uavs ?? []).filter(({ continuation_place }) => continuation_place !== null).map(({ continuation_place, place }) => [continuation_place, place]));
  return (plan?.plan?.routes ?? []).map((route, place) => ({ id, sequence: places.get(place) ?? place, geometry: route.geometry })).filter(({ geometry }) => geometry);
}

function drawHead(uavs, missions, now_ms) {
  const flying = uavs.filter(isAirborne).length;
  const clock = new Date(now_ms).toLocaleTimeString(localeOf(language), { timeZone: zone });
  const mission = page.mission ? feed.shown.missions.get(page.mission) : null;
  const complete = mission && t("{done} of {all} complete", { done: mission.counts.complete, all: mission.counts.all });
  const words = [clock, tn(flying, "{count} UAV in the air", "{count} UAVs in the air"), complete, !page.mission && missions.length ? tn(missions.length, "{count} mission", "{count} missions") : "", feed.state === BY_HTTP && t("asked every 2 s")].filter(Boolean);
  byId("live-facts").textContent = words.join(" · ");
  const chip = byId("live-state");
  chip.hidden = !mission;
  if (mission) {
    chip.className = `chip ${mission.state}`;
    chip.textContent = MISSION_STATES[mission.state];
  }
  drawCut();
  const openCount = values("alerts").filter(({ closed_at, acknowledged_at }) => !closed_at && !acknowledged_at).length;
  const title = document.title.replace(/^\(\d+\) /, "");
  document.title = openCount ? `(${openCount}) ${title}` : title;
}

/** What is wrong with the wire, if anything: stale data never look fresh. */
function drawCut() {
  const cut = byId("live-cut");
  const since = timeText(new Date(feed.since_ms).toISOString());
  const isFirst = feed.state === CONNECTING && !feed.shown.uavs.size && !feed.shown.missions.size;
  const said = {
    [SIGNED_OUT]: [t("You have been signed out."), h("a", { class: "text-button", href: signInAddress() }, t("Sign in"))],
    [GONE]: [t("This mission has been deleted.")],
    [CONNECTING]: [isFirst ? t("Connecting.") : t("No live data since {time}. What you see is from then. Connecting again.", { time: since })],
  }[feed.state];
  document.documentElement.dataset.live = feed.state;
  cut.hidden = !said;
  const key = said ? `${feed.state} ${feed.since_ms}` : "";
  if (cut.dataset.said === key) return;
  cut.dataset.said = key;
  if (said) cut.replaceChildren(icon("cloud-off", "small"), h("span", {}, ...said));
}

// the page

const layout = mountLivePanels();
function mountLivePanels() {
  const right = byId("live-right");
  const place = () => {
    if (narrow.matches) {
      byId("live-right-above").append(byId("live-alerts-part"));
      byId("live-right-below").append(byId("live-board-part"), byId("live-log-part"));
    } else right.append(byId("live-alerts-part"), byId("live-board-part"), byId("live-log-part"));
    byId("right").hidden = narrow.matches;
  };
  narrow.addEventListener("change", place);
  place();
  return mountWorkbench({ dockOnPhone: byId("live-right-above") });
}

function chooseAt(index) {
  const uav = [...values("uavs")].sort((a, b) => (a.place ?? 99) - (b.place ?? 99) || (a.name < b.name ? -1 : 1))[index];
  if (!uav) return false;
  choose(uav.id);
  return true;
}

function step(by) {
  const ids = [...byId("live-uavs").children].map(({ dataset }) => Number(dataset.uav));
  if (!ids.length) return false;
  const at = ids.indexOf(ui.chosen);
  choose(ids[Math.min(ids.length - 1, Math.max(0, at + by))]);
  return true;
}

const askKey = (kind) => () => (commands && chosenUav()?.mission ? (void commands.ask(kind), true) : false);

startChrome({
  bindings: [
    ...Array.from({ length: 8 }, (_, index) => ({ keys: [`${index + 1}`], words: index ? undefined : t("Choose UAV A to H (1 to 8)"), act: () => chooseAt(index) })),
    { keys: ["j"], words: t("Next UAV"), act: () => step(1) },
    { keys: ["k"], words: t("Previous UAV"), act: () => step(-1) },
    { keys: ["f"], words: t("Fit everything that flies"), act: () => ((ui.follows = false), map.fit()) },
    { keys: ["+", "="], words: t("Zoom in"), act: () => map.zoom(1) },
    { keys: ["-"], words: t("Zoom out"), act: () => map.zoom(-1) },
    { keys: ["["], words: t("Fold the side"), act: layout.foldSide },
    { keys: ["]"], words: t("Fold alerts and board"), act: () => ((byId("workbench").dataset.right = byId("workbench").dataset.right === "folded" ? "" : "folded"), map.resize()) },
    { keys: ["a"], words: t("Acknowledge the alert"), act: () => alertsPanel.acknowledgeFocused() },
    { keys: ["shift+p"], words: t("Pause the chosen UAV"), act: askKey("pause") },
    { keys: ["shift+h"], words: t("Hold the chosen UAV"), act: askKey("hold") },
    { keys: ["shift+r"], words: t("Return the chosen UAV"), act: askKey("return") },
    { keys: ["shift+l"], words: t("Land the chosen UAV here"), act: askKey("land") },
    { keys: ["escape"], words: t("Choose none"), act: () => (ui.chosen ? ((ui.chosen = null), redraw(), true) : false) },
  ].filter(({ act }) => act),
});

setInterval(redraw, 1_000); // ages go on
document.addEventListener("visibilitychange", redraw);
document.documentElement.dataset.loaded = "true";
