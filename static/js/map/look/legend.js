/** The legend of the map's symbols. On the map it lists those in view, in the layers menu all of them. */

import { byId, h, svg } from "../../dom.js";
import { AGES, ageOf, tintOf } from "../../domain/inspection_age.js";
import { t } from "../../text.js";
import { bandName } from "./shown.js";
import { voltageBand } from "./voltages.js";

/** @import { MapGeoJSONFeature } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { MapLibreMap } from "../types.d.ts" */

/** @param {...SVGElement} drawing */
const sample = (...drawing) =>
  svg("svg", { width: 26, height: 12, viewBox: "0 0 26 12", "aria-hidden": "true" }, drawing);
/** @param {string} token @param {number} width @param {Record<string, string>} [rest] */
const stroke = (token, width, rest = {}) =>
  svg("path", { d: "M1 6H25", stroke: `var(${token})`, "stroke-width": width, fill: "none", ...rest });

/** @param {string} token @param {number} width @param {Record<string, string>} [rest] */
const line = (token, width, rest) => () => sample(stroke(token, width, rest));

/** @param {number} accent of AGES */
const band = (accent) => sample(svg("path", { d: "M1 6H25", stroke: tintOf(accent), "stroke-width": 8 }));

/** @typedef {{ layer: string, words: string, draw: () => SVGElement, band?: string, kind?: string }} Row */

/** Of open findings, by the worst at a place. */
const SEVERITY_ROWS = [
  { severity: "1", words: t("Findings: danger"), token: "--critical" },
  { severity: "2", words: t("Findings: repair"), token: "--warning" },
  { severity: "3", words: t("Findings: watch or no action"), token: "--advisory" },
];

/** Rows: the layer that shows it is in view, words, drawing. @type {Row[]} */
const ROWS = [
  { layer: "lines", words: bandName("380"), band: "380", draw: line("--volt-400", 3) },
  { layer: "lines", words: bandName("200"), band: "200", draw: line("--volt-220", 2.2) },
  { layer: "lines", words: bandName("100"), band: "100", draw: line("--volt-132", 1.6) },
  { layer: "lines", words: bandName("50"), band: "50", draw: line("--volt-66", 1.1) },
  { layer: "lines", words: bandName("0"), band: "0", draw: line("--volt-20", 0.9) },
  {
    layer: "lines-unknown",
    words: bandName("none"),
    band: "none",
    draw: line("--volt-unknown", 1.3, { "stroke-dasharray": "5 3" }),
  },
  {
    layer: "railways",
    words: t("Railway"),
    draw: () => sample(stroke("--railway", 2.6), stroke("--ground", 1.3, { "stroke-dasharray": "5 5" })),
  },
  {
    layer: "bridges",
    words: t("Bridge"),
    draw: () => sample(svg("path", { d: "M1 4H25M1 8H25", stroke: "var(--bridge)", "stroke-width": 1.5 })),
  },
  {
    layer: "zones-fill",
    words: t("No-fly zone"),
    draw: () =>
      sample(
        svg("rect", {
          x: 3,
          y: 1,
          width: 20,
          height: 10,
          fill: "var(--zone-fill)",
          stroke: "var(--zone)",
          "stroke-width": 1.3,
        }),
        svg("path", { d: "M5 10l8-8M11 10l8-8M17 10l5-5", stroke: "var(--zone)", "stroke-width": 0.9 }),
      ),
  },
  {
    layer: "zones-fill",
    kind: "timed",
    words: t("No-fly zone at times"),
    draw: () =>
      sample(
        svg("rect", {
          x: 3,
          y: 1,
          width: 20,
          height: 10,
          fill: "var(--zone-fill)",
          stroke: "var(--zone)",
          "stroke-width": 1.3,
          "stroke-dasharray": "6 1.5 1 1.5",
        }),
        svg("path", { d: "M5 9l3-3M10 5l3-3M11 9l3-3M16 5l3-3M17 9l3-3", stroke: "var(--zone)", "stroke-width": 0.9 }),
      ),
  },
  {
    layer: "zones-fill",
    kind: "resting",
    words: t("No-fly zone, not in force now"),
    draw: () =>
      sample(
        svg("rect", {
          x: 3,
          y: 1,
          width: 20,
          height: 10,
          fill: "var(--zone-fill)",
          stroke: "var(--zone)",
          "stroke-width": 1.3,
          "stroke-dasharray": "4 3",
        }),
      ),
  },
  {
    layer: "towers-ring",
    words: t("Tower"),
    draw: () =>
      sample(
        svg("circle", { cx: 13, cy: 6, r: 3, fill: "var(--ground)", stroke: "var(--tower)", "stroke-width": 1.4 }),
      ),
  },
  ...AGES.map(({ key, words, accent }) => ({ layer: "inspections", kind: key, words, draw: () => band(accent) })),
  ...SEVERITY_ROWS.map(({ severity, words, token }) => ({
    layer: "findings",
    kind: severity,
    words,
    draw: () => sample(svg("circle", { cx: 13, cy: 6, r: 5, fill: `var(${token})` })),
  })),
  {
    layer: "routes",
    words: t("Route, flown to the arrow"),
    draw: () =>
      sample(
        stroke("--route-1", 3),
        svg("path", {
          d: "M17 6L10 2L12 6L10 10Z",
          fill: "var(--route-1)",
          stroke: "var(--map-casing)",
          "stroke-width": 1,
        }),
      ),
  },
  {
    layer: "route-stops",
    kind: "charging",
    words: t("Charging stop"),
    draw: () =>
      sample(
        svg("circle", { cx: 13, cy: 6, r: 5.25, fill: "var(--raised)", stroke: "var(--ink)", "stroke-width": 1.25 }),
        svg("path", { d: "M13.7 2L10.5 6.8H12.7L12.2 10L15.5 5.3H13.2Z", fill: "var(--ink)" }),
      ),
  },
  {
    layer: "route-stops",
    kind: "base",
    words: t("Base between two flights"),
    draw: () =>
      sample(
        svg("rect", {
          x: 9,
          y: 2,
          width: 8,
          height: 8,
          fill: "var(--raised)",
          stroke: "var(--ink)",
          "stroke-width": 1.5,
        }),
      ),
  },
  {
    layer: "lost-link-quiet",
    words: t("Way back without a link"),
    draw: line("--ink-2", 1, { "stroke-dasharray": "2 3" }),
  },
  {
    layer: "lost-link-lines",
    words: t("Way back without a link that fails"),
    draw: () =>
      sample(
        stroke("--critical", 1.5, { "stroke-dasharray": "4 3" }),
        svg("circle", { cx: 4, cy: 6, r: 3, fill: "var(--raised)", stroke: "var(--critical)", "stroke-width": 1.75 }),
      ),
  },
  {
    layer: "many-targets",
    words: t("Target"),
    draw: () =>
      sample(
        svg("circle", { cx: 13, cy: 6, r: 4.5, fill: "var(--raised)", stroke: "var(--ink-2)", "stroke-width": 1.75 }),
      ),
  },
];

