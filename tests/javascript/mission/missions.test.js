import assert from "node:assert/strict";
import test from "node:test";
import { changedParts } from "../../../static/js/mission/actions/save_request.js";
import { grouped, wordsOfEntry } from "../../../static/js/mission/panels/history.js";
import { savedWords } from "../../../static/js/mission/panels/saved_state.js";
import { basisOf, EMPTY, targetOf, withTargets } from "../../../static/js/mission/selection.js";
import {
  askedOf,
  countOfFields,
  isFiltered,
  NOTHING,
  nextOrder,
  requestOf,
  searchOf,
} from "../../../static/js/missions/asked.js";
import { createHistory, createStore } from "../../../static/js/store.js";

const tower = targetOf({ id: 7, kind: "tower", properties: { label: "18" }, centre: [10, 50] });

test("the page's address holds what the list was asked for", () => {
  const asked = { ...NOTHING, text: "south belt", state: "draft", stale: true, order: "name" };
  assert.equal(searchOf(asked), "?text=south+belt&state=draft&stale=true&order=name");
  assert.deepEqual(askedOf(searchOf(asked)), asked);
  assert.equal(searchOf(NOTHING), "");
});

test("the last day of a stretch of days counts whole", () => {
  const request = new URLSearchParams(
    requestOf({ ...NOTHING, changed: "between", from: "2026-03-01", to: "2026-03-02" }).split("?")[1],
  );
  const hours = (new Date(request.get("changed_before")) - new Date(request.get("changed_from"))) / 3_600_000;
  assert.equal(hours, 48);
});

test("the last seven days begin with a day, not with an hour", () => {
  const request = new URLSearchParams(
    requestOf({ ...NOTHING, changed: "7" }, new Date(2026, 2, 10, 15, 30)).split("?")[1],
  );
  assert.equal(new Date(request.get("changed_from")).getTime(), new Date(2026, 2, 4).getTime());
});

test("sorting alone is no filter, and fields are counted", () => {
  assert.equal(isFiltered({ ...NOTHING, order: "name" }), false);
  assert.equal(isFiltered({ ...NOTHING, deleted: true }), true);
  assert.equal(countOfFields({ ...NOTHING, author: "opal", stale: true, text: "x" }), 2);
});

test("a column sorts names up and figures down first, then the other way", () => {
  assert.equal(nextOrder("-changed", "name"), "name");
  assert.equal(nextOrder("name", "name"), "-name");
  assert.equal(nextOrder("name", "distance"), "-distance");
  assert.equal(nextOrder("-distance", "distance"), "distance");
});

test("only the parts that differ are sent", () => {
  const now = withTargets(EMPTY, [tower]);
  assert.deepEqual(Object.keys(changedParts(now, EMPTY)), ["targets"]);
  assert.deepEqual(changedParts(now, now), {});
  assert.equal(Object.keys(changedParts(now, null)).length, 4);
});

const picked = withTargets(EMPTY, [tower]);
const saved = {
  selection: picked,
  name: "North",
  plan: null,
  planIsStored: false,
  savedBasis: basisOf(picked),
  saving: false,
  problem: null,
  conflict: null,
  isAway: false,
  mission: { name: "North", updated_at: "2026-03-01T06:41:00Z" },
};

test("whether it is saved is always said", () => {
  assert.match(savedWords(saved).words, /^Saved \d\d:\d\d$/);
  assert.equal(savedWords({ ...saved, saving: true }).words, "Saving…");
  assert.equal(savedWords({ ...saved, name: "South" }).words, "Not saved yet");
  assert.equal(savedWords({ ...saved, name: "South", isAway: true }).words, "Not saved: the server cannot be reached");
  assert.match(savedWords({ ...saved, isAway: true }).words, /^No connection\. Saved/);
  assert.equal(savedWords({ ...saved, mission: null, selection: EMPTY, name: "" }), null);
});

test("changes of one person within ten minutes are one line of the history", () => {
  const change = (minute, actor = "opal") => ({ action: "change", actor, recorded_at: `2026-03-01T06:${minute}:00Z` });
  const groups = grouped([
    change("30"),
    change("25"),
    change("10"),
    change("05", "rory"),
    { action: "plan", actor: "rory", recorded_at: "2026-03-01T06:04:00Z" },
  ]);
  assert.deepEqual(
    groups.map((group) => group.length),
    [2, 1, 1, 1],
  );
});

test("the history names what came and went", () => {
  const after = {
    name: "North",
    objective: "total",
    return_to_start: true,
    targets_added: 7,
    targets_removed: 0,
    uavs_added: 0,
    uavs_removed: 0,
    targets_names: { added: ["18", "19"], removed: [] },
    uavs_names: { added: [], removed: [] },
  };
  const { title, detail } = wordsOfEntry({
    action: "change",
    before: { name: "North", objective: "total", return_to_start: true },
    after,
  });
  assert.deepEqual([title, detail], ["Changed", "7 targets added: 18, 19 and 5 more"]);
});

test("undo takes back one's own steps alone once somebody else's have come in", () => {
  const store = createStore({ list: ["a"] });
  const history = createHistory(store, "list");
  history.changeTo(["a", "mine"]);
  history.rebase((list) => ["theirs", ...list]);
  assert.deepEqual(store.state.list, ["theirs", "a", "mine"]);
  history.undo();
  assert.deepEqual(store.state.list, ["theirs", "a"]);
});

test("a change by hand and its taking back are lines of the history", () => {
  const summary = (action) =>
    Object.values(wordsOfEntry({ action, before: null, after: { revision: 3, uav: "Kite" } }));
  assert.deepEqual(summary("by-hand"), ["Changed by hand", "the route of Kite"]);
  assert.deepEqual(summary("by-hand-undone"), ["Change by hand taken back", "the route of Kite"]);
});
