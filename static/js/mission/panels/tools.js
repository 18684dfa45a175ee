/** The tools for picking on the map, and the doors to what needs no map: a pasted list, a saved selection. */

import { byId } from "../../dom.js";

export function mountTools(store, { pasteList, savedSelections }) {
  const tools = byId("tools");
  tools.addEventListener("change", (event) => store.update({ tool: event.target.value }));
  store.listen(["tool"], ({ tool }) => {
    const radio = tools.querySelector(`[value="${tool}"]`);
    if (radio) radio.checked = true;
  });
  byId("pick-line").addEventListener("click", () => store.update({ tool: "line" }));
  byId("paste-list").addEventListener("click", pasteList);
  byId("open-selections").addEventListener("click", savedSelections);
}
