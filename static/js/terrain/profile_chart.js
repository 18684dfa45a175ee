/** The profile as a drawing: the ground from the side, towers that stand on it, and one cursor. */

import { svg } from "../dom.js";
import { t, tn } from "../text.js";
import { heightText, lengthText, numberText } from "../units.js";

/** @import { AssetFeature, Profile } from "../api_types.d.ts" */

export const EDGES = { left: 52, right: 14, top: 14, bottom: 20 };
/**
 * A tower at a vertex of the profile's line; unknown values are null.
 *
 * @typedef {object} TowerAlong
 * @property {number} index of the sample
 * @property {string} label
 * @property {number} distance_m
 * @property {number | null} ground_amsl_m
 * @property {number | null} height_m
 * @property {number | null} top_amsl_m
 */
/** @typedef {Pick<Profile, "length_m" | "distance_m" | "positions" | "ground_amsl_m" | "lowest_m" | "highest_m">} ProfileLine */
/** @typedef {NonNullable<ReturnType<typeof scalesOf>>} Scales */

const MIN_SPAN_M = 20; // so that a plain does not look mountainous
const UNTOLD_TOWER_PX = 12; // of a tower with an unknown height; drawn broken
const RULES = 3;

/**
 * Stretches of a profile where the ground is known, and where not: [{ isKnown, from, to }], indices, both ends in.
 *
 * @param {(number | null)[]} heights_m
 */
export function stretchesOf(heights_m) {
  /** @type {{ isKnown: boolean, from: number, to: number }[]} */
  const found = [];
  heights_m.forEach((height_m, index) => {
    const isKnown = height_m !== null;
    const last = found.at(-1);
    if (last && last.isKnown === isKnown) last.to = index;
    else found.push({ isKnown, from: index, to: index });
  });
  return found;
}

/** Round heights for rules, at most three, from within the span. @param {number} low_m @param {number} high_m */
export function rulesOf(low_m, high_m) {
  const rough = (high_m - low_m) / RULES;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10]
    .map((factor) => factor * power)
    .find((candidate) => Math.floor(high_m / candidate) - Math.ceil(low_m / candidate) < RULES);
  if (!step) return [];
  const rules = [];
  for (let height = Math.ceil(low_m / step) * step; height <= high_m; height += step) rules.push(height);
  return rules;
}

/**
 * Scales for a profile with its towers in a drawing of this size [px]. Null where no terrain is known.
 *
 * @param {ProfileLine} profile
 * @param {TowerAlong[]} towers
 * @param {number} width
 * @param {number} height
 */
export function scalesOf(profile, towers, width, height) {
  const tops = towers.map(({ top_amsl_m }) => top_amsl_m);
  const known = [...profile.ground_amsl_m, ...tops].filter((height_m) => height_m !== null);
  if (!known.length) return null;
  const lowest = known.reduce((a, b) => Math.min(a, b));
  const highest = known.reduce((a, b) => Math.max(a, b));
  const room = Math.max(0, MIN_SPAN_M - (highest - lowest)) / 2;
  const [low, high] = [lowest - room, highest + room];
  const [wide, tall] = [width - EDGES.left - EDGES.right, height - EDGES.top - EDGES.bottom];
  return {
    low,
    high,
    /** @param {number} distance_m */
    x: (distance_m) => EDGES.left + (profile.length_m > 0 ? (distance_m / profile.length_m) * wide : 0),
    /** @param {number} height_m */
    y: (height_m) => EDGES.top + ((high - height_m) / (high - low)) * tall,
    /** @param {number} x */
    distanceAt: (x) => Math.min(1, Math.max(0, (x - EDGES.left) / wide)) * profile.length_m,
  };
}

/**
 * The index of the sample nearest to a distance along the line; distances rise.
 *
 * @param {number[]} distances_m
 * @param {number} distance_m
 */
export function nearestSample(distances_m, distance_m) {
  let [low, high] = [0, distances_m.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (distances_m[middle] <= distance_m) low = middle;
    else high = middle;
  }
  return distance_m - distances_m[low] <= distances_m[high] - distance_m ? low : high;
}

