/** "Replace the whole region": what it would remove is named before the file is read again for it. */

import { h } from "../dom.js";
import { countedText } from "../domain/counted.js";
import { open as openDialog } from "../page/keyboard.js";
import { t } from "../text.js";

/** @import { Proposal, ProposalActs } from "./types.d.ts" */

/** Another difference: the file is read again for it. @param {Proposal} proposal @param {ProposalActs["readAgain"]} readAgain */
export function regionChoice({ kind, state, parameters, summary }, readAgain) {
  if (kind !== "osm" || state !== "ready") return null;
  const checked = Boolean(parameters.replace_region);
  const box = h("input", { class: "check", type: "checkbox", id: "replace-region", checked });
  const removed = countedText(summary.replaced_region_removes ?? {});
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
