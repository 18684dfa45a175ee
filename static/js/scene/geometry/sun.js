/** Position of the sun. Numbers in, numbers out. */

const RADIANS = Math.PI / 180;
const DAY_MS = 86_400_000;

/**
 * { altitude_deg, azimuth_deg (clockwise from north) } at a place [lon, lat] and a Date, within a tenth of a degree; without refraction.
 * Source: the Astronomical Almanac's approximate solar coordinates.
 *
 * @param {Date} date
 * @param {readonly number[]} place
 */
export function sunAt(date, [lon, lat]) {
  const days = (date.getTime() - Date.UTC(2000, 0, 1, 12)) / DAY_MS;
  const mean = 280.46 + 0.9856474 * days;
  const anomaly = (357.528 + 0.9856003 * days) * RADIANS;
  const ecliptic = (mean + 1.915 * Math.sin(anomaly) + 0.02 * Math.sin(2 * anomaly)) * RADIANS;
  const tilt = (23.439 - 4e-7 * days) * RADIANS;
  const ascension = Math.atan2(Math.cos(tilt) * Math.sin(ecliptic), Math.cos(ecliptic));
  const declination = Math.asin(Math.sin(tilt) * Math.sin(ecliptic));
  const sidereal_deg = 280.46062 + 360.985647 * days + lon;
  const hour = sidereal_deg * RADIANS - ascension;
  const [sine, cosine] = [Math.sin(lat * RADIANS), Math.cos(lat * RADIANS)];
  const altitude = Math.asin(sine * Math.sin(declination) + cosine * Math.cos(declination) * Math.cos(hour));
  const azimuth = Math.atan2(-Math.sin(hour), Math.tan(declination) * cosine - sine * Math.cos(hour));
  return { altitude_deg: altitude / RADIANS, azimuth_deg: (azimuth / RADIANS + 360) % 360 };
}
