/** A campaign on the map: routes in the colours of their days, launch sites with the numbers of their missions, and where crews start. */

import { addSources, readToken, setFeatures, setPaint } from "../map/look/style.js";
import { colourOfDay } from "./schedule_view.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Campaign, CampaignRoutes } from "../api_types.d.ts" */
/** @import { MapLibreMap } from "../map/types.d.ts" */

const SOURCES = ["campaign-routes", "campaign-sites", "campaign-start"];
const DAYS = 8;
const DIM = 0.25;

/** @param {string[]} fonts @returns {LayerSpecification[]} */
function layers(fonts) {
  const [casing, raised, ink, ground] = ["--map-casing", "--raised", "--ink", "--ground"].map(readToken);
  const colours = Array.from({ length: DAYS }, (_, index) => readToken(`--route-${index + 1}`));
  const ofDay = ["match", ["get", "colour"], ...colours.flatMap((colour, index) => [index + 1, colour]), ink];
  const round = { "line-cap": "round", "line-join": "round" };
  const layers = [
    {
      id: "campaign-casing",
      type: "line",
      source: "campaign-routes",
      layout: round,
      paint: { "line-color": casing, "line-width": 5.5 },
    },
    {
      id: "campaign-lines",
      type: "line",
      source: "campaign-routes",
      layout: round,
      paint: { "line-color": ofDay, "line-width": 2.5 },
    },
    {
      id: "campaign-start-place",
      type: "circle",
      source: "campaign-start",
      paint: { "circle-radius": 6, "circle-color": ground, "circle-stroke-color": ink, "circle-stroke-width": 3 },
    },
    {
      id: "campaign-site-places",
      type: "circle",
      source: "campaign-sites",
      paint: { "circle-radius": 10, "circle-color": ofDay, "circle-stroke-color": raised, "circle-stroke-width": 2 },
    },
    {
      id: "campaign-site-numbers",
      type: "symbol",
      source: "campaign-sites",
      layout: {
        "text-field": ["get", "numbers"],
        "text-font": fonts,
        "text-size": 11,
        "text-allow-overlap": true,
        "text-ignore-placement": true,
      },
      paint: { "text-color": raised },
    },
  ];
  return /** @type {LayerSpecification[]} */ (layers);
}

/** @param {MapLibreMap} map @param {string[]} fonts */
export function addTo(map, fonts) {
  addSources(map, SOURCES);
  for (const layer of layers(fonts)) map.addLayer(layer);
}

/** @param {MapLibreMap} map @param {string[]} fonts */
export function recolour(map, fonts) {
  for (const layer of layers(fonts)) setPaint(map, layer);
}

/** @param {MapLibreMap} map @param {Campaign} campaign @param {CampaignRoutes | null} routes */
export function show(map, { schedule, rules }, routes) {
  const dayOf = new Map(schedule?.days.flatMap(({ day, visits }) => visits.map(({ mission }) => [mission, day])) ?? []);
  /** @param {number} number */
  const colourOf = (number) => colourOfDay(dayOf.get(number) ?? 0); // 0: in no day
  setFeatures(
    map,
    "campaign-routes",
    (routes?.features ?? []).map((feature) => ({
      ...feature,
      properties: { ...feature.properties, colour: colourOf(feature.properties.number) },
    })),
  );
  setFeatures(
    map,
    "campaign-sites",
    (schedule?.sites ?? []).flatMap(({ position }, site) => {
      const numbers = schedule?.missions.filter((mission) => mission.site === site).map(({ number }) => number) ?? [];
      if (numbers.length === 0) return [];
      const words = numbers.length > 2 ? `${numbers[0]}…` : numbers.join(",");
      return [pointOf(position, { numbers: words, colour: colourOf(numbers[0]) })];
    }),
  );
  setFeatures(map, "campaign-start", [pointOf(rules.start, {})]);
}

/** Dim all routes except those of one mission; null: none. @param {MapLibreMap} map @param {number | null} number */
export function light(map, number) {
  const opacity = number === null ? 1 : ["case", ["==", ["get", "number"], number], 1, DIM];
  for (const id of ["campaign-casing", "campaign-lines"]) setPaint(map, { id, paint: { "line-opacity": opacity } });
}

/** @param {number[]} position @param {Record<string, unknown>} properties */
const pointOf = (position, properties) => ({
  type: "Feature",
  properties,
  geometry: { type: "Point", coordinates: position },
});
