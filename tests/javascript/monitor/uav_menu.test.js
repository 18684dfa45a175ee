import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.document ??= { cookie: "", querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
globalThis.location ??= { hash: "", pathname: "/", protocol: "http:", host: "here" };
const { menuEntries } = await import("../../../static/js/monitor/uav_menu.js");

const APPROVAL = { id: "a", revoke_requested_at: null };
const flyer = { uav: 7, name: "Kite", place: 0, flights: 2, flown: 0, hasFailed: false };
const mission = (state) => ({ state, approval: APPROVAL });
const upload = {
  kind: "upload-mission",
  state: "applied",
  uav: { id: 7 },
  parameters: { flight: 1 },
  outcome_code: "",
};
const entriesOf = (commands, more = {}, now = "dispatched") =>
  Object.fromEntries(
    menuEntries({ mission: mission(now), commands, connection: null }, { ...flyer, ...more }, "").map((entry) => [
      entry.kind,
      entry,
    ]),
  );

test("a UAV that has its mission is started alone, and is not sent it again", () => {
  const { start, send } = entriesOf([upload]);
  assert.equal(start.reason, "");
  assert.equal(send.reason, "The mission is already on Kite.");
});

test("one whose upload failed is sent it again, and says why it cannot start", () => {
  const { start, send } = entriesOf([{ ...upload, state: "failed" }]);
  assert.deepEqual([send.label, send.reason], ["Upload again", ""]);
  assert.equal(start.reason, "Kite does not have its mission yet.");
});

test("after its first flight the next one is uploaded", () => {
  const { send } = entriesOf([upload], { flown: 1 }, "active");
  assert.deepEqual([send.label, send.reason, send.flight], ["Upload flight 2", "", 2]);
});
