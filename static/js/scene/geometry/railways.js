/** Railways: a bed over the ground, ramps to the bridges that carry it, and two rails a track. Values in, arrays out. */

const STEP_M = 20;
const GAUGE_M = 1.435;
const TRACK_M = 4.2; // from track to track
const BED_M = 4.4; // across, of one track
const BED_LIFT_M = 0.35;
const RAIL_LIFT_M = 0.25; // above the bed
const STEEPEST = 0.035; // of a ramp

/**
 * Gives { bed: { vertices, uv (0 to 1 across, metres along), index }, rails: Float32Array of segments (x, y, z, x, y, z) }.
 * deckAt(x, z): y of a bridge for rails there, or null.
 */
export function railwayTrack(railway, { frame, ground, deckAt = () => null }) {
  const points = densified(railway.line.map(([lon, lat]) => frame.toLocal(lon, lat, 0)).map(([x, , z]) => [x, z]));
  const heights = profile(points, ground, deckAt);
  const width_m = BED_M + (railway.tracks - 1) * TRACK_M;
  const bed = { vertices: new Float32Array(points.length * 6), uv: new Float32Array(points.length * 4), index: [] };
  const sides = sidesOf(points);
  let along_m = 0;
  points.forEach(([x, z], place) => {
    if (place) along_m += Math.hypot(x - points[place - 1][0], z - points[place - 1][1]);
    const [side_x, side_z] = sides[place];
    for (const [corner, sign] of [[0, -1], [1, 1]]) {
      const at = place * 2 + corner;
      bed.vertices.set([x + (sign * side_x * width_m) / 2, heights[place] + BED_LIFT_M, z + (sign * side_z * width_m) / 2], at * 3);
      bed.uv.set([corner, along_m], at * 2);
    }
    if (place < points.length - 1) {
      const low = place * 2;
      bed.index.push(low, low + 1, low + 2, low + 1, low + 3, low + 2);
    }
  });
  return { bed: { ...bed, index: Uint32Array.from(bed.index) }, rails: railLines(points, heights, sides, railway.tracks) };
}

function railLines(points, heights, sides, tracks) {
  const segments = [];
  for (let track = 0; track < tracks; track += 1) {
    const middle_m = (track - (tracks - 1) / 2) * TRACK_M;
    for (const across of [middle_m - GAUGE_M / 2, middle_m + GAUGE_M / 2]) {
      const place = (at) => [points[at][0] + across * sides[at][0], heights[at] + BED_LIFT_M + RAIL_LIFT_M, points[at][1] + across * sides[at][1]];
      for (let at = 0; at < points.length - 1; at += 1) segments.push(...place(at), ...place(at + 1));
    }
  }
  return Float32Array.from(segments);
}

function densified(line) {
  const points = [];
  line.forEach(([x, z], at) => {
    if (at) {
      const [lastX, lastZ] = line[at - 1];
      const pieces = Math.ceil(Math.hypot(x - lastX, z - lastZ) / STEP_M);
      for (let piece = 1; piece < pieces; piece += 1) points.push([lastX + ((x - lastX) * piece) / pieces, lastZ + ((z - lastZ) * piece) / pieces]);
    }
    points.push([x, z]);
  });
  return points;
}

/** The ground, lifted to bridges, with ramps before and behind them. */
function profile(points, ground, deckAt) {
  const heights = points.map(([x, z]) => Math.max(ground.heightAt(x, z), deckAt(x, z) ?? -Infinity));
  const ramp = (here, before) => {
    const far_m = Math.hypot(points[here][0] - points[before][0], points[here][1] - points[before][1]);
    heights[here] = Math.max(heights[here], heights[before] - STEEPEST * far_m);
  };
  for (let at = 1; at < points.length; at += 1) ramp(at, at - 1);
  for (let at = points.length - 2; at >= 0; at -= 1) ramp(at, at + 1);
  return heights;
}

/** At each point the direction to the right, of length 1. */
function sidesOf(points) {
  return points.map((_, at) => {
    const [before, after] = [points[Math.max(at - 1, 0)], points[Math.min(at + 1, points.length - 1)]];
    const [x, z] = [after[0] - before[0], after[1] - before[1]];
    const length = Math.hypot(x, z) || 1;
    return [-z / length, x / length];
  });
}
