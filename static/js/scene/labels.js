/** Names in the picture: UAVs, targets, and things on the ground, as text of the page without overlaps. */

import { h } from "../dom.js";
import { t } from "../text.js";
import { heightText } from "../units.js";
import { placeLabels } from "./label_places.js";

/** @import { GroundLabel } from "./geometry/labels.js" */
/** @import { LabelPlaces, PlacedItem, ScreenBox } from "./label_places.js" */
/** @import { Projected, Size, Vector } from "./types.d.ts" */

/**
 * A label at a place. parts: its name, then facts.
 *
 * @typedef {{ key: string, place: Vector, parts: string[], className: string, weight: number }} SceneLabel
 */
/** @typedef {{ element: HTMLElement, text: string | null, className: string, width: number, height: number }} LabelElement */
/** @typedef {ReturnType<typeof createLabels>} Labels */

const MAX_OF_GROUND = 14;
/** @type {Record<string, number>} by kind */
const GROUND_REACH_M = { zone: 6_000, line: 2_500, tower: 420, bridge: 1_500, railway: 1_500 };
const USUAL_REACH_M = 800;
const SAME_M = 250;
const TOUCHES_PX = 40; // labels beyond the edge are not measured

/** @param {HTMLElement} container */
export function createLabels(container) {
  const layer = h("div", { class: "scene-labels", "aria-hidden": "true" });
  container.append(layer);
  /** @type {Map<string, LabelElement>} by key */
  const elements = new Map();
  /** @type {LabelPlaces} */
  let placed = new Map();

  /** @param {SceneLabel} label */
  function elementOf({ key, className, parts }) {
    const text = parts.join("\n");
    let known = elements.get(key);
    if (!known) {
      known = { element: h("div", { class: "scene-label" }), text: null, className: "", width: 0, height: 0 };
      elements.set(key, known);
      layer.append(known.element);
    }
    if (known.text !== text || known.className !== className) {
      known.text = text;
      known.className = className;
      known.element.className = `scene-label ${className}`;
      known.element.replaceChildren(
        ...parts.filter(Boolean).map((part, index) => h(index === 0 ? "b" : "span", {}, part)),
      );
      known.element.style.visibility = "hidden";
      known.element.style.display = "";
      [known.width, known.height] = [known.element.offsetWidth, known.element.offsetHeight];
    }
    return known;
  }

  return {
    element: layer,
    /** At night the ground is dark in both themes. @param {boolean} isNight */
    setNight: (isNight) => layer.classList.toggle("night", isNight),
    /**
     * @param {readonly SceneLabel[]} items
     * @param {(place: Vector) => Projected | null} project
     * @param {Size} size of the picture
     * @param {readonly ScreenBox[]} [covered] boxes of elements over it
     */
    show(items, project, size, covered = []) {
      /** @type {PlacedItem[]} */
      const seen = [];
      for (const item of items) {
        const at = project(item.place);
        if (
          !at ||
          at.x < -TOUCHES_PX ||
          at.y < -TOUCHES_PX ||
          at.x > size.width + TOUCHES_PX ||
          at.y > size.height + TOUCHES_PX
        )
          continue;
        const { width, height } = elementOf(item);
        seen.push({ key: item.key, weight: item.weight, x: at.x, y: at.y, width, height });
      }
      placed = placeLabels(seen, size, placed, covered);
      for (const [key, known] of elements) {
        const at = placed.get(key);
        if (!at) known.element.style.display = "none";
        else {
          known.element.style.display = "";
          known.element.style.visibility = "";
          known.element.style.transform = `translate(${Math.round(at.left)}px, ${Math.round(at.top)}px)`;
        }
      }
      const keys = new Set(items.map(({ key }) => key));
      for (const [key, { element }] of elements) {
        if (keys.has(key)) continue;
        element.remove();
        elements.delete(key);
      }
    },
    /** The labels shown and their places, for a still picture. */
    shown: () =>
      [...placed].flatMap(([key, { left, top }]) => {
        const known = elements.get(key);
        return known ? [{ ...known, left, top }] : [];
      }),
    dispose: () => layer.remove(),
  };
}

/** Whether it is the first label with this name: two bridges of one road side by side share one. */
function isFirstOfItsName() {
  /** @type {Map<string, Vector[]>} places by kind and text */
  const kept = new Map();
  /** @param {GroundLabel} label */
  return ({ kind, text, position }) => {
    const others = kept.get(`${kind} ${text}`) ?? [];
    if (others.some((other) => Math.hypot(other[0] - position[0], other[2] - position[2]) < SAME_M)) return false;
    kept.set(`${kind} ${text}`, [...others, position]);
    return true;
  };
}

/**
 * Of the world's labels the nearest and heaviest that are near enough.
 *
 * @param {readonly GroundLabel[]} labels
 * @param {Vector} eye the camera's place
 * @param {number} [most]
 * @returns {SceneLabel[]}
 */
export function groundLabels(labels, eye, most = MAX_OF_GROUND) {
  return labels
    .map((label) => ({
      ...label,
      away_m: Math.hypot(label.position[0] - eye[0], label.position[1] - eye[1], label.position[2] - eye[2]),
    }))
    .filter(({ kind, away_m }) => away_m < (GROUND_REACH_M[kind] ?? USUAL_REACH_M))
    .sort((a, b) => b.weight / (200 + b.away_m) - a.weight / (200 + a.away_m))
    .filter(isFirstOfItsName())
    .slice(0, most)
    .map(({ kind, id, text, position, weight, away_m, counted_m }) => ({
      key: `${kind} ${id}`,
      place: position,
      parts: [text, counted_m ? t("counted as {height}", { height: heightText(counted_m) }) : ""],
      className: `ground ${kind}`,
      weight: Math.min(1, weight / 100) * 20 - away_m / 1_000,
    }));
}
