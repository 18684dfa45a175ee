/** Map data shown: kinds, voltages, zones out of force. Zones out of force are drawn as such. */

import { isInForce } from "../../domain/zones_in_force.js";
import { t } from "../../text.js";
import { BANDS, bandOf, GROUPS, TILES } from "./voltages.js";

/** @import { FilterSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { MapLibreMap } from "../types.d.ts" */

/** @typedef {ReturnType<typeof createShown>} Shown */

const LOOK_AGAIN_MS = 60_000;
const ZONE_LAYERS = ["zones", "zone_labels"];

/** @type {Record<string, string>} */
const GROUP_NAMES = {
  lines: t("Power lines"),
  towers: t("Towers"),
  railways: t("Railways"),
  bridges: t("Bridges"),
  zones: t("No-fly zones"),
};
/** @param {string} key */
export const groupName = (key) => GROUP_NAMES[key];

/** @type {Record<string, string>} */
const BAND_NAMES = {
  380: t("380 kV and over"),
  200: t("200 to 379 kV"),
  100: t("100 to 199 kV"),
  50: t("50 to 99 kV"),
  0: t("under 50 kV"),
  none: t("Voltage not stated"),
};
/** @param {string} key of BANDS */
export const bandName = (key) => BAND_NAMES[key];

/**
 * Filter of a layer without some voltages and some zones; `own` is the filter of the style. Without exclusions the result is `own`.
 *
 * @param {FilterSpecification | null} own
 * @param {{ group: string, bands: Set<string>, resting: number[] }} hidden
 * @returns {FilterSpecification | null}
 */
export function filterOf(own, { group, bands, resting }) {
  /** @type {unknown[]} */
  const more = [];
  if ((group === "lines" || group === "towers") && bands.size)
    more.push(["!", ["in", bandOf, ["literal", [...bands]]]]);
  if (group === "zones" && resting.length) more.push(["!", ["in", ["id"], ["literal", resting]]]);
  if (!more.length) return own ?? null;
  return /** @type {FilterSpecification} */ (/** @type {unknown} */ (["all", ...(own ? [own] : []), ...more]));
}

/** onChange() is called when the hidden features change. @param {MapLibreMap} map @param {() => void} [onChange] */
export function createShown(map, onChange = () => {}) {
  /** @type {Set<string>} */
  const groups = new Set(); // hidden ones
  /** @type {Set<string>} */
  const bands = new Set(); // hidden ones
  /** @type {Map<string, FilterSpecification | null>} */
  const own = new Map(); // layer → filter of the style
  let hidesResting = false;
  /** @type {number[]} */
  let resting = [];

  /** @param {string} [only] key of a group */
  function filterLayers(only) {
    for (const { key, layers } of GROUPS) {
      if (only && key !== only) continue;
      for (const id of layers) {
        if (!own.has(id)) own.set(id, map.getFilter(id) ?? null);
        map.setFilter(id, filterOf(own.get(id) ?? null, { group: key, bands, resting: hidesResting ? resting : [] }));
      }
    }
  }

  watchRestingZones(map, (next) => {
    resting = next;
    if (hidesResting) filterLayers("zones");
  });

  function changed() {
    filterLayers();
    onChange();
  }

  return {
    /** @param {string} key */
    hasGroup: (key) => !groups.has(key),
    /** @param {string} key */
    hasBand: (key) => !bands.has(key),
    hasResting: () => !hidesResting,
    isWhole: () => !groups.size && !bands.size && !hidesResting,
    /** @param {string} key @param {boolean} visible */
    showGroup(key, visible) {
      if (visible) groups.delete(key);
      else groups.add(key);
      for (const id of GROUPS.find((group) => group.key === key)?.layers ?? [])
        map.setLayoutProperty(id, "visibility", visible ? "visible" : "none");
      onChange();
    },
    /** @param {string} key @param {boolean} visible */
    showBand(key, visible) {
      if (visible) bands.delete(key);
      else bands.add(key);
      changed();
    },
    /** @param {boolean} visible */
    showResting(visible) {
      hidesResting = !visible;
      changed();
    },
    showAll() {
      for (const key of [...groups]) this.showGroup(key, true);
      bands.clear();
      hidesResting = false;
      changed();
    },
    bands: () => BANDS.filter((key) => !bands.has(key)),
  };
}

/**
 * Mark the loaded zones that do not apply now by their schedule.
 *
 * @param {MapLibreMap} map
 * @param {(resting: number[]) => void} onChange called with their ids
 */
function watchRestingZones(map, onChange) {
  /** @type {number[]} */
  let resting = [];

  function look() {
    const seen = loadedZones(map);
    for (const [id, rests] of seen) {
      for (const sourceLayer of ZONE_LAYERS)
        map.setFeatureState({ source: TILES, sourceLayer, id }, { resting: rests });
    }
    const stillResting = resting.filter((id) => seen.get(id) !== false);
    const nowResting = [...seen].filter(([, rests]) => rests).map(([id]) => id);
    const next = [...new Set([...stillResting, ...nowResting])].sort((a, b) => a - b);
    if (next.join() === resting.join()) return;
    resting = next;
    onChange(resting);
  }

  map.on("load", () => {
    let isDue = true;
    map.on("sourcedata", (event) => {
      if ("sourceId" in event && event.sourceId === TILES) isDue = true;
    });
    map.on("idle", () => {
      if (isDue) look();
      isDue = false;
    });
    setInterval(look, LOOK_AGAIN_MS);
  });
}

/** Zones with a schedule that the map has loaded, and whether each is out of force now. @param {MapLibreMap} map */
function loadedZones(map) {
  /** @type {Map<number, boolean>} */
  const seen = new Map();
  for (const feature of map.querySourceFeatures(TILES, { sourceLayer: "zones", filter: ["has", "schedule"] })) {
    const id = Number(feature.id);
    const { geometry } = feature;
    if (seen.has(id) || !(geometry.type === "Polygon" || geometry.type === "MultiPolygon")) continue;
    const place = geometry.type === "Polygon" ? geometry.coordinates[0][0] : geometry.coordinates[0][0][0];
    seen.set(id, isInForce(JSON.parse(feature.properties.schedule), Date.now(), place) === false);
  }
  return seen;
}
