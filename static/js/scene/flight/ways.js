/** Planned and flown ways as ribbons with height poles: one drawing for all routes of a kind, cut off at the moment that is shown. */

import { heightPoles, ribbon, stepped } from "../geometry/ribbon.js";
import { ESTIMATED } from "../sources/pieces.js";
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Group,
  LineSegments,
  Mesh,
  ShaderMaterial,
  Vector4,
} from "../three.js";

/** @import { HeightAt, ScenePalette, Vector } from "../types.d.ts" */
/** @import { FlownRoute, PlannedLine } from "./drawn_flight.js" */

/** @typedef {ReturnType<typeof createWays>} Ways */
/** @typedef {{ positions: number[], at_s?: number[] | null }} TimedPoints at_s: null where time is not shown */
/** @typedef {{ isLine?: boolean, width_m?: number, least_px?: number, most_px?: number, opacity: number, later: number }} WayLook later: opacity of the part after the moment shown */
/** @typedef {TimedPoints & { place: number, dashed?: boolean }} WayLine */
/** @typedef {{ position: Float32Array } & { [name: string]: Float32Array }} Attributes */
/** @typedef {{ arrays: Attributes, index?: Uint32Array | null }} Built */

const ROUTES = 8;
const PLANNED = { width_m: 0.16, least_px: 1.4, most_px: 3, poles_m: 120 };
const FLOWN = { width_m: 0.42, least_px: 3.2, most_px: 8, poles_m: 60 };
const APART_M = 0.4; // nearer points of a path add no visible detail
const MAX_LENGTH_M = 20; // of a stretch: its width is interpolated between its ends, which is right only for a short one
const ALWAYS_S = -1e9; // a time that is over
const FOR_EVER_S = 1e30;

const VERTEX = `
  uniform vec2 viewport; uniform float leastPx; uniform float mostPx; uniform float halfWidth;
  attribute vec3 tangent; attribute float along; attribute float at; attribute float route; attribute float dashed; attribute float side;
  varying float vAlong; varying float vAt; varying float vDashed; varying float vRoute; varying vec3 vPlace;
  void main() {
    vPlace = position;
    vec4 seen = modelViewMatrix * vec4(position, 1.0);
    vec3 way = (modelViewMatrix * vec4(tangent, 0.0)).xyz;
    vec3 across = cross(way, normalize(seen.xyz));
    across = length(across) > 1e-4 ? normalize(across) : vec3(1.0, 0.0, 0.0);
    float metresPerPixel = 2.0 * -seen.z / (projectionMatrix[1][1] * viewport.y);
    float most = 0.5 * mostPx * metresPerPixel; // behind the camera less than nothing, so that what is before it is as wide as it ought to be
    seen.xyz += across * side * (seen.z < 0.0 ? clamp(halfWidth, 0.5 * leastPx * metresPerPixel, most) : most);
    vAlong = along; vAt = at; vDashed = dashed; vRoute = route;
    gl_Position = projectionMatrix * seen;
  }`;
const LINE_VERTEX = `
  attribute float at; attribute float route;
  varying float vAlong; varying float vAt; varying float vDashed; varying float vRoute; varying vec3 vPlace;
  void main() {
    vPlace = vec3(1e9); vAlong = 0.0; vAt = at; vDashed = 0.0; vRoute = route;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }`;
const FRAGMENT = `
  uniform vec3 colours[${ROUTES}]; uniform float now; uniform float opacity; uniform float later; uniform float looked; uniform float rest; uniform vec4 heads[${ROUTES}];
  varying float vAlong; varying float vAt; varying float vDashed; varying float vRoute; varying vec3 vPlace;
  void main() {
    if (vDashed > 0.5) {
      float period = max(5.0, exp2(ceil(log2(max(fwidth(vAlong) * 9.0, 1e-4)))));
      if (fract(vAlong / period) > 0.56) discard;
    }
    int number = int(mod(vRoute + 0.5, ${ROUTES}.0));
    float alpha = opacity * (vAt > now ? later : 1.0) * (looked < -0.5 || abs(looked - vRoute) < 0.5 ? 1.0 : rest);
    vec3 colour = colours[0];
    vec4 head = heads[0];
    for (int i = 1; i < ${ROUTES}; i++) if (i == number) { colour = colours[i]; head = heads[i]; }
    if (head.w > 0.0) alpha *= smoothstep(head.w * 0.55, head.w, distance(vPlace, head.xyz));
    if (alpha < 0.01) discard;
    gl_FragColor = vec4(colour, alpha);
    #include <colorspace_fragment>
  }`;

/** @param {WayLook} look */
function material({ isLine, width_m = 0, least_px = 1, most_px = 1, opacity, later }) {
  return new ShaderMaterial({
    vertexShader: isLine ? LINE_VERTEX : VERTEX,
    fragmentShader: FRAGMENT,
    uniforms: {
      viewport: { value: [1, 1] },
      leastPx: { value: least_px },
      mostPx: { value: most_px },
      halfWidth: { value: width_m / 2 },
      colours: { value: Array.from({ length: ROUTES }, () => new Color()) },
      now: { value: FOR_EVER_S },
      opacity: { value: opacity },
      later: { value: later },
      heads: { value: Array.from({ length: ROUTES }, () => new Vector4()) },
      looked: { value: -1 },
      rest: { value: 0.35 },
    },
    transparent: true,
    depthWrite: false,
    side: DoubleSide,
  });
}

