import assert from "node:assert/strict";
import { test } from "node:test";
import { ESTIMATED, MEASURED } from "../../../static/js/domain/certainty.js";
import { batteryWords, figuresOf, landingPercent } from "../../../static/js/monitor/card_figures.js";
import { estimate, NOW_MS, plain, uav } from "./live_uav.js";

const BESIDE = {
  now_ms: NOW_MS,
  home: [10, 50.01],
  route: { length_m: 25_000, battery_percent: 40 },
  targetOf: () => ({ pill: "A3", label: "Tower 2" }),
};
const shown = (one, certainty, more = {}) =>
  figuresOf(one, certainty, { ...BESIDE, ...more }).map(({ figure, unit, words }) =>
    plain([figure, unit, words].filter(Boolean).join(" ")),
  );

test("a card has six figures in fixed places; estimated ones have a tilde", () => {
  const [battery, height, speed, home, next, age] = shown(uav({ age_s: 74, estimated: estimate() }), ESTIMATED);
  assert.deepEqual(
    [battery, height, speed, age],
    ["~ 71 % lands 41 %", "~ 46 m above take-off", "~ 10 m/s speed", "74 s age"],
  );
  assert.match(home, /^~ 1\.3 km home$/);
  assert.match(next, /^~ \d\d:\d\d next A3$/);
});

test("what is not known is a dash in its place, with the reason", () => {
  const bare = uav({ battery_percent: null, altitude_relative_m: null, speed_mps: null, position: null });
  const figures = figuresOf(bare, MEASURED, { ...BESIDE, home: null, route: null });
  assert.deepEqual(
    figures.map(({ figure }) => figure),
    ["—", "—", "—", "—", "—", "0.7"],
  );
  assert.ok(figures.every(({ figure, title }) => figure !== "—" || title));
  assert.deepEqual(
    figuresOf({ ...bare, measured: null }, null, BESIDE)
      .map(({ figure }) => figure)
      .slice(-1),
    ["—"],
  );
});

test("the height is above ground where that is known", () => {
  assert.equal(shown(uav({ altitude_agl_m: 31 }), MEASURED)[1], "31 m AGL");
  assert.equal(shown(uav(), MEASURED)[1], "45 m above take-off");
  assert.equal(shown(uav({ altitude_relative_m: null, altitude_amsl_m: 300 }), MEASURED)[1], "300 m AMSL");
});

test("while it holds, how long it can takes the place of what is next", () => {
  const holds = (hold_s) => uav({ mode: "Hold", estimated: estimate({ battery: { level: "", hold_s } }) });
  assert.equal(shown(holds(720), MEASURED)[4], "12 min can hold");
  const [low] = figuresOf(holds(10), MEASURED, BESIDE).slice(4);
  assert.deepEqual([low.level, low.title], ["critical", "Battery: too low to hold longer"]);
  assert.equal(shown(holds(null), MEASURED)[4], "— can hold");
});

test("the battery at landing is what the plan takes for the rest of the route", () => {
  assert.equal(landingPercent(uav({ estimated: estimate() }), BESIDE.route), 71 - (60 * 12_500) / 25_000);
  assert.equal(landingPercent(uav({ estimated: estimate() }), null), null);
});

test("the forecast of its own drain counts before the plan, and the reserve stands beside it", () => {
  const battery = { level: "", left_percent: 71, reserve_percent: 20, lands_percent: 43.2 };
  const one = uav({ estimated: estimate({ is_measured: true, battery }) });
  assert.equal(shown(one, MEASURED)[0], "71 % lands 43 %, reserve 20 %");
  assert.match(
    plain(figuresOf(one, MEASURED, BESIDE)[0].title),
    /^At landing about 43 %, by its own drain\. Reserve 20 %/,
  );
  const held = uav({ estimated: estimate({ is_measured: true, battery: { ...battery, lands_percent: null } }) });
  assert.equal(shown(held, MEASURED)[0], "71 % lands 41 %, reserve 20 %");
  const short = uav({ estimated: estimate({ is_measured: true, battery: { ...battery, lands_percent: -3 } }) });
  assert.equal(shown(short, MEASURED)[0], "71 % lands 0 %, reserve 20 %");
});

test("the battery's figure has its level, and minutes to the reserve stand against minutes home", () => {
  const battery = {
    level: "warning",
    left_percent: 31,
    reserve_percent: 20,
    home_percent: 9,
    home_s: 240,
    reserve_in_s: 720,
  };
  const low = uav({ estimated: estimate({ is_measured: true, battery }) });
  assert.equal(figuresOf(low, MEASURED, BESIDE)[0].level, "warning");
  assert.equal(plain(batteryWords(low)), "Battery: 12 min to the reserve, 4 min home");
  assert.equal(batteryWords(uav()), "");
});
