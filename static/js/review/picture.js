/** One photo large, with its marks; a box is drawn with the pointer. All places are in pixels of the upright original. */

import { h, setChildren, svg } from "../dom.js";
import { t } from "../text.js";

/** @import { Medium } from "../api_types.d.ts" */

/** @typedef {{ x: number, y: number, width: number, height: number }} Box */
/** @typedef {{ shape: any, severity: number, title: string }} ShownMark */

const MIN_SIDE_PX = 4; // on the screen, below which it was a click
const ZOOMS = [1, 1.5, 2, 3, 4, 6];
const DECODED = ["image/jpeg", "image/png", "image/webp"]; // by browsers

/**
 * @param {HTMLElement} element
 * @param {{ canDraw: boolean, notify: () => void }} options
 */
export function createPicture(element, { canDraw, notify }) {
  /** @type {Medium | null} */
  let medium = null;
  /** @type {Box | null} */
  let box = null;
  /** @type {ShownMark[]} */
  let marks = [];
  let zoom = 0;
  const image = h("img", { class: "review-image", alt: "", draggable: "false" });
  const overlay = svg("svg", { class: "review-overlay", preserveAspectRatio: "none", "aria-hidden": "true" });
  const frame = h("div", { class: "review-frame" }, image, overlay);

  if (canDraw)
    listenToBoxes(overlay, {
      size: () => medium && [medium.width_px ?? 1, medium.height_px ?? 1],
      move(drawn) {
        box = drawn;
        draw();
      },
      end: notify,
    });

  function draw() {
    const [width, height] = [medium?.width_px ?? 1, medium?.height_px ?? 1];
    overlay.setAttribute("viewBox", `0 0 ${width} ${height}`);
    setChildren(
      overlay,
      marks
        .filter(({ shape }) => shape)
        .map(({ shape, severity, title }) => outline(shape, `mark severity-${severity}`, title)),
      box && outline({ type: "box", ...box }, "mark drawn", ""),
    );
  }

  function drawZoom() {
    frame.style.width = zoom ? `${ZOOMS[zoom] * 100}%` : "";
    element.dataset.zoomed = String(zoom > 0);
    if (zoom && medium && DECODED.includes(medium.media_type) && image.dataset.of !== "original") {
      image.dataset.of = "original";
      image.src = medium.original;
    }
  }

  return {
    /** @param {Medium} shown */
    show(shown) {
      [medium, box, marks, zoom] = [shown, null, [], 0];
      const preview = shown.previews["1600"];
      image.dataset.of = "preview";
      image.alt = shown.file_name;
      if (preview) image.src = preview;
      frame.style.aspectRatio = `${shown.width_px ?? 4} / ${shown.height_px ?? 3}`;
      frame.style.setProperty("--shape", String((shown.width_px ?? 4) / (shown.height_px ?? 3)));
      const reason = shown.state === "waiting" ? t("The photo is not read yet.") : shown.fault;
      setChildren(element, preview ? frame : h("p", { class: "review-none" }, reason));
      drawZoom();
      draw();
    },
    /** @param {ShownMark[]} shown */
    mark(shown) {
      marks = shown;
      draw();
    },
    box: () => box,
    clear() {
      box = null;
      draw();
      notify();
    },
    /** @param {number} step */
    zoom(step) {
      const before = ZOOMS[zoom];
      zoom = Math.min(Math.max(zoom + step, 0), ZOOMS.length - 1);
      const [x, y] = [element.scrollLeft + element.clientWidth / 2, element.scrollTop + element.clientHeight / 2];
      drawZoom();
      const factor = ZOOMS[zoom] / before;
      element.scrollTo(x * factor - element.clientWidth / 2, y * factor - element.clientHeight / 2);
    },
  };
}

/**
 * Draws boxes by the pointer; a click without a box removes the one that is there.
 *
 * @param {SVGElement} overlay
 * @param {{ size: () => [number, number] | null, move: (box: Box | null) => void, end: () => void }} acts size: of the picture in pixels
 */
function listenToBoxes(overlay, { size, move, end }) {
  /** @type {[number, number] | null} */
  let from = null;
  /** @type {Box | null} */
  let box = null;

  /** @param {PointerEvent} event @returns {[number, number]} */
  function placeOf(event) {
    const { left, top, width, height } = overlay.getBoundingClientRect();
    const [full_x, full_y] = size() ?? [1, 1];
    const share = (/** @type {number} */ value) => Math.min(Math.max(value, 0), 1);
    return [share((event.clientX - left) / width) * full_x, share((event.clientY - top) / height) * full_y];
  }

  function finish() {
    if (!from) return;
    from = null;
    const scale = overlay.getBoundingClientRect().width / (size()?.[0] ?? 1);
    if (!box || Math.min(box.width, box.height) * scale < MIN_SIDE_PX) move(null);
    end();
  }

  overlay.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || !size()) return;
    event.preventDefault();
    overlay.setPointerCapture(event.pointerId);
    [from, box] = [placeOf(event), null];
  });
  overlay.addEventListener("pointermove", (event) => {
    if (!from) return;
    box = boxBetween(from, placeOf(event));
    move(box);
  });
  overlay.addEventListener("pointerup", finish);
  overlay.addEventListener("pointercancel", finish);
}

/** @param {[number, number]} one @param {[number, number]} other @returns {Box} */
export function boxBetween([x1, y1], [x2, y2]) {
  return { x: Math.min(x1, x2), y: Math.min(y1, y2), width: Math.abs(x2 - x1), height: Math.abs(y2 - y1) };
}

/** @param {any} shape @param {string} kind @param {string} title */
function outline(shape, kind, title) {
  const words = title && svg("title", {}, title);
  if (shape.type === "polygon")
    return svg(
      "polygon",
      { class: kind, points: shape.points.map((/** @type {number[]} */ point) => point.join(",")).join(" ") },
      words,
    );
  return svg("rect", { class: kind, x: shape.x, y: shape.y, width: shape.width, height: shape.height }, words);
}
