/** The page "Imports": composes what comes in, the list, the open one with its difference, and the map. */

import { ApiError, get, patch, post, signInAddress } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { mountGroundPage } from "../ground/ground_page.js";
import { boxAround } from "../map/map_view.js";
import { say, toast } from "../page/toast.js";
import { createStore } from "../store.js";
import { t, tn } from "../text.js";
import { numberText } from "../units.js";
import { mountBringIn, notAllowed } from "./bring_in.js";
import { mountChanges } from "./changes.js";
import { createChangesLayer, positionsOf } from "./changes_layer.js";
import { mountList, titleOf } from "./list.js";
import { mountOverpassBox } from "./overpass_box.js";
import { mountProposal } from "./proposal.js";
import { isOpen, STATES } from "./words.js";

const LOOK_MS = 1_000; // while the open one is worked on
const LIST_MS = 4_000; // while another one is
const LIST_PAGE = 50;
const CHANGES_PAGE = 1_000;
const LISTED = 200; // rows of a long difference at a time; the map has them all

const NO_CHANGES = { changes: [], listed: LISTED, action: "", lit: null, selected: null };
const store = createStore({ proposals: null, next: null, current: null, busy: null, ...NO_CHANGES });
let changesLayer = null;
let lookedAt = 0;

const { page, map, open } = mountGroundPage({
  click(thing, position, point) {
    const change = changeAt(point);
    if (change) select(change, { stay: true });
  },
  hover(thing, point) {
    const change = point && changeAt(point);
    light(change?.id ?? null);
  },
});

const changeAt = (point) => {
  const id = changesLayer?.at(point);
  return id ? store.state.changes.find((change) => change.id === id) : null;
};

