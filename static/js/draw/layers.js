/** A drawing on the map: fill, sides, vertices and middles as handles, and faults in red. */

import { circleRing, continuous } from "../domain/geodesy.js";
import { addSources, readToken, setFeatures, setPaint } from "../map/look/style.js";
import { circleOf, middlesOf, radiusHandle, verticesOf } from "./shape.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { MapLibreMap } from "../map/types.d.ts" */
/** @import { Fault, Handle, Shape, VertexPath } from "./types.d.ts" */

const MAX_MIDDLES = 400; // of a large ring, only vertices

/** @param {string} role */
const isRole = (role) => ["==", ["get", "role"], role];
const touch = matchMedia("(pointer: coarse)").matches;

/** @returns {LayerSpecification[]} */
function layers() {
  const [accent, casing, raised, critical] = ["--accent", "--map-casing", "--raised", "--critical"].map(readToken);
  const round = { "line-cap": "round", "line-join": "round" };
  const layers = [
    {
      id: "draw-fill",
      type: "fill",
      source: "draw-shape",
      filter: isRole("fill"),
      paint: { "fill-color": accent, "fill-opacity": 0.12 },
    },
    {
      id: "draw-casing",
      type: "line",
      source: "draw-shape",
      filter: isRole("side"),
      layout: round,
      paint: { "line-color": casing, "line-width": 6 },
    },
    {
      id: "draw-side",
      type: "line",
      source: "draw-shape",
      filter: isRole("side"),
      layout: round,
      paint: { "line-color": accent, "line-width": 2.5 },
    },
    {
      id: "draw-next",
      type: "line",
      source: "draw-next",
      filter: isRole("side"),
      paint: { "line-color": accent, "line-width": 1.5, "line-dasharray": [3, 2] },
    },
    {
      id: "draw-fault",
      type: "line",
      source: "draw-faults",
      filter: ["==", ["geometry-type"], "LineString"],
      layout: round,
      paint: { "line-color": critical, "line-width": 4 },
    },
    {
      id: "draw-middles",
      type: "circle",
      source: "draw-points",
      filter: isRole("middle"),
      paint: {
        "circle-radius": touch ? 6 : 3.5,
        "circle-color": raised,
        "circle-opacity": 0.85,
        "circle-stroke-color": accent,
        "circle-stroke-width": 1.25,
      },
    },
    {
      id: "draw-handles",
      type: "circle",
      source: "draw-points",
      filter: ["!=", ["get", "role"], "middle"],
      paint: {
        "circle-radius": ["case", ["get", "chosen"], touch ? 10 : 7, touch ? 8 : 5],
        "circle-color": ["case", ["get", "chosen"], accent, raised],
        "circle-stroke-color": ["case", ["get", "chosen"], raised, accent],
        "circle-stroke-width": 2,
      },
    },
    {
      id: "draw-fault-places",
      type: "circle",
      source: "draw-faults",
      filter: ["==", ["geometry-type"], "Point"],
      paint: { "circle-radius": 9, "circle-opacity": 0, "circle-stroke-color": critical, "circle-stroke-width": 2.5 },
    },
    {
      id: "draw-snap",
      type: "circle",
      source: "draw-snap",
      paint: { "circle-radius": 10, "circle-opacity": 0, "circle-stroke-color": accent, "circle-stroke-width": 2 },
    },
  ];
  return /** @type {LayerSpecification[]} */ (layers);
}

/** @param {MapLibreMap} map */
export function addTo(map) {
  addSources(map, ["draw-shape", "draw-next", "draw-points", "draw-faults", "draw-snap"]);
  for (const layer of layers()) map.addLayer(layer);
}

/** @param {MapLibreMap} map */
export function recolour(map) {
  for (const layer of layers()) setPaint(map, layer);
}

/** @param {string} role @param {string} type @param {unknown} coordinates @param {object} [rest] */
const feature = (role, type, coordinates, rest = {}) => ({
  type: "Feature",
  properties: { role, ...rest },
  geometry: { type, coordinates },
});

