/** Measuring on the map: points are clicked and labelled with lengths; three points or more also have an area. */

import { h } from "../dom.js";
import { distance_m, pathLength_m, ringArea_m2 } from "../domain/geodesy.js";
import { isTyping } from "../page/keyboard.js";
import { announce } from "../page/toast.js";
import { t } from "../text.js";
import { areaText, lengthText } from "../units.js";
import { sourceOf } from "./look/style.js";

/** @import { FeatureCollection, MapLibreMap, Position } from "./types.d.ts" */

const MIN_DISTANCE_M = 0.01;
const RADIANS = Math.PI / 180;

/**
 * Direction of a leg at its beginning, degrees from north, 0 to 359.
 *
 * @param {readonly number[]} from longitude, latitude
 * @param {readonly number[]} to
 */
export function bearing_deg([lon1, lat1], [lon2, lat2]) {
  const [a, b, turn] = [lat1 * RADIANS, lat2 * RADIANS, (lon2 - lon1) * RADIANS];
  const angle = Math.atan2(
    Math.sin(turn) * Math.cos(b),
    Math.cos(a) * Math.sin(b) - Math.sin(a) * Math.cos(b) * Math.cos(turn),
  );
  return (Math.round(angle / RADIANS) + 360) % 360;
}

/**
 * The features to draw: the path, the part to the pointer, and points with the length up to them.
 *
 * @param {Position[]} points
 * @param {Position | null} [pointer]
 */
export function measured(points, pointer = null) {
  /** @param {string} role @param {string} type @param {unknown} coordinates @param {string} [label] */
  const feature = (role, type, coordinates, label = "") => ({
    type: "Feature",
    properties: { role, label },
    geometry: { type, coordinates },
  });
  const features = points.map((position, index) =>
    feature("point", "Point", position, index ? lengthText(pathLength_m(points.slice(0, index + 1))) : ""),
  );
  if (points.length > 1) features.push(feature("path", "LineString", points));
  if (points.length && pointer) features.push(feature("next", "LineString", [points.at(-1), pointer]));
  return /** @type {FeatureCollection} */ ({ type: "FeatureCollection", features });
}

/** The sentence on a measurement. @param {Position[]} points @param {Position | null} [pointer] */
export function measureWords(points, pointer = null) {
  const all = pointer && points.length ? [...points, pointer] : points;
  if (all.length < 2)
    return points.length
      ? t("Click the next point.")
      : t("Click where to measure from, or press Enter for the middle of the map.");
  const [from, to] = all.slice(-2);
  const leg = distance_m(from, to);
  const words = [lengthText(pathLength_m(all))];
  if (all.length > 2) words.push(t("last leg {length}", { length: lengthText(leg) }));
  words.push(`${String(bearing_deg(from, to)).padStart(3, "0")}°`);
  if (all.length > 2) words.push(t("area {area}", { area: areaText(ringArea_m2(all)) }));
  return words.join(" · ");
}

/**
 * @typedef {object} MeasureOptions
 * @property {(isOn: boolean) => void} [onSwitch]
 * @property {() => boolean} [isBusy] whether another tool uses the pointer
 */

/**
 * @param {MapLibreMap} map
 * @param {HTMLElement} frame where the banner floats
 * @param {HTMLElement} button switches it
 * @param {MeasureOptions} [options]
 */
export const createMeasure = (map, frame, button, options) => new Measure(map, frame, button, options);

class Measure {
  #map;
  #frame;
  #button;
  #onSwitch;
  #isBusy;
  /** @type {Position[] | null} */
  #points = null; // null while nothing is measured
  /** @type {Position | null} */
  #pointer = null;
  #isDrawingDue = false;
  #words = h("span", { class: "measure-words" });
  #undo = h("button", { type: "button", class: "text-button" }, t("Remove the last point"));
  #banner;

  /** @param {MapLibreMap} map @param {HTMLElement} frame @param {HTMLElement} button @param {MeasureOptions} [options] */
  constructor(map, frame, button, { onSwitch = () => {}, isBusy = () => false } = {}) {
    this.#map = map;
    this.#frame = frame;
    this.#button = button;
    this.#onSwitch = onSwitch;
    this.#isBusy = isBusy;
    this.#undo.addEventListener("click", () => this.#removeLast());
    this.#banner = h(
      "div",
      { class: "map-banner measure-banner float", role: "group", "aria-label": t("Measuring"), hidden: true },
      this.#words,
      this.#undo,
      h("button", { type: "button", class: "text-button", onclick: this.end }, t("Done")),
    );
    frame.append(this.#banner);
    document.addEventListener("keydown", (event) => this.#press(event), true);
    button.addEventListener("click", () => (this.isOn() ? this.end() : this.start()));
  }

  isOn = () => this.#points !== null;

  /** @param {Position | null} [position] */
  start(position = null) {
    if (this.#isBusy()) return;
    this.#points = position ? [position] : [];
    this.#pointer = null;
    this.#frame.dataset.measuring = "true";
    this.#button.setAttribute("aria-pressed", "true");
    this.#draw();
    announce(this.#words.textContent ?? "");
    this.#onSwitch(true);
  }

  /** End measuring. Returns whether a measurement was active. */
  end = () => {
    if (this.#points === null) return false;
    this.#points = null;
    delete this.#frame.dataset.measuring;
    this.#button.setAttribute("aria-pressed", "false");
    this.#draw();
    this.#onSwitch(false);
    return true;
  };

  /** @param {Position} position */
  add(position) {
    const points = this.#points ?? [];
    const last = points.at(-1);
    if (last && last[0] === position[0] && last[1] === position[1]) return;
    this.#points = [...points, position];
    this.#pointer = null;
    this.#draw();
    announce(this.#words.textContent ?? "");
  }

  /** Where the pointer is; where it was clicked is a point already. @param {Position | null} position */
  at(position) {
    const last = this.#points?.at(-1);
    this.#pointer = last && position && distance_m(last, position) < MIN_DISTANCE_M ? null : position;
    if (this.#points === null || this.#isDrawingDue) return;
    this.#isDrawingDue = true;
    requestAnimationFrame(() => this.#draw());
  }

  #draw() {
    this.#isDrawingDue = false;
    sourceOf(this.#map, "measure")?.setData(measured(this.#points ?? [], this.#points ? this.#pointer : null));
    this.#banner.hidden = this.#points === null;
    if (this.#points === null) return;
    this.#words.textContent = measureWords(this.#points, this.#pointer);
    this.#undo.hidden = this.#points.length === 0;
  }

  #removeLast() {
    this.#points = (this.#points ?? []).slice(0, -1);
    this.#pointer = null;
    this.#draw();
  }

  /** @param {KeyboardEvent} event */
  #press(event) {
    if (this.#points === null || event.defaultPrevented || isTyping(event.target)) return;
    if (document.querySelector("dialog[open], .menu")) return;
    if (this.#actOf(event)) event.preventDefault();
  }

  /** The act of a key; returns whether the key has one. @param {KeyboardEvent} event */
  #actOf({ key, target }) {
    if (key === "Escape") return this.end();
    if (key === "Backspace" || key === "Delete") {
      if (!this.#points?.length) return false;
      this.#removeLast();
      return true;
    }
    if (key !== "Enter" || !(/** @type {Element} */ (target).matches("canvas, body"))) return false;
    const { lng, lat } = this.#map.getCenter();
    this.add([lng, lat]);
    return true;
  }
}
