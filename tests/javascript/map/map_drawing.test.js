import assert from "node:assert/strict";
import test from "node:test";

const element = () => ({ style: {}, setAttribute() {}, append() {}, remove() {} });
globalThis.document ??= {
  cookie: "",
  querySelector: () => null,
  createElement: element,
  createElementNS: element,
  documentElement: { lang: "en", dataset: {} },
};
globalThis.matchMedia ??= () => ({ matches: false });
globalThis.addEventListener ??= () => {};
const { routeClicks } = await import("../../../static/js/map/click_router.js");

/** A map that is drawn on with a tool: what was drawn and which clicks got through. */
function drawnOn(tool) {
  const got = { drawn: [], clicks: 0 };
  const canvas = Object.assign(new EventTarget(), {
    getBoundingClientRect: () => ({ left: 0, top: 0 }),
    append() {},
    setPointerCapture() {},
    classList: { toggle() {} },
  });
  const map = {
    getCanvasContainer: () => canvas,
    boxZoom: { disable() {} },
    dragPan: { disable() {}, enable() {} },
    on() {},
    getLayer: () => null,
    unproject: ([lng, lat]) => ({ lng, lat }),
  };
  routeClicks(map, {
    tool: () => tool,
    kinds: () => null,
    click() {},
    hover() {},
    box: (box) => got.drawn.push(box),
    lasso: (ring) => got.drawn.push(ring),
  });
  canvas.addEventListener("click", () => (got.clicks += 1));
  const at = (type, [clientX, clientY] = [0, 0]) =>
    canvas.dispatchEvent(
      Object.assign(new Event(type), { button: 0, pointerId: 1, isPrimary: true, clientX, clientY }),
    );
  return { got, at };
}

for (const tool of ["box", "lasso"]) {
  test(`letting go of a ${tool} picks nothing where it ends, and the next click counts again`, () => {
    const { got, at } = drawnOn(tool);
    at("pointerdown", [10, 10]);
    for (const place of [
      [80, 10],
      [80, 60],
    ])
      at("pointermove", place);
    at("pointerup", [80, 60]);
    at("click", [80, 60]);
    assert.deepEqual([got.drawn.length, got.clicks], [1, 0]);
    at("pointerdown", [30, 30]);
    at("pointerup", [30, 30]);
    at("click", [30, 30]);
    assert.deepEqual([got.drawn.length, got.clicks], [1, 1]);
  });
}
