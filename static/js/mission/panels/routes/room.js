/** Room in the dock for the strips of the routes. */

import { find } from "../../../dom.js";

const BESIDE_PX = 184 + 84 + 72 + 80 + 4 * 12 + 32; // name, figures, hand and Why, gaps and edges, as in planning.css
const BATTERY_PX = 76 + 12; // where one has a battery
const MIN_STRIP_PX = 200; // below this, battery is hidden
const MIN_PX = 160;

/** @param {HTMLElement} dock */
export const mainOf = (dock) => find(dock, ".dock-main", HTMLElement);

/** Width that the grid leaves beside name and all figures. @param {HTMLElement} dock */
const roomBesideAll = (dock) =>
  mainOf(dock).clientWidth - BESIDE_PX - (dock.classList.contains("with-battery") ? BATTERY_PX : 0);

/** Whether battery must be hidden. @param {HTMLElement} dock */
export const isTight = (dock) => roomBesideAll(dock) < MIN_STRIP_PX;

/**
 * Room for a strip: on a phone all there is, where the dock is narrow without battery.
 *
 * @param {HTMLElement} dock
 */
export function stripRoom(dock) {
  const width = mainOf(dock).clientWidth;
  if (matchMedia("(max-width: 720px)").matches) return Math.max(MIN_PX, width - 32);
  const room = roomBesideAll(dock);
  return Math.max(MIN_PX, room < MIN_STRIP_PX ? width - BESIDE_PX : room);
}