/** @param {number[]} position */
const placeKey = ([longitude, latitude]) => `${longitude.toFixed(6)} ${latitude.toFixed(6)}`;

/**
 * Towers (features) at vertices of the profile's line, along it. Unknown values are null.
 *
 * @param {ProfileLine} profile
 * @param {AssetFeature[]} features
 * @returns {TowerAlong[]}
 */
export function towersAlong(profile, features) {
  const byPlace = new Map(
    features.map((feature) => [placeKey(/** @type {number[]} */ (feature.geometry.coordinates)), feature]),
  );
  return profile.positions.flatMap((position, index) => {
    const feature = byPlace.get(placeKey(position));
    if (!feature) return [];
    const ground = profile.ground_amsl_m[index];
    const height = feature.properties.height_m ?? null;
    return [
      {
        index,
        label: feature.properties.label,
        distance_m: profile.distance_m[index],
        ground_amsl_m: ground,
        height_m: height,
        top_amsl_m: ground === null || height === null ? null : ground + height,
      },
    ];
  });
}

/** The whole profile in a sentence. @param {ProfileLine} profile @param {TowerAlong[]} [towers] */
export function profileSentence(profile, towers = []) {
  const known = profile.ground_amsl_m.filter((ground) => ground !== null).length;
  const long = lengthText(profile.length_m);
  if (!known) return t("{length}; no terrain model knows the ground here.", { length: long });
  const unknown = profile.ground_amsl_m.length - known;
  const parts = [
    t("{length}, ground from {low} to {high} above sea level", {
      length: long,
      low: heightText(profile.lowest_m ?? 0),
      high: heightText(profile.highest_m ?? 0),
    }),
  ];
  if (towers.length) parts.push(tn(towers.length, "{count} tower", "{count} towers"));
  if (unknown)
    parts.push(
      tn(unknown, "unknown at {count} place of {all}", "unknown at {count} places of {all}", {
        all: numberText(profile.ground_amsl_m.length),
      }),
    );
  return `${parts.join(", ")}.`;
}

/**
 * Rows of the table behind the drawing: each tower, both ends, and places between, some fifty in all.
 *
 * @param {ProfileLine} profile
 * @param {TowerAlong[]} towers
 * @param {number} [most]
 */
export function rowsOf(profile, towers, most = 40) {
  const last = profile.distance_m.length - 1;
  const step = Math.max(1, Math.ceil(last / most));
  const byIndex = new Map(towers.map((tower) => [tower.index, tower]));
  const wanted = new Set([last, ...byIndex.keys()]);
  for (let index = 0; index < last; index += step) wanted.add(index);
  return [...wanted]
    .sort((a, b) => a - b)
    .map((index) => ({
      index,
      distance_m: profile.distance_m[index],
      ground_amsl_m: profile.ground_amsl_m[index],
      tower: byIndex.get(index) ?? null,
    }));
}

/**
 * Draws it. point(index) shows the cursor at a sample, null hides it.
 *
 * @param {ProfileLine} profile
 * @param {TowerAlong[]} towers
 * @param {number} width [px]
 * @param {number} height [px]
 * @returns {{ element: SVGSVGElement, scales?: Scales, point: (index: number | null) => void }}
 */
export function drawProfile(profile, towers, width, height) {
  const scales = scalesOf(profile, towers, width, height);
  const element = svg("svg", {
    class: "profile-chart",
    width,
    height,
    viewBox: `0 0 ${width} ${height}`,
    role: "img",
    "aria-label": profileSentence(profile, towers),
  });
  if (!scales) return { element, point: () => {} };
  const floor = height - EDGES.bottom;
  drawRules(element, scales, width);
  for (const { isKnown, from, to } of stretchesOf(profile.ground_amsl_m)) {
    if (isKnown) drawGround(element, profile, from, to, scales, floor);
    else drawUnknown(element, profile, from, to, scales, floor);
  }
  drawTowers(element, towers, scales);
  const end = { class: "tick", x: width - EDGES.right, y: height - 5, "text-anchor": "end" };
  element.append(
    svg("text", { class: "tick", x: EDGES.left, y: height - 5 }, heightText(0)),
    svg("text", end, lengthText(profile.length_m)),
  );
  return { element, scales, point: cursorOf(element, profile, scales, floor) };
}

