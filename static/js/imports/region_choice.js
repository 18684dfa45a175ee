/** "Replace the whole region": what it would remove is named before the file is read again for it. */

import { h } from "../dom.js";
import { open as openDialog } from "../page/keyboard.js";
import { t, tn } from "../text.js";

/** @import { Proposal, ProposalActs } from "./types.d.ts" */

/** Another difference: the file is read again for it. @param {Proposal} proposal @param {ProposalActs["readAgain"]} readAgain */
export function regionChoice({ kind, state, parameters, summary }, readAgain) {
  if (kind !== "osm" || state !== "ready") return null;
  const checked = Boolean(parameters.replace_region);
  const box = h("input", { class: "check", type: "checkbox", id: "replace-region", checked });
  const removed = removedText(summary.replaced_region_removes ?? {});
  box.addEventListener("change", () => {
    if (box.checked && removed) {
      box.checked = false;
      askToReplace(removed, () => readAgain({ replace_region: true }));
    } else readAgain({ replace_region: box.checked });
  });
  const words = removed
    ? t("Also removes {assets}, which other files brought in and this one does not have.", { assets: removed })
    : t("Nothing else would be removed: no other file brought anything into this area that this one lacks.");
  return h(
    "div",
    {},
    h("label", { class: "overwrite" }, box, h("span", {}, t("Replace the whole region with this file"))),
    !checked && summary.replaced_region_removes && h("p", { class: "caption" }, words),
  );
}

/** "12 towers, 3 lines"; empty where there is none. @param {Record<string, number>} removed by kind */
export function removedText(removed) {
  /** @type {Record<string, (count: number) => string>} */
  const words = {
    tower: (count) => tn(count, "{count} tower", "{count} towers"),
    line: (count) => tn(count, "{count} line", "{count} lines"),
    railway: (count) => tn(count, "{count} railway", "{count} railways"),
    bridge: (count) => tn(count, "{count} bridge", "{count} bridges"),
  };
  return Object.entries(words)
    .filter(([kind]) => removed[kind] > 0)
    .map(([kind, counted]) => counted(removed[kind]))
    .join(", ");
}

/** @param {string} removed @param {() => void} replace */
function askToReplace(removed, replace) {
  const dialog = h(
    "dialog",
    { "aria-labelledby": "replace-title" },
    h("h2", { id: "replace-title" }, t("Replace the whole region?")),
    h(
      "p",
      {},
      t("Also removes {assets}, which other files brought in and this one does not have.", { assets: removed }),
    ),
    h("p", {}, t("The file is read again. Nothing changes until you apply it.")),
    h(
      "form",
      { method: "dialog", class: "acts" },
      h("button", { class: "button", autofocus: true }, t("Cancel")),
      h("button", { class: "button danger filled", onclick: replace }, t("Replace the region")),
    ),
  );
  openDialog(dialog);
}
