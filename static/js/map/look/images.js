/** Hatch, arrows and photos, drawn on a canvas in the palette's colours when the style first requests them. */

/** @import { Palette } from "../../domain/palette.js" */
/** @import { MapLibreMap } from "../types.d.ts" */

const RATIO = 2;

/** @param {number} size_px */
function canvasOf(size_px) {
  const canvas = document.createElement("canvas");
  canvas.width = size_px * RATIO;
  canvas.height = size_px * RATIO;
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { willReadFrequently: true }));
  pen.scale(RATIO, RATIO);
  return pen;
}

/** @param {CanvasRenderingContext2D} pen */
const pixels = (pen) => pen.getImageData(0, 0, pen.canvas.width, pen.canvas.height);

const HATCH_PX = 8;

/** 45 degrees; the corners are drawn too, so that the pattern meets itself. @param {Palette} palette */
function hatch(palette) {
  const pen = canvasOf(HATCH_PX);
  pen.strokeStyle = palette.zone;
  pen.lineWidth = 0.9;
  for (const shift of [-HATCH_PX, 0, HATCH_PX]) {
    pen.beginPath();
    pen.moveTo(shift - 1, HATCH_PX + 1);
    pen.lineTo(shift + HATCH_PX + 1, -1);
    pen.stroke();
  }
  return pixels(pen);
}

/** The same in strokes with gaps: a zone that applies at times. @param {Palette} palette */
function timedHatch(palette) {
  const pen = canvasOf(HATCH_PX);
  pen.strokeStyle = palette.zone;
  pen.lineWidth = 1.1;
  pen.beginPath();
  pen.moveTo(1, HATCH_PX - 1);
  pen.lineTo(HATCH_PX / 2 + 1, HATCH_PX / 2 - 1);
  pen.stroke();
  return pixels(pen);
}

/** @param {Palette} palette @param {string} colour */
function arrow(palette, colour) {
  const pen = canvasOf(14);
  pen.fillStyle = colour;
  pen.strokeStyle = palette.casing;
  pen.lineWidth = 1.5;
  pen.lineJoin = "round";
  pen.beginPath();
  pen.moveTo(12, 7);
  pen.lineTo(3, 2.5);
  pen.lineTo(5.5, 7);
  pen.lineTo(3, 11.5);
  pen.closePath();
  pen.stroke();
  pen.fill();
  return pixels(pen);
}

/** What a photo shows from where it is taken, to the north; filled where it is chosen. @param {Palette} palette @param {boolean} isChosen */
function photo(palette, isChosen) {
  const pen = canvasOf(28);
  pen.lineWidth = 1.5;
  pen.lineJoin = "round";
  pen.fillStyle = isChosen ? palette.ink : palette.raised;
  pen.strokeStyle = palette.ink;
  pen.beginPath();
  pen.moveTo(14, 16);
  pen.lineTo(8, 3);
  pen.lineTo(20, 3);
  pen.closePath();
  pen.fill();
  pen.stroke();
  return pixels(pen);
}

/**
 * Where a UAV waits: a square for a base, a bolt on a disc for charging.
 *
 * @param {Palette} palette
 * @param {string} kind
 */
function stop(palette, kind) {
  const pen = canvasOf(20);
  pen.fillStyle = palette.raised;
  pen.strokeStyle = palette.ink;
  pen.lineWidth = 1.75;
  pen.lineJoin = "round";
  pen.beginPath();
  if (kind === "base") pen.rect(4, 4, 12, 12);
  else pen.arc(10, 10, 8, 0, 2 * Math.PI);
  pen.fill();
  pen.stroke();
  if (kind === "base") return pixels(pen);
  pen.fillStyle = palette.ink;
  pen.beginPath();
  for (const [x, y] of [
    [11, 4],
    [6.5, 11],
    [9.5, 11],
    [9, 16],
    [13.5, 9],
    [10.5, 9],
  ])
    pen.lineTo(x, y);
  pen.closePath();
  pen.fill();
  return pixels(pen);
}

/** @param {string} id @param {Palette} palette */
function draw(id, palette) {
  if (id === "hatch") return hatch(palette);
  if (id === "hatch-timed") return timedHatch(palette);
  if (id === "photo" || id === "photo-chosen") return photo(palette, id === "photo-chosen");
  const kind = /^stop-(base|charging)$/.exec(id)?.[1];
  if (kind) return stop(palette, kind);
  const number = /^arrow-(\d+)$/.exec(id)?.[1];
  return number ? arrow(palette, palette.routes[Number(number) - 1] ?? palette.inkSecond) : null;
}

/**
 * `palette()` returns the present one. Returns a function that redraws all after a theme change.
 *
 * @param {MapLibreMap} map
 * @param {() => Palette} palette
 */
export function provideImages(map, palette) {
  const given = new Set();
  map.setMissingStyleImageResolver((id) => {
    const image = draw(id, palette());
    if (!image || map.hasImage(id)) return;
    given.add(id);
    map.addImage(id, image, { pixelRatio: RATIO });
  });
  return () => {
    for (const id of given) {
      const image = draw(id, palette());
      if (image && map.hasImage(id)) map.updateImage(id, image);
    }
  };
}
