/** The operator's map: composes the page and loads its data. */

import { ApiError, get } from "../api.js";
import { byId, h, whenSeen } from "../dom.js";
import { mapBindings } from "../map/controls.js";
import { openingBox } from "../map/map_view.js";
import { mapLibraryAfter } from "../map/maplibre.js";
import { readBriefing } from "../offline/briefing.js";
import { copiedAt } from "../offline_copy.js";
import { readPage, startChrome } from "../page/chrome.js";
import { mountPlannedStarts } from "../page/planned_starts.js";
import { KEEP_NO_MORE, KEEP_NOW } from "../page/signing_out.js";
import { mountWorkbench } from "../page/workbench.js";
import { mountSceneOpener } from "../scene/opener.js";
import { createHistory, createStore } from "../store.js";
import { t } from "../text.js";
import { createActions } from "./actions/actions.js";
import { createDrafts } from "./actions/draft.js";
import { watchMission } from "./actions/together.js";
import { createFlying } from "./flying/flying_actions.js";
import { mountMap } from "./map/map_panel.js";
import { mountFinder } from "./panels/finder.js";
import { mountFlying } from "./panels/flying.js";
import { mountFoot } from "./panels/foot.js";
import { mountHeader } from "./panels/header.js";
import { mountFlightOptions } from "./panels/options/flight_options.js";
import { mountLostLink } from "./panels/options/lost_link.js";
import { mountOptions } from "./panels/options/options.js";
import { mountOptionsRead } from "./panels/options/options_read.js";
import { askForList } from "./panels/paste_list.js";
import { mountRehearsal } from "./panels/rehearsal/rehearsal.js";
import { mountProfile } from "./panels/routes/profile.js";
import { mountRoutes } from "./panels/routes/routes.js";
import { showSelections } from "./panels/saved_selections.js";
import { mountSavedState } from "./panels/saved_state.js";
import { mountTargets } from "./panels/targets/targets.js";
import { mountTools } from "./panels/tools.js";
import { mountEndings } from "./panels/uavs/endings.js";
import { mountUavs } from "./panels/uavs/uavs.js";
import { mountWhy } from "./panels/why/why.js";
import { isUnsaved } from "./plan/plan_view.js";
import { createRehearsing, NOTHING as NO_REHEARSAL } from "./rehearsal/rehearsal_actions.js";
import { EMPTY } from "./selection.js";
import { createGrounds } from "./strips/profile.js";
import { lockOf } from "./targets/locks.js";
import { standingUavs } from "./uavs/fleet.js";
import { uavOf } from "./uavs/mission_uavs.js";

/** @import { Answer } from "../api.js" */
/** @import { AssetFeature, Ground, UavCollection } from "../api_types.d.ts" */
/** @import { MissionPageData, MissionPageState, MissionStore, Tool } from "./types.d.ts" */

const STAGES = [
  ["", t("Plan")],
  ["/rehearse", t("Rehearse")],
  ["/fly", t("Fly")],
  ["/report", t("Report")],
  ["/3d", "3D"],
];
/** @type {MissionPageData} */
const page = readPage();
const isStage = page.stage === "rehearse";
/** @type {MissionPageState} */
const BEGINNING = {
  ground: null,
  fleet: [],
  mission: null,
  name: "",
  selection: { ...EMPTY },
  canUndo: false,
  canRedo: false,
  plan: null,
  groundRevision: null,
  planIsStored: false,
  savedBasis: null,
  restoredBasis: null,
  figures: {},
  uavNumbers: null,
  proof: null,
  planning: null,
  saving: false,
  problem: null,
  conflict: null,
  stored: null,
  isAway: !navigator.onLine,
  others: [],
  lastPlan: null,
  shownPlan: null,
  planningBeside: null,
  refusedBeside: {},
  why: null,
  along: null,
  tool: "point",
  stretchFrom: null,
  litTarget: null,
  chosenTarget: null,
  chosenTargets: [],
  lookedAt: null,
  chosenRoute: null,
  litZones: [],
  caught: null,
  litReturn: null,
  hand: null,
  commands: null,
  returns: null,
  connections: new Map(),
  preflight: null,
  isDispatching: false,
  arrival: "awaited",
  rehearsal: NO_REHEARSAL,
};
/** @type {MissionStore} */
const store = createStore(BEGINNING);
const history = createHistory(store, "selection");
const editor = crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;
const drafts = createDrafts({ user: page.userId, editor });
const actions = createActions(store, history, page, drafts);
const flying = createFlying(store, { failed: actions.failed, page });

