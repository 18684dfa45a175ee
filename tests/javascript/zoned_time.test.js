import assert from "node:assert/strict";
import test from "node:test";

globalThis.document = { documentElement: { lang: "en", dataset: { timeZone: "Europe/Berlin" } } };
const { momentTyped, typedMoment, zoneText } = await import("../../static/js/units.js");

test("a moment is typed by the clock of the reader's zone, which is named with its offset", () => {
  assert.equal(typedMoment("2026-11-21T18:30:00Z"), "2026-11-21T19:30");
  assert.equal(typedMoment("2026-07-01T22:30:00Z"), "2026-07-02T00:30");
  assert.equal(zoneText("2026-11-21T18:30:00Z"), "Europe/Berlin, UTC+1");
  assert.equal(zoneText("2026-07-01T18:30:00Z"), "Europe/Berlin, UTC+2");
});

test("what is typed is the moment on that clock, in winter and in summer", () => {
  assert.equal(momentTyped("2026-11-21T19:30"), "2026-11-21T18:30:00.000Z");
  assert.equal(momentTyped("2026-07-02T00:30"), "2026-07-01T22:30:00.000Z");
});

test("an hour that the clocks skip is the one after it", () => {
  assert.equal(typedMoment(momentTyped("2026-03-29T02:30")), "2026-03-29T03:30");
});
