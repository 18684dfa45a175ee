/** One sentence at a time, bottom centre, 8 s, longer while it is hovered or has focus. */

import { byId, h } from "../dom.js";

const STAYS_MS = 8000;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;

/**
 * toast("3 targets removed.", { label: "Undo", act: undo })
 *
 * @param {string} sentence
 * @param {{ label: string, act: () => unknown } | null} [action]
 */
export function toast(sentence, action = null) {
  const region = byId("toasts");
  const close = () => region.replaceChildren();
  const wait = () => {
    clearTimeout(timer);
    timer = setTimeout(close, STAYS_MS);
  };
  const act = () => {
    close();
    action?.act();
  };
  const button = action && h("button", { type: "button", onclick: act }, action.label);
  const box = h("div", { class: "toast" }, h("span", {}, sentence), button);
  for (const stay of ["pointerenter", "focusin"]) box.addEventListener(stay, () => clearTimeout(timer));
  for (const go of ["pointerleave", "focusout"]) box.addEventListener(go, wait);
  region.replaceChildren(box);
  wait();
}

/** For screen readers alone: what a sighted person sees happen anyway. @param {string} sentence */
export function announce(sentence) {
  byId("spoken").textContent = sentence;
}
