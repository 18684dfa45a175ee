import assert from "node:assert/strict";
import test from "node:test";

const element = () => ({ addEventListener() {}, append() {}, setAttribute() {}, classList: { toggle() {} } });
globalThis.document ??= { querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
globalThis.document.createElement ??= element;
globalThis.matchMedia ??= () => ({ matches: false });
const regions = await import("../../../static/js/map/layers/regions.js");
const { routeClicks } = await import("../../../static/js/map/click_router.js");

test("a click on a region's dot brings the region into view, and is none on the page's map", () => {
  const [listeners, layerListeners] = [{}, {}];
  let hasDot = true;
  const map = {
    getCanvasContainer: element,
    getLayer: () => ({}),
    boxZoom: { disable() {} },
    getSource: () => null,
    on: (name, ...of) => {
      if (of.length === 1) listeners[name] = of[0];
      else layerListeners[name] = of;
    },
    queryRenderedFeatures: (_place, { layers }) => (hasDot && layers.includes("region-dots") ? [{}] : []),
  };
  const [clicks, shown] = [[], []];
  const extent = [8, 49, 10, 51];
  regions.addTo(map, [{ id: 7, name: "Here", extent, counts: {} }], (box) => shown.push(box));
  routeClicks(map, { kinds: () => null, tool: () => "point", click: (...of) => clicks.push(of) });
  const event = { point: { x: 4, y: 5 }, lngLat: { lng: 9, lat: 50 } };
  listeners.click(event);
  assert.deepEqual(clicks, []);
  const [layers, act] = layerListeners.click;
  assert.ok(layers.includes("region-dots"));
  act({ features: [{ id: 7 }] });
  assert.deepEqual(shown, [extent]);
  hasDot = false;
  listeners.click(event);
  assert.deepEqual(clicks, [[null, [9, 50], { x: 4, y: 5 }]]);
});
