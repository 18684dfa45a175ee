/** The page "Imports": composes uploads, the list, the open import with its difference, and the map. */

import { ApiError, get, patch, post, signInAddress } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { boxAround } from "../domain/geodesy.js";
import { mountGroundPage } from "../ground/ground_page.js";
import { loadMapLibrary } from "../map/maplibre.js";
import { announce, toast } from "../page/toast.js";
import { createStore } from "../store.js";
import { t, tn } from "../text.js";
import { numberText } from "../units.js";
import { mountBringIn, notAllowed } from "./bring_in.js";
import { mountChanges } from "./changes.js";
import { createChangesLayer, positionsOf } from "./changes_layer.js";
import { mountList, titleOf } from "./list.js";
import { mountOverpassBox } from "./overpass_box.js";
import { mountProposal } from "./proposal.js";
import { isOpen, isTouched, STATES } from "./words.js";

/** @import { Answer } from "../api.js" */
/** @import { Ground, ZoneSet, ZoneSetPage, ZoneSetVersion, ZoneSetVersionPage } from "../api_types.d.ts" */
/** @import { GroundPage } from "../ground/types.d.ts" */
/** @import { ScreenPoint } from "../map/types.d.ts" */
/** @import { Change, ImportsState, Proposal, ProposalActs } from "./types.d.ts" */

/** @typedef {GroundPage & { overpass: { most_km2: number } | null, proposal: string | null }} ImportsPage */

const LOOK_MS = 1_000; // while the open one is worked on
const LIST_MS = 4_000; // while another one is
const LIST_PAGE = 50;
const CHANGES_PAGE = 1_000;
const LISTED = 200; // rows of a long difference at a time; the map has them all

/** @type {Pick<ImportsState, "changes" | "listed" | "action" | "subject" | "excluded" | "lit" | "selected">} */
const NO_CHANGES = { changes: [], listed: LISTED, action: "", subject: "", excluded: [], lit: null, selected: null };
/** @type {ImportsState} */
const FIRST_STATE = { proposals: null, next: null, current: null, busy: null, ...NO_CHANGES };
const store = createStore(FIRST_STATE);
/** @type {ReturnType<typeof createChangesLayer> | null} */
let changesLayer = null;
let lookedAt = 0;

await loadMapLibrary();
const { page, map, open } = mountGroundPage({
  click(_thing, _place, point) {
    const change = changeAt(point);
    if (change) select(change, { stay: true });
  },
  hover(_thing, point) {
    const change = point && changeAt(point);
    light(change?.id ?? null);
  },
});

/** @param {ScreenPoint} point */
function changeAt(point) {
  const id = changesLayer?.at(point);
  return id ? store.state.changes.find((change) => change.id === id) : null;
}

/** @param {unknown} error @param {string} title */
function notify(error, title) {
  if (!(error instanceof ApiError)) throw error;
  const words = error.isSignedOut
    ? [`${t("Sign in to go on.")} `, h("a", { class: "text-button", href: signInAddress() }, t("Sign in"))]
    : [error.message];
  byId("notices").replaceChildren(
    h(
      "div",
      { class: "notice critical", role: "alert" },
      icon("circle-alert"),
      h("p", {}, h("strong", {}, title), " ", ...words),
    ),
  );
}
/** @param {unknown} error */
const statusOf = (error) => (error instanceof ApiError ? error.status : 0);
const clearNotices = () => byId("notices").replaceChildren();

/** Run a user's act; shows a failure. Returns true on success. @param {string} title @param {() => Promise<unknown>} act */
async function attempt(title, act) {
  clearNotices();
  try {
    await act();
    return true;
  } catch (error) {
    notify(error, title);
    return false;
  }
}

/* the list */

/** @param {{ more?: boolean }} [how] whether the next page is added */
async function loadList({ more = false } = {}) {
  const { next, proposals: known } = store.state;
  const address = more && next ? next : `/imports?limit=${LIST_PAGE}`;
  const { data } = /** @type {Answer<{ results: Proposal[], next: string | null }>} */ (await get(address));
  const proposals = more ? [...(known ?? []), ...data.results] : data.results;
  store.update({ proposals, next: data.next });
  showFacts(proposals);
}