/**
 * shape null draws nothing. `growing`: the ring that is still open.
 *
 * @param {MapLibreMap} map
 * @param {Shape | null} shape
 * @param {{ chosen?: VertexPath | null, faults?: Fault[], growing?: VertexPath | null, hasHandles?: boolean }} [how]
 */
export function show(map, shape, { chosen = null, faults = [], growing = null, hasHandles = true } = {}) {
  setFeatures(map, "draw-shape", shape ? shapeFeatures(shape, growing) : []);
  setFeatures(map, "draw-points", shape && hasHandles ? handleFeatures(shape, chosen, growing) : []);
  setFeatures(
    map,
    "draw-faults",
    faults.flatMap((fault) => [
      ...fault.sides.map((side) => feature("fault", "LineString", side)),
      ...(fault.position ? [feature("fault", "Point", fault.position)] : []),
    ]),
  );
}

/**
 * What the next click would add: the side to the pointer, or the circle round its centre.
 *
 * @param {MapLibreMap} map
 * @param {Shape | null} shape
 */
export function showNext(map, shape) {
  setFeatures(map, "draw-next", shape ? shapeFeatures(shape, null) : []);
}

/** @param {MapLibreMap} map @param {number[] | null} position */
export function showSnap(map, position) {
  setFeatures(map, "draw-snap", position ? [feature("snap", "Point", position)] : []);
}

/** @param {Shape} shape @param {VertexPath | null} growing */
function shapeFeatures(shape, growing) {
  const circle = circleOf(shape);
  if (circle) {
    const ring = circleRing(circle.centre, circle.radius_m);
    return [feature("fill", "Polygon", [ring]), feature("side", "LineString", ring)];
  }
  if (shape.kind === "point" || shape.kind === "circle") return [];
  const start = shape.parts[0][0][0]?.[0];
  const parts = shape.parts.map((part) => part.map((ring) => continuous(ring, start)));
  /** @param {number} p @param {number} r */
  const isGrowing = (p, r) => growing !== null && growing[0] === p && growing[1] === r;
  /** @param {number[][]} ring */
  const closed = (ring) => [...ring, ring[0]];
  const fills =
    shape.kind === "area"
      ? parts
          .map((part, p) => part.filter((ring, r) => ring.length > 2 && !isGrowing(p, r)).map(closed))
          .filter((rings, p) => rings.length && !isGrowing(p, 0))
      : [];
  const sides = parts.flatMap((part, p) =>
    part.map((ring, r) => (shape.kind === "area" && ring.length > 2 && !isGrowing(p, r) ? closed(ring) : ring)),
  );
  return [
    ...(fills.length ? [feature("fill", "MultiPolygon", fills)] : []),
    ...sides.filter((ring) => ring.length > 1).map((ring) => feature("side", "LineString", ring)),
  ];
}

/**
 * The handles of a shape: { role, at, position }; `at` of a middle is the vertex before it.
 *
 * @param {Shape} shape
 * @returns {Handle[]}
 */
export function handlesOf(shape) {
  /** @type {Handle[]} */
  const vertices = verticesOf(shape).map(({ at, position }) => ({ role: "vertex", at, position }));
  const radius = radiusHandle(shape);
  /** @type {Handle[]} */
  const middles =
    vertices.length <= MAX_MIDDLES
      ? middlesOf(shape).map(({ after, position }) => ({ role: "middle", at: after, position }))
      : [];
  /** @type {Handle[]} */
  const radii = radius ? [{ role: "radius", at: null, position: radius }] : [];
  return [...middles, ...vertices, ...radii];
}

/** @param {Shape} shape @param {VertexPath | null} chosen @param {VertexPath | null} growing */
function handleFeatures(shape, chosen, growing) {
  /** @param {Handle} handle */
  const isChosen = ({ role, at }) => role === "vertex" && chosen !== null && at?.join() === chosen.join();
  return handlesOf(shape)
    .filter(({ role }) => role === "vertex" || !growing)
    .map((handle) => feature(handle.role, "Point", handle.position, { chosen: isChosen(handle) }));
}
