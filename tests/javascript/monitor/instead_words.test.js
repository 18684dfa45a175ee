import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.document ??= { cookie: "", querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
globalThis.location ??= { hash: "", pathname: "/", protocol: "http:", host: "here" };
const { inUnit } = await import("../../../static/js/mission/panels/why/in_unit.js");
const { insteadWords } = await import("../../../static/js/mission/panels/why/instead_words.js");

const plain = (text) => text.replaceAll("\u00a0", " ");
const route = (uav, duration_s, length_m) => ({ uav, duration_s, length_m, departs_s: 0 });
const plan = (objective) => ({
  targets: [{ label: "H135" }],
  result: { objective, routes: [route("Kestrel", 1200, 12000), route("Osprey", 1500, 15000)] }, // 10 m/s
});
const summary = (more) => ({
  uav: 0,
  alternative: {
    target: 0,
    uav: 1,
    other_length_m: 18600,
    total_change_m: -3500,
    max_range_m: null,
    is_beyond_range: false,
    ...more,
  },
});

test("what giving a target away costs is told in the unit of the objective", () => {
  assert.equal(
    plain(insteadWords(summary(), plan("makespan"))),
    "Giving H135 to Osprey would finish about 6 min later (and fly 3.5 km less).",
  );
  assert.equal(
    plain(insteadWords(summary({ total_change_m: 900 }), plan("total"))),
    "Giving H135 to Osprey would fly 900 m more in total.",
  );
  assert.match(insteadWords(summary({ other_length_m: 15000 }), plan("makespan")), /at about the same time/);
});

test("a plan for the least flying time or energy is told in minutes or watt-hours", () => {
  assert.equal(
    plain(insteadWords(summary({ total_change_m: 1800 }), plan("time"))),
    "Giving H135 to Osprey would take about 3 min more in total.",
  );
  const powered = plan("energy");
  for (const one of powered.result.routes) one.energy_wh = one.length_m / 100; // 10 Wh per km
  assert.equal(
    plain(insteadWords(summary({ total_change_m: -1800 }), powered)),
    "Giving H135 to Osprey would take about 18 Wh less in total.",
  );
  const parts = ["total", "makespan", "time", "energy"].map((objective) =>
    inUnit(powered.result.routes[0], 600, objective),
  );
  assert.deepEqual(
    parts.map(({ text, beside }) => [plain(text), plain(beside)]),
    [
      ["600 m", ""],
      ["1 min", "600 m"],
      ["1 min", "600 m"],
      ["6 Wh", "600 m"],
    ],
  );
});

test("a UAV whose range does not reach is named with it, and without another UAV there is nothing to tell", () => {
  const beyond = summary({ is_beyond_range: true, max_range_m: 15500 });
  assert.equal(
    plain(insteadWords(beyond, plan("makespan"))),
    "Giving H135 to Osprey is not possible: it would fly 18.6 km, its range is 15.5 km.",
  );
  assert.equal(insteadWords({ uav: 0, alternative: null }, plan("total")), "");
});