/** @param {Proposal[]} proposals */
function showFacts(proposals) {
  const waiting = proposals.filter(({ state }) => state === "ready").length;
  const working = proposals.filter(isOpen).length;
  byId("page-facts").textContent = [
    working && t("{count} being worked on", { count: numberText(working) }),
    waiting
      ? tn(waiting, "{count} import ready for review", "{count} imports ready for review")
      : t("No imports to review"),
  ]
    .filter(Boolean)
    .join(" · ");
}

/** Store the present state of a proposal in the list, and show it if it is open. @param {Proposal} proposal */
function put(proposal) {
  const proposals = store.state.proposals ?? [];
  const isKnown = proposals.some(({ id }) => id === proposal.id);
  const next = isKnown
    ? proposals.map((known) => (known.id === proposal.id ? proposal : known))
    : [proposal, ...proposals];
  store.update({ proposals: next, ...(store.state.current?.id === proposal.id ? { current: proposal } : {}) });
  showFacts(next);
}

/** Show the server's answer. @param {Promise<Answer>} answer */
async function putAnswer(answer) {
  put(/** @type {Proposal} */ ((await answer).data));
}

/* the open one */

/** @param {string} id @param {{ isNew?: boolean, focus?: boolean }} [how] isNew: in the browser's history */
async function openProposal(id, { isNew = true, focus = true } = {}) {
  clearNotices();
  try {
    const { data } = /** @type {Answer<Proposal>} */ (await get(`/imports/${id}`));
    if (isNew) history.pushState({}, "", `/imports/${id}`);
    store.update({ current: data, ...NO_CHANGES });
    byId("side-scroll").scrollTop = 0;
    if (focus) byId("proposal-title").focus({ preventScroll: true });
    await loadChanges({ fit: true });
  } catch (error) {
    notify(error, statusOf(error) === 404 ? t("This import is not there.") : t("Not opened."));
  }
}

function closeProposal({ isNew = true } = {}) {
  const id = store.state.current?.id;
  if (isNew) history.pushState({}, "", "/imports");
  store.update({ current: null, ...NO_CHANGES });
  showChanges();
  map.ring([]);
  /** @type {HTMLElement | null} */
  const row = id ? document.querySelector(`a[href="/imports/${id}"]`) : null;
  row?.focus();
}

/** All of them, page by page: the map shows each. */
async function loadChanges({ fit = false } = {}) {
  const { current } = store.state;
  if (!current || current.state === "reading") return;
  /** @type {Change[]} */
  let changes = [];
  /** @type {string | null} */
  let next = `/imports/${current.id}/changes?limit=${CHANGES_PAGE}`;
  while (next) {
    const { data } = /** @type {Answer<{ features: Change[], next: string | null }>} */ (await get(next));
    if (store.state.current?.id !== current.id || store.state.current.state === "reading") return; // another proposal is open by now
    changes = [...changes, ...data.features];
    next = data.next;
    store.update({ changes });
    showChanges();
  }
  showChanges();
  if (fit) map.fit(boxAround(drawn().flatMap((change) => positionsOf(change.geometry))));
}

/**
 * A file whose columns have no meanings yet has no changes, but shapes; terrain has its coverage.
 *
 * @param {Proposal | null} proposal
 * @returns {Change[]}
 */
function previewOf(proposal) {
  if (!proposal) return [];
  const { kind, summary, difference } = proposal;
  if (kind === "terrain" && summary.extent) {
    const [west, south, east, north] = summary.extent;
    const ring = [
      [west, south],
      [east, south],
      [east, north],
      [west, north],
      [west, south],
    ];
    const action = difference.changed ? "changed" : "new";
    return [
      { id: -1, geometry: { type: "Polygon", coordinates: [ring] }, properties: { action, before: null, after: null } },
    ];
  }
  const features = summary.needs_mapping ? (summary.preview?.features ?? []) : [];
  return features.map(({ geometry }, place) => ({
    geometry,
    id: -1 - place,
    properties: { action: "new", before: null, after: null },
  }));
}

