/** Folding the side and the dock, and on a phone the sheet with its three heights. */

import { byId } from "../dom.js";
import { t } from "../text.js";

const HEIGHTS = ["low", "half", "full"];
/** @type {Record<string, string>} */
const HEIGHT_WORDS = { low: t("Panel height: low"), half: t("Panel height: half"), full: t("Panel height: full") };
const phone = matchMedia("(max-width: 720px)");

/**
 * dockOnPhone: the element that contains the dock on a phone, first in the sheet; null on a page without a dock.
 *
 * @param {{ dockOnPhone: HTMLElement | null }} options
 */
export function mountWorkbench({ dockOnPhone }) {
  const workbench = byId("workbench");
  const dock = dockOnPhone && byId("dock");
  const stage = byId("main");

  /** One place for the dock: under the map, or first in the sheet. */
  const place = () => {
    if (!dock) return;
    if (phone.matches) dockOnPhone.append(dock);
    else stage.append(dock);
  };
  phone.addEventListener("change", place);
  place();

  const setHeight = dragSheet(workbench, byId("sheet-handle"));
  return {
    /** On a phone, lower a sheet that covers the map, for an act on the map. */
    showMap() {
      if (phone.matches && workbench.dataset.sheet === "full") setHeight("half");
    },
    foldSide: () => toggle(workbench, "side"),
    foldDock: () => toggle(workbench, "dock"),
    foldRight: () => toggle(workbench, "right"),
    isPhone: () => phone.matches,
  };
}

/** @param {HTMLElement} workbench @param {string} part */
function toggle(workbench, part) {
  if (workbench.dataset[part] === "folded") delete workbench.dataset[part];
  else workbench.dataset[part] = "folded";
}

/** @param {HTMLElement} workbench @param {HTMLElement} handle */
function dragSheet(workbench, handle) {
  /** @type {{ y: number, height: number, moved: boolean } | null} */
  let from = null;
  /** @param {string} name */
  const setHeight = (name) => {
    workbench.style.removeProperty("--sheet");
    workbench.dataset.sheet = name;
    handle.setAttribute("aria-label", HEIGHT_WORDS[name]);
  };
  setHeight("half");

  handle.addEventListener("pointerdown", (event) => {
    from = { y: event.clientY, height: byId("side").offsetHeight, moved: false };
    handle.setPointerCapture(event.pointerId);
  });
  handle.addEventListener("pointermove", (event) => {
    if (!from) return;
    const height = from.height + from.y - event.clientY;
    if (Math.abs(height - from.height) < 6 && !from.moved) return;
    from.moved = true;
    workbench.style.setProperty("--sheet", `${Math.max(72, Math.min(workbench.clientHeight, height))}px`);
  });
  handle.addEventListener("pointerup", () => {
    if (!from) return;
    const { moved } = from;
    from = null;
    if (!moved) return;
    const share = byId("side").offsetHeight / workbench.clientHeight;
    setHeight(share < 0.3 ? "low" : share < 0.8 ? "half" : "full");
    handle.dataset.dragged = "true";
  });
  handle.addEventListener("click", () => {
    if (handle.dataset.dragged) {
      delete handle.dataset.dragged; // the click that ends a drag
      return;
    }
    setHeight(HEIGHTS[(HEIGHTS.indexOf(workbench.dataset.sheet ?? "") + 1) % HEIGHTS.length]);
  });
  return setHeight;
}
