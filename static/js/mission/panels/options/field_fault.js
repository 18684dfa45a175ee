/** What is wrong with a field, beside it. */

import { h, icon } from "../../../dom.js";

/** A place for what is wrong with a field. @param {string} id */
export const faultPlace = (id) => h("p", { class: "field-error", id, hidden: true });

/**
 * Shows what is wrong with a field; empty words take that away.
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
