/** What of the ground the map shows: kinds, voltages, zones out of force. Zones that rest are drawn as such. */

import { isInForce } from "../domain/zones_in_force.js";
import { t } from "../text.js";
import { BANDS, bandOf, GROUPS, TILES } from "./style.js";

const LOOK_AGAIN_MS = 60_000;
const ZONE_LAYERS = ["zones", "zone_labels"];

export const groupName = (key) =>
  ({
    lines: t("Power lines"),
    towers: t("Towers"),
    railways: t("Railways"),
    bridges: t("Bridges"),
    zones: t("No-fly zones"),
  })[key];

export const bandName = (key) =>
  ({
    380: t("380 kV and over"),
    200: t("200 to 379 kV"),
    100: t("100 to 199 kV"),
    50: t("50 to 99 kV"),
    0: t("under 50 kV"),
    none: t("Voltage not stated"),
  })[key];

/** Filter of a layer with some voltages and some zones left out; `own` is what the style says. Without anything left out it is `own`. */
export function filterOf(own, { group, bands, resting }) {
  const more = [];
  if ((group === "lines" || group === "towers") && bands.size)
    more.push(["!", ["in", bandOf, ["literal", [...bands]]]]);
  if (group === "zones" && resting.length) more.push(["!", ["in", ["id"], ["literal", resting]]]);
  return more.length ? ["all", ...(own ? [own] : []), ...more] : (own ?? null);
}

/** onChange() is called when what is hidden changes. */
export function createShown(map, onChange = () => {}) {
  const groups = new Set(); // hidden ones
  const bands = new Set(); // hidden ones
  const own = new Map(); // layer → filter of the style
  let hidesResting = false;
  let resting = [];

  function filterLayers(only = null) {
    for (const { key, layers } of GROUPS) {
      if (only && key !== only) continue;
      for (const id of layers) {
        if (!own.has(id)) own.set(id, map.getFilter(id) ?? null);
        map.setFilter(id, filterOf(own.get(id), { group: key, bands, resting: hidesResting ? resting : [] }));
      }
    }
  }

  /** Zones whose schedule says that they do not apply now, of those that the map has loaded. */
  function lookAtZones() {
    const seen = new Map();
    for (const feature of map.querySourceFeatures(TILES, { sourceLayer: "zones", filter: ["has", "schedule"] })) {
      if (seen.has(feature.id)) continue;
      const [place] = feature.geometry.coordinates.flat(feature.geometry.type === "MultiPolygon" ? 2 : 1);
      seen.set(feature.id, isInForce(JSON.parse(feature.properties.schedule), Date.now(), place) === false);
    }
    for (const [id, rests] of seen) {
      for (const sourceLayer of ZONE_LAYERS)
        map.setFeatureState({ source: TILES, sourceLayer, id }, { resting: rests });
    }
    const next = [
      ...new Set([
        ...resting.filter((id) => seen.get(id) !== false),
        ...[...seen].filter(([, rests]) => rests).map(([id]) => id),
      ]),
    ].sort((a, b) => a - b);
    if (next.join() === resting.join()) return;
    resting = next;
    if (hidesResting) filterLayers("zones");
  }

  map.on("load", () => {
    let isDue = true;
    map.on("sourcedata", ({ sourceId }) => (isDue ||= sourceId === TILES));
    map.on("idle", () => {
      if (isDue) lookAtZones();
      isDue = false;
    });
    setInterval(lookAtZones, LOOK_AGAIN_MS);
  });

  function changed() {
    filterLayers();
    onChange();
  }

  return {
    hasGroup: (key) => !groups.has(key),
    hasBand: (key) => !bands.has(key),
    hasResting: () => !hidesResting,
    isWhole: () => !groups.size && !bands.size && !hidesResting,
    showGroup(key, visible) {
      if (visible) groups.delete(key);
      else groups.add(key);
      for (const id of GROUPS.find((group) => group.key === key).layers)
        map.setLayoutProperty(id, "visibility", visible ? "visible" : "none");
      onChange();
    },
    showBand(key, visible) {
      if (visible) bands.delete(key);
      else bands.add(key);
      changed();
    },
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
