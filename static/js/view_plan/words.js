/** A plan of photos in words: coverage by kind of component, the model's assumptions, and why nothing can be shown. */

import { gsdAt_mm, gsdText, standoff_m } from "../cameras/words.js";
import { t, tn } from "../text.js";
import { exactHeightText, percentText, voltageText } from "../units.js";

/** @import { BridgeModel, ComponentCoverage, TowerModel, ViewPlan } from "../api_types.d.ts" */

/** @typedef {NonNullable<ComponentCoverage["limit"]>} Limit */
/**
 * Coverage of all components of one kind. ofReachable and unreachable: shares, 0 to 1; limit: what limits most of the unreachable part.
 *
 * @typedef {object} KindCoverage
 * @property {string} kind
 * @property {number | null} ofReachable null where nothing can be shown
 * @property {number} unreachable
 * @property {number | null} gsd_mm
 * @property {Limit | null} limit
 */

const NEGLIGIBLE = 0.005; // a share that rounds to 0 %

/** @type {Record<string, string>} */
export const COMPONENTS = {
  foundation: t("Foundations"),
  plate: t("Number plate"),
  body: t("Body"),
  head: t("Head"),
  crossarm: t("Crossarms"),
  string: t("Insulator strings"),
  clamp: t("Clamps"),
  earth_wire_peak: t("Earth-wire peaks"),
  guy: t("Guys"),
  wires: t("Wires"),
  deck: t("Deck"),
  face: t("Side faces"),
  underside: t("Underside"),
  pier: t("Piers"),
  abutment: t("Abutments"),
};

/** @type {Record<Limit, string>} */
const LIMITS = {
  hidden: t("hidden by other parts"),
  height: t("only from below the least height"),
  gimbal: t("outside the gimbal's range"),
  distance: t("too far from outside the clearance"),
};

/** @type {Record<string, string>} */
const FORMS = {
  lattice: t("lattice tower"),
  tubular: t("tubular tower"),
  wooden: t("wooden pole"),
  "h-frame": t("H-frame"),
  portal: t("portal"),
  guyed: t("guyed tower"),
  stake: t("bend without a mapped support"),
};

/** "Model: lattice tower, 50 m (assumed), 380 kV, suspension." @param {TowerModel} model */
export function modelText({ form, height_m, height_source: source, voltage_v, is_anchor: isAnchor }) {
  const height = exactHeightText(height_m);
  const heights = {
    tag: height,
    line: t("{height} (from its line)", { height }),
    assumed: t("{height} (assumed)", { height }),
  };
  const facts = [
    FORMS[form] ?? form,
    heights[source],
    voltage_v ? voltageText(voltage_v / 1000) : t("voltage unknown"),
    isAnchor ? t("tension") : t("suspension"),
  ];
  return t("Model: {facts}.", { facts: facts.join(", ") });
}

/**
 * "Model: deck 8 m above ground (estimated), 60 m × 12 m, counted as 34 m high, 1 pier (position assumed)." @param {BridgeModel} bridge
 */
export function bridgeText({ deck_height_m, deck_source: source, top_m, length_m, width_m, piers }) {
  const height = exactHeightText(deck_height_m);
  const facts = [
    source === "tag"
      ? t("deck {height} above ground", { height })
      : t("deck {height} above ground (estimated)", { height }),
    `${exactHeightText(length_m)} × ${exactHeightText(width_m)}`,
    t("counted as {height} high", { height: exactHeightText(top_m) }),
    piers > 0 && tn(piers, "{count} pier (position assumed)", "{count} piers (positions assumed)"),
  ];
  return t("Model: {facts}.", { facts: facts.filter(Boolean).join(", ") });
}

/** What a tower or a bridge is taken to look like. @param {ViewPlan} plan */
export const assumedText = ({ model, bridge }) => (bridge ? bridgeText(bridge) : model ? modelText(model) : "");

/** The limit of most of the area that cannot be shown. @param {readonly ComponentCoverage[]} rows @returns {Limit | null} */
function mainLimit(rows) {
  /** @type {Map<Limit, number>} */
  const areas = new Map();
  for (const { limit, area_m2, reachable } of rows)
    if (limit) areas.set(limit, (areas.get(limit) ?? 0) + area_m2 * (1 - reachable));
  return [...areas].sort(([, a], [, b]) => b - a)[0]?.[0] ?? null;
}

/** By kind, in the order in which kinds first come. @param {readonly ComponentCoverage[]} rows @returns {KindCoverage[]} */
export function byKind(rows) {
  return [...new Set(rows.map(({ component }) => component))].map((kind) => {
    const own = rows.filter(({ component }) => component === kind);
    /** @param {(row: ComponentCoverage) => number} share */
    const area_m2 = (share) => own.reduce((sum, row) => sum + row.area_m2 * share(row), 0);
    const reachable_m2 = area_m2(({ reachable }) => reachable);
    const gsds_mm = own.flatMap(({ gsd_mm }) => (gsd_mm === null ? [] : [gsd_mm]));
    return {
      kind,
      ofReachable: reachable_m2 > 0 ? Math.min(1, area_m2(({ shown }) => shown) / reachable_m2) : null,
      unreachable: 1 - reachable_m2 / area_m2(() => 1),
      gsd_mm: gsds_mm.length ? Math.max(...gsds_mm) : null,
      limit: mainLimit(own),
    };
  });
}

/** "12 % hidden by other parts"; "" where all can be shown. @param {KindCoverage} row */
export const restText = ({ unreachable, limit }) =>
  unreachable < NEGLIGIBLE ? "" : `${shareText(unreachable)}${limit ? ` ${LIMITS[limit]}` : ""}`;

/** Rounded down: less than all is not 100 %. @param {number} share */
export const shareText = (share) => percentText(Math.floor(share * 100 + 1e-9));

/** Why a plan without photos shows nothing, and what to change. @param {ViewPlan} plan */
export function nothingText({ pattern, camera, gsd_mm, clearance_m, coverage }) {
  if (pattern === "overview")
    return t(
      "The whole of it does not fit into a picture of this camera. Choose a wider lens, or photos of every part.",
    );
  const clearance = exactHeightText(clearance_m);
  const distance_m = standoff_m(camera, gsd_mm);
  const focus_m = camera.nearest_focus_m ?? 0;
  if (distance_m < clearance_m && focus_m <= clearance_m)
    return t(
      "This camera shows {gsd} at the clearance of {clearance} at best. Choose a longer lens or a coarser GSD.",
      { gsd: gsdText(gsdAt_mm(camera, clearance_m)), clearance },
    );
  if (distance_m <= focus_m)
    return t("This camera focuses from {distance} on and shows {gsd} there. Choose a coarser GSD.", {
      distance: exactHeightText(focus_m),
      gsd: gsdText(gsdAt_mm(camera, focus_m)),
    });
  const limit = mainLimit(coverage.components);
  if (pattern === "spans" && limit === "distance")
    return t(
      "This camera is too coarse from outside the clearance of swinging wires. Choose a longer lens or a coarser GSD.",
    );
  if (pattern === "spans" && limit) return t("Most of the wires: {reason}.", { reason: LIMITS[limit] });
  return limit
    ? t("Most of the surface: {reason}.", { reason: LIMITS[limit] })
    : t("Choose another camera or a coarser GSD.");
}
