/** Lengths and areas while drawing, on the sphere: within 0.5 % of the server's measurement on the ellipsoid; and the box round positions. */

/** @import { Box } from "../map/types.d.ts" */

const EARTH_RADIUS_M = 6_371_008.8; // IUGG mean radius
const RADIANS = Math.PI / 180;
const CIRCLE_CORNERS = 96;

/** @typedef {{ type: "LineString", coordinates: number[][] } | { type: "MultiLineString", coordinates: number[][][] }} Line in GeoJSON */
/**
 * A drawn shape: polygons of open rings. A line is the only ring of the only part; a point and the centre of a circle are the first
 * position of such a ring.
 *
 * @typedef {{ kind: "point" | "line" | "area" | "circle", parts: number[][][][], radius_m: number | null }} Shape
 */

/** @param {readonly number[]} from longitude, latitude @param {readonly number[]} to @returns {number} */
export function distance_m([lon1, lat1], [lon2, lat2]) {
  const [a, b] = [lat1 * RADIANS, lat2 * RADIANS];
  const half = Math.sin((b - a) / 2) ** 2 + Math.cos(a) * Math.cos(b) * Math.sin(((lon2 - lon1) * RADIANS) / 2) ** 2;
  return 2 * EARTH_RADIUS_M * Math.asin(Math.min(1, Math.sqrt(half)));
}

/**
 * The position at a bearing (degrees from north) and a distance.
 *
 * @param {readonly number[]} from longitude, latitude
 * @param {number} bearing_deg
 * @param {number} far_m
 * @returns {[number, number]}
 */
export function towards([longitude, latitude], bearing_deg, far_m) {
  const [angle, bearing, lat] = [far_m / EARTH_RADIUS_M, bearing_deg * RADIANS, latitude * RADIANS];
  const north = Math.asin(Math.sin(lat) * Math.cos(angle) + Math.cos(lat) * Math.sin(angle) * Math.cos(bearing));
  const east = Math.atan2(
    Math.sin(bearing) * Math.sin(angle) * Math.cos(lat),
    Math.cos(angle) - Math.sin(lat) * Math.sin(north),
  );
  return [longitude + east / RADIANS, north / RADIANS];
}

/**
 * The longitude in the turn nearest to another one: -179 beside 180 is 181.
 *
 * @param {number} other
 * @param {number} longitude
 */
export const beside = (other, longitude) =>
  Math.abs(longitude - other) <= 180 ? longitude : longitude + 360 * Math.round((other - longitude) / 360);

/**
 * A path over the 180th meridian without its jump: longitudes continue beyond ±180. It starts near `start`.
 *
 * @param {readonly (readonly number[])[]} path
 * @param {number} [start]
 * @returns {[number, number][]}
 */
export function continuous(path, start = path[0]?.[0]) {
  let last = start;
  return path.map(([longitude, latitude]) => {
    last = beside(last, longitude);
    return [last, latitude];
  });
}

/** @param {readonly (readonly number[])[]} path */
export const pathLength_m = (path) =>
  path.slice(1).reduce((sum, position, index) => sum + distance_m(path[index], position), 0);

/** Area of a ring that does not repeat its first position [m²]. @param {readonly (readonly number[])[]} ring */
export function ringArea_m2(ring) {
  let sum = 0;
  ring.forEach(([longitude, latitude], index) => {
    const [nextLon, nextLat] = ring[(index + 1) % ring.length];
    sum +=
      (beside(longitude, nextLon) - longitude) *
      RADIANS *
      (2 + Math.sin(latitude * RADIANS) + Math.sin(nextLat * RADIANS));
  });
  return Math.abs((sum * EARTH_RADIUS_M ** 2) / 2);
}

/** The box round positions, or null where there are none. @param {readonly (readonly number[])[]} positions @returns {Box | null} */
export function boxAround(positions) {
  if (!positions.length) return null;
  /** @type {Box} */
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [longitude, latitude] of positions) {
    box[0] = Math.min(box[0], longitude);
    box[1] = Math.min(box[1], latitude);
    box[2] = Math.max(box[2], longitude);
    box[3] = Math.max(box[3], latitude);
  }
  return box;
}