function tell(error, title) {
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
const clearNotices = () => byId("notices").replaceChildren();

/** Runs what somebody asked for; says so where it did not work. True if it did. */
async function attempt(title, act) {
  clearNotices();
  try {
    await act();
    return true;
  } catch (error) {
    tell(error, title);
    return false;
  }
}

/* the list */

async function loadList({ more = false } = {}) {
  const { data } = await get(more ? store.state.next : `/imports?limit=${LIST_PAGE}`);
  const proposals = more ? [...store.state.proposals, ...data.results] : data.results;
  store.update({ proposals, next: data.next });
  tellFacts(proposals);
}

function tellFacts(proposals) {
  const waiting = proposals.filter(({ state }) => state === "ready").length;
  const working = proposals.filter(isOpen).length;
  byId("page-facts").textContent = [
    working && t("{count} being worked on", { count: numberText(working) }),
    waiting ? tn(waiting, "{count} import to be decided", "{count} imports to be decided") : t("Nothing to be decided"),
  ]
    .filter(Boolean)
    .join(" · ");
}

const put = (proposal) => {
  const proposals = store.state.proposals ?? [];
  const isKnown = proposals.some(({ id }) => id === proposal.id);
  const next = isKnown
    ? proposals.map((known) => (known.id === proposal.id ? proposal : known))
    : [proposal, ...proposals];
  store.update({ proposals: next, ...(store.state.current?.id === proposal.id ? { current: proposal } : {}) });
  tellFacts(next);
};

/* the open one */

async function openProposal(id, { isNew = true, focus = true } = {}) {
  clearNotices();
  try {
    const { data } = await get(`/imports/${id}`);
    if (isNew) history.pushState({}, "", `/imports/${id}`);
    store.update({ current: data, ...NO_CHANGES });
    byId("side-scroll").scrollTop = 0;
    if (focus) byId("proposal-title").focus({ preventScroll: true });
    await loadChanges({ fit: true });
  } catch (error) {
    tell(error, error.status === 404 ? t("This import is not there.") : t("Not opened."));
  }
}

function closeProposal({ isNew = true } = {}) {
  const id = store.state.current?.id;
  if (isNew) history.pushState({}, "", "/imports");
  store.update({ current: null, ...NO_CHANGES });
  showChanges();
  map.ring([]);
  if (id) document.querySelector(`a[href="/imports/${id}"]`)?.focus();
}

/** All of them, page by page: the map shows each. */
async function loadChanges({ fit = false } = {}) {
  const { current } = store.state;
  if (!current || current.state === "reading") return;
  let changes = [];
  let next = `/imports/${current.id}/changes?limit=${CHANGES_PAGE}`;
  while (next) {
    const { data } = await get(next);
    if (store.state.current?.id !== current.id || store.state.current.state === "reading") return; // somebody has gone on
    changes = [...changes, ...data.features];
    next = data.next;
    store.update({ changes });
    showChanges();
  }
  showChanges();
  if (fit) map.fit(boxAround(drawn().flatMap((change) => positionsOf(change.geometry))));
}

/** A file whose columns nobody has explained yet has no changes, but shapes; terrain has what it covers. */
function previewOf(proposal) {
  if (!proposal) return [];
  const { kind, summary, difference } = proposal;
  if (kind === "terrain" && summary.extent) {
    const [west, south, east, north] = summary.extent;
    const geometry = {
      type: "Polygon",
      coordinates: [
        [
          [west, south],
          [east, south],
          [east, north],
          [west, north],
          [west, south],
        ],
      ],
    };
    return [
      {
        type: "Feature",
        id: -1,
        geometry,
        properties: { action: difference.changed ? "changed" : "new", before: null, after: null },
      },
    ];
  }
  const features = summary.needs_mapping ? (summary.preview?.features ?? []) : [];
  return features.map((feature, place) => ({
    ...feature,
    id: -1 - place,
    properties: { action: "new", before: null, after: null },
  }));
}

const drawn = () => [...store.state.changes, ...previewOf(store.state.current)];

function showChanges() {
  changesLayer?.show(drawn(), store.state.action);
}

const geometriesOf = (change) => (change?.geometry ? [change.geometry] : []);

function light(id) {
  if (id === store.state.lit) return;
  store.update({ lit: id });
  const change =
    store.state.changes.find((known) => known.id === id) ??
    store.state.changes.find((known) => known.id === store.state.selected);
  map.ring(geometriesOf(change));
}

function select(change, { stay = false } = {}) {
  const isAgain = store.state.selected === change.id && !stay;
  store.update({ selected: isAgain ? null : change.id });
  map.ring(isAgain ? [] : geometriesOf(change));
  if (isAgain || !change.geometry) return;
  if (stay) document.querySelector(".change[aria-expanded=true]")?.scrollIntoView({ block: "nearest" });
  else map.fit(boxAround(positionsOf(change.geometry)));
}

/** What somebody decides; where somebody else was faster, what that one decided is shown. */
async function decide(busy, title, act) {
  store.update({ busy });
  clearNotices();
  try {
    put((await act()).data);
  } catch (error) {
    tell(error, title);
    if (error.status === 409) put((await get(`/imports/${store.state.current.id}`)).data);
  } finally {
    store.update({ busy: null });
  }
}

const acts = {
  back: () => closeProposal(),
  /** What is read is thrown away; what is applied goes back to be decided, once its worker has heard of it. */
  async cancel(proposal) {
    try {
      if (proposal.state === "reading") put((await post(`/imports/${proposal.id}/discard`, {})).data);
      else await post(`/jobs/${proposal.job.id}/cancel`, {});
    } catch (error) {
      tell(error, t("Not stopped."));
      throw error;
    }
  },
  apply: (overwrites) =>
    decide("apply", t("Not applied."), () =>
      post(`/imports/${store.state.current.id}/apply`, { parameters: { replace_edited: overwrites } }),
    ),
  async discard() {
    const { current } = store.state;
    await decide("discard", t("Not discarded."), () => post(`/imports/${current.id}/discard`, {}));
    if (store.state.current?.state !== "discarded") return;
    closeProposal();
    toast(t("“{name}” is discarded. Nothing of it counts.", { name: titleOf(current) }));
  },
  async readAgain(parameters) {
    await decide("read", t("Not read again."), () => patch(`/imports/${store.state.current.id}`, { parameters }));
    store.update(NO_CHANGES);
    showChanges();
  },
  place(position) {
    map.show(position);
    map.ring([{ type: "Point", coordinates: position }]);
  },
  async versions(name) {
    const found = { set: null, rows: [] };
    await attempt("The versions were not loaded.", async () => {
      const { data } = await get("/zone-sets?limit=1000");
      found.set = data.results.find((set) => set.name === name) ?? null;
      if (found.set) found.rows = (await get(`/zone-sets/${found.set.id}/versions`)).data.results;
    });
    return found;
  },
  rollBack: (set, version) =>
    attempt("Not rolled back.", async () => {
      const { data } = await post(`/zone-sets/${set.id}/roll-back`, { version });
      await openProposal(data.id);
    }),
};

mountProposal(store, acts);
mountList(store, {
  open: (id) => openProposal(id),
  more: () => attempt("Not loaded.", () => loadList({ more: true })),
});
mountChanges(store, {
  filter(action) {
    store.update({ action, selected: null, listed: LISTED });
    map.ring([]);
    showChanges();
  },
  point: (change) => light(change?.id ?? null),
  show: select,
  more: () => store.update({ listed: store.state.listed + LISTED }),
});

/** Looks again while something is worked on; what has ended is said once. */
async function look() {
  const { current, proposals } = store.state;
  if (document.hidden) return;
  try {
    if (current && isOpen(current)) {
      const { data } = await get(`/imports/${current.id}`);
      if (store.state.current?.id !== data.id) return;
      put(data);
      if (data.state !== current.state) await ended(data);
    } else if (proposals?.some(isOpen) && Date.now() - lookedAt > LIST_MS) {
      lookedAt = Date.now();
      await loadList();
    }
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (error.isSignedOut) tell(error, t("You are signed out."));
  }
}

async function ended(proposal) {
  say(`${titleOf(proposal)}: ${STATES[proposal.state].words}.`);
  await loadChanges({ fit: true });
  if (proposal.state === "refused" && proposal.faults[0]?.position) acts.place(proposal.faults[0].position);
  if (proposal.state === "applied") {
    map.refreshTiles();
    map.setGround((await get("/ground")).data);
  }
}

function openWhatTheAddressNames() {
  const id = /^\/imports\/([0-9a-f-]{36})/.exec(location.pathname)?.[1] ?? null;
  if (id === (store.state.current?.id ?? null)) return;
  if (id) openProposal(id, { isNew: false });
  else closeProposal({ isNew: false });
}

if (page.canCurate) {
  const bringIn = mountBringIn({
    userId: page.userId,
    onStarted(proposal, { isLast }) {
      put(proposal);
      if (isLast) openProposal(proposal.id);
    },
  });
  addEventListener("popstate", openWhatTheAddressNames);
  open({
    bindings: [
      {
        keys: ["u"],
        words: t("Choose a file"),
        act: () => (store.state.current ? closeProposal() : undefined, bringIn.choose()),
      },
    ],
    async load() {
      changesLayer = createChangesLayer(map);
      changesLayer.addTo();
      map.onRecolour(() => changesLayer.recolour());
      if (page.overpass) {
        mountOverpassBox(map, page.overpass, (box) =>
          attempt("Not taken.", async () => {
            const { data } = await post("/imports", { kind: "osm", parameters: { overpass_bbox: box } });
            put(data);
            await openProposal(data.id);
          }),
        );
      }
      await attempt("The list was not loaded.", () => loadList());
      if (page.proposal) await openProposal(page.proposal, { isNew: false, focus: false });
      setInterval(look, LOOK_MS);
    },
  });
} else {
  byId("imports-home").replaceChildren(h("section", { class: "panel-section" }, notAllowed()));
  open();
}
