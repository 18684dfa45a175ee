/** The arrow of a wind. */

import { svg } from "../../dom.js";

/** It points to where the wind blows that comes from there. @param {number} from_deg */
export function windArrow(from_deg) {
  const arrow = svg(
    "svg",
    { class: "wind-arrow", width: 16, height: 16, viewBox: "0 0 16 16", "aria-hidden": "true" },
    svg("path", { d: "M8 14V2.5M3.5 7L8 2.5L12.5 7" }),
  );
  arrow.style.rotate = `${from_deg + 180}deg`;
  return arrow;
}
