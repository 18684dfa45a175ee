/** The flight through the photos of an asset on the map: its line, and a cone per photo along its yaw. */

import { boxAround } from "../domain/geodesy.js";
import { answerClicks } from "../map/layers/clicks.js";
import { coneLayer, conesOf } from "../map/layers/photos.js";
import { addSources, readToken, setFeatures, setPaint } from "../map/look/style.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { ViewPlan } from "../api_types.d.ts" */
/** @import { Box, MapLibreMap } from "../map/types.d.ts" */

const ROUTE = "view-plan-route";
const PHOTOS = "view-plan-photos";
const NEAREST_ZOOM = 19;
const PADDING_PX = 56;
const SETTLED_MS = 350;

/** @returns {LayerSpecification[]} */
function layers() {
  const round = { "line-cap": "round", "line-join": "round" };
  const [casing, ink] = [readToken("--map-casing"), readToken("--accent")];
  const found = [
    {
      id: "view-plan-casing",
      type: "line",
      source: ROUTE,
      layout: round,
      paint: { "line-color": casing, "line-width": 4.5 },
    },
    {
      id: "view-plan-line",
      type: "line",
      source: ROUTE,
      layout: round,
      paint: { "line-color": ink, "line-width": 1.6 },
    },
    coneLayer(PHOTOS),
  ];
  return /** @type {LayerSpecification[]} */ (found);
}

/** @param {ViewPlan} plan */
const routeOf = ({ route }) => [
  {
    type: "Feature",
    properties: {},
    geometry: { type: "LineString", coordinates: route.map((place) => place.slice(0, 2)) },
  },
];

/** @param {MapLibreMap} map @param {(number: number) => void} clicked a photo's cone is, the first has number 0 */
export function createViewPlanLayer(map, clicked) {
  function add() {
    addSources(map, [ROUTE, PHOTOS]);
    for (const layer of layers()) map.addLayer(layer);
    answerClicks(map, [PHOTOS], ({ properties }) => clicked(properties.number));
  }

  /** @param {ViewPlan} plan */
  function fit({ route }) {
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    map.fitBounds(/** @type {Box} */ (boxAround(route)), {
      padding: PADDING_PX,
      maxZoom: NEAREST_ZOOM,
      duration: calm ? 0 : SETTLED_MS,
    });
  }

  return {
    /** Shows a plan, or none. @param {ViewPlan | null} plan @param {{ isNew?: boolean }} [how] isNew: the map moves there */
    show(plan, { isNew = false } = {}) {
      if (!map.getSource(ROUTE)) {
        if (!plan) return;
        add();
      }
      setFeatures(map, ROUTE, plan?.photos.length ? routeOf(plan) : []);
      setFeatures(map, PHOTOS, plan ? conesOf(plan.photos) : []);
      if (isNew && plan?.photos.length) fit(plan);
    },
    /** Highlights a photo, or none. @param {ViewPlan} plan @param {number | null} number */
    choose(plan, number) {
      setFeatures(map, PHOTOS, conesOf(plan.photos, number));
    },
    recolour() {
      if (map.getSource(ROUTE)) for (const layer of layers()) setPaint(map, layer);
    },
  };
}
