/** Records of a zone file that have a fault: listed one by one, each with its place, and marked as seen before the rest counts. */

import { h } from "../dom.js";
import { t, tn } from "../text.js";

/** @import { ProposalActs, UnreadRecord } from "./types.d.ts" */

/**
 * @param {UnreadRecord[]} records
 * @param {{ seen: Set<string> | null, changed: () => void, acts: Pick<ProposalActs, "place"> }} how seen: null where it is decided
 */
export function notRead(records, { seen, changed, acts }) {
  if (!records.length) return null;
  const words = tn(
    records.length,
    "{count} record is not read. What the set has of it stays as it is.",
    "{count} records are not read. What the set has of them stays as it is.",
  );
  return h(
    "section",
    { class: "not-read", id: "not-read", "aria-label": t("Records that are not read") },
    h("p", { class: "caption" }, words),
    h(
      "ul",
      { class: "faults" },
      records.map((record) => h("li", {}, row(record, { seen, changed }), seePlace(record, acts))),
    ),
  );
}

/** @param {UnreadRecord} record @param {{ seen: Set<string> | null, changed: () => void }} how */
function row({ place, name, message }, { seen, changed }) {
  const parts = [h("strong", {}, name || place), ` ${place}: ${message}`];
  if (!seen) return h("span", {}, parts);
  const box = h("input", { class: "check", type: "checkbox", checked: seen.has(place) });
  box.addEventListener("change", () => {
    if (box.checked) seen.add(place);
    else seen.delete(place);
    changed();
  });
  return h("label", { class: "overwrite" }, box, h("span", {}, parts, " ", h("em", { class: "caption" }, t("Seen"))));
}

/** @param {UnreadRecord} record @param {Pick<ProposalActs, "place">} acts */
function seePlace({ bbox, position }, acts) {
  const at = position ?? (bbox && [(bbox[0] + bbox[2]) / 2, (bbox[1] + bbox[3]) / 2]);
  if (!at) return null;
  return h("button", { type: "button", class: "text-button", onclick: () => acts.place(at) }, t("See the place"));
}
