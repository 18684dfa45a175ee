/** The page of zones: when one applies, its heights in words, and what is sent of them. */

import assert from "node:assert/strict";
import { test } from "node:test";
import {
  fromField,
  newPeriod,
  timeFromField,
  timeToField,
  toField,
  weekOf,
} from "../../../static/js/domain/schedule.js";
import { heightsText } from "../../../static/js/domain/zone_heights.js";
import { reasonsOf, restrictionChoices, restrictionHint } from "../../../static/js/zones/form.js";
import { localText } from "../../../static/js/zones/schedule_editor.js";

const entry = (rest) => ({ day: ["MON"], startTime: null, startEvent: null, endTime: null, endEvent: null, ...rest });
const week = (...schedule) => weekOf({ startDateTime: null, endDateTime: null, schedule });
const hours = ({ day, from_h, to_h }) => [day, from_h, to_h];

test("working hours are five stretches", () => {
  assert.deepEqual(
    weekOf(newPeriod()).map(hours),
    [0, 1, 2, 3, 4].map((day) => [day, 8, 18]),
  );
});

test("a period without hours covers the whole week", () => {
  assert.deepEqual(
    week().map(hours),
    [0, 1, 2, 3, 4, 5, 6].map((day) => [day, 0, 24]),
  );
});

test("a night goes on after midnight, from Sunday on Monday", () => {
  const night = entry({ day: ["SUN"], startTime: "22:30:00Z", endTime: "06:00:00Z" });
  assert.deepEqual(week(night).map(hours), [
    [6, 22.5, 24],
    [0, 0, 6],
  ]);
  assert.deepEqual(week(entry({ startTime: "22:00:00Z", endTime: "00:00:00Z" })).map(hours), [[0, 22, 24]]);
});

test("what ends with the sun has a soft end", () => {
  const [stretch] = week(entry({ startTime: "08:00:00Z", endEvent: "SS" }));
  assert.equal(stretch.softStart, false);
  assert.equal(stretch.softEnd, true);
});

test("moments and times come back as they were, in UTC", () => {
  assert.equal(fromField(toField("2026-12-31T18:00:00Z")), "2026-12-31T18:00:00Z");
  assert.equal(timeFromField(timeToField("07:45:00Z")), "07:45:00Z");
  assert.equal(fromField(toField(null)), null);
  assert.equal(timeFromField(timeToField(null)), null);
});

test("heights are told with what they count from, and what is not stated as such", () => {
  const above = (value_m, reference) => ({ value_m, reference });
  assert.equal(
    heightsText({ lower_limit: above(0, "AGL"), upper_limit: above(120, "AGL") }),
    "From ground to 120\u00a0m above ground",
  );
  assert.equal(
    heightsText({ lower_limit: null, upper_limit: above(2895.6, "STD") }),
    "Up to FL\u00a095, lower limit not stated",
  );
  assert.equal(
    heightsText({ lower_limit: above(300, "AMSL"), upper_limit: null }),
    "From 300\u00a0m above sea level, upper limit not stated",
  );
  assert.equal(heightsText({ lower_limit: null, upper_limit: null }), "Heights not stated");
});

test("a restriction of either standard is in the list, and what a source says beside them stays", () => {
  assert.equal(restrictionChoices("REQ_AUTHORIZATION").chosen, "REQ_AUTHORISATION");
  assert.equal(restrictionChoices("USPACE").values.length, 5);
  assert.deepEqual(restrictionChoices("Danger area").values.slice(-1), ["Danger area"]);
  assert.deepEqual(restrictionChoices("").values, restrictionChoices("PROHIBITED").values);
});

test("a restriction says what planning makes of it", () => {
  assert.equal(restrictionHint(""), "Not stated: plans keep clear of it, as of a prohibited zone.");
  assert.match(restrictionHint("NO_RESTRICTION"), /^Plans keep clear of it all the same/);
  assert.equal(restrictionHint("CONDITIONAL"), "Plans keep clear of it.");
});

test("reasons are codes of the standards, and the source's own words beside them", () => {
  assert.deepEqual(reasonsOf("AIR_TRAFFIC, NATURE"), { codes: ["AIR_TRAFFIC", "NATURE"], other: "" });
  assert.deepEqual(reasonsOf("AIR_TRAFFIC, military, jets"), { codes: ["AIR_TRAFFIC"], other: "military, jets" });
  assert.deepEqual(reasonsOf(""), { codes: [], other: "" });
});

test("an hour of UTC has the reader's beside it, and an event of the sun none", () => {
  assert.equal(localText(null), "");
  const ahead = -new Date().getTimezoneOffset();
  assert.equal(localText("08:00:00Z") === "", ahead === 0);
});
