/** A difference on the map: new, changed, vanished and kept, each with its own colour, stroke and sign. */

import { addSources, readToken, setFeatures, setPaint } from "../map/look/style.js";
import { ACTIONS, isGeometry } from "./words.js";

/** @import { FilterSpecification, LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Geometry, MapLibreMap, MapView, ScreenPoint } from "../map/types.d.ts" */
/** @import { Change } from "./types.d.ts" */

/** @typedef {{ type: "GeometryCollection", geometries: Geometry[] }} Collection */

const reach_px = () => (matchMedia("(pointer: coarse)").matches ? 16 : 6);
const SOURCE = "import-changes";
const BEFORE = "import-before";
const SIGNS = "import-signs";
const SHAPES = ["import-fill", "import-line", "import-line-vanished", "import-line-kept", "import-dot"];
const FILTERED = [...SHAPES, "import-casing", "import-sign", "import-before-line", "import-before-dot"];

/** Far off a point is a small dot, and a shape needs none; near by each carries its sign. @param {number} far @param {number} near [px] */
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
/** @param {string} type */
const isShape = (type) => ["==", ["geometry-type"], type];
/** @param {...string} actions */
const actionIs = (...actions) => ["in", ["get", "action"], ["literal", actions]];
/** @param {Record<string, string>} values */
const byAction = (values) => ["match", ["get", "action"], ...Object.entries(values).flat(), values.changed];

/** The colour of each action, as the theme has it now. */
function colours() {
  return {
    casing: readToken("--map-casing"),
    actions: {
      new: readToken("--accent"),
      changed: readToken("--warning"),
      vanished: readToken("--critical"),
      kept: readToken("--advisory"),
      not_read: readToken("--critical"),
    },
    before: readToken("--ink"),
  };
}

/** @type {Record<string, unknown[]>} */
const baseFilters = {
  "import-fill": isShape("Polygon"),
  "import-casing": ["!", isShape("Point")],
  "import-line": ["all", ["!", isShape("Point")], actionIs("new", "changed")],
  "import-line-vanished": ["all", ["!", isShape("Point")], actionIs("vanished", "not_read")],
  "import-line-kept": ["all", ["!", isShape("Point")], actionIs("kept")],
  "import-before-line": ["!", isShape("Point")],
  "import-before-dot": isShape("Point"),
};

/** @param {ReturnType<typeof colours>} colours @param {string[]} fonts @returns {LayerSpecification[]} */
function layers({ casing, actions, before }, fonts) {
  const colour = byAction(actions);
  const round = { "line-cap": "round", "line-join": "round" };
  const line = { "line-color": colour, "line-width": 3 };
  const layers = [
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
  return /** @type {LayerSpecification[]} */ (layers);
}

/** @param {{ map: MapLibreMap, view: MapView }} ground */
export function createChangesLayer({ map, view }) {
  let shownAction = "";

  function addTo() {
    addSources(map, [BEFORE, SOURCE, SIGNS]);
    for (const layer of layers(colours(), view.palette().fonts)) map.addLayer(layer);
    filter();
  }

  function filter() {
    const wanted = shownAction ? ["==", ["get", "action"], shownAction] : null;
    for (const id of FILTERED) {
      if (!map.getLayer(id)) continue;
      const base = baseFilters[id] ?? null;
      const both = base && wanted ? ["all", base, wanted] : (base ?? wanted);
      map.setFilter(id, /** @type {FilterSpecification | null} */ (/** @type {unknown} */ (both)));
    }
  }

  return {
    addTo,
    recolour() {
      for (const layer of layers(colours(), view.palette().fonts)) setPaint(map, layer);
    },
    /** @param {Change[]} changes @param {string} action the only one that is shown; "" for all */
    show(changes, action) {
      shownAction = action;
      const drawn = changes.flatMap(({ geometry, ...change }) => (geometry ? [{ ...change, geometry }] : []));
      setFeatures(
        map,
        SOURCE,
        drawn.map((change) => featureOf(change, change.geometry)),
      );
      const signs = drawn.map((change) => ({ change, coordinates: placeOfSign(change.geometry) }));
      setFeatures(
        map,
        SIGNS,
        signs.map(({ change, coordinates }) => featureOf(change, { type: "Point", coordinates })),
      );
      const moved = drawn.flatMap((change) => {
        const { action: what, before } = change.properties;
        return what !== "vanished" && isGeometry(before?.geometry) ? [featureOf(change, before.geometry)] : [];
      });
      setFeatures(map, BEFORE, moved);
      filter();
    },
    /** The id of the change under a point of the screen, or null. @param {ScreenPoint | null} point @returns {number | null} */
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
      /** @param {{ layer: { id: string } }} feature */
      const rank = ({ layer }) => -SHAPES.indexOf(layer.id);
      return found.sort((a, b) => rank(a) - rank(b))[0]?.properties.id ?? null;
    },
  };
}

/** @param {Pick<Change, "id" | "properties"> & { geometry: Geometry }} change @param {object} geometry */
const featureOf = ({ id, properties, geometry: own }, geometry) => ({
  type: "Feature",
  geometry,
  properties: { id, action: properties.action, isPoint: own.type === "Point" },
});

/**
 * Position of a geometry's sign: on a line its middle vertex, on an area its northernmost one, where no name is drawn.
 *
 * @param {Geometry} geometry
 */
export function placeOfSign(geometry) {
  const positions = positionsOf(geometry);
  if (geometry.type.endsWith("Polygon"))
    return positions.reduce((best, position) => (position[1] > best[1] ? position : best));
  return positions[Math.floor(positions.length / 2)];
}

/** All positions of a geometry. @param {Geometry | Collection | null} geometry @returns {number[][]} */
export function positionsOf(geometry) {
  if (!geometry) return [];
  if ("geometries" in geometry) return geometry.geometries.flatMap(positionsOf);
  return positionsIn(geometry.coordinates);
}

/** @param {readonly unknown[]} coordinates @returns {number[][]} */
const positionsIn = (coordinates) =>
  typeof coordinates[0] === "number"
    ? [/** @type {number[]} */ (coordinates)]
    : /** @type {unknown[][]} */ (coordinates).flatMap(positionsIn);
