/** Measuring on the map: points are clicked, lengths stand at them; three points or more also have an area. */

import { h } from "../dom.js";
import { distance_m, pathLength_m, ringArea_m2 } from "../domain/geodesy.js";
import { isTyping } from "../page/keyboard.js";
import { say } from "../page/toast.js";
import { t } from "../text.js";
import { areaText, lengthText } from "../units.js";

const NEAREST_M = 0.01;
const RADIANS = Math.PI / 180;

/** Direction of a leg at its beginning, degrees from north, 0 to 359. */
export function bearing_deg([lon1, lat1], [lon2, lat2]) {
  const [a, b, turn] = [lat1 * RADIANS, lat2 * RADIANS, (lon2 - lon1) * RADIANS];
  const angle = Math.atan2(
    Math.sin(turn) * Math.cos(b),
    Math.cos(a) * Math.sin(b) - Math.sin(a) * Math.cos(b) * Math.cos(turn),
  );
  return (Math.round(angle / RADIANS) + 360) % 360;
}

/** What is drawn: the path, what the pointer would add, and points with the length as far as them. */
export function measured(points, pointer = null) {
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
  return { type: "FeatureCollection", features };
}

/** The sentence of what has been measured. */
export function measureWords(points, pointer = null) {
  const all = pointer && points.length ? [...points, pointer] : points;
  if (all.length < 2)
    return points.length
      ? t("Click the next point.")
      : t("Click where to measure from, or press Enter for the middle of the map.");
  const leg = distance_m(all.at(-2), all.at(-1));
  const words = [lengthText(pathLength_m(all))];
  if (all.length > 2) words.push(t("last leg {length}", { length: lengthText(leg) }));
  words.push(`${String(bearing_deg(all.at(-2), all.at(-1))).padStart(3, "0")}°`);
  if (all.length > 2) words.push(t("area {area}", { area: areaText(ringArea_m2(all)) }));
  return words.join(" · ");
}

/** frame: where the banner floats. button: switches it, unless the pointer belongs to something else. onSwitch(isOn) tells of both. */
export function createMeasure(map, frame, button, { onSwitch = () => {}, isBusy = () => false } = {}) {
  let points = null; // null while nothing is measured
  let pointer = null;
  let waits = false;
  const words = h("span", { class: "measure-words" });
  const undo = h("button", { type: "button", class: "text-button", onclick: () => back() }, t("Remove the last point"));
  const banner = h(
    "div",
    { class: "map-banner measure-banner float", role: "group", "aria-label": t("Measuring"), hidden: true },
    words,
    undo,
    h("button", { type: "button", class: "text-button", onclick: () => end() }, t("Done")),
  );
  frame.append(banner);

  function draw() {
    waits = false;
    map.getSource("measure")?.setData(points ? measured(points, pointer) : measured([]));
    banner.hidden = points === null;
    if (points === null) return;
    words.textContent = measureWords(points, pointer);
    undo.hidden = points.length === 0;
  }

  function start(position = null) {
    if (isBusy()) return;
    points = position ? [position] : [];
    pointer = null;
    frame.dataset.measuring = "true";
    button.setAttribute("aria-pressed", "true");
    draw();
    say(words.textContent);
    onSwitch(true);
  }

  function end() {
    if (points === null) return false;
    points = null;
    delete frame.dataset.measuring;
    button.setAttribute("aria-pressed", "false");
    draw();
    onSwitch(false);
    return true;
  }

  function back() {
    points.pop();
    pointer = null;
    draw();
  }

  const add = (position) => {
    const last = points.at(-1);
    if (last && last[0] === position[0] && last[1] === position[1]) return;
    points.push(position);
    pointer = null;
    draw();
    say(words.textContent);
  };

  const acts = {
    Escape: end,
    Backspace: () => points.length > 0 && back(),
    Delete: () => points.length > 0 && back(),
    Enter: (target) => target.matches("canvas, body") && add(map.getCenter().toArray()),
  };
  document.addEventListener(
    "keydown",
    (event) => {
      if (
        points === null ||
        event.defaultPrevented ||
        isTyping(event.target) ||
        document.querySelector("dialog[open], .menu")
      )
        return;
      if (acts[event.key] && acts[event.key](event.target) !== false) event.preventDefault();
    },
    true,
  );
  button.addEventListener("click", () => (points === null ? start() : end()));
  return {
    isOn: () => points !== null,
    start,
    end,
    add,
    at(position) {
      const last = points?.at(-1);
      pointer = last && position && distance_m(last, position) < NEAREST_M ? null : position; // where the pointer was clicked is a point already
      if (points === null || waits) return;
      waits = true;
      requestAnimationFrame(draw);
    },
  };
}
