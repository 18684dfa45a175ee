/** The fault of a field, shown beside it. */

import { h, icon } from "../../../dom.js";

/** An element for the fault of a field. @param {string} id */
export const faultPlace = (id) => h("p", { class: "field-error", id, hidden: true });

/**
 * Show the fault of a field; empty words remove it.
 *
 * @param {HTMLInputElement} input
 * @param {HTMLElement} place
 * @param {string} words
 */
export function showFault(input, place, words) {
  place.hidden = !words;
  place.replaceChildren(...(words ? [icon("circle-alert", "small"), words] : []));
  if (words) input.setAttribute("aria-invalid", "true");
  else input.removeAttribute("aria-invalid");
}
