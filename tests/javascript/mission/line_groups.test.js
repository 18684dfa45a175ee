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