/** Unit directions along a line of points, n × 3. @param {readonly number[]} positions */
function tangentsOf(positions) {
  const count = positions.length / 3;
  const found = new Float32Array(positions.length);
  for (let point = 0; point < count; point += 1) {
    const [from, to] = [Math.max(point - 1, 0) * 3, Math.min(point + 1, count - 1) * 3];
    const way = [0, 1, 2].map((axis) => positions[to + axis] - positions[from + axis]);
    const length = Math.hypot(...way) || 1;
    way.forEach((metres, axis) => {
      found[point * 3 + axis] = metres / length;
    });
  }
  return found;
}

/** Names of a ribbon's attributes with the count of numbers per vertex; its material sets the width, and it turns to the camera. */
const ATTRIBUTES = { position: 3, tangent: 3, along: 1, at: 1, route: 1, dashed: 1, side: 1 };

/**
 * The line without points close to each other; the first and the last one stay.
 *
 * @template {TimedPoints} Line
 * @param {Line} line
 */
export function thinned({ positions, at_s, ...line }) {
  /** @type {number[]} */
  const kept = [];
  /** @type {number[]} */
  const times = [];
  const count = positions.length / 3;
  for (let point = 0; point < count; point += 1) {
    const [x, y, z] = positions.slice(point * 3, point * 3 + 3);
    const end = kept.length;
    if (end && point < count - 1 && Math.hypot(x - kept[end - 3], y - kept[end - 2], z - kept[end - 1]) < APART_M)
      continue;
    kept.push(x, y, z);
    if (at_s) times.push(at_s[point]);
  }
  return { ...line, positions: kept, at_s: at_s && times };
}

/** Returns attributes and index of all lines together. @param {readonly WayLine[]} lines */
export function ribbonArrays(lines) {
  const drawn = lines
    .map(thinned)
    .filter(({ positions }) => positions.length >= 6)
    .map((line) => stepped(line, MAX_LENGTH_M))
    .map((line) => ({ ...line, band: ribbon(line.positions), tangents: tangentsOf(line.positions) }));
  const count = drawn.reduce((sum, { positions }) => sum + (positions.length / 3) * 2, 0);
  const arrays = {
    position: new Float32Array(count * 3),
    tangent: new Float32Array(count * 3),
    along: new Float32Array(count),
    at: new Float32Array(count),
    route: new Float32Array(count),
    dashed: new Float32Array(count),
    side: new Float32Array(count),
  };
  const index = new Uint32Array(drawn.reduce((sum, { band }) => sum + band.index.length, 0));
  let [first, put] = [0, 0];
  for (const { place, positions, at_s, dashed, band, tangents } of drawn) {
    arrays.along.set(band.along_m, first);
    for (let vertex = 0; vertex < band.along_m.length; vertex += 1) {
      const point = vertex >> 1;
      for (let axis = 0; axis < 3; axis += 1) {
        arrays.position[(first + vertex) * 3 + axis] = positions[point * 3 + axis];
        arrays.tangent[(first + vertex) * 3 + axis] = tangents[point * 3 + axis];
      }
      arrays.at[first + vertex] = at_s ? at_s[point] : ALWAYS_S;
      arrays.route[first + vertex] = place;
      arrays.dashed[first + vertex] = dashed ? 1 : 0;
      arrays.side[first + vertex] = vertex % 2 ? 1 : -1;
    }
    for (const number of band.index) index[put++] = number + first;
    first += band.along_m.length;
  }
  return { arrays, index };
}

/**
 * Poles of lines: positions of their ends, with route and time of each end.
 *
 * @param {readonly WayLine[]} lines
 * @param {HeightAt} groundAt
 * @param {number} spacing_m
 */
export function poleArrays(lines, groundAt, spacing_m) {
  /** @type {number[]} */
  const position = [];
  /** @type {number[]} */
  const route = [];
  /** @type {number[]} */
  const at = [];
  for (const { place, positions, at_s } of lines) {
    const { segments } = heightPoles(positions, groundAt, { spacing_m });
    const poles = segments.length / 6;
    const whenPassed = at_s && passing(positions, at_s);
    for (let pole = 0; pole < poles; pole += 1) {
      const when = whenPassed ? whenPassed(pole === poles - 1 ? Infinity : pole * spacing_m) : ALWAYS_S;
      for (let axis = 0; axis < 6; axis += 1) position.push(segments[pole * 6 + axis]);
      route.push(place, place);
      at.push(when, when);
    }
  }
  return { arrays: { position: new Float32Array(position), route: new Float32Array(route), at: new Float32Array(at) } };
}

