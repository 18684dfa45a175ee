/** A QR code as a drawing. */

import { svg } from "../dom.js";

const QUIET = 4; // modules around it, by ISO/IEC 18004

/**
 * @param {readonly string[]} rows of modules, "1" is dark
 * @param {string} label
 */
export function qrCode(rows, label) {
  const size = rows.length + 2 * QUIET;
  const path = rows.flatMap((row, y) =>
    [...row].flatMap((dark, x) => (dark === "1" ? [`M${x + QUIET} ${y + QUIET}h1v1h-1z`] : [])),
  );
  return svg(
    "svg",
    { class: "qr-code", viewBox: `0 0 ${size} ${size}`, role: "img", "aria-label": label },
    svg("rect", { width: size, height: size, class: "light" }),
    svg("path", { d: path.join(""), class: "dark" }),
  );
}
