/** Terrain on the map: how far the models reach, the line of the profile, its points and its cursor. */

const NOTHING = { type: "FeatureCollection", features: [] };
const SOURCES = ["terrain-models", "terrain-line", "terrain-points", "terrain-cursor"];

const read = (token) => getComputedStyle(document.documentElement).getPropertyValue(token).trim();

function layers() {
  const [outline, casing, accent, raised, ink] = ["--outline", "--map-casing", "--accent", "--raised", "--ink"].map(
    read,
  );
  const isChosen = ["boolean", ["get", "chosen"], false];
  const round = { "line-cap": "round", "line-join": "round" };
  return [
    {
      id: "terrain-fill",
      type: "fill",
      source: "terrain-models",
      paint: { "fill-color": ink, "fill-opacity": ["case", isChosen, 0.1, 0.035] },
    },
    {
      id: "terrain-edge",
      type: "line",
      source: "terrain-models",
      paint: {
        "line-color": ["case", isChosen, ink, outline],
        "line-width": ["case", isChosen, 2, 1.25],
        "line-dasharray": [4, 3],
      },
    },
    {
      id: "terrain-line-casing",
      type: "line",
      source: "terrain-line",
      layout: round,
      paint: { "line-color": casing, "line-width": 7 },
    },
    {
      id: "terrain-line",
      type: "line",
      source: "terrain-line",
      layout: round,
      paint: { "line-color": accent, "line-width": 3 },
    },
    {
      id: "terrain-points",
      type: "circle",
      source: "terrain-points",
      paint: { "circle-radius": 5, "circle-color": accent, "circle-stroke-color": raised, "circle-stroke-width": 2 },
    },
    {
      id: "terrain-cursor",
      type: "circle",
      source: "terrain-cursor",
      paint: { "circle-radius": 5, "circle-color": raised, "circle-stroke-color": ink, "circle-stroke-width": 2.5 },
    },
  ];
}

export function addTo(map) {
  for (const source of SOURCES) map.addSource(source, { type: "geojson", data: NOTHING });
  for (const layer of layers()) map.addLayer(layer);
}

export function recolour(map) {
  for (const layer of layers()) {
    for (const [name, value] of Object.entries(layer.paint)) map.setPaintProperty(layer.id, name, value);
  }
}

const feature = (geometry, properties = {}) => ({ type: "Feature", properties, geometry });
const put = (map, source, features) => map.getSource(source).setData({ type: "FeatureCollection", features });

/** What counts on top is drawn last. */
export function showModels(map, models, chosenId = null) {
  put(
    map,
    "terrain-models",
    [...models].reverse().map(({ id, geometry }) => feature(geometry, { chosen: id === chosenId })),
  );
}

export function showLine(map, positions, points) {
  put(map, "terrain-line", positions.length > 1 ? [feature({ type: "LineString", coordinates: positions })] : []);
  put(
    map,
    "terrain-points",
    points.map((coordinates) => feature({ type: "Point", coordinates })),
  );
}

export function showCursor(map, position) {
  put(map, "terrain-cursor", position ? [feature({ type: "Point", coordinates: position })] : []);
}
