/** Gaps on the map: dots for those in the list, the chosen one drawn whole, and what a repair would draw. */

const NOTHING = { type: "FeatureCollection", features: [] };
const SOURCES = ["gaps", "gap", "gap-repair"];
const DOTS = "gaps-dots";
const REACH_PX = matchMedia("(pointer: coarse)").matches ? 16 : 7;

const read = (token) => getComputedStyle(document.documentElement).getPropertyValue(token).trim();
const byZoom = (far, near) => ["interpolate", ["linear"], ["zoom"], 9, far, 13, near]; // a hundred places of one line must not become a blot
const isPoint = ["==", ["geometry-type"], "Point"];
const isLine = ["==", ["geometry-type"], "LineString"];

function layers() {
  const [mark, casing, ground, accent, raised] = [
    "--warning-mark",
    "--map-casing",
    "--ground",
    "--accent",
    "--raised",
  ].map(read);
  const round = { "line-cap": "round", "line-join": "round" };
  return [
    {
      id: DOTS,
      type: "circle",
      source: "gaps",
      paint: { "circle-radius": 4, "circle-color": mark, "circle-stroke-color": casing, "circle-stroke-width": 1.5 },
    },
    {
      id: "gap-casing",
      type: "line",
      source: "gap",
      filter: isLine,
      layout: round,
      paint: { "line-color": casing, "line-width": 9 },
    },
    {
      id: "gap-line",
      type: "line",
      source: "gap",
      filter: isLine,
      paint: { "line-color": mark, "line-width": 4, "line-dasharray": [2, 1.2] },
    },
    {
      id: "gap-halo",
      type: "circle",
      source: "gap",
      filter: isPoint,
      paint: { "circle-radius": byZoom(4, 11), "circle-color": mark, "circle-opacity": 0.18 },
    },
    {
      id: "gap-places",
      type: "circle",
      source: "gap",
      filter: isPoint,
      paint: {
        "circle-radius": byZoom(1.6, 5.5),
        "circle-color": ground,
        "circle-stroke-color": mark,
        "circle-stroke-width": byZoom(1, 2.5),
      },
    },
    {
      id: "gap-repair-casing",
      type: "line",
      source: "gap-repair",
      filter: isLine,
      layout: round,
      paint: { "line-color": casing, "line-width": 6.5 },
    },
    {
      id: "gap-repair-line",
      type: "line",
      source: "gap-repair",
      filter: isLine,
      layout: round,
      paint: { "line-color": accent, "line-width": 3 },
    },
    {
      id: "gap-repair-places",
      type: "circle",
      source: "gap-repair",
      filter: isPoint,
      paint: {
        "circle-radius": byZoom(2, 5),
        "circle-color": accent,
        "circle-stroke-color": raised,
        "circle-stroke-width": byZoom(0.5, 1.5),
      },
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
const points = (positions) => positions.map((coordinates) => feature({ type: "Point", coordinates }));

export function showAll(map, gaps) {
  const features = gaps.map((gap) => feature({ type: "Point", coordinates: gap.properties.position }, { id: gap.id }));
  map.getSource("gaps").setData({ type: "FeatureCollection", features });
}

/** The gap's own geometry, with a ring at each of its places; of a dead end also the way to the next part of the network. */
export function showGap(map, gap) {
  const features = gap ? [feature(gap.geometry), ...points(placesOf(gap.geometry))] : [];
  const nearest = gap?.properties.details.nearest;
  if (nearest) features.unshift(feature({ type: "LineString", coordinates: [gap.properties.position, nearest] }));
  map.getSource("gap").setData({ type: "FeatureCollection", features });
}

/** A FeatureCollection, or null. Lines first, so that towers stand on them. */
export function showRepair(map, preview) {
  const features =
    preview?.features.filter(({ geometry }) => geometry.type === "Point" || geometry.type === "LineString") ?? [];
  map.getSource("gap-repair").setData({ type: "FeatureCollection", features });
}

export function showPlaces(map, positions) {
  map.getSource("gap-repair").setData({ type: "FeatureCollection", features: points(positions) });
}

/** The id of the gap whose dot is within reach of a point of the screen, or null. */
export function gapAt(map, { x, y }) {
  if (!map.getLayer(DOTS)) return null;
  const met = map.queryRenderedFeatures(
    [
      [x - REACH_PX, y - REACH_PX],
      [x + REACH_PX, y + REACH_PX],
    ],
    { layers: [DOTS] },
  );
  const away = ({ geometry }) => {
    const place = map.project(geometry.coordinates);
    return Math.hypot(place.x - x, place.y - y);
  };
  return met.sort((a, b) => away(a) - away(b))[0]?.properties.id ?? null;
}

export function placesOf(geometry) {
  return geometry.type === "Point" ? [geometry.coordinates] : geometry.coordinates;
}
