/** The page of the 3D view: one mission, from where and when the address says. */

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

const KEPT_MS = 400; // after a change the address says it
const TICK_MS = 500; // of a live source: silence is seen without a word
const AGAIN_MS = 30_000; // a record that still grows is read
const SOURCE_WORDS = { plan: t("Planned"), rehearsal: t("Rehearsal"), live: t("Live"), record: t("Record") };

const page = readPage();
const root = byId("scene");
let stage = null;
let mission = null;
let feed = null;
let timer = 0;
let following = 0; // the interval of what grows
let opened = 0; // the last one wins

/** What the stage of the moment can do; nothing while there is none. */
const acts = new Proxy(
  {},
  {
    get:
      (_target, name) =>
      (...given) =>
        stage?.[name]?.(...given) ?? false,
  },
);

function keepAddress() {
  clearTimeout(timer);
  timer = setTimeout(() => stage && history.replaceState(null, "", stage.address()), KEPT_MS);
}

function tell(words, again = null) {
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

/** What went wrong in words, with a way on. */
function tellFault(error, again) {
  if (!(error instanceof ApiError)) throw error;
  tell(error.message, error.isSignedOut ? null : again);
  if (error.isSignedOut) root.firstElementChild.append(" ", h("a", { href: signInAddress() }, t("Sign in")));
}

async function open(wanted, link = null) {
  const turn = ++opened;
  stage?.dispose();
  stage = null;
  feed?.close();
  feed = null;
  clearInterval(following);
  tell(t("Reading what there is to see."));
  try {
    const { source, choices } = await readSource(mission, wanted);
    if (turn !== opened) return;
    drawSources(source, choices);
    if (!source.routes.length) return tell(t("There is nothing to see yet: plan the mission first."));
    if (source.kind === "live") follow(source);
    if (source.isGrowing) following = setInterval(() => void readAgain(wanted), AGAIN_MS);
    const made = await openStage(root, {
      isWanted: () => turn === opened,
      mission: { id: page.mission, name: mission.name },
      source,
      link,
      now_ms: () => feed?.now_ms() ?? Date.now(),
      onChange: keepAddress,
    });
    if (!made) return;
    stage = made;
    root.dataset.kind = stage.kind;
  } catch (error) {
    if (turn === opened) tellFault(error, () => void open(wanted, link));
  }
}

function follow(source) {
  let revision = source.revision;
  const own = (feed = openFeed({ mission: page.mission, onChange: take }));
  following = setInterval(() => {
    take();
    stage?.sayStale(staleWords({ link: own.state, since_ms: own.since_ms, now_ms: own.now_ms() }));
  }, TICK_MS);

  function take() {
    if (!source.take({ uavs: [...own.shown.uavs.values()], now_ms: own.now_ms() })) return;
    stage?.refresh(source.revision !== revision);
    revision = source.revision;
  }
}

/** The record of a mission that still flies; what cannot be read now is read the next time. */
async function readAgain(wanted) {
  const own = stage;
  try {
    const loaded = await loadMission(page.mission);
    if (own !== stage || !own) return;
    if (own.source.span) own.renew(loaded);
    else void open(wanted);
    if (!own.source.isGrowing) clearInterval(following);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
  }
}

function drawSources(source, choices) {
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
          onchange: () => void open({ kind, rehearsal: null, run: null }).then(keepAddress),
        }),
        h("span", { class: "segment" }, SOURCE_WORDS[kind]),
      ),
    ),
  );
  const runs = byId("scene-runs");
  runs.hidden = (source.runs?.length ?? 0) < 2;
  runs.replaceChildren(...(source.runs ?? []).map(({ sequence, words }) => h("option", { value: sequence }, words)));
  if (source.runs) runs.value = source.run;
  runs.onchange = () =>
    void open({ kind: "rehearsal", rehearsal: source.rehearsal, run: Number(runs.value) }).then(keepAddress);
}

startChrome({ bindings: sceneKeys(acts) });
addEventListener("pagehide", () => feed?.close());

async function begin() {
  try {
    mission = (await get(`/missions/${page.mission}`)).data;
    const link = readLink(location.search);
    await open(link.source, link);
  } catch (error) {
    tellFault(error, () => void begin());
  }
}

await begin();
document.documentElement.dataset.loaded = "true";
globalThis.spanwiseScene = { figures: () => stage?.figures() ?? null }; // for measurements: benchmarks/scene.py
