import assert from "node:assert/strict";
import test from "node:test";

import { isInForce, sunEvent } from "../../../static/js/domain/zones_in_force.js";

const COLUMBUS = [-83, 39.96];
const at = (iso) => Date.parse(iso);
const entry = (changes) => ({
  day: ["ANY"],
  startTime: null,
  startEvent: null,
  endTime: null,
  endEvent: null,
  ...changes,
});
const period = (changes, ...schedule) => [{ startDateTime: null, endDateTime: null, schedule, ...changes }];

test("a zone without a schedule is always in force", () => assert.equal(isInForce(null, 0, COLUMBUS), true));

test("weekdays and times of day are UTC, and the end is no longer in force", () => {
  const office = period({}, entry({ day: ["MON", "TUE"], startTime: "08:00:00Z", endTime: "18:00:00Z" }));
  assert.equal(isInForce(office, at("2026-11-23T08:00:00Z"), COLUMBUS), true); // a Monday
  assert.equal(isInForce(office, at("2026-11-23T18:00:00Z"), COLUMBUS), false);
  assert.equal(isInForce(office, at("2026-11-25T12:00:00Z"), COLUMBUS), false);
});

test("a time past midnight belongs to the day on which it begins", () => {
  const night = period({}, entry({ day: ["FRI"], startTime: "22:00:00Z", endTime: "04:00:00Z" }));
  assert.equal(isInForce(night, at("2026-11-21T03:59:00Z"), COLUMBUS), true); // Saturday, begun on Friday
  assert.equal(isInForce(night, at("2026-11-20T03:59:00Z"), COLUMBUS), false);
});

test("dates bound a period", () => {
  const summer = period({ startDateTime: "2026-06-01T00:00:00Z", endDateTime: "2026-09-01T00:00:00Z" });
  assert.deepEqual(
    ["2026-05-31T23:59:59Z", "2026-06-01T00:00:00Z", "2026-09-01T00:00:00Z"].map((iso) =>
      isInForce(summer, at(iso), COLUMBUS),
    ),
    [false, true, false],
  );
});

test("sunrise and sunset are those of the almanac within three minutes", () => {
  // US Naval Observatory, Columbus OH: 21 Jun 2026 sunrise 06:03, sunset 21:04 EDT; Greenwich 21 Dec 2026: 08:04 and 15:53 UTC
  const near = (found, iso) =>
    assert.ok(Math.abs(found - at(iso)) < 180_000, `${new Date(found).toISOString()} for ${iso}`);
  near(sunEvent("SR", at("2026-06-21T00:00:00Z"), COLUMBUS), "2026-06-21T10:03:00Z");
  near(sunEvent("SS", at("2026-06-21T00:00:00Z"), COLUMBUS), "2026-06-22T01:04:00Z");
  near(sunEvent("SR", at("2026-12-21T00:00:00Z"), [0, 51.48]), "2026-12-21T08:04:00Z");
  near(sunEvent("SS", at("2026-12-21T00:00:00Z"), [0, 51.48]), "2026-12-21T15:53:00Z");
});

test("from sunset to sunrise is the night, across midnight UTC", () => {
  const night = period({}, entry({ startEvent: "SS", endEvent: "SR" }));
  assert.equal(isInForce(night, at("2026-06-22T04:00:00Z"), COLUMBUS), true);
  assert.equal(isInForce(night, at("2026-06-21T18:00:00Z"), COLUMBUS), false);
});

test("where the sun does not set, and where the form is unknown, nothing is said", () => {
  const night = period({}, entry({ startEvent: "SS", endEvent: "SR" }));
  assert.equal(isInForce(night, at("2026-06-21T12:00:00Z"), [20, 78]), null);
  assert.equal(isInForce([{ permanent: "NO" }], at("2026-06-21T12:00:00Z"), COLUMBUS), null);
});