/** @type {ReturnType<typeof mountUavs> | null} */
let uavPanel = null;
const layout = mountWorkbench({ dockOnPhone: byId("routes-on-phone") });
/** @type {ReturnType<typeof mountMap> | null} */
let map = null; // comes later than the rest of the page
/** @type {() => void} */
let showUsable = () => {};
/** @type {Promise<void>} */
const usable = new Promise((resolve) => {
  showUsable = resolve;
});
const mountedMap = mapLibraryAfter(usable).then(() => {
  map = mountMap(store, actions, page, { askForUav: (position) => uavPanel?.askForUav(position) });
  return map;
});
/** @param {(map: ReturnType<typeof mountMap>) => unknown} act */
const onMap = (act) => void mountedMap.then(act);
const boxOfMap = () => map?.box() ?? openingBox(page);
const centreOfMap = () => {
  const [west, south, east, north] = openingBox(page);
  return map?.centre() ?? [(west + east) / 2, (south + north) / 2];
};
/** @param {AssetFeature} feature */
const targetOfFeature = (feature) => actions.targetOfFeature(feature);
/** @param {number[][]} positions */
const showPlaces = (positions) => {
  layout.showMap();
  onMap((there) => there.showPlaces(positions));
};
showStages();
mountHeader(store, actions, page.canPlan, {
  canCopy: page.canFly,
  canCurate: page.canCurate,
  showPlace: (position) => onMap((there) => there.goTo({ position, zoom: 14 })),
  showPlaces,
  addUavAt: (position) => uavPanel?.askForUav(position),
});
if (page.isFrozen) {
  mountFlying(store, flying, { canFly: page.canFly, saveCopy: () => void actions.save({ asCopy: true }) });
  mountPlannedStarts({ mission: page.mission, canFly: page.canFly });
}

const scene = mountSceneOpener(sceneOfMission);
const rehearsing = mountRehearsal(store, createRehearsing(store, { isStage }), {
  canRehearse: page.canFly,
  isFrozen: page.isFrozen,
  isStage,
  seeInSpace: () => void scene.open(),
  actions,
  canPlan: page.canPlan,
  showPlaces,
});
flying.watch();
mountSavedState(store, page.canPlan);
mountTargets(store, actions, page.canPlan, {
  show: (target) => onMap((there) => there.show(target)),
  ground: mountedMap.then(({ ground }) => ground),
});
uavPanel = mountUavs(store, actions, page.canPlan, { mapCentre: centreOfMap });
if (page.canPlan) {
  mountOptions(store, actions, page.canPlan);
  mountFlightOptions(store, actions);
  mountEndings(store, actions);
} else mountOptionsRead(store);
mountLostLink(store, actions, { canPlan: page.canPlan, showPlaces });
mountFoot(store, actions, { approve: () => void flying.approve(), rehearse: rehearsing.begin });
const grounds = createGrounds(whenSeen(byId("route-list")));
mountRoutes(store, actions, { canPlan: page.canPlan, grounds, showPoint: (position) => map?.showPoint(position) });
mountProfile(store, { grounds });
mountWhy(store, actions, { canPlan: page.canPlan });
const finder = mountFinder({
  canPlan: page.canPlan,
  box: boxOfMap,
  show: (feature) => onMap((there) => there.show(targetOfFeature(feature))),
  add: (feature) => void actions.addWhole(targetOfFeature(feature)),
  addAll: (features) => void actions.addFound(features.map(targetOfFeature)),
  things: () =>
    standingUavs(store.state).map(({ name, base_name, position }) => ({
      name,
      position,
      icon: "uav",
      detail: base_name ?? "",
    })),
  goTo: (place) => onMap((there) => there.goTo(place)),
});
if (page.canPlan)
  mountTools(store, { pasteList: () => askForList(actions), savedSelections: () => showSelections(store, actions) });

