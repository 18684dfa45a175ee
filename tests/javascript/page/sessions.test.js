import assert from "node:assert/strict";
import test from "node:test";

import { ApiError } from "../../../static/js/api.js";
import { draftsOf, forget } from "../../../static/js/page/left_behind.js";
import { createSessionWatch, WARNS_S } from "../../../static/js/page/session_end.js";

const settled = () => new Promise((resolve) => setImmediate(resolve));

function watched(endsIn_s, answers) {
  const shown = [];
  const waits_s = [];
  let fire = null;
  const answer = async () => {
    const next = answers.shift();
    if (next instanceof Error) throw next;
    return next;
  };
  const setTimer = (act, ms) => {
    fire = act;
    return waits_s.push(ms / 1_000);
  };
  const watch = createSessionWatch({
    endsIn_s,
    ask: answer,
    stay: answer,
    show: (state) => shown.push(state),
    setTimer,
    clearTimer: () => {},
    now_ms: () => 1_000_000,
  });
  const time = () => {
    fire();
    return settled();
  };
  return { shown, waits_s, keep: watch.keep, time };
}

test("nothing is asked or shown until five minutes before the end", async () => {
  const page = watched(7_200, [7_000]);
  assert.deepEqual([page.waits_s, page.shown], [[7_200 - WARNS_S], []]);
  await page.time();
  assert.deepEqual([page.waits_s.at(-1), page.shown], [7_000 - WARNS_S, []], "somebody was busy in another window");
});

test("a word stands there from five minutes before the end until somebody stays", async () => {
  const page = watched(7_200, [280, 7_200]);
  await page.time();
  assert.deepEqual(page.shown, [{ ends_at_ms: 1_280_000 }]);
  assert.equal(page.waits_s.at(-1), 30);
  await page.keep();
  assert.deepEqual(page.shown.at(-1), null);
  assert.equal(page.waits_s.at(-1), 6_900);
});

test("after the end the page says so and asks no more", async () => {
  const page = watched(100, [new ApiError("", { status: 401 })]);
  const before = page.waits_s.length;
  await page.time();
  assert.deepEqual(page.shown.at(-1), { isOver: true });
  assert.equal(page.waits_s.length, before);
});

test("a server that is away ends no session", async () => {
  const page = watched(100, [new ApiError("", { status: 0 }), 90]);
  await page.time();
  assert.deepEqual(page.shown, [{ ends_at_ms: 1_100_000 }]);
  await page.time();
  assert.deepEqual(page.shown.at(-1), { ends_at_ms: 1_090_000 });
});

function storageOf(keys) {
  const kept = new Map(keys.map((key) => [key, "{}"]));
  return {
    get length() {
      return kept.size;
    },
    key: (place) => [...kept.keys()][place],
    removeItem: (key) => kept.delete(key),
    keys: () => [...kept.keys()],
  };
}

const MINE = [
  "spanwise.draft.7.new",
  "spanwise.draft.7.0b1e",
  "spanwise.zones-draft.7",
  "spanwise.uploads.7",
  "spanwise.planning.7.new",
];
const OTHERS = [
  "spanwise.draft.77.new",
  "spanwise.zones-draft.8",
  "spanwise.theme",
  "spanwise.map.7up",
  "elsewhere.draft.7.new",
];

test("signing out leaves nothing of whoever signs out, and everything of others", () => {
  const storage = storageOf([...MINE, ...OTHERS]);
  assert.equal(draftsOf(7, [storage]), 3);
  forget(7, { storages: [storage] });
  assert.deepEqual(storage.keys(), OTHERS);
});

test("drafts stay where somebody wants to keep them, and nothing else does", () => {
  const storage = storageOf([...MINE, ...OTHERS]);
  forget(7, { keepsDrafts: true, storages: [storage] });
  assert.deepEqual(storage.keys(), [...MINE.slice(0, 3), ...OTHERS]);
});

test("a closed storage keeps nobody from signing out", () => {
  const closed = {
    get length() {
      throw new Error("closed");
    },
  };
  assert.equal(draftsOf(7, [closed]), 0);
  forget(7, { storages: [closed] });
});
