import assert from "node:assert/strict";
import { test } from "node:test";
import { alarmOf, alertsInOrder, downAt, isUnanswered, pinnedAlerts } from "../../../static/js/domain/order.js";
import { markedTitle } from "../../../static/js/page/bell.js";

const NOW_MS = Date.parse("2026-09-21T14:15:00Z");
const ago = (seconds) => new Date(NOW_MS - seconds * 1000).toISOString();

const anAlert = (change) => ({
  id: 1,
  uav: 1,
  code: "converging",
  subject: "2",
  level: "critical",
  opened_at: ago(60),
  closed_at: null,
  acknowledged_at: null,
  ...change,
});

test("a critical alert that has ended stays until it is acknowledged; a warning does not", () => {
  const ended = anAlert({ closed_at: ago(10) });
  const warning = anAlert({ id: 2, level: "warning", closed_at: ago(10) });
  const seen = anAlert({ id: 3, closed_at: ago(10), acknowledged_at: ago(5) });
  assert.deepEqual(pinnedAlerts([ended, warning, seen]), [ended]);
  assert.deepEqual([ended, warning, seen].map(isUnanswered), [true, false, false]);
  const open = anAlert({ id: 4, code: "zone", level: "warning" });
  assert.deepEqual(
    alertsInOrder([open, ended, anAlert({ id: 5 })]).map(({ id }) => id),
    [5, 1, 4],
  );
});

test("of one cause the newest alert is shown", () => {
  const [first, again] = [anAlert({ closed_at: ago(40) }), anAlert({ id: 2, opened_at: ago(30) })];
  assert.deepEqual(pinnedAlerts([first, again]), [again]);
  const other = anAlert({ id: 3, subject: "9" });
  assert.equal(pinnedAlerts([first, again, other]).length, 2);
});

test("a UAV in alarm has the worst level of its pinned alerts, also where a critical one has ended unseen", () => {
  const ended = anAlert({ id: 2, closed_at: ago(1) });
  const alerts = [anAlert({ level: "warning" }), { ...ended, acknowledged_at: ago(1) }, anAlert({ id: 3, uav: 9 })];
  assert.deepEqual([alarmOf(1, alerts), alarmOf(9, alerts), alarmOf(5, alerts)], ["warning", "critical", null]);
  assert.equal(alarmOf(1, [...alerts, ended]), "critical");
});

test("the tab's title counts alerts, and keeps its name", () => {
  assert.equal(markedTitle("Live · Spanwise", "(2!) "), "(2!) Live · Spanwise");
  assert.equal(markedTitle("(2!) Live · Spanwise", "(1) "), "(1) Live · Spanwise");
  assert.equal(markedTitle("(1) Live · Spanwise", ""), "Live · Spanwise");
});

test("of a UAV that is down away from its plan the position is known", () => {
  const down = { code: "down-off-plan", details: { position: [9.2, 51.1234567] } };
  const others = [
    { ...down, code: "gps" },
    { ...down, details: {} },
    { ...down, details: { position: [9.2, null] } },
  ];
  assert.deepEqual([down, ...others].map(downAt), [[9.2, 51.1234567], null, null, null]);
});
