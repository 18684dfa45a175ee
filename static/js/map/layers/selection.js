/** What is picked as a whole (lines), and what the pointer or a list row is at. */

const collection = (geometries) => ({ type: "FeatureCollection", features: geometries.map((geometry) => ({ type: "Feature", properties: {}, geometry })) });

export function update(map, geometries) {
  map.getSource("picked-shapes").setData(collection(geometries));
}

/** Geometries to ring: a point, or all pieces of a line. */
export function showHovered(map, geometries) {
  map.getSource("selection").setData(collection(geometries));
}
