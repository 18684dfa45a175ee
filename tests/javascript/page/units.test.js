import assert from "node:assert/strict";
import test from "node:test";
import { tn } from "../../../static/js/text.js";
import {
  coordinateText,
  durationText,
  lengthText,
  momentTyped,
  sinceText,
  typedMoment,
  voltageText,
  whenText,
} from "../../../static/js/units.js";

const plain = (text) => text.replaceAll("\u00a0", " ");

test("lengths are metres below 1 km and kilometres with one digit above", () => {
  assert.equal(plain(lengthText(0)), "0 m");
  assert.equal(plain(lengthText(850.4)), "850 m");
  assert.equal(plain(lengthText(999.7)), "1.0 km");
  assert.equal(plain(lengthText(24_949)), "24.9 km");
  assert.equal(plain(lengthText(1_234_567)), "1,235 km");
  assert.equal(lengthText(null), "—");
});

test("a unit never stands on the next line", () => {
  assert.ok(lengthText(24_900).includes("\u00a0km"));
  assert.ok(durationText(2_760).includes("\u00a0min"));
});

test("durations are minutes, then hours and minutes, and never 0 for a flight", () => {
  assert.equal(plain(durationText(2_760)), "46 min");
  assert.equal(plain(durationText(10)), "1 min");
  assert.equal(plain(durationText(0)), "0 min");
  assert.equal(plain(durationText(7_380)), "2 h 3 min");
  assert.equal(plain(durationText(7_200)), "2 h");
});

test("people read latitude first, with a true minus", () => {
  assert.equal(coordinateText([-82.95342, 39.90214]), "39.9021, −82.9534");
});

test("voltages are kV", () => {
  assert.equal(plain(voltageText(138)), "138 kV");
  assert.equal(plain(voltageText(7.2)), "7.2 kV");
});

test("one is singular and thousands have a comma", () => {
  assert.equal(tn(1, "{count} target", "{count} targets"), "1 target");
  assert.equal(tn(2_000, "{count} target", "{count} targets"), "2,000 targets");
});

test("times are said as people say them", () => {
  const now = new Date(2026, 8, 12, 15, 0, 0);
  assert.equal(whenText(new Date(2026, 8, 12, 14, 59, 30).toISOString(), now), "now");
  assert.equal(whenText(new Date(2026, 8, 12, 11, 40).toISOString(), now), "today, 11:40");
  assert.equal(whenText(new Date(2026, 8, 11, 9, 12).toISOString(), now), "yesterday, 09:12");
  assert.equal(plain(whenText(new Date(2026, 8, 1, 9, 12).toISOString(), now)), "1 Sept");
  assert.equal(plain(whenText(new Date(2025, 8, 1, 9, 12).toISOString(), now)), "1 Sept 2025");
});

test("time since a departure is minutes and seconds, with hours where there are some", () => {
  assert.equal(sinceText(0), "+00:00");
  assert.equal(sinceText(725.4), "+12:05");
  assert.equal(sinceText(3725), "+1:02:05");
});

test("a typed moment and the moment are the same there and back", () => {
  for (const iso of ["2026-11-21T19:30:00.000Z", "2026-03-29T00:59:00.000Z", "2026-12-31T23:59:00.000Z"])
    assert.equal(momentTyped(typedMoment(iso)), iso);
  assert.equal(momentTyped(""), null);
});
