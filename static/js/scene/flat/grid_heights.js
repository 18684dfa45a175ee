/** Heights of the ground between the points of a scene's grid. Values in, values out. */

/** ground: of GET /api/v1/scene. → heightAt(x, z) → y in the frame; beyond the grid as at its edge. */
export function gridHeights(ground, frame) {
  const { west_deg, north_deg, step_lon_deg, step_lat_deg, columns, rows, altitude_amsl_m: heights } = ground;
  const origin_m = frame.origin.altitude_amsl_m;
  const [step_x, step_z] = [step_lon_deg * frame.metresPerDegree[0], step_lat_deg * frame.metresPerDegree[1]];
  const [x0, , z0] = frame.toLocal(west_deg, north_deg, 0);
  const clamp = (value, most) => Math.min(Math.max(value, 0), most);
  return (x, z) => {
    const [column, row] = [clamp((x - x0) / step_x, columns - 1), clamp((z - z0) / step_z, rows - 1)];
    const [left, top] = [Math.min(Math.floor(column), Math.max(columns - 2, 0)), Math.min(Math.floor(row), Math.max(rows - 2, 0))];
    const [right, bottom] = [Math.min(left + 1, columns - 1), Math.min(top + 1, rows - 1)];
    const [across, down] = [column - left, row - top];
    const mix = (a, b, share) => a + (b - a) * share;
    return mix(mix(heights[top * columns + left], heights[top * columns + right], across), mix(heights[bottom * columns + left], heights[bottom * columns + right], across), down) - origin_m;
  };
}
