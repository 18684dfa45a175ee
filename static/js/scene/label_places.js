/** Places of labels without overlaps. Values in, values out. */

const GAP_PX = 3;

/** Round a point: above, right, left, below, then higher up. As shares of the label's size from its top left corner, and pixels besides. */
const TRIES = [
  [-0.5, -1, 0, -10],
  [0, -0.5, 14, 0],
  [-1, -0.5, -14, 0],
  [-0.5, 0, 0, 12],
  [-0.5, -1, 0, -36],
];

/** @typedef {{ key: string, x: number, y: number, width: number, height: number, weight: number }} PlacedItem x, y: where it belongs */
/** @typedef {{ left: number, top: number, right: number, bottom: number }} ScreenBox */
/** @typedef {Map<string, { left: number, top: number, tried: number }>} LabelPlaces by key */

/**
 * Heavier ones are placed first; those that have no room are left out.
 *
 * @param {readonly PlacedItem[]} items
 * @param {{ width: number, height: number }} size of the picture
 * @param {LabelPlaces} [before] the last answer: a label stays where it stood, if it can
 * @param {readonly ScreenBox[]} [covered] elements over the picture
 * @param {readonly number[][]} [tries] places round a point, the best first
 */
export function placeLabels(items, { width, height }, before = new Map(), covered = [], tries = TRIES) {
  /** @type {LabelPlaces} */
  const placed = new Map();
  const taken = [...covered];
  for (const item of [...items].sort((a, b) => b.weight - a.weight)) {
    const last = before.get(item.key)?.tried;
    const order =
      last === undefined ? [...tries.keys()] : [last, ...[...tries.keys()].filter((number) => number !== last)];
    for (const number of order) {
      const [across, down, right_px, down_px] = tries[number];
      const left = item.x + across * item.width + right_px;
      const top = item.y + down * item.height + down_px;
      if (left < 2 || top < 2 || left + item.width > width - 2 || top + item.height > height - 2) continue;
      if (
        taken.some(
          (box) =>
            left < box.right + GAP_PX &&
            left + item.width > box.left - GAP_PX &&
            top < box.bottom + GAP_PX &&
            top + item.height > box.top - GAP_PX,
        )
      )
        continue;
      taken.push({ left, top, right: left + item.width, bottom: top + item.height });
      placed.set(item.key, { left, top, tried: number });
      break;
    }
  }
  return placed;
}
