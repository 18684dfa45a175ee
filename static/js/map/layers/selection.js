/** What is picked as a whole (lines), and what the pointer or a list row is at. */

const collection = (geometries) => ({ type: "FeatureCollection", features: geometries.map((geometry) => ({ type: "Feature", properties: {}, geometry })) });

export function update(map, geometries) {
  map.getSource("picked-shapes").setData(collection(geometries));
}

export function showHovered(map, geometry) {
  map.getSource("selection").setData(collection(geometry ? [geometry] : []));
}
