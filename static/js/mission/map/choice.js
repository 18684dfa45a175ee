/** A choice of a few acts at a place of the map. */

import { find, h, icon } from "../../dom.js";

/** @import { ScreenPoint } from "../../map/types.d.ts" */

/** @typedef {{ icon: string, words: string, act: () => unknown }} Choice */

/**
 * @param {HTMLElement} frame
 * @param {() => void} opened is called when one opens
 */
export function createChoice(frame, opened) {
  /** @type {HTMLElement | null} */
  let box = null;
  /** @type {HTMLElement | null} */
  let opener = null;
  const close = () => {
    const was = box;
    box = null;
    if (was?.contains(document.activeElement)) {
      const map = /** @type {HTMLElement | null | undefined} */ (opener?.closest("#map"));
      if (map) map.dataset.pointed = "true"; // opened by a click: no focus ring round the map
      opener?.focus();
    }
    was?.remove();
    return was !== null;
  };
  return {
    close,
    isOpen: () => box !== null,
    /** @param {string} title @param {Choice[]} choices @param {ScreenPoint} point */
    open(title, choices, point) {
      close();
      opened();
      opener = document.activeElement instanceof HTMLElement ? document.activeElement : null;
      box = h(
        "div",
        { class: "map-choice float", role: "group", "aria-label": title },
        h("p", { class: "caption" }, title),
        choices.map((choice) => {
          const choose = () => {
            close();
            choice.act();
          };
          return h("button", { type: "button", onclick: choose }, icon(choice.icon), choice.words);
        }),
      );
      frame.append(box);
      box.style.left = `${Math.min(Math.max(8, point.x - 60), frame.clientWidth - box.offsetWidth - 8)}px`;
      box.style.top = `${Math.max(8, Math.min(point.y + 12, frame.clientHeight - box.offsetHeight - 8))}px`;
      find(box, "button").focus();
    },
  };
}
