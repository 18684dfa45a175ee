/** Open findings on the map: a disc at each asset in the colour of the worst, with their number; near ones are counted together. */

import { t } from "../../text.js";
import { readToken, setPaint } from "../look/style.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Palette } from "../../domain/palette.js" */
/** @import { MapLibreMap, SwitchedLayer } from "../types.d.ts" */

const SOURCE = "findings";
const QUERY = "state=open,work_ordered";
const CLUSTER_PX = 24;
const MAX_ZOOM = 24;

/** @param {readonly string[]} fonts @returns {LayerSpecification[]} */
function layers(fonts) {
  const [danger, repair, rest, casing, ground] = [
    "--critical",
    "--warning",
    "--advisory",
    "--map-casing",
    "--ground",
  ].map(readToken);
  const worst = ["coalesce", ["get", "worst"], ["get", "severity"]];
  const layers = [
    {
      id: "findings",
      source: SOURCE,
      type: "circle",
      layout: { "circle-sort-key": ["-", 0, worst] },
      paint: {
        "circle-color": ["match", worst, 1, danger, 2, repair, rest],
        "circle-radius": ["case", ["has", "point_count"], 11, 9],
        "circle-stroke-color": casing,
        "circle-stroke-width": 1.5,
      },
    },
    {
      id: "findings-counts",
      source: SOURCE,
      type: "symbol",
      layout: {
        "text-field": ["to-string", ["coalesce", ["get", "point_count_abbreviated"], 1]],
        "text-font": fonts,
        "text-size": 11,
        "text-allow-overlap": true,
        "text-ignore-placement": true,
      },
      paint: { "text-color": ground },
    },
  ];
  return /** @type {LayerSpecification[]} */ (/** @type {unknown} */ (layers));
}

/**
 * The entry of the layers menu. Findings are requested once it is switched on.
 *
 * @param {MapLibreMap} map
 * @param {Promise<unknown>} ready
 * @param {() => Palette} palette
 * @returns {SwitchedLayer & { recolour: () => void }}
 */
export function createFindingsLayer(map, ready, palette) {
  let isOn = false;

  async function draw() {
    await ready;
    if (isOn === Boolean(map.getSource(SOURCE))) return;
    if (!isOn) {
      for (const { id } of layers(palette().fonts)) map.removeLayer(id);
      map.removeSource(SOURCE);
      return;
    }
    map.addSource(SOURCE, {
      type: "geojson",
      data: `${location.origin}/api/v1/findings.geojson?${QUERY}`,
      cluster: true,
      clusterRadius: CLUSTER_PX,
      maxzoom: MAX_ZOOM,
      clusterMaxZoom: MAX_ZOOM - 1, // findings of one asset stay together
      clusterProperties: { worst: ["min", ["get", "severity"]] },
    });
    for (const layer of layers(palette().fonts)) map.addLayer(layer);
  }

  return {
    words: t("Open findings"),
    isOn: () => isOn,
    turn(on) {
      isOn = on;
      void draw();
    },
    recolour() {
      if (isOn && map.getSource(SOURCE)) for (const layer of layers(palette().fonts)) setPaint(map, layer);
    },
  };
}
