/** What is picked as a whole (lines), and what the pointer or a list row is at. */

import { TILES } from "../voltages.js";

let lit = null; // the zone that is ringed

const collection = (geometries) => ({
  type: "FeatureCollection",
  features: geometries.map((geometry) => ({ type: "Feature", properties: {}, geometry })),
});

export function update(map, geometries) {
  map.getSource("picked-shapes").setData(collection(geometries));
}

/** Rings a zone of the tiles, whose pieces end at the edges of tiles; null takes the ring away. */
export function showZone(map, id) {
  if (id === lit) return;
  const zone = (of) => ({ source: TILES, sourceLayer: "zones", id: of });
  if (lit !== null) map.setFeatureState(zone(lit), { lit: false });
  if (id !== null) map.setFeatureState(zone(id), { lit: true });
  lit = id;
}

/** Geometries to ring: a point, or all pieces of a line. */
export function showHovered(map, geometries) {
  map.getSource("selection").setData(collection(geometries));
}
