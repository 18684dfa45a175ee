import assert from "node:assert/strict";
import { test } from "node:test";

const catalogue = new URL("../../../static/js/locale/de.js", import.meta.url).href;
globalThis.document = {
  documentElement: { lang: "de", dataset: {} },
  cookie: "",
  querySelector: () => ({ getAttribute: () => catalogue }),
};
const { changeWords } = await import("../../../static/js/mission/uavs/uav_changes.js");

test("what has changed of a UAV is told in German", () => {
  assert.equal(
    changeWords({ name: "Kite", state: "maintenance", figures: [{ name: "battery_wh", kept: 56.6, now: 40 }] }),
    "Kite: Akku 56,6 → 40\u00a0Wh, ist in Wartung.",
  );
});
