/** Straight members: what towers are built of. Arrays in, arrays out. */

/**
 * A list of members that grows: add(start, end, width_m, tone), points [x, y, z]. Taken as { ends: Float32Array (6 n), width_m (n),
 * tone: Uint8Array (n) }.
 */
export function memberList() {
  const [ends, widths, tones] = [[], [], []];
  return {
    add(start, end, width_m, tone = 0) {
      ends.push(...start, ...end);
      widths.push(width_m);
      tones.push(tone);
    },
    get length() {
      return widths.length;
    },
    take: () => ({ ends: Float32Array.from(ends), width_m: Float32Array.from(widths), tone: Uint8Array.from(tones) }),
  };
}

/**
 * For each member the 4 x 4 matrix, by columns, that brings a prism of width 1 around y = -1/2 to 1/2 to its place; written to `into` from
 * member number `from` on, where given.
 */
export function memberMatrices({ ends, width_m }, into = new Float32Array(width_m.length * 16), from = 0) {
  for (let member = 0; member < width_m.length; member += 1) {
    const at = member * 6;
    const [x0, y0, z0, x1, y1, z1] = ends.subarray(at, at + 6);
    const [dx, dy, dz] = [x1 - x0, y1 - y0, z1 - z0];
    const length = Math.hypot(dx, dy, dz) || 1e-6;
    const [ux, uy, uz] = [dx / length, dy / length, dz / length];
    // A side that is level where the member is not upright, so that prisms lie square.
    const level = Math.hypot(ux, uz);
    const [sx, sy, sz] = level > 1e-4 ? [-uz / level, 0, ux / level] : [1, 0, 0];
    const [tx, ty, tz] = [sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux];
    const width = width_m[member];
    into.set(
      [
        sx * width, sy * width, sz * width, 0,
        dx, dy, dz, 0,
        tx * width, ty * width, tz * width, 0,
        (x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2, 1,
      ],
      (from + member) * 16,
    );
  }
  return into;
}
