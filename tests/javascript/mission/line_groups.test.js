import assert from "node:assert/strict";
import { test } from "node:test";
import { lineGroups, withoutFolded } from "../../../static/js/mission/panels/targets/group.js";

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
  const part = (number) => ({
    key: `p${number}`,
    asset: 9,
    line: null,
    stretch: [],
    label: `E402, km ${number}.0–${number + 1}.0`,
    detail: "",
  });
  const parts = [0, 1, 2, 3, 4, 5, 6].map(part);
  const groups = lineGroups(parts, (key) => (key < "p3" ? 0 : 1));
  assert.deepEqual(
    groups.map(({ words, keys, isOfParts }) => [words, keys.length, isOfParts]),
    [
      ["E402, km 0.0–3.0", 3, true],
      ["E402, km 3.0–7.0", 4, true],
    ],
  );
  assert.equal(lineGroups([parts[0], parts[1], parts[5]])[0].words, "E402");
  assert.deepEqual(lineGroups(parts.slice(0, 2)), []);
});
