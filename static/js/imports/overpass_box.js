/** "Take the visible area from Overpass": its size, the limit, and the button. */

import { byId } from "../dom.js";
import { t } from "../text.js";
import { areaText } from "../units.js";

/** @import { mountGroundMap } from "../ground/ground_map.js" */

const EARTH_RADIUS_KM = 6_371.0088; // IUGG mean radius

/** Area of [west, south, east, north] on the sphere. @param {readonly number[]} box west, south, east, north */
export function areaKm2([west, south, east, north]) {
  const radians = Math.PI / 180;
  return (
    EARTH_RADIUS_KM ** 2 *
    Math.abs(east - west) *
    radians *
    Math.abs(Math.sin(north * radians) - Math.sin(south * radians))
  );
}

/** @param {number} area_km2 */
const text = (area_km2) => areaText(area_km2 * 1e6);

/**
 * @param {ReturnType<typeof mountGroundMap>} map
 * @param {{ most_km2: number }} limit
 * @param {(box: number[]) => Promise<unknown>} take starts it
 */
export function mountOverpassBox(map, limit, take) {
  byId("overpass").hidden = false;
  const button = byId("take-area");
  const words = byId("area-words");
  const box = () => map.box().map((degrees) => Number(degrees.toFixed(6)));
  let isTooLarge = false;

  function measure() {
    const [west, south, east, north] = box();
    const area_km2 = areaKm2([west, south, east, north]);
    isTooLarge = area_km2 > limit.most_km2 || west < -180 || east > 180;
    button.setAttribute("aria-disabled", String(isTooLarge));
    words.textContent = isTooLarge
      ? t("The map shows {area}; at most {most} are taken at once. Zoom in.", {
          area: text(area_km2),
          most: text(limit.most_km2),
        })
      : t("The map shows {area}, of at most {most}.", { area: text(area_km2), most: text(limit.most_km2) });
  }
  map.map.on("moveend", measure);
  measure();
  button.addEventListener("click", async () => {
    if (isTooLarge || button.getAttribute("aria-busy") === "true") return;
    button.setAttribute("aria-busy", "true");
    await take(box());
    button.setAttribute("aria-busy", "false");
  });
}
