import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.document ??= { cookie: "", querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
globalThis.location ??= { hash: "", pathname: "/", protocol: "http:", host: "here" };
const { hasArrived, isNone } = await import("../../../static/js/monitor/arrival.js");
const { factsOf } = await import("../../../static/js/mission/plan/head_facts.js");

test("a list is not called empty before it has arrived", () => {
  assert.equal(isNone({ isWhole: false }, []), false);
  assert.equal(isNone({ isWhole: true }, []), true);
  assert.equal(isNone({ isWhole: true }, [1]), false);
});

test("the map is loading until the routes of each mission are there", () => {
  const missions = [{ id: "a" }, { id: "b" }];
  assert.equal(hasArrived({ isWhole: false, missions: [], details: new Map() }), false);
  assert.equal(hasArrived({ isWhole: true, missions, details: new Map([["a", {}]]) }), false);
  assert.equal(hasArrived({ isWhole: true, missions, details: new Map(missions.map(({ id }) => [id, {}])) }), true);
  assert.equal(hasArrived({ isWhole: true, missions: [], details: new Map() }), true);
});

test("a mission that is being read is loading, and no mission is open only once that is known", () => {
  const page = { plan: null, mission: null, selection: { targets: [] } };
  assert.deepEqual(factsOf({ ...page, arrival: "awaited" }, false), ["Loading …"]);
  assert.deepEqual(factsOf({ ...page, arrival: "whole" }, false), ["no mission is open"]);
  assert.deepEqual(factsOf({ ...page, arrival: "failed" }, false), []);
});