startChrome({
  bindings: [
    { keys: ["/"], words: t("Find an asset"), act: finder.focus },
    ...(page.canPlan ? planningKeys() : []),
    ...rehearsing.bindings,
    ...mapBindings(() => map?.controls),
    scene.binding,
    { keys: ["f"], words: t("Fit the mission"), act: () => map?.fit() },
    { keys: ["+", "="], words: t("Zoom in"), act: () => map?.zoom(1) },
    { keys: ["-"], words: t("Zoom out"), act: () => map?.zoom(-1) },
    { keys: ["["], words: t("Fold the side"), act: layout.foldSide },
    { keys: ["]"], words: t("Fold the routes"), act: layout.foldDock },
    { keys: ["escape"], words: page.canPlan ? t("Close, back to points") : t("Close"), act: closeTop },
    { keys: ["enter"], act: placeInTheMiddle },
  ],
});

watchMission(store, {
  editor,
  take: actions.take,
  connectedAgain: actions.connectedAgain,
  showDeleted: actions.showDeleted,
  readFleet: fleetOfOrganisation,
});

store.listen(["tool"], ({ tool }) => tool !== "point" && layout.showMap());

/** Show the stages of the mission once one that was begun on this page is stored. */
function showStages() {
  if (document.querySelector(".stages")) return; // the page was made with them
  store.listen(["mission"], ({ mission }) => {
    if (!mission || document.querySelector(".stages")) return;
    const links = STAGES.map(([rest, words]) =>
      h("a", { href: `/missions/${mission.id}${rest}`, "aria-current": rest ? null : "page" }, words),
    );
    byId("others").after(h("nav", { class: "page-tabs stages", "aria-label": t("Stages of the mission") }, links));
  });
}

/**
 * The scene of the mission: the run of a rehearsal that is shown, else the stored plan.
 *
 * @returns {ReturnType<Parameters<typeof mountSceneOpener>[0]>}
 */
function sceneOfMission() {
  const { mission, rehearsal } = store.state;
  if (!mission?.plan) return null;
  const { track, detail, run } = rehearsal;
  return { mission: mission.id, wanted: track && detail ? { kind: "rehearsal", rehearsal: detail.id, run } : null };
}

/** @type {string | null} */
let plannedSeen = null;
store.listen(["mission"], ({ mission }) => {
  scene.show(Boolean(mission?.plan));
  const isOther = plannedSeen !== null && (mission?.planned_at ?? null) !== plannedSeen;
  if (isOther && mission?.plan && scene.stage()?.source.kind === "plan") void scene.open({ takesFocus: false }); // it was planned again
  plannedSeen = mission?.planned_at ?? null;
});
/** @type {MissionPageState["rehearsal"]["track"]} */
let runSeen = null;
store.listen(["rehearsal"], ({ rehearsal: { track } }) => {
  const isOther = track !== null && track !== runSeen;
  if (isOther && runSeen !== null && scene.isOpen()) void scene.open(); // another run was chosen
  if (isOther) runSeen = track;
});

function planningKeys() {
  /** @param {Tool} tool */
  const choose = (tool) => () => store.update({ tool });
  return [
    { keys: ["p"], words: t("Plan, plan again"), act: actions.plan },
    { keys: ["mod+s"], words: t("Save"), whileTyping: true, act: () => void actions.save() },
    { keys: ["mod+z"], words: t("Undo"), act: () => (store.state.hand ? actions.undoManualEdit() : actions.undo()) },
    {
      keys: ["mod+shift+z", "mod+y"],
      words: t("Redo"),
      act: () => (store.state.hand ? actions.redoManualEdit() : actions.redo()),
    },
    { keys: ["delete", "backspace"], words: t("Remove the chosen targets"), act: removeChosen },
    { keys: ["l"], words: t("Lock or unlock the chosen target"), act: lockChosen },
    { keys: ["alt+arrowup"], words: t("The chosen target earlier"), act: () => shiftChosen(-1) },
    { keys: ["alt+arrowdown"], words: t("The chosen target later"), act: () => shiftChosen(1) },
    { keys: ["v"], words: t("Pick points"), act: choose("point") },
    { keys: ["b"], words: t("Pick by box"), act: choose("box") },
    { keys: ["o"], words: t("Draw round what is picked"), act: choose("lasso") },
    { keys: ["w"], words: t("Pick whole lines"), act: choose("line") },
    { keys: ["t"], words: t("Pick tower to tower"), act: choose("stretch") },
    { keys: ["i"], words: t("Paste a list"), act: () => void askForList(actions) },
  ];
}

