/** The mark of simulation, wherever a simulated UAV or its data are shown. */

import { h } from "./dom.js";
import { t } from "./text.js";

export const simulatedMark = () => h("span", { class: "simulated-mark", title: t("No real aircraft") }, t("Simulated"));

/** Shows or hides the mark behind `before`, which stays where it is. @param {Element} before @param {boolean} isSimulated */
export function markSimulated(before, isSimulated) {
  const next = before.nextElementSibling;
  const mark = next?.classList.contains("simulated-mark") ? next : null;
  if (isSimulated && !mark) before.after(simulatedMark());
  if (!isSimulated && mark) mark.remove();
}
