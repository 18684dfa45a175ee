/** What was flown in simulation over what was planned: thin and dotted on a casing, so that nobody takes it for a flight. */

import { routeNumber } from "../palette.js";

const SOURCE = "rehearsed";
const BEFORE = "line-labels";

function layersOf(palette) {
  const round = { "line-cap": "round", "line-join": "round" };
  const colour = ["match", ["get", "route"], ...palette.routes.flatMap((value, index) => [index + 1, value]), palette.inkSecond];
  return [
    { id: "rehearsed-casing", type: "line", source: SOURCE, layout: round, paint: { "line-color": palette.casing, "line-width": 6, "line-opacity": 0.8 } },
    { id: "rehearsed", type: "line", source: SOURCE, layout: round, paint: { "line-color": colour, "line-width": 3, "line-dasharray": [0.1, 1.8] } },
  ];
}

/** routes: of a track, null takes them away. */
export function show(map, palette, routes) {
  if (!map.getSource(SOURCE)) {
    if (!routes) return;
    map.addSource(SOURCE, { type: "geojson", data: { type: "FeatureCollection", features: [] } });
    for (const layer of layersOf(palette)) map.addLayer(layer, map.getLayer(BEFORE) ? BEFORE : undefined);
  }
  const features = (routes ?? []).flatMap(({ uav, flights }) => flights.filter(({ position }) => position.length > 1).map(({ position }) => ({ type: "Feature", properties: { route: routeNumber(uav) }, geometry: { type: "LineString", coordinates: position } })));
  map.getSource(SOURCE).setData({ type: "FeatureCollection", features });
}

export function recolour(map, palette) {
  if (!map.getSource(SOURCE)) return;
  for (const { id, paint } of layersOf(palette)) for (const [name, value] of Object.entries(paint)) map.setPaintProperty(id, name, value);
}