/**
 * Return the function that gives when so many metres over the ground were flown; its argument must not decrease.
 *
 * @param {readonly number[]} positions
 * @param {readonly number[]} at_s
 */
function passing(positions, at_s) {
  let [point, way_m] = [0, 0];
  /** @param {number} wanted_m */
  return (wanted_m) => {
    for (; point < at_s.length - 1; point += 1) {
      const step_m = Math.hypot(
        positions[point * 3 + 3] - positions[point * 3],
        positions[point * 3 + 5] - positions[point * 3 + 2],
      );
      if (way_m + step_m >= wanted_m)
        return at_s[point] + (at_s[point + 1] - at_s[point]) * (step_m > 0 ? (wanted_m - way_m) / step_m : 0);
      way_m += step_m;
    }
    return at_s[at_s.length - 1];
  };
}

/** @param {Built} built @param {Record<string, number>} sizes */
function geometryOf({ arrays, index = null }, sizes) {
  const geometry = new BufferGeometry();
  for (const [name, array] of Object.entries(arrays))
    geometry.setAttribute(name, new BufferAttribute(array, sizes[name]));
  if (index) geometry.setIndex(new BufferAttribute(index, 1));
  return geometry;
}

/**
 * @template {Mesh | LineSegments} Drawing
 * @param {Drawing} object
 * @param {number} order
 */
function drawing(object, order) {
  object.frustumCulled = false; // attributes besides the position move its vertices
  object.renderOrder = order;
  object.visible = false;
  return object;
}

/** @param {Mesh | LineSegments} object @param {Built} built @param {Record<string, number>} sizes */
function refill(object, built, sizes) {
  object.geometry.dispose();
  object.geometry = geometryOf(built, sizes);
  object.visible = built.arrays.position.length > 0;
}

/** @param {HeightAt} groundAt of the drawn ground */
export function createWays(groundAt) {
  const group = new Group();
  /** @param {WayLook} look @param {number} order */
  const band = (look, order) => drawing(new Mesh(new BufferGeometry(), material(look)), order);
  /** @param {WayLook} look */
  const poles = (look) => drawing(new LineSegments(new BufferGeometry(), material({ ...look, isLine: true })), 1);
  const planned = band({ ...PLANNED, opacity: 0.85, later: 1 }, 1);
  const plannedPoles = poles({ opacity: 0.22, later: 1 });
  const flown = band({ ...FLOWN, opacity: 1, later: 0.16 }, 2);
  const flownPoles = poles({ opacity: 0.32, later: 0 });
  const all = [planned, plannedPoles, flown, flownPoles];
  group.add(...all);
  let from_ms = 0;

  return {
    group,
    /** @param {readonly PlannedLine[]} lines */
    showPlanned(lines) {
      const dashed = lines.map((line) => ({ ...line, at_s: null, dashed: true }));
      refill(planned, ribbonArrays(dashed), ATTRIBUTES);
      refill(plannedPoles, poleArrays(dashed, groundAt, PLANNED.poles_m), { position: 3, route: 1, at: 1 });
    },
    /**
     * @param {readonly FlownRoute[]} routes
     * @param {number} begins_ms from which times are counted, so that they stay exact
     */
    showFlown(routes, begins_ms) {
      from_ms = begins_ms;
      const lines = routes.flatMap(({ place, pieces }) =>
        pieces.map(({ kind, positions, at_ms }) => ({
          place,
          positions,
          at_s: at_ms.map((at) => (at - from_ms) / 1_000),
          dashed: kind === ESTIMATED,
        })),
      );
      refill(flown, ribbonArrays(lines), ATTRIBUTES);
      refill(
        flownPoles,
        poleArrays(
          lines.filter(({ dashed }) => !dashed),
          groundAt,
          FLOWN.poles_m,
        ),
        { position: 3, route: 1, at: 1 },
      );
    },
    /**
     * @param {object} now
     * @param {number | null} now.at_ms the part after it is faint
     * @param {readonly { route: number, place: Vector, radius_m: number }[]} now.heads UAVs, which their paths do not cover
     * @param {number | null} now.looked place of the selected route
     * @param {number[]} now.viewport
     */
    frame({ at_ms, heads, looked, viewport }) {
      for (const { material: look } of all) {
        look.uniforms.now.value = at_ms === null ? FOR_EVER_S : (at_ms - from_ms) / 1_000;
        look.uniforms.looked.value = looked ?? -1;
        look.uniforms.viewport.value = viewport;
        for (const head of look.uniforms.heads.value) head.set(0, 0, 0, 0);
        for (const { route, place, radius_m } of heads)
          look.uniforms.heads.value[route % ROUTES].set(...place, radius_m);
      }
    },
    /** @param {Pick<ScenePalette, "routes">} palette */
    setPalette(palette) {
      for (const { material: look } of all) {
        for (const [index, colour] of look.uniforms.colours.value.entries()) colour.set(palette.routes[index]);
      }
    },
    dispose() {
      for (const { geometry, material: look } of all) {
        geometry.dispose();
        look.dispose();
      }
    },
  };
}
