import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.document = { documentElement: { lang: "de", dataset: {} }, cookie: "" };
const { inWords } = await import("../../static/js/mission/plan_words.js");

const RANGE = "It is 93.1 km there and back, 33.1 km more than the range of Kite";

test("what keeps every UAV of the mission is told in German", () => {
  assert.equal(
    inWords(
      `${RANGE}: 46.0 min of flight. Other UAVs: no permitted route (Tern (old), Owl +2); battery too small (Heron).`,
    ),
    "Es sind 93,1\u00a0km hin und zurück, 33,1\u00a0km mehr als die Reichweite von Kite: 46,0 min Flug. " +
      "Andere UAVs: keine zulässige Route (Tern (old), Owl +2); Akku zu klein (Heron).",
  );
});

test("why a UAV to which a target is tied or locked cannot take off is told in German", () => {
  assert.equal(
    inWords("It is tied to East. East stands inside Airport and cannot take off."),
    "Es ist an East gebunden. East steht in Airport und kann nicht starten.",
  );
  assert.match(
    inWords("It is locked to U1. U1 is in maintenance and does not fly."),
    /^Es ist auf U1 festgelegt\. U1 .*Wartung/,
  );
  assert.match(
    inWords(
      "There is no UAV that can take off. East stands inside St. Gallen and cannot take off. West is retired and flies no more.",
    ),
    /^Kein UAV kann starten\. East .*St\. Gallen.* West /,
  );
});

test("no sentence about a target that is left out stays English", () => {
  const sentences = [
    "There is no permitted route for West, East.",
    "No UAV can get there: no way on the network keeps clear of every zone.",
    "There is no way from it to a base that lies outside every no-fly zone.",
    "Every straight way to it from the network within 10 km meets a no-fly zone.",
    "It is more than 2.5 km from the network.",
    "No UAV has a clear way of up to 10 km to the network from where it stands.",
    "To land there is to fly through Airport.",
    "It is 130 m high: a UAV would have to fly at 140 m, above the limit of 120 m.",
    "It is locked to others of which one cannot be reached: the run is left out as a whole.",
    "It is tied to West, which has as many targets as it may have.",
    "It is tied to West, which does not have the sensor Lidar.",
    "It is tied to West, which cannot fly to it.",
    "No UAV of the plan has the sensor Lidar.",
    "No UAV that can take off has the sensor Lidar. East stands inside Airport and cannot take off.",
    "There is no UAV that can take off.",
    "The battery of Kite or Tern does not last for it.",
    "It takes 80.0 Wh there, 0.4 Wh more than the battery of Kite may give: 1.0 min of flight.",
    `${RANGE}: 46.0 min of flight. It is locked to others: the run is left out as a whole.`,
  ];
  for (const sentence of sentences) assert.notEqual(inWords(sentence), sentence);
});
