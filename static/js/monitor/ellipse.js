/** An ellipse on the ground as a ring of positions. */

const METRES_A_DEGREE = 111_320;
const POINTS = 48;

/** centre: longitude, latitude [deg]; bound: half-axes [m] along a bearing [deg from north, clockwise] and across it. */
export function ringOf([longitude, latitude], { along_m, across_m, bearing_deg }, scale = 1) {
  const bearing = (bearing_deg * Math.PI) / 180;
  const east_m = METRES_A_DEGREE * Math.cos((latitude * Math.PI) / 180);
  return Array.from({ length: POINTS + 1 }, (_, index) => {
    const angle = (2 * Math.PI * (index % POINTS)) / POINTS;
    const along = along_m * scale * Math.cos(angle);
    const across = across_m * scale * Math.sin(angle);
    const east = along * Math.sin(bearing) + across * Math.cos(bearing);
    const north = along * Math.cos(bearing) - across * Math.sin(bearing);
    return [longitude + east / east_m, latitude + north / METRES_A_DEGREE];
  });
}