function removeChosen() {
  const { hand, chosenTargets } = store.state;
  if (hand) return hand.chosen !== null && actions.removeManually(hand.chosen);
  if (!chosenTargets.length) return false;
  actions.removeTargets(chosenTargets);
  return true;
}

function lockChosen() {
  const { chosenTarget, selection } = store.state;
  if (chosenTarget === null) return false;
  if (lockOf(selection, chosenTarget)) return actions.unlockTarget(chosenTarget);
  return actions.lockTarget(chosenTarget);
}

/** @param {number} step */
function shiftChosen(step) {
  const { chosenTarget } = store.state;
  return chosenTarget !== null && actions.shiftTarget(chosenTarget, step);
}

function closeTop() {
  if (map?.closeTop()) return;
  if (store.state.caught) actions.dropCaught();
  else if (store.state.why) store.update({ why: null });
  else if (store.state.problem) store.update({ problem: null });
  else if (store.state.tool !== "point") store.update({ tool: "point" });
  else store.update({ chosenTarget: null, chosenTargets: [], chosenRoute: null });
}

function placeInTheMiddle() {
  if (store.state.tool === "rally") {
    actions.addRallyPoint(centreOfMap());
    return true;
  }
  if (store.state.tool === "zone") {
    onMap((there) => there.askForZone({ centre: there.centre() }));
    return true;
  }
  if (store.state.tool !== "place") return false;
  uavPanel?.askForUav();
  return true;
}

// The selection survives a reload: it is stored a moment after each change, and deleted once there is none to keep.
/** @type {ReturnType<typeof setTimeout> | undefined} */
let keepTimer;
let isKept = true;
let isLoaded = false;
store.listen(["selection", "name", "savedBasis", "mission", "conflict"], () => {
  clearTimeout(keepTimer);
  if (!page.canPlan || !isLoaded) return;
  keepTimer = setTimeout(() => {
    isKept = actions.settleDraft();
  }, 400);
});
addEventListener("pagehide", () => {
  if (page.canPlan && isLoaded) actions.settleDraft();
});
addEventListener(KEEP_NOW, () => page.canPlan && isLoaded && actions.settleDraft());
addEventListener(KEEP_NO_MORE, () => {
  clearTimeout(keepTimer);
  isLoaded = false;
});
addEventListener("beforeunload", (event) => {
  if (page.canPlan && !isKept && isUnsaved(store.state)) event.preventDefault(); // storage is closed: ask
});

async function fleetOfOrganisation() {
  const fleet = [];
  /** @type {string | null} */
  let next = "/uavs?limit=100";
  while (next) {
    const { data } = /** @type {Answer<UavCollection>} */ (await get(next));
    fleet.push(...data.features.map(uavOf));
    next = data.next;
  }
  return fleet;
}

async function load() {
  try {
    const fleet = fleetOfOrganisation();
    fleet.catch(() => {}); // shown below, after the map has its data
    store.update({ ground: /** @type {Answer<Ground>} */ (await get("/ground")).data });
    store.update({ fleet: await fleet });
    if (page.mission) await actions.open(page.mission);
    if (page.mission && copiedAt !== null) {
      const { element } = await readBriefing(page.mission, (position) => map?.showPoint(position));
      byId("notices").after(element);
    } else if (page.canPlan) actions.openDraft();
    isLoaded = true;
    store.update({ arrival: "whole" });
    void actions.resume();
  } catch (error) {
    store.update({ arrival: "failed" });
    actions.failed(t("Not loaded."), error, [{ label: t("Load again"), act: () => location.reload() }]);
    if (!(error instanceof ApiError)) throw error;
  }
  document.documentElement.dataset.usable = "true";
  showUsable();
  const { ready, opensAtPlace, fit } = await mountedMap;
  await ready;
  if (!store.state.plan && !opensAtPlace) fit({ animate: false });
  document.documentElement.dataset.loaded = "true";
}

load();
