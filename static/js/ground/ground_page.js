/** Common parts of pages on map data: the map, the sheet and folds, the keys, and the facts of the map data. */

import { get } from "../api.js";
import { byId } from "../dom.js";
import { readPage, startChrome } from "../page/chrome.js";
import { mountWorkbench } from "../page/workbench.js";
import { t } from "../text.js";
import { mountGroundMap } from "./ground_map.js";

/** @import { Answer } from "../api.js" */
/** @import { Ground } from "../api_types.d.ts" */
/** @import { Binding } from "../page/keyboard.js" */
/** @import { GroundHandlers, GroundPage } from "./types.d.ts" */

/**
 * Mount the page. `open` starts the keys, loads the state of the map data and the page's own data, and marks the document as loaded (for
 * tests, `html[data-loaded]`).
 *
 * @param {GroundHandlers} [on]
 */
export function mountGroundPage(on = {}) {
  /** @type {GroundPage} */
  const page = readPage();
  const map = mountGroundMap(page, on);
  const layout = mountWorkbench({ dockOnPhone: byId("dock-on-phone") });

  /** @param {{ bindings?: Binding[], load?: () => Promise<unknown> }} [options] */
  async function open({ bindings = [], load = async () => {} } = {}) {
    startChrome({
      bindings: [
        ...bindings,
        ...map.bindings,
        { keys: ["f"], words: t("Fit everything"), act: () => map.fitAll() },
        { keys: ["+", "="], words: t("Zoom in"), act: () => map.zoom(1) },
        { keys: ["-"], words: t("Zoom out"), act: () => map.zoom(-1) },
        { keys: ["["], words: t("Fold the side"), act: layout.foldSide },
        { keys: ["]"], words: t("Fold the dock"), act: layout.foldDock },
      ],
    });
    const { data } = /** @type {Answer<Ground>} */ (await get("/ground"));
    map.setGround(data);
    await map.ready;
    await load();
    document.documentElement.dataset.loaded = "true";
  }

  return { page, map, layout, open };
}
