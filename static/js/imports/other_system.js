/** Form after an asset file was refused because its coordinate system is unknown: asks for the system and reads the file again. */

import { h } from "../dom.js";
import { t } from "../text.js";

/** @import { Parameters, Proposal } from "./types.d.ts" */

/** @param {Proposal["faults"][number]} fault */
const isAboutTheSystem = ({ place, message }) => place === "crs" || /\bsystem\b/.test(message);

/**
 * readAgain(parameters) has the file read in the system; null when the faults are others.
 *
 * @param {Proposal} proposal
 * @param {(parameters: Parameters) => void} readAgain
 */
export function otherSystem({ kind, faults, parameters, size_bytes }, readAgain) {
  if (kind !== "assets" || size_bytes === null || !faults.some(isAboutTheSystem)) return null;
  const system = h("input", {
    class: "input",
    id: "other-system",
    placeholder: "EPSG:2056",
    value: parameters.crs ?? "",
    maxlength: "40",
    required: true,
    autocomplete: "off",
  });
  const form = h(
    "form",
    { class: "column-form", "aria-label": t("Coordinate system") },
    h(
      "div",
      { class: "field" },
      h("label", { for: "other-system" }, t("Coordinate system of the file")),
      system,
      h("span", { class: "caption" }, t("A code such as EPSG:25832. Ask whoever made the file.")),
    ),
    h(
      "div",
      { class: "row-acts" },
      h("button", { type: "submit", class: "button primary" }, t("Read again in this system")),
    ),
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    readAgain({ crs: system.value.trim() });
  });
  return form;
}
