/** Limits of alerts of a type's UAVs: differences from the default, and the button to change them. */

import { openAlertLimits } from "../alert_limits/dialog.js";
import { statedLines } from "../alert_limits/words.js";
import { get } from "../api.js";
import { h, icon } from "../dom.js";
import { t } from "../text.js";

/** @import { Figures } from "../alert_limits/words.js" */
/** @import { Answer } from "../api.js" */
/** @import { AlertLimits } from "../api_types.d.ts" */
/** @import { FleetType } from "./types.d.ts" */

/**
 * Draws itself into `place`. Rejects with ApiError, and calls failed(it) where one comes later.
 *
 * @param {HTMLElement} place
 * @param {FleetType} type
 * @param {{ canPlan: boolean, failed: (error: unknown) => void }} how
 */
export async function mountTypeLimits(place, type, { canPlan, failed }) {
  const address = `/uav-types/${type.id}/alert-limits`;
  const hint = t(
    "For all UAVs of this type, at once, also in flight. Blank: default (grey). A mission can have its own.",
  );
  const change = () =>
    openAlertLimits({ address, title: t("Alert thresholds: {name}", { name: type.name }), hint, onSaved: draw });

  /** @param {Figures} stated */
  function draw(stated) {
    const lines = statedLines(stated);
    place.replaceChildren(
      lines.length
        ? h(
            "dl",
            { class: "facts" },
            lines.map(([label, figure]) => [h("dt", {}, label), h("dd", {}, figure)]),
          )
        : h("p", { class: "quiet-text" }, t("Default thresholds.")),
      ...(canPlan
        ? [
            h(
              "button",
              { type: "button", class: "button", onclick: () => void change().catch(failed) },
              icon("bell", "small"),
              t("Change alert thresholds"),
            ),
          ]
        : []),
    );
  }

  const { data } = /** @type {Answer<AlertLimits>} */ (await get(address));
  draw(data.stated);
}
