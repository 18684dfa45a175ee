/** The live page: composes the page, listens to the feed, keeps the time. */

import { ApiError, get } from "../api.js";
import { byId } from "../dom.js";
import { inAir } from "../domain/in_air.js";
import { openFeed } from "../live/feed.js";
import { KINDS } from "../live/shown.js";
import { staleWords } from "../live/stale.js";
import { mapBindings } from "../map/controls.js";
import { mapLibraryAfter } from "../map/maplibre.js";
import { copiedAt } from "../offline_copy.js";
import { readPage, startChrome } from "../page/chrome.js";
import { mountPlannedStarts } from "../page/planned_starts.js";
import { mountWorkbench } from "../page/workbench.js";
import { mountSceneOpener } from "../scene/opener.js";
import { createStore } from "../store.js";
import { t } from "../text.js";
import { hasArrived } from "./arrival.js";
import { missionNumbers } from "./call_signs.js";
import { createCommanding } from "./commands/commanding.js";
import { createEventReading } from "./event_reading.js";
import { EVERYTHING, isHead, listed } from "./fleet_groups.js";
import { mountMonitorMap } from "./map/monitor_map.js";
import { createMissionDetails } from "./mission_details.js";
import { mountNarrow } from "./narrow.js";
import { showCopy, silentFeed } from "./offline_copy.js";
import { mountAbortMission } from "./panels/abort_mission.js";
import { mountAlerts } from "./panels/alerts.js";
import { mountBoard } from "./panels/board.js";
import { mountCards } from "./panels/cards.js";
import { mountCloseMission } from "./panels/close_mission.js";
import { mountCommandBar } from "./panels/command_bar.js";
import { mountFleetFilter } from "./panels/fleet_filter.js";
import { mountHead } from "./panels/head.js";
import { mountOffers } from "./panels/offers.js";
import { mountPreflight } from "./panels/preflight.js";
import { mountSimulation } from "./panels/simulation.js";
import { mountUrgent } from "./panels/urgent.js";
import { ofPage, placed } from "./placed.js";

/** @import { Stage } from "../scene/stage.js" */

/** @import { Answer } from "../api.js" */
/** @import { Live } from "../api_types.d.ts" */
/** @import { Touched } from "../live/shown.js" */
/** @import { Ground } from "../map/types.d.ts" */
/** @import { MonitorPage, MonitorState } from "./types.d.ts" */

const TICK_MS = 500;

const page = /** @type {MonitorPage} */ (readPage());
const store = createStore(
  /** @type {MonitorState} */ ({
    uavs: [],
    missions: [],
    alerts: [],
    commands: [],
    offers: [],
    details: new Map(),
    flown: new Map(),
    offered: [],
    ground: null,
    numbers: new Map(),
    filter: EVERYTHING,
    chosen: null,
    isFollowing: false,
    showsLog: false,
    events: null,
    olderEvents: null,
    link: null,
    since_ms: 0,
    received_ms: null,
    silent_ms: 0,
    unsent: new Map(),
    sending: new Map(),
    isWhole: false,
    now_ms: Date.now(),
  }),
);

