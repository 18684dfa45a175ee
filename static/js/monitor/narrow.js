/** Where the window is narrow, alerts and board are the side's second tab instead of a panel of their own. */

import { byId, find } from "../dom.js";

const narrow = matchMedia("(max-width: 1099px)");

/** Returns { showBoard() }: scrolls to its top, where an offer is above the alerts. */
export function mountNarrow() {
  const parts = byId("right-parts");
  const tabs = byId("narrow-tabs");

  function place() {
    const isBoard = narrow.matches && find(tabs, ":checked", HTMLInputElement).value === "board";
    (narrow.matches ? byId("part-board") : byId("right")).append(parts);
    tabs.hidden = !narrow.matches;
    byId("right").hidden = narrow.matches;
    byId("part-board").hidden = !isBoard;
    byId("part-uavs").hidden = isBoard;
  }

  narrow.addEventListener("change", place);
  tabs.addEventListener("change", place);
  place();
  return {
    showBoard() {
      find(tabs, "[value=board]", HTMLInputElement).checked = true;
      place();
      parts.parentElement?.scrollTo(0, 0);
      byId("alerts-title").focus({ preventScroll: true });
    },
  };
}
