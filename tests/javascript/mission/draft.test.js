import assert from "node:assert/strict";
import test from "node:test";

import { isSignedOut, signInAddress } from "../../../static/js/api.js";
import { createDrafts, draftDecision, isStarted, whoseSave } from "../../../static/js/mission/actions/draft.js";
import { basisOf, EMPTY, targetOf, withTargets } from "../../../static/js/mission/selection.js";
import { factsOfUav } from "../../../static/js/mission/uavs/fleet.js";
import { withUav, withUavAs } from "../../../static/js/mission/uavs/mission_uavs.js";

const tower = targetOf({ id: 7, kind: "tower", properties: { label: "18" }, centre: [10, 50] });
const bridge = targetOf({ id: 8, kind: "bridge", properties: { label: "I 270" }, centre: [10, 50] });
const heron = {
  id: 3,
  name: "Heron",
  base_name: "West",
  position: [9, 49],
  max_range_m: 80_000,
  cruise_speed_mps: 12,
  end_action: "hover",
};
const stored = withTargets(EMPTY, [tower]);
const mine = withTargets(stored, [bridge]);
const mission = { name: "North", revision: 4 };

function browser() {
  const kept = new Map();
  const storage = {
    getItem: (key) => kept.get(key) ?? null,
    setItem: (key, value) => kept.set(key, value),
    removeItem: (key) => kept.delete(key),
  };
  return (user, editor = "page") => createDrafts({ user, editor, storage: () => storage });
}

test("nobody sees the draft of another user in the same browser", () => {
  const as = browser();
  as(1).keep("m", { name: "North", selection: mine, revision: 4 });
  assert.equal(as(2).read("m"), null);
  as(2).drop("m");
  assert.deepEqual(as(1).read("m").selection, mine);
});

test("saving in one window leaves the draft of another", () => {
  const as = browser();
  as(1, "second").keep("m", { name: "North", selection: mine, revision: 4 });
  as(1, "first").dropOwn("m");
  assert.equal(as(1).read("m").name, "North");
  as(1, "second").dropOwn("m");
  assert.equal(as(1).read("m"), null);
});

test("a closed or damaged storage is told, not thrown", () => {
  const closed = createDrafts({
    user: 1,
    editor: "page",
    storage: () => {
      throw new Error("closed");
    },
  });
  assert.equal(closed.keep("m", { name: "", selection: mine, revision: 1 }), false);
  assert.equal(closed.read("m"), null);
  closed.drop("m");
  const damaged = createDrafts({ user: 1, editor: "page", storage: () => ({ getItem: () => '{"selection": 3' }) });
  assert.equal(damaged.read("m"), null);
});

test("a draft of the same revision comes back, one from before another save is told", () => {
  const draft = { name: "North", selection: mine, revision: 4 };
  assert.equal(draftDecision(draft, mission, basisOf(stored)), "restore");
  assert.equal(draftDecision({ ...draft, revision: 3 }, mission, basisOf(stored)), "behind");
});

test("a draft that says what is stored needs no word, a changed name does", () => {
  const same = { name: "North", selection: stored, revision: 3 };
  assert.equal(draftDecision(same, mission, basisOf(stored)), "none");
  assert.equal(draftDecision(null, mission, basisOf(stored)), "none");
  assert.equal(draftDecision({ ...same, name: "South", revision: 4 }, mission, basisOf(stored)), "restore");
});

test("a new mission is started by a name, a target, a UAV or an option", () => {
  assert.equal(isStarted({ name: " ", selection: { ...EMPTY } }), false);
  assert.equal(isStarted({ name: "North", selection: EMPTY }), true);
  assert.equal(isStarted({ name: "", selection: stored }), true);
  assert.equal(isStarted({ name: "", selection: withUav(EMPTY, heron) }), true);
  assert.equal(isStarted({ name: "", selection: { ...EMPTY, return_to_start: false } }), true);
});

test("the save that came in between has an owner", () => {
  assert.equal(whoseSave("vera", "opal"), "vera’s");
  assert.equal(whoseSave("opal", "opal"), "your own");
  assert.equal(whoseSave(null, "opal"), "another operator’s");
});

test("signed out is told apart from not allowed", () => {
  assert.equal(isSignedOut(401, "not_authenticated"), true);
  assert.equal(isSignedOut(403, "not_authenticated"), true);
  assert.equal(isSignedOut(403, "permission_denied", "CSRF Failed: CSRF token missing."), true);
  assert.equal(isSignedOut(403, "permission_denied", "Your role may not plan."), false);
  assert.equal(isSignedOut(403, undefined, undefined), false);
});

test("the door leads back to where the page was", () => {
  assert.equal(
    signInAddress({ pathname: "/missions/new", search: "", hash: "#map=12/39.9/-83" }),
    "/sign-in?next=%2Fmissions%2Fnew%23map%3D12%2F39.9%2F-83",
  );
});

test("a UAV says its range or that there is none, its speed and its end", () => {
  const plain = (text) => text.replaceAll("\u00a0", " ");
  assert.equal(plain(factsOfUav(heron, false)), "range 80.0 km · 12 m/s · hovers at the end");
  assert.equal(
    plain(factsOfUav({ ...heron, max_range_m: null }, true)),
    "range not stated · 12 m/s · returns to start",
  );
});

test("a changed end or a range taken away asks for another plan", () => {
  const selection = withUav(stored, heron);
  assert.notEqual(basisOf(withUavAs(selection, 0, { end_action: "land" })), basisOf(selection));
  assert.equal(JSON.parse(basisOf(withUavAs(selection, 0, { max_range_m: null }))).uavs[0].max_range_m, null);
});
