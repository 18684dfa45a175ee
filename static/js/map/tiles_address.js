/** Address of the vector tiles. With the version that the page was made with, browsers keep them for some minutes. */

import { copiedAt } from "../offline_copy.js";

/** @type {HTMLMetaElement | null | undefined} */
const version = globalThis.document?.querySelector?.('meta[name="tiles"]');

/** @param {string | number} [of] another version, so that all tiles are requested anew */
export function tilesAddress(of = version?.content ?? "") {
  const address = `${location.origin}/api/v1/tiles/{z}/{x}/{y}`;
  return of === "" || copiedAt !== null ? address : `${address}?of=${encodeURIComponent(of)}`; // a copy has them without
}
