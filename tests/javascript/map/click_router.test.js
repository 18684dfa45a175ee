import assert from "node:assert/strict";
import test from "node:test";

const element = () => ({ addEventListener() {}, append() {}, setAttribute() {}, classList: { toggle() {} } });
globalThis.document ??= { querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
globalThis.document.createElement ??= element;
globalThis.matchMedia ??= () => ({ matches: false });
const { routeClicks } = await import("../../../static/js/map/click_router.js");

test("a click on a region's dot is none on the page's map", () => {
  const listeners = {};
  let hasDot = true;
  const map = {
    getCanvasContainer: element,
    getLayer: () => ({}),
    boxZoom: { disable() {} },
    on: (name, act) => {
      listeners[name] = act;
    },
    queryRenderedFeatures: (_place, { layers }) => (hasDot && layers.includes("region-dots") ? [{}] : []),
  };
  const clicks = [];
  routeClicks(map, { kinds: () => null, tool: () => "point", click: (...of) => clicks.push(of) });
  const event = { point: { x: 4, y: 5 }, lngLat: { lng: 9, lat: 50 } };
  listeners.click(event);
  assert.deepEqual(clicks, []);
  hasDot = false;
  listeners.click(event);
  assert.deepEqual(clicks, [[null, [9, 50], { x: 4, y: 5 }]]);
});
