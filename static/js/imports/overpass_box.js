/** "Take the visible area from Overpass": how large it is, how large it may be, and the button. */

import { byId } from "../dom.js";

const EARTH_RADIUS_KM = 6_371.0088; // IUGG mean radius

/** Area of [west, south, east, north] on the sphere. */
export function areaKm2([west, south, east, north]) {
  const radians = Math.PI / 180;
  return EARTH_RADIUS_KM ** 2 * Math.abs(east - west) * radians * Math.abs(Math.sin(north * radians) - Math.sin(south * radians));
}

const text = (area_km2) => `${area_km2.toLocaleString("en-GB", { maximumFractionDigits: area_km2 < 10 ? 1 : 0 })}\u00a0km²`;

/** limit: { most_km2 }. take(box) asks for it. */
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
    words.textContent = isTooLarge ? `The map shows ${text(area_km2)}; at most ${text(limit.most_km2)} are taken at once. Zoom in.` : `The map shows ${text(area_km2)}, of at most ${text(limit.most_km2)}.`;
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
