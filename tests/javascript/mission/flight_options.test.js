import assert from "node:assert/strict";
import test from "node:test";
import { isAlike, merged } from "../../../static/js/mission/actions/merge.js";
import { changedParts } from "../../../static/js/mission/actions/save_request.js";
import {
  conditionsOf,
  conditionsText,
  flightOptionsAsked,
  nextMinute,
  timeAt,
} from "../../../static/js/mission/options/flight_options.js";
import { basisOf, EMPTY, requestOf, selectionOf } from "../../../static/js/mission/selection.js";
import { compassText } from "../../../static/js/units.js";

const plain = (text) => text.replaceAll("\u00a0", " ");
const LEAVES = "2026-11-21T18:30:00.000Z";
const WEST = { wind: [{ altitude_agl_m: 100, speed_mps: 8, from_deg: 270 }], temperature_c: 5 };

test("calm and mild air is the same as nothing said", () => {
  assert.equal(conditionsOf({ wind: [], temperature_c: 15 }), null);
  assert.equal(conditionsOf({ wind: [{ altitude_agl_m: 10, speed_mps: 0, from_deg: 90 }], temperature_c: 15 }), null);
  assert.deepEqual(conditionsOf({ wind: [], temperature_c: 5 }), { wind: [], temperature_c: 5 });
});

test("layers of wind are lowest first, so that equal air asks for equal plans", () => {
  const [low, high] = [
    { altitude_agl_m: 10, speed_mps: 3, from_deg: 0 },
    { altitude_agl_m: 100, speed_mps: 8, from_deg: 10 },
  ];
  assert.equal(
    basisOf({ ...EMPTY, conditions: { wind: [high, low], temperature_c: 15 } }),
    basisOf({ ...EMPTY, conditions: { wind: [low, high] } }),
  );
});

test("air in words says from where the wind comes", () => {
  assert.equal(plain(conditionsText(null)), "Calm, 15 °C");
  assert.equal(plain(conditionsText(WEST)), "8 m/s from the west at 100 m, 5 °C");
  assert.equal(compassText(359), "north");
  assert.equal(compassText(-90), "west");
});

test("what is not said is not asked, and a stored mission reads as it was asked", () => {
  assert.deepEqual(flightOptionsAsked(EMPTY), {});
  const asked = requestOf({ ...EMPTY, departs_at: LEAVES, conditions: WEST, charging_w: 80 });
  const stored = selectionOf({ ...asked, departs_at: "2026-11-21T19:30:00+01:00", targets: [], uavs: [] });
  assert.equal(basisOf(stored), JSON.stringify(asked));
});

test("clearing a departure is a change that is saved as null", () => {
  const stored = { ...EMPTY, departs_at: LEAVES, charging_w: 80 };
  assert.deepEqual(changedParts(EMPTY, stored), { departs_at: null, charging_w: null });
  assert.deepEqual(changedParts(stored, stored), {});
});

test("options of two people are put together, and where both changed the same mine stands", () => {
  const version = (options) => ({ name: "South", selection: { ...EMPTY, ...options } });
  const both = merged(version({}), version({ departs_at: LEAVES }), version({ conditions: WEST }));
  assert.deepEqual([both.selection.departs_at, both.selection.conditions, both.clashes], [LEAVES, WEST, []]);
  const clash = merged(version({}), version({ charging_w: 50 }), version({ charging_w: 80 }));
  assert.deepEqual([clash.selection.charging_w, clash.clashes], [50, ["charging_w"]]);
  assert.equal(isAlike(version({}), version({ conditions: { wind: [], temperature_c: 15 } })), true);
});

test("an arrival is said by the clock where there is a departure, else from take-off", () => {
  assert.equal(timeAt(null, 725), "+12:05");
  assert.match(timeAt(LEAVES, 600), /^\d\d:\d\d$/);
  assert.match(timeAt(LEAVES, 2 * 86_400), /^\d+ Nov.*, \d\d:\d\d$/);
  assert.equal(timeAt(LEAVES, null), "—");
});

test("now is the next full minute", () => {
  assert.equal(nextMinute(Date.parse("2026-11-21T18:29:01Z")), "2026-11-21T18:30:00.000Z");
  assert.equal(nextMinute(Date.parse("2026-11-21T18:30:00Z")), "2026-11-21T18:30:00.000Z");
});
