/** Targets that a plan leaves out are told by cause: one card for each, with the limit that binds. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { causesOf, causeWords, commonSentence } from "../../../static/js/mission/unassigned/causes.js";

/** @param {{ reason: string, message: string, why: { code: string, params?: object }[] }[]} unassigned */
const planOf = (unassigned) => ({
  targets: unassigned.map((_, place) => ({ key: `${place}`, label: `Tower ${place}` })),
  result: {
    routes: [],
    unassigned: unassigned.map((entry, target) => ({
      ...entry,
      target,
      why: entry.why.map(({ code, params = {} }) => ({ code, params })),
    })),
  },
});
const inZone = {
  reason: "inside_zone",
  message: "It stands inside Elmsgard Heliport.",
  why: [{ code: "stands_inside_zone", params: { zone: "Elmsgard Heliport", zone_id: 4 } }],
};
/** @param {number} away_km */
const elsewhere = (away_km) => ({
  reason: "no_path",
  message: `No permitted route from any base. It is ${away_km} km away.`,
  why: [{ code: "no_path" }, { code: "not_connected", params: { away_km } }],
});

test("eleven targets in one zone are one cause with the zone", () => {
  const [cause, ...others] = causesOf(planOf(Array(11).fill(inZone)));
  assert.equal(others.length, 0);
  assert.deepEqual(cause.zone, { name: "Elmsgard Heliport", id: 4 });
  assert.equal(causeWords(cause), "11 targets lie in Elmsgard Heliport.");
  assert.equal(commonSentence(cause), inZone.message);
});

test("two zones of one name are two causes", () => {
  const other = { ...inZone, why: [{ ...inZone.why[0], params: { zone: "Elmsgard Heliport", zone_id: 5 } }] };
  assert.equal(causesOf(planOf([inZone, other])).length, 2);
});

test("towers of another continent are not connected, whatever their distances", () => {
  const [cause, ...others] = causesOf(planOf([elsewhere(5312), elsewhere(5313), elsewhere(5314)]));
  assert.equal(others.length, 0);
  assert.equal(cause.code, "not_connected");
  assert.equal(causeWords(cause), "3 targets are not connected to the network of any UAV.");
  assert.equal(commonSentence(cause), "");
});

test("the cause of most targets comes first, and a plan without codes is told by its sentences", () => {
  const old = { reason: "no_path", message: "No way.", why: [] };
  const causes = causesOf(planOf([old, inZone, inZone, { ...old, message: "Too far." }]));
  assert.deepEqual(
    causes.map(({ targets }) => targets.length),
    [2, 1, 1],
  );
  assert.equal(causeWords(causes[1]), "No permitted route to 1 target.");
});

test("what only does not fit beside the others is not called out of range", () => {
  const entry = { reason: "beyond_range", message: "", why: [{ code: "in_range_alone" }] };
  const [cause] = causesOf(planOf([entry, entry]));
  assert.equal(causeWords(cause), "2 targets are reachable only without the others.");
});
