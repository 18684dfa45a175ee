import assert from "node:assert/strict";
import { test } from "node:test";
import { lineGroups, withoutFolded } from "../../../static/js/mission/panels/targets/group.js";
import { EMPTY, targetOf, withTargets, withWishes } from "../../../static/js/mission/selection.js";
import {
  isWholeLine,
  labelOfParts,
  lineOfPart,
  targetOfPart,
  withJoinedParts,
  withParts,
} from "../../../static/js/mission/targets/line_parts.js";

const LINE = { id: 7, kind: "line", label: "E402", detail: "400 kV", length_m: 4_000, centre: [9, 50], line: null };
const whole = targetOf({ id: 7, kind: "line", properties: LINE, centre: [9, 50] });
const part = (km) =>
  targetOfPart({
    line: LINE,
    label: `E402, km ${km}.0–${km + 1}.0`,
    stretch: [
      [9 + km / 100, 50],
      [9 + (km + 1) / 100, 50],
    ],
    length_m: 1_000,
  });
const parts = [0, 1, 2, 3].map(part);
const of = (targets) => withTargets(EMPTY, targets);
const labels = ({ targets }) => targets.map(({ label }) => label);

test("parts take the place, the task and the wishes of their line", () => {
  const asked = withWishes(of([whole]), [whole.key], { priority: "high" });
  const shared = withParts(asked, whole.key, parts);
  assert.deepEqual(
    labels(shared),
    parts.map(({ label }) => label),
  );
  assert.ok(shared.targets.every(({ priority, stretch }) => priority === "high" && stretch));
  assert.ok(isWholeLine(whole) && !isWholeLine(parts[0]));
});

test("all parts are the whole line again, some of them one stretch, and what is asked otherwise stays apart", () => {
  const all = withJoinedParts(of(parts), whole);
  assert.deepEqual(labels(all), ["E402"]);
  assert.equal(all.targets[0].key, whole.key);
  const some = withJoinedParts(of([parts[2], parts[1]]), whole);
  assert.deepEqual(labels(some), ["E402, km 1.0–3.0"]);
  assert.deepEqual(some.targets[0].stretch, [
    [9.01, 50],
    [9.03, 50],
  ]);
  assert.deepEqual(labels(withJoinedParts(of([parts[0], parts[1], parts[3]]), whole)), [
    "E402, km 0.0–2.0",
    "E402, km 3.0–4.0",
  ]);
  const urgent = withWishes(of(parts), [parts[3].key], { priority: "high" });
  assert.deepEqual(labels(withJoinedParts(urgent, whole)), ["E402, km 0.0–3.0", "E402, km 3.0–4.0"]);
});

test("several parts are called by where they begin and end", () => {
  assert.equal(labelOfParts(parts.map(({ label }) => label)), "E402, km 0.0–4.0");
  assert.equal(labelOfParts([parts[0].label, parts[2].label]), "E402");
  assert.equal(lineOfPart("Line, km by km, km 0.0–1.5"), "Line, km by km");
  assert.equal(lineOfPart("E402"), "E402");
});

const on = (line, count, first = 0) =>
  Array.from({ length: count }, (_, at) => ({
    key: `${line} ${first + at}`,
    line,
    label: "T",
    detail: `Line ${line}`,
  }));

test("a long list has its targets in groups by line, as they stand one after the other", () => {
  const targets = [...on(1, 8), ...on(null, 1), ...on(2, 2), ...on(1, 5, 20)];
  const groups = lineGroups(targets);
  assert.deepEqual(
    groups.map(({ key, words, keys }) => [key, words, keys.length]),
    [
      ["1 0", "Line 1", 8],
      ["1 20", "Line 1", 5],
    ],
  );
  assert.equal(withoutFolded(targets, groups, () => false).length, 16);
  const keys = withoutFolded(targets, groups, ({ key }) => key === "1 0").map(({ key }) => key);
  assert.deepEqual(keys.slice(0, 3), ["1 0", "null 0", "2 0"]);
  assert.deepEqual(lineGroups(on(1, 12)), []);
});

test("parts of a line are a group in any list, of each route one", () => {
  const partOf = (number) => ({
    key: `p${number}`,
    asset: 9,
    line: null,
    stretch: [],
    label: `E402, km ${number}.0–${number + 1}.0`,
    detail: "",
  });
  const listed = [0, 1, 2, 3, 4, 5, 6].map(partOf);
  const groups = lineGroups(listed, (key) => (key < "p3" ? 0 : 1));
  assert.deepEqual(
    groups.map(({ words, keys, isOfParts }) => [words, keys.length, isOfParts]),
    [
      ["E402, km 0.0–3.0", 3, true],
      ["E402, km 3.0–7.0", 4, true],
    ],
  );
  assert.equal(lineGroups([listed[0], listed[1], listed[5]])[0].words, "E402");
  assert.deepEqual(lineGroups(listed.slice(0, 2)), []);
});