/** @param {number} id of a UAV */
const pick = (id) => store.update({ chosen: id, isFollowing: store.state.isFollowing && store.state.chosen === id });
const layout = mountWorkbench({ dockOnPhone: null });
/** @type {ReturnType<typeof mountMonitorMap> | null} */
let map = null; // comes later than the rest of the page
/** @type {() => void} */
let showUsable = () => {};
/** @type {Promise<void>} */
const usable = new Promise((resolve) => {
  showUsable = () => {
    document.documentElement.dataset.usable = "true";
    resolve();
  };
});
const mountedMap = mapLibraryAfter(usable).then(() => {
  map = mountMonitorMap(store, page, { pick });
  return map;
});
/** @param {(map: ReturnType<typeof mountMonitorMap>) => unknown} act */
const onMap = (act) => void mountedMap.then(act);
const scene = mountSceneOpener(() => {
  const mission = missionSeen(store.state);
  return mission !== null && { mission, now_ms: () => feed.shown_ms(), follow: followFeed };
});
const commanding = page.canFly ? createCommanding(store, page) : null;
const narrow = mountNarrow();
createMissionDetails(
  store,
  mountedMap.then(({ ready }) => ready),
);
mountHead(store, page);
const fleetFilter = page.mission === null ? mountFleetFilter(store) : null;
mountCards(store, {
  isOfOne: page.mission !== null,
  pick,
  close: () => store.update({ chosen: null, isFollowing: false }),
  showShown: (shown, all) => fleetFilter?.notify(shown, all),
  jumpTo: (id) => onMap((there) => there.jumpTo(id)),
  follow: () => store.update({ isFollowing: !store.state.isFollowing }),
  commanding,
});
mountOffers(store, page);
const alertKeys = mountAlerts(store, page, { pick, commanding, showBoard: narrow.showBoard });
mountBoard(store, {
  show(mission, place) {
    const position = store.state.details.get(mission)?.targets[place]?.position;
    if (position) onMap((there) => there.showPlace(position));
  },
  readOlder: createEventReading(store, page).readOlder,
});
const simulation = mountSimulation(store, page);
mountPlannedStarts({ mission: page.mission, canFly: page.canFly });
mountPreflight(store, page, simulation);
mountAbortMission(store, page);
mountCloseMission(store, page);
mountUrgent(store, { open: narrow.showBoard });
const commandKeys = commanding ? mountCommandBar(store, commanding) : [];

/** The mission of its own page, else that of the chosen UAV, else the first. @param {Readonly<MonitorState>} state */
const missionSeen = ({ uavs, chosen, missions }) =>
  page.mission ?? uavs.find(({ id }) => id === chosen)?.mission ?? missions[0]?.id ?? null;
store.listen(["missions"], (state) => scene.show(missionSeen(state) !== null));

/** Pass the feed's changes to the 3D view. @param {Stage} stage */
function followFeed(stage) {
  const { source } = stage;
  if (source.kind !== "live") return () => {};
  let { revision } = source;
  return store.listen(["uavs", "now_ms", "silent_ms", "link"], (state) => {
    const { uavs, now_ms } = state;
    stage.showStale(staleWords(state));
    if (!source.take?.({ uavs, now_ms })) return;
    stage.refresh(source.revision !== revision);
    revision = source.revision;
  });
}

/** The UAV that the address names, as links of alerts do: ?uav=12. */
function pickNamed() {
  const named = Number(new URLSearchParams(location.search).get("uav"));
  if (store.state.uavs.some(({ id }) => id === named)) pick(named);
}

/** @param {number} by 1 or -1 */
function step(by) {
  const order = listed(store.state, page.mission !== null).flatMap((entry) => (isHead(entry) ? [] : entry));
  if (!order.length) return;
  const at = order.findIndex(({ id }) => id === store.state.chosen);
  pick(order[at < 0 ? 0 : (at + by + order.length) % order.length].id);
}

const byNumber = Array.from({ length: 8 }, (_, place) => ({
  keys: [`${place + 1}`],
  words: place === 0 ? t("Choose UAV A; 2 to 8: B to H") : "",
  act() {
    const mission = missionSeen(store.state); // several have a UAV A
    const uav = store.state.uavs.find((entry) => entry.place === place && entry.mission === mission);
    if (!uav) return false;
    pick(uav.id);
    return true;
  },
}));

/** @param {KeyboardEvent} event */
const isOnControl = ({ target }) => target instanceof Element && target.closest("button, a, input, summary") !== null;

