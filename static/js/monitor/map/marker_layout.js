/** Layout of the labels of UAVs without overlaps, and of counts in place of UAVs close together. Values in, values out. */

import { placeLabels } from "../../scene/label_places.js";

/** @import { LabelPlaces } from "../../scene/label_places.js" */

/** @typedef {{ id: number | string, x: number, y: number, width: number, height: number, weight: number }} PlacedMark x, y: centre of its mark [px]; width, height: of its label */
/** A label's top left corner from the centre of its mark, and where its leader line ends; null: it is beside its mark. @typedef {{ left: number, top: number, leader: { x: number, y: number } | null }} LabelSpot */

const CLOSE_PX = 16; // marks of 26 px cover most of each other
const MIN_MEMBERS = 3; // two that overlap can still be distinguished
const MARK_PX = 14; // half the size that no label may cover
export const ALONE = 3; // from this weight on a UAV is never part of a count

/** As in label_places.js: beside the mark, then farther off, where a leader line is drawn. */
const TRIES = [
  [0, -0.5, 19, 0],
  [-1, -0.5, -19, 0],
  [-0.5, -1, 0, -19],
  [-0.5, 0, 0, 19],
  ...[40, 72, 108].flatMap((far_px) => [
    [0, -0.5, far_px, -far_px * 0.8],
    [0, -0.5, far_px, far_px * 0.8],
    [-1, -0.5, -far_px, -far_px * 0.8],
    [-1, -0.5, -far_px, far_px * 0.8],
    [-0.5, -1, 0, -far_px * 1.2],
    [-0.5, 0, 0, far_px * 1.2],
  ]),
];
const BESIDE = 4; // of the tries

/**
 * Groups of at least three with overlapping marks. Marks with a weight of ALONE or more stay single.
 *
 * @template {Pick<PlacedMark, "x" | "y" | "weight">} Mark
 * @param {Mark[]} marks
 * @returns {Mark[][]}
 */
export function clustersOf(marks) {
  const waiting = marks.filter(({ weight }) => weight < ALONE);
  /** @type {Mark[][]} */
  const groups = [];
  while (waiting.length) {
    const group = waiting.splice(0, 1);
    for (const member of group) {
      for (let index = waiting.length - 1; index >= 0; index -= 1) {
        const other = waiting[index];
        if (Math.hypot(other.x - member.x, other.y - member.y) < CLOSE_PX) group.push(...waiting.splice(index, 1));
      }
    }
    if (group.length >= MIN_MEMBERS) groups.push(group);
  }
  return groups;
}

/**
 * Places of labels; one without room is left out.
 *
 * @param {PlacedMark[]} marks single marks
 * @param {{ x: number, y: number }[]} others that no label may cover, such as counts
 * @param {{ width: number, height: number }} size of the map
 * @param {LabelPlaces} before the last answer's places
 * @returns {{ spots: Map<number | string, LabelSpot>, places: LabelPlaces }}
 */
export function spotsOf(marks, others, size, before) {
  const covered = [...marks, ...others].map(({ x, y }) => ({
    left: x - MARK_PX,
    top: y - MARK_PX,
    right: x + MARK_PX,
    bottom: y + MARK_PX,
  }));
  const items = marks.map(({ id, ...mark }) => ({ key: `${id}`, ...mark }));
  const places = placeLabels(items, size, before, covered, TRIES);
  const spots = new Map(
    marks.flatMap(({ id, x, y, width, height }) => {
      const found = places.get(`${id}`);
      if (!found) return [];
      const [left, top] = [found.left - x, found.top - y];
      const leader =
        found.tried < BESIDE
          ? null
          : { x: Math.min(Math.max(0, left), left + width), y: Math.min(Math.max(0, top), top + height) };
      return [/** @type {const} */ ([id, { left, top, leader }])];
    }),
  );
  return { spots, places };
}
