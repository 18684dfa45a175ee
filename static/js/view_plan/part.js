/** The part "Photos" of a tower's details: the button that opens the panel, and the panel. */

import { h, icon, setChildren } from "../dom.js";
import { t } from "../text.js";
import { createViewPlanLayer } from "./layer.js";
import { ViewPlanPanel } from "./panel.js";

/** @import { Palette } from "../domain/palette.js" */
/** @import { MapLibreMap } from "../map/types.d.ts" */

/** @typedef {{ map: MapLibreMap, onRecolour: (act: (palette: Palette) => void) => unknown }} Ground */

/** @type {ReturnType<typeof createViewPlanLayer> | null} */
let layer = null;
/** @type {ViewPlanPanel | null} */
let open = null;

/** Close the panel, where one is open: the tower is no longer shown. */
export function closeViewPlan() {
  open?.close();
}

/** @param {Ground} ground */
function layerOf({ map, onRecolour }) {
  const made = createViewPlanLayer(map);
  onRecolour(() => made.recolour());
  return made;
}

/** @param {number} asset id of a tower @param {Ground} ground */
export function viewPlanPart(asset, ground) {
  const place = h("div", {});
  const button = h(
    "button",
    { type: "button", class: "button", onclick: show },
    icon("camera", "small"),
    t("Plan photos"),
  );
  function show() {
    layer ??= layerOf(ground);
    open = new ViewPlanPanel(asset, {
      layer,
      closed() {
        open = null;
        setChildren(place, button);
        if (button.isConnected) button.focus();
      },
    });
    setChildren(place, open.element);
    open.title.focus({ preventScroll: true });
    open.element.scrollIntoView({ block: "start" });
  }
  setChildren(place, button);
  return h("div", { class: "record-acts" }, place);
}