/** Layers that the rows of another one explain. @type {Record<string, string>} */
const SAME_ROWS = { "inspections-points": "inspections" };

/** UAVs are HTML on the map, not a layer. */
const UAV_ROW = {
  words: t("UAV"),
  draw: () => {
    const look = { fill: "var(--map-casing)", stroke: "var(--ink-2)", "stroke-width": 1.3, "stroke-linejoin": "round" };
    return sample(
      svg("circle", { cx: 6, cy: 6, r: 4, ...look }),
      svg("path", { d: "M19 1L24 11L19 8.5L14 11Z", ...look }),
    ); // with and without a heading
  },
};

/** @param {Pick<Row, "words" | "draw">[]} rows */
const items = (rows) => rows.map(({ words, draw }) => h("li", {}, draw(), words));

/** All rows, for where there is room. */
export const legendItems = () => items([...ROWS, UAV_ROW]);

/** The small drawing of a voltage band. @param {string} band */
export const bandSample = (band) => ROWS.find((row) => row.band === band)?.draw() ?? null;

/** @param {Element} element @param {Element} frame */
function isWithin(element, frame) {
  const [inner, outer] = [element.getBoundingClientRect(), frame.getBoundingClientRect()];
  return inner.right > outer.left && inner.left < outer.right && inner.bottom > outer.top && inner.top < outer.bottom;
}

/** @param {string} layer @param {string} [kind] */
const keyOf = (layer, kind = "") => `${layer}/${kind}`;

/**
 * Which of a layer's rows shows a feature: by its voltage, or whether a zone has times and is out of force now.
 *
 * @param {MapGeoJSONFeature} feature
 * @returns {string}
 */
function kindOf({ layer, properties, state }) {
  if (layer.id === "lines") return voltageBand(properties.voltage);
  if (layer.id === "route-stops") return properties.kind;
  if (layer.id === "findings") return String(Math.min(properties.worst ?? properties.severity, 3));
  if (layer.id.startsWith("inspections")) return ageOf(properties.inspected_s);
  if (layer.id !== "zones-fill" || properties.schedule === undefined) return "";
  return state.resting ? "resting" : "timed";
}

/** Show a legend of the symbols in view. @param {MapLibreMap} map */
export function mountLegend(map) {
  const legend = byId("legend");
  let shown = "";
  map.on("idle", () => {
    const layers = [...new Set([...ROWS.map((row) => row.layer), ...Object.keys(SAME_ROWS)])].filter((id) =>
      map.getLayer(id),
    );
    const seen = new Set();
    for (const feature of map.queryRenderedFeatures({ layers }))
      seen.add(keyOf(SAME_ROWS[feature.layer.id] ?? feature.layer.id, kindOf(feature)));
    const rows = ROWS.filter((row) => seen.has(keyOf(row.layer, row.kind ?? (row.layer === "lines" ? row.band : ""))));
    if ([...map.getContainer().querySelectorAll(".map-dart")].some((dart) => isWithin(dart, map.getContainer())))
      rows.push({ layer: "", ...UAV_ROW });
    const words = rows.map((row) => row.words).join();
    if (words === shown) return;
    shown = words;
    legend.hidden = rows.length === 0;
    legend.replaceChildren(...items(rows));
  });
}
