import assert from "node:assert/strict";
import { test } from "node:test";
import { colourOfDay, dayClock, factsOf, siteName } from "../../../static/js/campaign/schedule_view.js";

const mission = { number: 1, mission: "a", state: "planned", targets: 3, flights: 2, work_s: 900, farthest_m: 800 };
const schedule = {
  sites: [
    { name: "", position: [9.5, 47.1] },
    { name: "Depot", position: [9.6, 47.1] },
  ],
  missions: [
    { ...mission, site: 0, length_m: 12_000, is_too_long: false },
    { ...mission, number: 2, site: 1, length_m: 8_400, is_too_long: false },
    { ...mission, number: 3, site: 1, flights: 1, length_m: 100, is_too_long: true },
  ],
  days: [
    { day: 1, crew: 1, visits: [], back_m: 0, back_s: 0, ends_s: 0 },
    { day: 2, crew: 1, visits: [], back_m: 0, back_s: 0, ends_s: 0 },
  ],
  is_proven: true,
  unassigned: [],
};

test("a day begins at 8, and its clock goes on over midnight", () => {
  assert.equal(dayClock(0), "08:00");
  assert.equal(dayClock(2_430), "08:41");
  assert.equal(dayClock(16.5 * 3600), "00:30");
});

test("the facts of a campaign count days, the sites that are used, flights and metres", () => {
  assert.equal(factsOf(schedule).replaceAll("\u00a0", " "), "2 days · 2 launch sites · 5 flights · 20.5 km");
});

test("a proposed launch site is named by its number", () => {
  assert.equal(siteName(schedule, 0), "Launch site 1");
  assert.equal(siteName(schedule, 1), "Depot");
});

test("the colours of days repeat", () => {
  assert.deepEqual([1, 8, 9].map(colourOfDay), [1, 8, 1]);
});
