/** What the filters of the registers of assets and of zones have in common. */

import { h } from "../dom.js";
import { numberText } from "../units.js";

/** "110 kV (1,204)". @param {string} words @param {number} count */
export const withCount = (words, count) => `${words} (${numberText(count)})`;

/** @param {string} label @param {HTMLElement} control @param {...HTMLElement} more */
export const filterField = (label, control, ...more) =>
  h("div", { class: "filter" }, h("label", { for: control.id }, label), control, more);
