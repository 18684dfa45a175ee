/** What is being drawn, on the map: fill, sides, vertices and middles as handles, and what is wrong in red. */

import { circleRing } from "./measure.js";
import { circleOf, geometryOf, middlesOf, radiusHandle, verticesOf } from "./shape.js";

const NOTHING = { type: "FeatureCollection", features: [] };
export const HANDLES = "draw-handles";
const MOST_MIDDLES = 400; // of a large ring, only vertices

const read = (token) => getComputedStyle(document.documentElement).getPropertyValue(token).trim();
const isRole = (role) => ["==", ["get", "role"], role];
const touch = matchMedia("(pointer: coarse)").matches;

function layers() {
  const [accent, casing, raised, critical] = ["--accent", "--map-casing", "--raised", "--critical"].map(read);
  const round = { "line-cap": "round", "line-join": "round" };
  return [
    { id: "draw-fill", type: "fill", source: "draw-shape", filter: isRole("fill"), paint: { "fill-color": accent, "fill-opacity": 0.12 } },
    { id: "draw-casing", type: "line", source: "draw-shape", filter: isRole("side"), layout: round, paint: { "line-color": casing, "line-width": 6 } },
    { id: "draw-side", type: "line", source: "draw-shape", filter: isRole("side"), layout: round, paint: { "line-color": accent, "line-width": 2.5 } },
    { id: "draw-next", type: "line", source: "draw-shape", filter: isRole("next"), paint: { "line-color": accent, "line-width": 1.5, "line-dasharray": [3, 2] } },
    { id: "draw-fault", type: "line", source: "draw-faults", filter: ["==", ["geometry-type"], "LineString"], layout: round, paint: { "line-color": critical, "line-width": 4 } },
    {
      id: "draw-middles",
      type: "circle",
      source: "draw-points",
      filter: isRole("middle"),
      paint: { "circle-radius": touch ? 6 : 3.5, "circle-color": raised, "circle-opacity": 0.85, "circle-stroke-color": accent, "circle-stroke-width": 1.25 },
    },
    {
      id: HANDLES,
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
    { id: "draw-snap", type: "circle", source: "draw-snap", paint: { "circle-radius": 10, "circle-opacity": 0, "circle-stroke-color": accent, "circle-stroke-width": 2 } },
  ];
}

export function addTo(map) {
  for (const source of ["draw-shape", "draw-points", "draw-faults", "draw-snap"]) map.addSource(source, { type: "geojson", data: NOTHING });
  for (const layer of layers()) map.addLayer(layer);
}

export function recolour(map) {
  for (const layer of layers()) {
    for (const [name, value] of Object.entries(layer.paint)) map.setPaintProperty(layer.id, name, value);
  }
}

const feature = (role, type, coordinates, rest = {}) => ({ type: "Feature", properties: { role, ...rest }, geometry: { type, coordinates } });
const put = (map, source, features) => map.getSource(source).setData({ type: "FeatureCollection", features });

/** shape null draws nothing. `next`: the line from the last vertex to the pointer, while drawing. */
export function show(map, shape, { chosen = null, faults = [], next = null, hasHandles = true } = {}) {
  put(map, "draw-shape", shape ? [...shapeFeatures(shape), ...(next ? [feature("next", "LineString", next)] : [])] : []);
  put(map, "draw-points", shape && hasHandles ? handleFeatures(shape, chosen) : []);
  put(map, "draw-faults", faults.flatMap((fault) => [
    ...fault.sides.map((side) => feature("fault", "LineString", side)),
    ...(fault.position ? [feature("fault", "Point", fault.position)] : []),
  ]));
}

export function showSnap(map, position) {
  put(map, "draw-snap", position ? [feature("snap", "Point", position)] : []);
}

function shapeFeatures(shape) {
  const circle = circleOf(shape);
  if (circle) {
    const ring = circleRing(circle.centre, circle.radius_m);
    return [feature("fill", "Polygon", [ring]), feature("side", "LineString", ring)];
  }
  const geometry = shape.kind === "area" ? geometryOf(shape) : null;
  const sides = shape.parts.flat().filter((ring) => ring.length > 1);
  return [
    ...(geometry ? [feature("fill", geometry.type, geometry.coordinates)] : []),
    ...sides.map((ring) => feature("side", "LineString", shape.kind === "area" && ring.length > 2 ? [...ring, ring[0]] : ring)),
  ];
}

function handleFeatures(shape, chosen) {
  const isChosen = (at) => chosen !== null && at.join() === chosen.join();
  const vertices = verticesOf(shape);
  const middles = vertices.length <= MOST_MIDDLES ? middlesOf(shape) : [];
  const radius = radiusHandle(shape);
  return [
    ...middles.map(({ after, position }) => feature("middle", "Point", position, { at: after.join(), chosen: false })),
    ...vertices.map(({ at, position }) => feature("vertex", "Point", position, { at: at.join(), chosen: isChosen(at) })),
    ...(radius ? [feature("radius", "Point", radius, { at: "", chosen: false })] : []),
  ];
}