/** @param {SVGElement} element @param {Scales} scales @param {number} width [px] */
function drawRules(element, { low, high, y }, width) {
  for (const rule of rulesOf(low, high)) {
    element.append(
      svg("line", { class: "rule", x1: EDGES.left, x2: width - EDGES.right, y1: y(rule), y2: y(rule) }),
      svg("text", { class: "tick", x: EDGES.left - 8, y: y(rule) + 4, "text-anchor": "end" }, heightText(rule)),
    );
  }
}

/** @param {SVGElement} element @param {TowerAlong[]} towers @param {Scales} scales */
function drawTowers(element, towers, { x, y }) {
  for (const { ground_amsl_m, top_amsl_m, distance_m } of towers) {
    if (ground_amsl_m === null) continue;
    const [at, foot] = [x(distance_m), y(ground_amsl_m)];
    const top = top_amsl_m === null ? foot - UNTOLD_TOWER_PX : y(top_amsl_m);
    const look = top_amsl_m === null ? "tower untold" : "tower";
    element.append(svg("line", { class: look, x1: at, x2: at, y1: foot, y2: top }));
  }
}

/**
 * Adds the cursor, and returns what moves it.
 *
 * @param {SVGElement} element
 * @param {ProfileLine} profile
 * @param {Scales} scales
 * @param {number} floor [px]
 * @returns {(index: number | null) => void}
 */
function cursorOf(element, profile, { x, y }, floor) {
  const line = svg("line", { class: "cursor", y1: EDGES.top, y2: floor });
  const dot = svg("circle", { class: "cursor-dot", r: 4 });
  const cursor = svg("g", { visibility: "hidden" }, line, dot);
  element.append(cursor);
  return (index) => {
    cursor.setAttribute("visibility", index === null ? "hidden" : "visible");
    if (index === null) return;
    const [at, ground] = [String(x(profile.distance_m[index])), profile.ground_amsl_m[index]];
    line.setAttribute("x1", at);
    line.setAttribute("x2", at);
    dot.setAttribute("visibility", ground === null ? "hidden" : "inherit");
    dot.setAttribute("cx", at);
    dot.setAttribute("cy", String(ground === null ? floor : y(ground)));
  };
}

/**
 * @param {SVGElement} element
 * @param {ProfileLine} profile
 * @param {number} from
 * @param {number} to
 * @param {Scales} scales
 * @param {number} floor [px]
 */
function drawGround(element, profile, from, to, { x, y }, floor) {
  /** @type {string[]} */
  const points = [];
  for (let index = from; index <= to; index += 1)
    points.push(`${x(profile.distance_m[index]).toFixed(1)} ${y(profile.ground_amsl_m[index] ?? 0).toFixed(1)}`);
  const [start, end] = [x(profile.distance_m[from]), x(profile.distance_m[to])];
  element.append(
    svg("path", { class: "ground", d: `M${start} ${floor}L${points.join("L")}L${end} ${floor}Z` }),
    svg("path", { class: "ground-edge", d: `M${points.join("L")}` }),
  );
}

/**
 * From the last place that is known to the next one.
 *
 * @param {SVGElement} element
 * @param {ProfileLine} profile
 * @param {number} from
 * @param {number} to
 * @param {Scales} scales
 * @param {number} floor [px]
 */
function drawUnknown(element, profile, from, to, { x }, floor) {
  const start = x(profile.distance_m[Math.max(0, from - 1)]);
  const end = x(profile.distance_m[Math.min(profile.distance_m.length - 1, to + 1)]);
  element.append(
    svg("rect", {
      class: "unknown",
      x: start,
      y: EDGES.top,
      width: Math.max(1, end - start),
      height: floor - EDGES.top,
    }),
  );
  if (end - start > 80)
    element.append(
      svg(
        "text",
        { class: "unknown-words", x: (start + end) / 2, y: EDGES.top + 16, "text-anchor": "middle" },
        t("No terrain"),
      ),
    );
}
