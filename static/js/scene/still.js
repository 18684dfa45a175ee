/** A picture of the moment to save: the view, its labels, and a caption. */

/** @import { CopiedPicture, ScenePalette } from "./types.d.ts" */

/** @typedef {{ element: HTMLElement, left: number, top: number, width: number, height: number }} StillLabel */

const LINE_PX = 40;
const PADDING_PX = 14;

/**
 * @param {CopiedPicture} copied
 * @param {readonly StillLabel[]} labels
 * @param {[title: string, facts: string, mark: string]} words
 * @param {ScenePalette} palette
 */
export function stillOf({ picture, scale }, labels, words, palette) {
  const line = LINE_PX * scale;
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [picture.width, picture.height + line];
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  context.drawImage(picture, 0, 0);
  for (const label of labels) drawLabel(context, label, scale, palette);
  context.fillStyle = palette.panel;
  context.fillRect(0, picture.height, canvas.width, line);
  context.textBaseline = "middle";
  const middle = picture.height + line / 2;
  const [title, facts, mark] = words;
  context.fillStyle = palette.ink;
  context.font = `600 ${14 * scale}px ${palette.font}`;
  context.fillText(title, PADDING_PX * scale, middle);
  const from = PADDING_PX * scale + context.measureText(title).width + 16 * scale;
  context.font = `400 ${13 * scale}px ${palette.font}`;
  context.fillStyle = palette.inkSecond;
  const markWidth = context.measureText(mark).width;
  context.fillText(mark, canvas.width - markWidth - PADDING_PX * scale, middle);
  context.fillText(facts, from, middle, Math.max(10, canvas.width - from - markWidth - 3 * PADDING_PX * scale));
  return canvas;
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {StillLabel} label
 * @param {number} scale
 * @param {ScenePalette} palette
 */
function drawLabel(context, { element, left, top, width, height }, scale, palette) {
  const look = getComputedStyle(element);
  context.save();
  context.scale(scale, scale);
  if (look.backgroundColor !== "rgba(0, 0, 0, 0)") {
    context.fillStyle = look.backgroundColor;
    context.beginPath();
    context.roundRect(left, top, width, height, 4);
    context.fill();
  }
  const parts = [...element.children];
  const rows = parts.map((part) => ({ part, box: part.getBoundingClientRect() }));
  const corner = element.getBoundingClientRect();
  context.textBaseline = "middle";
  for (const { part, box } of rows) {
    const own = getComputedStyle(part);
    const text = part.textContent ?? "";
    context.font = `${own.fontWeight} ${own.fontSize} ${palette.font}`;
    const [x, y] = [left + box.left - corner.left, top + box.top - corner.top + box.height / 2];
    if (look.backgroundColor === "rgba(0, 0, 0, 0)") {
      context.lineWidth = 3;
      context.lineJoin = "round";
      context.strokeStyle = palette.halo;
      context.strokeText(text, x, y);
    }
    context.fillStyle = own.color;
    context.fillText(text, x, y);
  }
  context.restore();
}

/** Download a canvas as a PNG file. @param {HTMLCanvasElement} canvas @param {string} name */
export async function download(canvas, name) {
  /** @type {Blob | null} */
  const blob = await new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
  if (!blob) throw new Error("the picture could not be encoded");
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/**
 * "north-belt-2026-09-10-091204-chase.png": of letters, digits and hyphens in any language.
 *
 * @param {string} mission
 * @param {string} at
 * @param {string} camera
 */
export function fileName(mission, at, camera) {
  const plain = mission
    .toLowerCase()
    .normalize("NFC")
    .replace(/[^\p{Letter}\p{Number}]+/gu, "-")
    .replace(/^-+|-+$/g, "");
  return `${[plain || "mission", at, camera].filter(Boolean).join("-")}.png`;
}
