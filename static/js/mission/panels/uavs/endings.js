/** How the flight of each UAV ends, beside the switch; where not all fly back. */

import { byId, find, h, keyedList } from "../../../dom.js";
import { routeLetter, routeNumber } from "../../../domain/palette.js";
import { t } from "../../../text.js";
import { END_CHOICES } from "./fields.js";

/** @import { EndActionEnum } from "../../../api_types.d.ts" */
/** @import { MissionActions, MissionStore, PickedUav } from "../../types.d.ts" */

/** @typedef {Pick<PickedUav, "name" | "end_action"> & { sequence: number }} Ending */

/** @param {MissionStore} store @param {MissionActions} actions */
export function mountEndings(store, actions) {
  const list = byId("endings");
  const draw = keyedList(
    list,
    /** @param {Ending} ending */ ({ sequence }) => `${sequence}`,
    ({ sequence }) => {
      const choice = h(
        "select",
        { class: "input" },
        END_CHOICES.map(([value, words]) => h("option", { value }, words)),
      );
      choice.addEventListener("change", () =>
        actions.changeUav(sequence, { end_action: /** @type {EndActionEnum} */ (choice.value) }),
      );
      return h(
        "li",
        {},
        h("span", { class: `letter route-${routeNumber(sequence)}` }, routeLetter(sequence)),
        h("span", { class: "name" }),
        choice,
      );
    },
    (row, { name, end_action }) => {
      const called = find(row, ".name", HTMLElement);
      called.textContent = name;
      called.title = name;
      const choice = find(row, "select", HTMLSelectElement);
      choice.setAttribute("aria-label", t("How the flight of {name} ends", { name }));
      choice.value = end_action ?? "";
    },
  );
  store.listen(["selection"], ({ selection: { uavs, return_to_start } }) => {
    list.hidden = return_to_start || !uavs.length;
    draw(return_to_start ? [] : uavs.map(({ name, end_action }, sequence) => ({ name, end_action, sequence })));
  });
}