const drawn = () => [...store.state.changes, ...previewOf(store.state.current)];

function showChanges() {
  const { action, subject } = store.state;
  const shown = drawn().filter(({ properties }) => !subject || properties.subject === subject);
  changesLayer?.show(shown, action);
}

/** @param {Change | undefined} change */
const geometriesOf = (change) => (change?.geometry ? [change.geometry] : []);

/** @param {number | null} id */
function light(id) {
  if (id === store.state.lit) return;
  store.update({ lit: id });
  const change =
    store.state.changes.find((known) => known.id === id) ??
    store.state.changes.find((known) => known.id === store.state.selected);
  map.ring(geometriesOf(change));
}

/** @param {Change} change @param {{ stay?: boolean }} [how] stay: the map does */
function select(change, { stay = false } = {}) {
  const isAgain = store.state.selected === change.id && !stay;
  store.update({ selected: isAgain ? null : change.id });
  map.ring(isAgain ? [] : geometriesOf(change));
  if (isAgain || !change.geometry) return;
  if (stay) document.querySelector(".change[aria-expanded=true]")?.scrollIntoView({ block: "nearest" });
  else map.fit(boxAround(positionsOf(change.geometry)));
}

/**
 * Carry out a decision; where another user was faster, show that user's decision.
 *
 * @param {string} busy
 * @param {string} title of the message on failure
 * @param {(id: string) => Promise<Answer>} act
 */
async function decide(busy, title, act) {
  const id = store.state.current?.id;
  if (!id) return;
  store.update({ busy });
  clearNotices();
  try {
    await putAnswer(act(id));
  } catch (error) {
    notify(error, title);
    if (statusOf(error) === 409) await putAnswer(get(`/imports/${id}`));
  } finally {
    store.update({ busy: null });
  }
}

/** @type {ProposalActs} */
const acts = {
  back: () => closeProposal(),
  /** Stop the job: a file being read is dropped; one being applied returns to the decision once its worker has stopped. */
  async cancel(proposal) {
    try {
      if (proposal.state === "reading") await putAnswer(post(`/imports/${proposal.id}/discard`, {}));
      else if (proposal.job) await post(`/jobs/${proposal.job.id}/cancel`, {});
    } catch (error) {
      notify(error, t("Not stopped."));
      throw error;
    }
  },
  apply: (overwrites, seen) =>
    decide("apply", t("Not applied."), (id) =>
      post(`/imports/${id}/apply`, {
        parameters: {
          replace_edited: overwrites,
          ...(seen.length ? { seen } : {}),
          ...(store.state.excluded.length ? { excluded: store.state.excluded } : {}),
        },
      }),
    ),
  leftOut(overwrites) {
    const { changes, excluded } = store.state;
    const keys = new Set(excluded);
    return changes.filter(({ properties: { action, key } }) => key && keys.has(key) && isTouched(action, overwrites))
      .length;
  },
  async discard() {
    const { current } = store.state;
    await decide("discard", t("Not discarded."), (id) => post(`/imports/${id}/discard`, {}));
    if (!current || store.state.current?.state !== "discarded") return;
    closeProposal();
    toast(t("“{name}” is discarded. Nothing of it counts.", { name: titleOf(current) }));
  },
  async readAgain(parameters) {
    await decide("read", t("Not read again."), (id) => patch(`/imports/${id}`, { parameters }));
    store.update(NO_CHANGES);
    showChanges();
  },
  place(position) {
    map.show(position);
    map.ring([{ type: "Point", coordinates: position }]);
  },
  async versions(name) {
    /** @type {{ set: ZoneSet | null, rows: ZoneSetVersion[] }} */
    const found = { set: null, rows: [] };
    await attempt(t("The versions were not loaded."), async () => {
      const { data } = /** @type {Answer<ZoneSetPage>} */ (await get("/zone-sets?limit=1000"));
      found.set = data.results.find((set) => set.name === name) ?? null;
      if (!found.set) return;
      const earlier = /** @type {Answer<ZoneSetVersionPage>} */ (await get(`/zone-sets/${found.set.id}/versions`));
      found.rows = earlier.data.results;
    });
    return found;
  },
  undo: ({ id }) =>
    attempt(t("Not undone."), async () => {
      const answer = await post(`/imports/${id}/undo`, {});
      await openProposal(/** @type {Answer<Proposal>} */ (answer).data.id);
    }),
  rollBack: (set, version) =>
    attempt(t("Not rolled back."), async () => {
      const answer = await post(`/zone-sets/${set.id}/roll-back`, { version });
      await openProposal(/** @type {Answer<Proposal>} */ (answer).data.id);
    }),
};

