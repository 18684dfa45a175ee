import assert from "node:assert/strict";
import { test } from "node:test";
import { targetOf, targetOfRow } from "../../../static/js/mission/selection.js";
import {
  areLines,
  caughtWords,
  groupsOf,
  linesOf,
  notPickedYet,
  rowsWithout,
} from "../../../static/js/mission/targets/caught.js";

const tower = (id, line, voltage_v = 138_000) => ({
  id,
  kind: "tower",
  label: `T${id}`,
  detail: line ? `138 kV L${line}` : "",
  length_m: null,
  centre: [9, 50],
  line,
  voltage_v,
});
const bridge = { ...tower(9, null, null), kind: "bridge", label: "Bridge 9" };
const rows = [tower(1, 100), tower(2, 100), tower(3, 200, 66_000), bridge];

test("what a box has found is told by kind and line", () => {
  assert.equal(caughtWords(rows), "3 towers on 2 lines, 1 bridge");
  assert.equal(caughtWords([bridge]), "1 bridge");
  assert.equal(caughtWords([tower(1, null)]), "1 tower");
});

test("it is chosen by kind, line and voltage, where there are several", () => {
  const groups = Object.fromEntries(groupsOf(rows));
  assert.deepEqual(
    groups.kind.map(({ words, count }) => [words, count]),
    [
      ["Towers", 3],
      ["Bridges", 1],
    ],
  );
  assert.deepEqual(
    groups.line.map(({ words }) => words),
    ["138 kV L100", "138 kV L200"],
  );
  assert.deepEqual(
    groups.voltage.map(({ words }) => words),
    ["138\u00a0kV", "66\u00a0kV"],
  );
  assert.deepEqual(groupsOf([rows[0], rows[1]]), []);
  const ids = (off) => rowsWithout(rows, new Set(off)).map(({ id }) => id);
  assert.deepEqual(ids([]), [1, 2, 3, 9]);
  assert.deepEqual(ids(["line 100"]), [3, 9]);
  assert.deepEqual(ids(["kind bridge", "voltage 66000"]), [1, 2]);
});

test("of an area with more towers than can be named its lines are chosen by voltage", () => {
  const line = (id, voltage_v) => ({ ...tower(id, null, voltage_v), kind: "line", label: `L${id}` });
  const lines = [line(100, 138_000), line(200, 66_000), line(300, 66_000)];
  assert.ok(areLines(lines));
  assert.ok(!areLines(rows) && !areLines([]));
  assert.equal(caughtWords(lines), "3 lines");
  assert.deepEqual(
    groupsOf(lines).map(([name, groups]) => [name, groups.map(({ count }) => count)]),
    [["voltage", [2, 1]]],
  );
  assert.deepEqual(linesOf(rowsWithout(lines, new Set(["voltage 66000"]))), [100]);
  const whole = targetOf({ id: 100, kind: "line", properties: { label: "L100" }, centre: [9, 50] });
  assert.deepEqual(
    notPickedYet(lines, [whole]).rows.map(({ id }) => id),
    [200, 300],
  );
});

test("what is picked already, and towers of lines that are picked whole, are left out", () => {
  const line = targetOf({ id: 100, kind: "line", properties: { label: "L100" }, centre: [9, 50] });
  const found = notPickedYet(rows, [line, targetOfRow(bridge)]);
  assert.deepEqual(
    found.rows.map(({ id }) => id),
    [3],
  );
  assert.equal(found.covered, 2);
  const part = (south) =>
    targetOf({
      id: 100,
      kind: "line",
      properties: { label: "L100" },
      stretch: [
        [9, south],
        [9, south + 1],
      ],
    });
  assert.equal(notPickedYet(rows, [part(50)]).covered, 2);
  assert.equal(notPickedYet(rows, [part(51)]).covered, 0);
});
