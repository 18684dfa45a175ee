/** A picture of the moment to keep: what is seen, its labels, and a line that says what it is. */

const LINE_PX = 40;
const PADDING_PX = 14;

/** copied: { picture: canvas, scale } of the view; labels: of createLabels().shown(); words: [title, facts]; palette. → canvas. */
export function stillOf({ picture, scale }, labels, words, palette) {
  const line = LINE_PX * scale;
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [picture.width, picture.height + line];
  const context = canvas.getContext("2d");
  context.drawImage(picture, 0, 0);
  for (const { element, left, top, width, height } of labels)
    drawLabel(context, element, { left, top, width, height }, scale, palette);
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

function drawLabel(context, element, { left, top, width, height }, scale, palette) {
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
    context.font = `${own.fontWeight} ${own.fontSize} ${palette.font}`;
    const [x, y] = [left + box.left - corner.left, top + box.top - corner.top + box.height / 2];
    if (look.backgroundColor === "rgba(0, 0, 0, 0)") {
      context.lineWidth = 3;
      context.lineJoin = "round";
      context.strokeStyle = palette.halo;
      context.strokeText(part.textContent, x, y);
    }
    context.fillStyle = own.color;
    context.fillText(part.textContent, x, y);
  }
  context.restore();
}

/** Gives a canvas to the reader as a PNG file. */
export async function download(canvas, name) {
  const blob = await new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** "north-belt-2026-09-10-091204-chase.png": of letters, digits and hyphens in any language. */
export function fileName(mission, at, camera) {
  const plain = mission
    .toLowerCase()
    .normalize("NFC")
    .replace(/[^\p{Letter}\p{Number}]+/gu, "-")
    .replace(/^-+|-+$/g, "");
  return `${[plain || "mission", at, camera].filter(Boolean).join("-")}.png`;
}