mountProposal(store, acts);
mountList(store, {
  open: (id) => openProposal(id),
  more: () => attempt(t("Not loaded."), () => loadList({ more: true })),
});
mountChanges(store, {
  filter({ action, subject }) {
    store.update({ action, subject, selected: null, listed: LISTED });
    map.ring([]);
    showChanges();
  },
  leaveOut({ properties: { key } }, isLeftOut) {
    const others = store.state.excluded.filter((known) => known !== key);
    store.update({ excluded: isLeftOut && key ? [...others, key] : others });
  },
  point: (change) => light(change?.id ?? null),
  show: select,
  more: () => store.update({ listed: store.state.listed + LISTED }),
});

/** Poll while a job runs; announce its end once. */
async function look() {
  const { current, proposals } = store.state;
  if (document.hidden) return;
  try {
    if (current && isOpen(current)) {
      const { data } = /** @type {Answer<Proposal>} */ (await get(`/imports/${current.id}`));
      if (store.state.current?.id !== data.id) return;
      put(data);
      if (data.state !== current.state) await ended(data);
    } else if (proposals?.some(isOpen) && Date.now() - lookedAt > LIST_MS) {
      lookedAt = Date.now();
      await loadList();
    }
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (error.isSignedOut) notify(error, t("You are signed out."));
  }
}

/** @param {Proposal} proposal */
async function ended(proposal) {
  announce(`${titleOf(proposal)}: ${STATES[proposal.state].words}.`);
  await loadChanges({ fit: true });
  if (proposal.state === "refused" && proposal.faults[0]?.position) acts.place(proposal.faults[0].position);
  if (proposal.state === "applied") {
    map.refreshTiles();
    const { data } = /** @type {Answer<Ground>} */ (await get("/ground"));
    map.setGround(data);
  }
}

function openWhatTheAddressNames() {
  const id = /^\/imports\/([0-9a-f-]{36})/.exec(location.pathname)?.[1] ?? null;
  if (id === (store.state.current?.id ?? null)) return;
  if (id) openProposal(id, { isNew: false });
  else closeProposal({ isNew: false });
}

/** @param {ImportsPage} page */
async function start({ userId, overpass, proposal }) {
  const bringIn = mountBringIn({
    userId,
    onStarted(started, { isLast }) {
      put(started);
      if (isLast) openProposal(started.id);
    },
  });
  const choose = () => {
    if (store.state.current) closeProposal();
    bringIn.choose();
  };
  addEventListener("popstate", openWhatTheAddressNames);
  await open({
    bindings: [{ keys: ["u"], words: t("Choose a file"), act: choose }],
    async load() {
      const layer = createChangesLayer(map);
      changesLayer = layer;
      layer.addTo();
      map.onRecolour(() => layer.recolour());
      if (overpass) mountOverpassBox(map, overpass, takeArea);
      await attempt(t("The list was not loaded."), () => loadList());
      if (proposal) await openProposal(proposal, { isNew: false, focus: false });
      setInterval(look, LOOK_MS);
    },
  });
}

/** Fetches the infrastructure in a box from Overpass. @param {number[]} box */
const takeArea = (box) =>
  attempt(t("Not taken."), async () => {
    const answer = await post("/imports", { kind: "osm", parameters: { overpass_bbox: box } });
    const { data } = /** @type {Answer<Proposal>} */ (answer);
    put(data);
    await openProposal(data.id);
  });

if (page.canCurate) start(/** @type {ImportsPage} */ (page));
else {
  byId("imports-home").replaceChildren(h("section", { class: "panel-section" }, notAllowed()));
  open();
}
