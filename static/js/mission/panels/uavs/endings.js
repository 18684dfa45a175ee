/** Where UAVs do not all fly back: how the flight of each one ends, beside the switch. */

import { byId, h, keyedList } from "../../../dom.js";
import { routeLetter, routeNumber } from "../../../domain/palette.js";
import { t } from "../../../text.js";
import { END_CHOICES } from "./dialog.js";

export function mountEndings(store, actions) {
  const list = byId("endings");
  const draw = keyedList(
    list,
    ({ sequence }) => `${sequence}`,
    ({ sequence }) => {
      const choice = h(
        "select",
        { class: "input", onchange: () => actions.changeUav(sequence, { end_action: choice.value }) },
        END_CHOICES.map(([value, words]) => h("option", { value }, words)),
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
      row.querySelector(".name").textContent = row.querySelector(".name").title = name;
      const choice = row.querySelector("select");
      choice.setAttribute("aria-label", t("How the flight of {name} ends", { name }));
      choice.value = end_action;
    },
  );
  store.listen(["selection"], ({ selection: { uavs, return_to_start } }) => {
    list.hidden = return_to_start || !uavs.length;
    draw(return_to_start ? [] : uavs.map(({ name, end_action }, sequence) => ({ name, end_action, sequence })));
  });
}
