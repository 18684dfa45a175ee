/** Hatch and arrows, drawn on a canvas in the palette's colours when the style first asks for them. */

const RATIO = 2;

function canvasOf(size_px) {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = size_px * RATIO;
  const pen = canvas.getContext("2d", { willReadFrequently: true });
  pen.scale(RATIO, RATIO);
  return pen;
}

const pixels = (pen) => pen.getImageData(0, 0, pen.canvas.width, pen.canvas.height);

const HATCH_PX = 8;

/** 45 degrees; the corners are drawn too, so that the pattern meets itself. */
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

/** The same in strokes with gaps: a zone that applies at times. */
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

function draw(id, palette) {
  if (id === "hatch") return hatch(palette);
  if (id === "hatch-timed") return timedHatch(palette);
  const number = /^arrow-(\d+)$/.exec(id)?.[1];
  return number ? arrow(palette, palette.routes[number - 1] ?? palette.inkSecond) : null;
}

/** `palette()` gives the one in use. Returns a function that draws all again after a theme change. */
export function provideImages(map, palette) {
  const given = new Set();
  map.setMissingStyleImageResolver((id) => {
    const image = draw(id, palette());
    if (!image || map.hasImage(id)) return;
    given.add(id);
    map.addImage(id, image, { pixelRatio: RATIO });
  });
  return () => {
    for (const id of given) if (map.hasImage(id)) map.updateImage(id, draw(id, palette()));
  };
}
