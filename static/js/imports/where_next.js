/** Where an applied import is used next. */

import { h, icon } from "../dom.js";
import { hashOf } from "../map/address.js";
import { t } from "../text.js";

/** @import { Proposal } from "./types.d.ts" */

/** Links from an applied import to where its data are used. @param {Proposal} proposal */
export function whereNext({ kind, summary }) {
  const view = summary.extent ? viewOfExtent(summary.extent) : "";
  return h(
    "nav",
    { class: "where-next", "aria-label": t("Next") },
    h("a", { href: `${kind === "zones" ? "/zones" : "/assets"}${view}` }, icon("map", "small"), t("Show on the map")),
    kind !== "zones" &&
      kind !== "terrain" &&
      h("a", { href: `/data-issues${view}` }, icon("list-checks", "small"), t("Data quality")),
    h("a", { href: `/missions/new${view}` }, icon("plus", "small"), t("Plan here")),
  );
}

/** The hash of a map that shows the middle of an extent. @param {number[]} extent west, south, east, north */
export function viewOfExtent([west, south, east, north]) {
  const wide = Math.max(east - west, (north - south) * 1.5, 0.005);
  const zoom = Math.min(Math.max(Math.log2(720 / wide), 2), 15);
  return hashOf({ zoom, centre: [(west + east) / 2, (south + north) / 2] });
}
