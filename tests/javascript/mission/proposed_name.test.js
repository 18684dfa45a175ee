import assert from "node:assert/strict";
import { test } from "node:test";
import { baseView } from "../../../static/js/mission/map/base_view.js";
import { proposedName } from "../../../static/js/mission/targets/proposed_name.js";

const tower = (label, detail = "138 kV AEP") => ({ kind: "tower", label, detail });

test("a mission is proposed a name from what is picked", () => {
  assert.equal(proposedName([]), "");
  assert.equal(proposedName([tower("Tower 17 of 41")]), "Tower 17 of 41, 138 kV AEP");
  assert.equal(proposedName([tower("1"), tower("2")]), "138 kV AEP: 2 towers");
  const bridge = { kind: "bridge", label: "Bridge w42", detail: "carries a road" };
  assert.equal(proposedName([tower("1"), bridge, tower("2", "110 kV")]), "2 towers, 1 bridge");
  const part = (number, asset = 7) => ({
    kind: "line",
    asset,
    label: `E402, km ${number}.0–${number + 1}.0`,
    stretch: [],
    detail: "",
  });
  assert.equal(proposedName([part(0), part(1)]), "E402");
  assert.equal(proposedName([part(0), part(1), part(0, 8), tower("1")]), "1 tower, 2 lines");
  assert.ok(proposedName([tower("x".repeat(500))]).length <= 200);
});

test("a new mission opens on the bases, where several regions have some on those of most UAVs", () => {
  assert.equal(baseView([]), null);
  const at = (...position) => ({ position });
  const [west, south, east, north] = baseView([at(9, 50)]);
  assert.ok(west < 9 && east > 9 && south < 50 && north > 50);
  const [, , to] = baseView([at(-83, 40), at(9, 50), at(9.4, 50.1)]);
  assert.ok(to > 9.4 && to < 10);
  assert.ok(baseView([at(-83, 40), at(9, 50), at(9.4, 50.1)])[0] > 8);
});
