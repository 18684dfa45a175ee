import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.document = { documentElement: { lang: "de", dataset: {} }, cookie: "" };
const { inWords } = await import("../../static/js/mission/plan_words.js");
const { changeWords } = await import("../../static/js/mission/uav_changes.js");

const nearest = "more than the battery of the UAV that comes nearest to it may give.";

test("figures of a stored sentence have the decimal sign of the reader", () => {
  assert.match(
    inWords(`It takes 1,234.5 Wh there and back, 12.3 Wh ${nearest}`),
    /1\.234,5 Wh.* hin und zurück, 12,3 Wh/,
  );
  assert.match(inWords(`It takes 80.0 Wh there, 0.4 Wh ${nearest}`), /80,0 Wh.* hin, 0,4 Wh/);
  assert.match(
    inWords("It is 12.3 km there and back, 800 m more than the range of the UAV that comes nearest to it."),
    /12,3\u00a0km hin und zurück, 800\u00a0m/,
  );
  assert.match(
    inWords(
      "Over the ground and what stands tall it takes 61.2 Wh there and on to the nearest base, 3.1 Wh more than the battery of Kite 2 may give.",
    ),
    /61,2 Wh .*3,1 Wh.*Kite 2/,
  );
  assert.match(
    inWords("However Kite charges on the way, it alone takes up to 5.5 Wh more than the battery of Kite may give."),
    /Kite .*5,5 Wh/,
  );
  assert.match(inWords("However Kite or Tern charges on the way, the battery does not last for it."), /Kite oder Tern/);
});

test("what is missing is told in minutes of flight, whatever comes after it", () => {
  const said = `It takes 80.0 Wh there, 1,234.5 Wh ${nearest.slice(0, -1)}: 470.3 min of flight.`;
  assert.match(inWords(said), /1\.234,5 Wh mehr.*nächsten kommt: 470,3 min Flug\.$/);
  assert.match(
    inWords(`${said} It is locked to others: the run is left out as a whole.`),
    /470,3 min Flug\. Es ist mit anderen festgelegt/,
  );
  assert.equal(inWords("Nobody knows this: 1.0 min of flight."), "Nobody knows this: 1.0 min of flight.");
});

test("what was changed by hand and is not kept is told in German", () => {
  const said =
    "Legs of Kite that were changed by hand and are as planned again: 1 of 2. Their ends differ, or something bars them now.";
  assert.match(inWords(said), /Kite.*1 von 2/);
});

test("what has changed of a UAV is told in German", () => {
  assert.equal(
    changeWords({ name: "Kite", state: "maintenance", figures: [{ name: "battery_wh", kept: 56.6, now: 40 }] }),
    "Kite: Akku 56,6 → 40\u00a0Wh, ist in Wartung.",
  );
});
