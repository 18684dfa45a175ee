/** The tools for picking on the map, and the buttons for other sources: a pasted list, a saved selection. */

import { byId } from "../../dom.js";

/** @import { MissionStore, Tool } from "../types.d.ts" */

/** @param {MissionStore} store @param {{ pasteList: () => unknown, savedSelections: () => unknown }} acts */
export function mountTools(store, { pasteList, savedSelections }) {
  const tools = byId("tools");
  tools.addEventListener("change", (event) => {
    const radio = /** @type {HTMLInputElement} */ (event.target);
    store.update({ tool: /** @type {Tool} */ (radio.value) });
  });
  store.listen(["tool"], ({ tool }) => {
    const radio = /** @type {HTMLInputElement | null} */ (tools.querySelector(`[value="${tool}"]`));
    if (radio) radio.checked = true;
  });
  byId("pick-line").addEventListener("click", () => store.update({ tool: "line" }));
  byId("paste-list").addEventListener("click", pasteList);
  byId("open-selections").addEventListener("click", savedSelections);
}
