/** What was flown in simulation over what was planned: dashed in ink, so that nobody takes it for a flight. */

const SOURCE = "rehearsed";
const BEFORE = "line-labels";

function layersOf(palette) {
  const joined = { "line-join": "round" };
  return [
    {
      id: "rehearsed-casing",
      type: "line",
      source: SOURCE,
      layout: joined,
      paint: { "line-color": palette.casing, "line-width": 4, "line-opacity": 0.9 },
    },
    {
      id: "rehearsed",
      type: "line",
      source: SOURCE,
      layout: joined,
      paint: { "line-color": palette.ink, "line-width": 1.75, "line-dasharray": [3, 2] },
    },
  ];
}

/** routes: of a track, null takes them away. */
export function show(map, palette, routes) {
  if (!map.getSource(SOURCE)) {
    if (!routes) return;
    map.addSource(SOURCE, { type: "geojson", data: { type: "FeatureCollection", features: [] } });
    for (const layer of layersOf(palette)) map.addLayer(layer, map.getLayer(BEFORE) ? BEFORE : undefined);
  }
  const features = (routes ?? []).flatMap(({ uav, flights }) =>
    flights
      .filter(({ position }) => position.length > 1)
      .map(({ position }) => ({
        type: "Feature",
        properties: { uav },
        geometry: { type: "LineString", coordinates: position },
      })),
  );
  map.getSource(SOURCE).setData({ type: "FeatureCollection", features });
}

export function recolour(map, palette) {
  if (!map.getSource(SOURCE)) return;
  for (const { id, paint } of layersOf(palette))
    for (const [name, value] of Object.entries(paint)) map.setPaintProperty(id, name, value);
}