/** { length_m, area_m2 }: what there is of them. @param {Shape} shape */
export function measure(shape) {
  if (shape.kind === "line") return { length_m: pathLength_m(shape.parts[0][0]), area_m2: null };
  if (shape.kind === "circle") return { length_m: null, area_m2: Math.PI * (shape.radius_m ?? 0) ** 2 };
  if (shape.kind !== "area") return { length_m: null, area_m2: null };
  /** @param {number[][][]} rings the outline, then its holes */
  const ofPart = ([outer, ...holes]) => holes.reduce((sum, hole) => sum - ringArea_m2(hole), ringArea_m2(outer));
  return { length_m: null, area_m2: shape.parts.reduce((sum, part) => sum + ofPart(part), 0) };
}

/**
 * A circle as a closed ring, to be drawn.
 *
 * @param {readonly number[]} centre longitude, latitude
 * @param {number} radius_m
 */
export const circleRing = (centre, radius_m) =>
  Array.from({ length: CIRCLE_CORNERS + 1 }, (_, index) => towards(centre, (index * 360) / CIRCLE_CORNERS, radius_m));

/**
 * The point of a drawn line nearest to a place, both lon lat; lengths are compared on the local plane.
 *
 * @param {Line} geometry
 * @param {readonly number[]} place longitude, latitude
 * @returns {number[] | null}
 */
export function nearestOnLine(geometry, [longitude, latitude]) {
  const shrink = Math.cos((latitude * Math.PI) / 180);
  const parts = geometry.type === "MultiLineString" ? geometry.coordinates : [geometry.coordinates];
  let best = null;
  for (const part of parts) {
    for (let index = 1; index < part.length; index += 1) {
      const [ax, ay] = [part[index - 1][0] * shrink, part[index - 1][1]];
      const [bx, by] = [part[index][0] * shrink, part[index][1]];
      const [dx, dy] = [bx - ax, by - ay];
      const square = dx * dx + dy * dy;
      const share = square
        ? Math.min(1, Math.max(0, ((longitude * shrink - ax) * dx + (latitude - ay) * dy) / square))
        : 0;
      const [x, y] = [ax + share * dx, ay + share * dy];
      const distance = (x - longitude * shrink) ** 2 + (y - latitude) ** 2;
      if (!best || distance < best.distance) best = { distance, position: [x / shrink, y] };
    }
  }
  return best?.position.map((degrees) => Number(degrees.toFixed(7))) ?? null;
}

/**
 * A closed line with the corners that it needs to stay within a share of its extent (Douglas and Peucker 1973).
 *
 * @template {readonly number[]} Place
 * @param {readonly Place[]} ring open
 * @param {number} share
 * @returns {Place[]}
 */
export function simplified(ring, share) {
  const stretch = Math.cos((ring[0]?.[1] ?? 0) * RADIANS);
  const flat = ring.map(([longitude, latitude]) => [longitude * stretch, latitude]);
  const [xs, ys] = [0, 1].map((axis) => flat.map((point) => point[axis]));
  const within = share * Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys));
  /** @param {number} first @param {number} last @returns {number[]} indices that stay, without the last */
  function kept(first, last) {
    let [far, at] = [within, -1];
    for (let index = first + 1; index < last; index += 1) {
      const away = fromLine(flat[index], flat[first], flat[last]);
      if (away > far) [far, at] = [away, index];
    }
    return at < 0 ? [first] : [...kept(first, at), ...kept(at, last)];
  }
  if (ring.length < 4) return [...ring];
  const middle = ring.length >> 1;
  const last = ring.length - 1;
  const isBack = Math.hypot(flat[last][0] - flat[0][0], flat[last][1] - flat[0][1]) <= within; // at its begin
  return [...kept(0, middle), ...kept(middle, last), ...(isBack ? [] : [last])].map((index) => ring[index]);
}

/** Distance of a point from a line between two others. @param {number[]} point @param {number[]} from @param {number[]} to */
function fromLine([x, y], [x1, y1], [x2, y2]) {
  const length = Math.hypot(x2 - x1, y2 - y1);
  return length ? Math.abs((x2 - x1) * (y1 - y) - (x1 - x) * (y2 - y1)) / length : Math.hypot(x - x1, y - y1);
}
