/** A difference on the map: new, changed, vanished and kept, each with its own colour, stroke and sign. */

import { ACTIONS, isGeometry } from "./words.js";

const NOTHING = { type: "FeatureCollection", features: [] };
const reach_px = () => (matchMedia("(pointer: coarse)").matches ? 16 : 6);
const SOURCE = "import-changes";
const BEFORE = "import-before";
const SIGNS = "import-signs";
const SHAPES = ["import-fill", "import-line", "import-line-vanished", "import-line-kept", "import-dot"];
const FILTERED = [...SHAPES, "import-casing", "import-sign", "import-before-line", "import-before-dot"];

/** Far off a point is a small dot, and a shape needs none; near by each carries its sign. */
const byZoom = (far, near) => [
  "interpolate",
  ["linear"],
  ["zoom"],
  8,
  ["case", ["get", "isPoint"], far, 0],
  11,
  ["case", ["get", "isPoint"], (far + near) / 2, 0],
  13,
  near,
];
const isShape = (type) => ["==", ["geometry-type"], type];
const actionIs = (...actions) => ["in", ["get", "action"], ["literal", actions]];
const byAction = (values) => ["match", ["get", "action"], ...Object.entries(values).flat(), values.changed];

/** The colour of each action, as the theme has it now. */
function colours() {
  const read = (token) => getComputedStyle(document.documentElement).getPropertyValue(token).trim();
  return {
    casing: read("--map-casing"),
    actions: {
      new: read("--accent"),
      changed: read("--warning"),
      vanished: read("--critical"),
      kept: read("--advisory"),
    },
    before: read("--ink"),
  };
}

const baseFilters = {
  "import-fill": isShape("Polygon"),
  "import-casing": ["!", isShape("Point")],
  "import-line": ["all", ["!", isShape("Point")], actionIs("new", "changed")],
  "import-line-vanished": ["all", ["!", isShape("Point")], actionIs("vanished")],
  "import-line-kept": ["all", ["!", isShape("Point")], actionIs("kept")],
  "import-before-line": ["!", isShape("Point")],
  "import-before-dot": isShape("Point"),
};

function layers({ casing, actions, before }, fonts) {
  const colour = byAction(actions);
  const round = { "line-cap": "round", "line-join": "round" };
  const line = { "line-color": colour, "line-width": 3 };
  return [
    {
      id: "import-before-line",
      type: "line",
      source: BEFORE,
      paint: { "line-color": before, "line-width": 2.5, "line-dasharray": [2.5, 2] },
    },
    {
      id: "import-before-dot",
      type: "circle",
      source: BEFORE,
      paint: { "circle-radius": 5, "circle-opacity": 0, "circle-stroke-color": before, "circle-stroke-width": 1.5 },
    },
    { id: "import-fill", type: "fill", source: SOURCE, paint: { "fill-color": colour, "fill-opacity": 0.12 } },
    {
      id: "import-casing",
      type: "line",
      source: SOURCE,
      layout: round,
      paint: { "line-color": casing, "line-width": 6 },
    },
    { id: "import-line", type: "line", source: SOURCE, layout: round, paint: line },
    { id: "import-line-vanished", type: "line", source: SOURCE, paint: { ...line, "line-dasharray": [2.4, 1.8] } },
    {
      id: "import-line-kept",
      type: "line",
      source: SOURCE,
      layout: round,
      paint: { ...line, "line-dasharray": [0.1, 2] },
    },
    {
      id: "import-dot",
      type: "circle",
      source: SIGNS,
      paint: {
        "circle-radius": byZoom(2.5, 8),
        "circle-color": casing,
        "circle-stroke-color": colour,
        "circle-stroke-width": byZoom(1.5, 2),
      },
    },
    {
      id: "import-sign",
      type: "symbol",
      source: SIGNS,
      layout: {
        "text-field": byAction(Object.fromEntries(Object.entries(ACTIONS).map(([action, { sign }]) => [action, sign]))),
        "text-font": fonts,
        "text-size": ["interpolate", ["linear"], ["zoom"], 9, 13, 13, 17],
        "text-padding": 0,
      },
      paint: { "text-color": colour, "text-halo-color": casing, "text-halo-width": 2 },
    },
  ];
}

export function createChangesLayer({ map, view }) {
  let shownAction = "";

  function addTo() {
    for (const id of [BEFORE, SOURCE, SIGNS]) map.addSource(id, { type: "geojson", data: NOTHING });
    for (const layer of layers(colours(), view.palette().fonts)) map.addLayer(layer);
    filter();
  }

  function filter() {
    const wanted = shownAction ? ["==", ["get", "action"], shownAction] : null;
    for (const id of FILTERED) {
      if (!map.getLayer(id)) continue;
      const base = baseFilters[id] ?? null;
      map.setFilter(id, base && wanted ? ["all", base, wanted] : (base ?? wanted));
    }
  }

  return {
    addTo,
    recolour() {
      for (const layer of layers(colours(), view.palette().fonts)) {
        for (const [name, value] of Object.entries(layer.paint)) map.setPaintProperty(layer.id, name, value);
      }
    },
    show(changes, action) {
      shownAction = action;
      const drawn = changes.filter((change) => change.geometry);
      const feature = (change, geometry) => ({
        type: "Feature",
        geometry,
        properties: { id: change.id, action: change.properties.action, isPoint: change.geometry.type === "Point" },
      });
      map
        .getSource(SOURCE)
        .setData({ type: "FeatureCollection", features: drawn.map((change) => feature(change, change.geometry)) });
      map.getSource(SIGNS).setData({
        type: "FeatureCollection",
        features: drawn.map((change) => feature(change, { type: "Point", coordinates: placeOfSign(change.geometry) })),
      });
      const moved = changes.filter(
        (change) => change.properties.action !== "vanished" && isGeometry(change.properties.before?.geometry),
      );
      map.getSource(BEFORE).setData({
        type: "FeatureCollection",
        features: moved.map((change) => feature(change, change.properties.before.geometry)),
      });
      filter();
    },
    /** The id of the change under a point of the screen, or null. */
    at(point) {
      const shown = SHAPES.filter((id) => map.getLayer(id));
      if (!shown.length || !point) return null;
      const reach = reach_px();
      const found = map.queryRenderedFeatures(
        [
          [point.x - reach, point.y - reach],
          [point.x + reach, point.y + reach],
        ],
        { layers: shown },
      );
      const rank = ({ layer }) => -SHAPES.indexOf(layer.id);
      return found.sort((a, b) => rank(a) - rank(b))[0]?.properties.id ?? null;
    },
  };
}

/** Where a geometry's sign stands: on a line its middle vertex, on an area its northernmost one, where no name is drawn. */
export function placeOfSign(geometry) {
  const positions = positionsOf(geometry);
  if (geometry.type.endsWith("Polygon"))
    return positions.reduce((best, position) => (position[1] > best[1] ? position : best));
  return positions[Math.floor(positions.length / 2)];
}

/** All positions of a geometry. */
export function positionsOf(geometry) {
  if (!geometry) return [];
  if (geometry.type === "GeometryCollection") return geometry.geometries.flatMap(positionsOf);
  const walk = (value) => (typeof value[0] === "number" ? [value] : value.flatMap(walk));
  return walk(geometry.coordinates);
}
