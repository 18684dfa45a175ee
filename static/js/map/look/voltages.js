/** Voltage bands of lines and towers, and their style; the names of the tiles and of the layers in them. */

/** @import { Palette } from "../../domain/palette.js" */

export const TILES = "ground-tiles";

/** Layers that a click or the pointer can meet, in the order of picking. */
export const PICKABLE = [
  "towers",
  "towers-high",
  "towers-ring",
  "bridges-fill",
  "bridges",
  "bridge-points",
  "railways",
  "lines",
  "lines-unknown",
  "zones-fill",
];

/** What the layers menu switches, and the layers behind it. */
export const GROUPS = [
  { key: "lines", layers: ["lines-casing", "lines", "lines-unknown", "line-labels"] },
  { key: "towers", layers: ["towers", "towers-high", "towers-ring", "tower-labels", "count-discs", "count-numbers"] },
  { key: "railways", layers: ["railways", "railways-ties"] },
  { key: "bridges", layers: ["bridges-fill", "bridges", "bridge-points"] },
  {
    key: "zones",
    layers: [
      "zones-fill",
      "zones-hatch",
      "zones-outline",
      "zones-outline-timed",
      "zones-outline-resting",
      "zones-lit",
      "zone-labels",
    ],
  },
];

/** @typedef {readonly unknown[]} Expression of MapLibre's style specification */

/** @type {Expression} */
export const voltage = ["coalesce", ["get", "voltage"], -1];
/** The value of a feature's band. @param {...unknown} values unknown, under 50, from 50, 100, 200, 380 kV @returns {Expression} */
export const bandsOf = (...values) => {
  const [unknown, under50, from50, from100, from200, from380] = values;
  return ["step", voltage, unknown, 0, under50, 50, from50, 100, from100, 200, from200, 380, from380];
};
/** Bands of voltage by their least kV, and the one of a feature. */
export const BANDS = ["380", "200", "100", "50", "0", "none"];
export const bandOf = bandsOf("none", "0", "50", "100", "200", "380");
/** @param {number | null | undefined} voltage_kv @returns {string} */
export const voltageBand = (voltage_kv) =>
  voltage_kv === undefined || voltage_kv === null ? "none" : (BANDS.find((band) => voltage_kv >= Number(band)) ?? "0");
/** Colour of a voltage in kV, for the legend and the tests. @param {Palette} palette @param {number | null | undefined} voltage_kv */
export function voltageColour(palette, voltage_kv) {
  if (voltage_kv === null || voltage_kv === undefined) return palette.voltUnknown;
  /** @type {[number, "volt400" | "volt220" | "volt132" | "volt66"][]} */
  const steps = [
    [380, "volt400"],
    [200, "volt220"],
    [100, "volt132"],
    [50, "volt66"],
  ];
  return palette[steps.find(([least]) => voltage_kv >= least)?.[1] ?? "volt20"];
}
