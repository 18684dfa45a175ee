/** The page of the 3D view: one mission, at the place and time that the address states. */

import { ApiError, get, signInAddress } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { openFeed } from "../live/feed.js";
import { staleWords } from "../live/stale.js";
import { readPage, startChrome } from "../page/chrome.js";
import { loadMission } from "../record/load.js";
import { t } from "../text.js";
import { sceneKeys } from "./keys.js";
import { readLink } from "./link.js";
import { readSource } from "./sources/read.js";
import { openStage } from "./stage.js";

const KEPT_MS = 400; // delay until the address is updated after a change
const TICK_MS = 500; // for a live source: silence is detected without messages
const AGAIN_MS = 30_000; // a record that still grows is read
/** @type {Record<SourceKind, string>} */
const SOURCE_WORDS = { plan: t("Planned"), rehearsal: t("Rehearsal"), live: t("Live"), record: t("Record") };

/** @import { Answer } from "../api.js" */
/** @import { Mission } from "../api_types.d.ts" */
/** @import { SceneActs } from "./acts.js" */
/** @import { SceneLink } from "./link.js" */
/** @import { Stage } from "./stage.js" */
/** @import { FlightSource, SourceKind, WantedSource } from "./types.d.ts" */

/** @type {{ mission: string }} */
const page = readPage();
const root = byId("scene");
/** @type {Stage | null} */
let stage = null;
/** @type {ReturnType<typeof openFeed> | null} */
let feed = null;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;
/** @type {ReturnType<typeof setInterval> | undefined} of a source that grows */
let following;
let opened = 0; // the last one wins

/** The acts of the present stage; without effect while there is none. */
const acts = /** @type {SceneActs} */ (
  new Proxy(
    {},
    {
      get:
        (_target, name) =>
        /** @param {unknown[]} given */
        (...given) => {
          const act = stage?.[/** @type {keyof SceneActs} */ (name)];
          return (act && Reflect.apply(act, stage, given)) ?? false;
        },
    },
  )
);

function keepAddress() {
  clearTimeout(timer);
  timer = setTimeout(() => {
    if (stage) history.replaceState(null, "", stage.address());
  }, KEPT_MS);
}

/** @param {string} words @param {(() => void) | null} [again] */
function notify(words, again = null) {
  root.replaceChildren(
    h(
      "p",
      { class: "scene-waiting", role: again ? "alert" : "status" },
      again && icon("cloud-off"),
      ` ${words} `,
      again && h("button", { class: "button small", type: "button", onclick: again }, t("Try again")),
    ),
  );
}

/** Show a fault with a way to continue. @param {unknown} error @param {() => void} again */
function showFault(error, again) {
  if (!(error instanceof ApiError)) throw error;
  notify(error.message, error.isSignedOut ? null : again);
  if (error.isSignedOut) root.firstElementChild?.append(" ", h("a", { href: signInAddress() }, t("Sign in")));
}

/** @param {Mission} mission @param {WantedSource | null} wanted @param {SceneLink | null} [link] */
async function open(mission, wanted, link = null) {
  const turn = ++opened;
  stage?.dispose();
  stage = null;
  feed?.close();
  feed = null;
  clearInterval(following);
  notify(t("Reading what there is to see."));
  try {
    const { source, choices } = await readSource(mission, wanted);
    if (turn !== opened) return;
    drawSources(mission, source, choices);
    if (!source.routes.length) {
      notify(t("There is nothing to see yet: plan the mission first."));
      return;
    }
    if (source.kind === "live") follow(source);
    if (source.isGrowing) following = setInterval(() => void readAgain(mission, wanted), AGAIN_MS);
    const made = await openStage(root, {
      isWanted: () => turn === opened,
      mission: { id: page.mission, name: mission.name },
      source,
      link,
      now_ms: () => feed?.shown_ms() ?? Date.now(),
      onChange: keepAddress,
    });
    if (!made) return;
    stage = made;
    root.dataset.kind = stage.kind;
  } catch (error) {
    if (turn === opened) showFault(error, () => void open(mission, wanted, link));
  }
}

/** @param {FlightSource} source a live one */
function follow(source) {
  let { revision } = source;
  const own = openFeed({ mission: page.mission, onChange: take });
  feed = own;
  following = setInterval(() => {
    take();
    const { state: link, since_ms, received_ms } = own;
    stage?.showStale(staleWords({ link, since_ms, received_ms, now_ms: own.now_ms(), silent_ms: own.silent_ms() }));
  }, TICK_MS);

  function take() {
    stage?.showAlerts([...own.shown.alerts.values()], `/missions/${page.mission}/fly`);
    if (!source.take?.({ uavs: [...own.shown.uavs.values()], now_ms: own.shown_ms() })) return;
    stage?.refresh(source.revision !== revision);
    revision = source.revision;
  }
}

/**
 * Read the record of a mission in flight again; after a failure it is read the next time.
 *
 * @param {Mission} mission
 * @param {WantedSource | null} wanted
 */
async function readAgain(mission, wanted) {
  const own = stage;
  try {
    const loaded = await loadMission(page.mission);
    if (own !== stage || !own) return;
    if (own.source.span) own.renew(loaded);
    else void open(mission, wanted);
    if (!own.source.isGrowing) clearInterval(following);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
  }
}

/** @param {Mission} mission @param {FlightSource} source @param {SourceKind[]} choices */
function drawSources(mission, source, choices) {
  /** @param {WantedSource} wanted */
  const choose = (wanted) => void open(mission, wanted).then(keepAddress);
  byId("scene-sources").replaceChildren(
    h("legend", { class: "unseen" }, t("What is shown")),
    ...choices.map((kind) =>
      h(
        "label",
        {},
        h("input", {
          type: "radio",
          name: "source",
          value: kind,
          checked: kind === source.kind,
          onchange: () => choose({ kind, rehearsal: null, run: null }),
        }),
        h("span", { class: "segment" }, SOURCE_WORDS[kind]),
      ),
    ),
  );
  const runs = byId("scene-runs", HTMLSelectElement);
  runs.hidden = (source.runs?.length ?? 0) < 2;
  runs.replaceChildren(...(source.runs ?? []).map(({ sequence, words }) => h("option", { value: sequence }, words)));
  if (source.runs) runs.value = `${source.run}`;
  runs.onchange = () => choose({ kind: "rehearsal", rehearsal: source.rehearsal, run: Number(runs.value) });
}

startChrome({ bindings: sceneKeys(acts) });
addEventListener("pagehide", () => feed?.close());

async function begin() {
  try {
    const { data: mission } = /** @type {Answer<Mission>} */ (await get(`/missions/${page.mission}`));
    const link = readLink(location.search);
    await open(mission, link.source, link);
  } catch (error) {
    showFault(error, () => void begin());
  }
}

await begin();
document.documentElement.dataset.loaded = "true";
Object.assign(globalThis, { spanwiseScene: { figures: () => stage?.figures() ?? null } }); // for measurements: benchmarks/scene.py
