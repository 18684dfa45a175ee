/** What was flown over what was planned: measured solid, estimated dotted, and the leg that is looked at under both. */

import { routeNumber } from "../domain/palette.js";

const BEFORE = "line-labels";
const NOTHING = { type: "FeatureCollection", features: [] };
const THIN_PX = 1.6;

const feature = (coordinates, place) => ({
  type: "Feature",
  properties: { route: routeNumber(place) },
  geometry: { type: "LineString", coordinates },
});
const collection = (features) => ({ type: "FeatureCollection", features });

function layersOf(palette) {
  const round = { "line-cap": "round", "line-join": "round" };
  const colour = [
    "match",
    ["get", "route"],
    ...palette.routes.flatMap((value, index) => [index + 1, value]),
    palette.inkSecond,
  ];
  return [
    {
      id: "record-leg",
      type: "line",
      source: "record-leg",
      layout: round,
      paint: { "line-color": palette.select, "line-width": 11, "line-opacity": 0.3 },
    },
    {
      id: "record-flown-casing",
      type: "line",
      source: "record-flown",
      layout: round,
      paint: { "line-color": palette.casing, "line-width": 5.6 },
    },
    {
      id: "record-flown",
      type: "line",
      source: "record-flown",
      layout: round,
      paint: { "line-color": colour, "line-width": 3.6 },
    },
    {
      id: "record-estimated",
      type: "line",
      source: "record-estimated",
      layout: round,
      paint: { "line-color": colour, "line-width": 3, "line-dasharray": [0.1, 2] },
    },
  ];
}

const thinRoutes = (map) => map.setPaintProperty("routes", "line-width", THIN_PX);

export function addTo(map, palette) {
  for (const { source } of layersOf(palette))
    if (!map.getSource(source)) map.addSource(source, { type: "geojson", data: NOTHING });
  const before = map.getLayer(BEFORE) ? BEFORE : undefined;
  for (const layer of layersOf(palette)) map.addLayer(layer, before);
  thinRoutes(map);
}

export function recolour(map, palette) {
  for (const { id, paint } of layersOf(palette))
    for (const [name, value] of Object.entries(paint)) map.setPaintProperty(id, name, value);
  thinRoutes(map);
}

const positionsOf = (run) => run.map(({ position }) => position).filter(Boolean);
const linesOf = (runs, place) =>
  runs
    .map(positionsOf)
    .filter((line) => line.length > 1)
    .map((line) => feature(line, place));

/** routes: [{ place, track }] */
export function showTracks(map, routes) {
  map
    .getSource("record-flown")
    .setData(collection(routes.flatMap(({ place, track }) => linesOf(track.measured, place))));
  map
    .getSource("record-estimated")
    .setData(collection(routes.flatMap(({ place, track }) => linesOf(track.estimated, place))));
}

/** positions of a leg, or null. */
export function lightLeg(map, positions) {
  map.getSource("record-leg").setData(positions ? collection([feature(positions, 0)]) : NOTHING);
}

/** Brings one UAV forward; null gives all of them back. */
export function lookAt(map, place, rest) {
  const opacity = place === null ? 1 : ["case", ["==", ["get", "route"], routeNumber(place)], 1, rest];
  for (const id of ["record-flown", "record-estimated"]) map.setPaintProperty(id, "line-opacity", opacity);
}
