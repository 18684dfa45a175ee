/** Elements around the map: scale, coordinates, attribution, tooltip. */

import { byId, find } from "../dom.js";
import { coordinateText, lengthText } from "../units.js";

/** @import { MapLibreMap, Position, ScreenPoint, Tip } from "./types.d.ts" */

const TIP_AFTER_MS = 300;
const MAX_SCALE_WIDTH_PX = 90;

/** The longest round distance that is at most 90 px: { length_m, width_px }. @param {number} metres_per_px */
export function scaleOf(metres_per_px) {
  const most = metres_per_px * MAX_SCALE_WIDTH_PX;
  const power = 10 ** Math.floor(Math.log10(most));
  const length_m = [5, 2].map((factor) => factor * power).find((candidate) => candidate <= most) ?? power;
  return { length_m, width_px: length_m / metres_per_px };
}

/** "2 km" of "2.0 km" and "2,0 km"; thousands stay as they are. @param {string} length */
export const roundText = (length) => length.replace(/[.,]0(?!\d)/, "");

/** @param {MapLibreMap} map */
export function mountScale(map) {
  const scale = byId("scale");
  const draw = () => {
    const latitude = map.getCenter().lat;
    const metres_per_px = (40_075_016.686 * Math.cos((latitude * Math.PI) / 180)) / (512 * 2 ** map.getZoom());
    const { length_m, width_px } = scaleOf(metres_per_px);
    find(scale, "span").textContent = roundText(lengthText(length_m));
    find(scale, "i").style.width = `${width_px}px`;
  };
  map.on("move", draw);
  draw();
}

export function mountCoordinates() {
  const place = byId("coordinates");
  /** @param {Position | null} position */
  return (position) => {
    place.textContent = position ? coordinateText(position) : "";
  };
}

/** Each source once; "© X" is left out beside "© X, licence". @param {string[]} sources */
export function distinct(sources) {
  const all = [...new Set(sources)];
  return all.filter((source) => !all.some((other) => other !== source && other.startsWith(`${source},`)));
}

/** @param {(string | false | null | undefined)[]} sources */
export function setAttribution(sources) {
  byId("attribution").textContent = distinct(sources.flatMap((source) => source || [])).join(" · ");
}

/**
 * Show text beside the pointer after 300 ms, at once with `soon`; null hides it. `make` receives a function that replaces the text later.
 *
 * @param {HTMLElement} frame
 * @returns {Tip}
 */
export function createTip(frame) {
  const tip = byId("map-tip");
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  /** @type {string | null} */
  let current = null;
  let at = { x: 0, y: 0 };
  /** @param {ScreenPoint} point */
  const place = (point) => {
    at = point;
    const [width, height] = [tip.offsetWidth, tip.offsetHeight];
    const left = at.x + 14 + width > frame.clientWidth ? at.x - width - 14 : at.x + 14;
    const top = at.y + 14 + height > frame.clientHeight ? at.y - height - 14 : at.y + 14;
    tip.style.transform = `translate(${Math.max(6, left)}px, ${Math.max(6, top)}px)`;
  };
  const hide = () => {
    clearTimeout(timer);
    tip.hidden = true;
    current = null;
  };
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && !tip.hidden) hide();
  });
  return (key, point, make, { soon = false } = {}) => {
    if (key === null || !point || !make) {
      hide();
      return;
    }
    if (key === current && !soon) {
      if (tip.hidden) at = point;
      else place(point);
      return;
    }
    hide();
    current = key;
    at = point;
    /** @param {(Node | string)[]} content */
    const fill = (content) => {
      if (current !== key) return;
      tip.replaceChildren(...content);
      tip.hidden = false;
      place(at);
    };
    timer = setTimeout(() => fill(make(fill)), soon ? 0 : TIP_AFTER_MS);
  };
}
