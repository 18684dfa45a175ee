import assert from "node:assert/strict";
import test from "node:test";

globalThis.document ??= { cookie: "", querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
globalThis.addEventListener ??= () => {};
const { storeLastView } = await import("../../../static/js/map/last_view.js");

test("a map that follows a UAV stores its view once, when it rests", async (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const stored = [];
  context.mock.method(globalThis, "fetch", async (_address, { method, body }) => {
    stored.push([method, JSON.parse(body).longitude]);
    return new Response(null, { status: 204 });
  });
  let longitude = 0;
  let moved;
  storeLastView({
    getCenter: () => ({ wrap: () => ({ lng: longitude, lat: 50 }) }),
    getZoom: () => 12,
    on: (_name, act) => {
      moved = act;
    },
  });
  for (longitude = 1; longitude <= 10; longitude += 1) {
    moved({ originalEvent: {} });
    context.mock.timers.tick(1_000);
  }
  assert.deepEqual(stored, []);
  context.mock.timers.tick(1_000);
  assert.deepEqual(stored, [["PUT", longitude]]);
});

test("a move of the page itself is not where the user worked", async (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const stored = [];
  context.mock.method(globalThis, "fetch", async (_address, { body }) => {
    stored.push(JSON.parse(body).longitude);
    return new Response(null, { status: 204 });
  });
  let longitude = 0;
  let moved;
  const map = { getCenter: () => ({ wrap: () => ({ lng: longitude, lat: 50 }) }), getZoom: () => 12 };
  storeLastView({ ...map, on: (_name, act) => (moved = act) });
  longitude = 5;
  moved({ isOfPage: true });
  context.mock.timers.tick(2_000);
  assert.deepEqual(stored, []);
  moved({ originalEvent: {}, isOfPage: false });
  context.mock.timers.tick(2_000);
  assert.deepEqual(stored, [5]);
});