startChrome({
  bindings: [
    ...byNumber,
    { keys: ["j"], words: t("Next UAV"), act: () => step(1) },
    { keys: ["k"], words: t("Previous UAV"), act: () => step(-1) },
    {
      keys: ["enter"],
      words: t("Show the chosen UAV on the map"),
      act: (event) => !isOnControl(event) && (map?.jumpTo(store.state.chosen) ?? false),
    },
    ...alertKeys,
    ...commandKeys,
    ...mapBindings(() => map?.controls),
    scene.binding,
    { keys: ["f"], words: t("Fit what flies"), act: () => map?.fit() },
    { keys: ["+", "="], words: t("Zoom in"), act: () => map?.zoom(1) },
    { keys: ["-"], words: t("Zoom out"), act: () => map?.zoom(-1) },
    { keys: ["["], words: t("Fold the side"), act: layout.foldSide },
    { keys: ["]"], words: t("Fold alerts and targets"), act: layout.foldRight },
    {
      keys: ["escape"],
      words: t("Close"),
      act() {
        if (!map?.closeTop()) store.update({ chosen: null, isFollowing: false });
      },
    },
  ],
});

// Changes are drawn together, at most once a frame; on a hidden page after a delay.

const HIDDEN_MS = 500;
/** @type {Set<keyof Live> | null} */
let waiting = null; // the kinds that have changed since the last drawing

/** @param {Touched | null} touched */
function take(touched) {
  const kinds = touched ? KINDS.filter((kind) => touched[kind]?.size) : KINDS;
  const isDrawing = waiting !== null;
  waiting = new Set([...(waiting ?? []), ...kinds]);
  if (isDrawing) return;
  if (document.hidden) setTimeout(show, HIDDEN_MS);
  else requestAnimationFrame(show);
}

function show() {
  /** @type {Partial<Live>} */
  const reported = Object.fromEntries([...(waiting ?? [])].map((kind) => [kind, [...feed.shown[kind].values()]]));
  if (reported.uavs || reported.missions) {
    reported.uavs = ofPage(placed([...feed.shown.uavs.values()], [...feed.shown.missions.values()]), page.mission);
  }
  waiting = null;
  const numbers =
    page.mission === null
      ? missionNumbers(store.state.numbers, [...feed.shown.missions.values()])
      : store.state.numbers;
  store.update({ ...reported, numbers, ...timesOf() });
  if (!store.state.isWhole) pickNamed();
  store.update({ isWhole: true }); // from here on what comes is news
}

const feed =
  copiedAt === null
    ? openFeed({
        mission: page.mission,
        onChange: take,
        onState: ({ state, since_ms }) => store.update({ link: state, since_ms }),
      })
    : silentFeed(copiedAt);
/** The data shown are of `now_ms`: it stops while the device receives none. */
const timesOf = () => ({ now_ms: feed.shown_ms(), received_ms: feed.received_ms, silent_ms: feed.silent_ms() });
setInterval(() => store.update(timesOf()), TICK_MS);
addEventListener("pagehide", () => feed.close());

async function load() {
  try {
    store.update({ ground: /** @type {Answer<Ground>} */ (await get("/ground")).data });
  } catch (error) {
    if (!(error instanceof ApiError)) throw error; // the map itself reports that it cannot be read
  }
  const loading = byId("map-loading");
  store.listen(["isWhole", "missions", "details"], (state) => {
    loading.hidden ||= copiedAt !== null || hasArrived(state); // a mission that comes later is no reason to cover the map
    if (loading.hidden) showUsable();
  });
  const approved =
    copiedAt !== null && page.mission
      ? await showCopy(store, page.mission, (position) => onMap((there) => there.showPlace(position)))
      : null;
  const there = await mountedMap;
  await there.ready;
  if (approved) {
    there.showApproved(approved);
    if (!there.opensAtPlace) there.fit({ animate: false });
  }
  document.documentElement.dataset.loaded = "true";
  let wasFitted = there.opensAtPlace;
  store.listen(["details", "uavs"], ({ details, uavs, missions }) => {
    if (wasFitted || !uavs.length || missions.some(({ id }) => !details.has(id))) return;
    wasFitted = true;
    if (!there.opensAtLastView || uavs.some(inAir)) there.fit({ animate: false });
  });
}

load();
