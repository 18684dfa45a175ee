/** The comparison of numbers of UAVs: when they are done, in how many flights, how far they fly, and one click to choose. */

import { byId, h, icon, keepingFocus, setChildren } from "../../../dom.js";
import { announce } from "../../../page/toast.js";
import { t, tn } from "../../../text.js";
import { durationText, lengthText, numberText } from "../../../units.js";
import { bestOf, canCompareNumbers } from "../../uavs/uav_numbers.js";

/** @import { MissionActions, MissionPageState, MissionStore, UavNumber } from "../../types.d.ts" */

const HEADS = [t("UAVs"), t("Done in"), t("Flights"), t("Distance")];

/** @param {MissionStore} store @param {MissionActions} actions */
export function mountUavNumbers(store, actions) {
  const button = byId("compare-uav-numbers");
  const place = byId("uav-numbers");
  button.addEventListener("click", () => {
    if (store.state.uavNumbers) actions.closeUavNumbers();
    else void actions.compareUavNumbers();
  });

  store.listen(["uavNumbers"], ({ uavNumbers }) => {
    if (!uavNumbers || uavNumbers.planning !== null) return;
    const best = bestOf(uavNumbers.rows);
    if (best)
      announce(t("Done soonest: {count} in {time}.", { count: countText(best), time: durationText(best.done_s) }));
  });
  store.listen(["uavNumbers", "selection", "fleet", "planning"], (state) => {
    const { uavNumbers, selection, fleet, planning } = state;
    button.hidden = !uavNumbers && !canCompareNumbers(selection, fleet);
    button.toggleAttribute("disabled", Boolean(planning));
    button.setAttribute("aria-expanded", `${uavNumbers !== null}`);
    place.hidden = uavNumbers === null;
    if (uavNumbers) keepingFocus(place, () => setChildren(place, ...contentOf(state, actions)));
  });
}

/** @param {UavNumber} row */
const countText = ({ uavs }) => tn(uavs.length, "{count} UAV", "{count} UAVs");

/** @param {Readonly<MissionPageState>} state @param {MissionActions} actions */
function contentOf({ uavNumbers, selection }, actions) {
  const { rows, planning, fault, candidates, isStopped } = /** @type {NonNullable<typeof uavNumbers>} */ (uavNumbers);
  const best = rows.length > 1 ? bestOf(rows) : null;
  return [
    h("p", { class: "caption" }, t("Each is planned to be done soonest, with the UAVs that are named.")),
    planning !== null &&
      h(
        "p",
        { class: "uav-numbers-progress" },
        tn(planning, "Planning {count} UAV …", "Planning {count} UAVs …"),
        h("button", { type: "button", class: "text-button", onclick: () => actions.stopAlternatives() }, t("Stop")),
      ),
    fault && h("p", { class: "caption" }, fault),
    isStopped && h("p", { class: "caption" }, t("Stopped: not all numbers are planned.")),
    rows.length > 0 &&
      h(
        "table",
        { class: "why-table ways uav-numbers" },
        h(
          "thead",
          {},
          h(
            "tr",
            {},
            HEADS.map((words) => h("th", { scope: "col" }, words)),
            h("th", { scope: "col" }, h("span", { class: "unseen" }, t("Choice"))),
          ),
        ),
        h(
          "tbody",
          {},
          rows.map((row) => rowOf(row, isInUse(row, selection.uavs), row === best, actions)),
        ),
      ),
    planning === null &&
      rows.length > 0 &&
      !isStopped &&
      rows[rows.length - 1].uavs.length < candidates.length &&
      h("p", { class: "caption" }, t("More UAVs would not be done sooner.")),
    planning === null &&
      rows.length === 0 &&
      !isStopped &&
      !fault &&
      h("p", { class: "caption" }, t("No number of UAVs can be compared: the plan uses none.")),
  ].filter((part) => part instanceof Node);
}

/** @param {UavNumber} row @param {UavNumber["uavs"]} chosen */
const isInUse = ({ uavs }, chosen) =>
  uavs.length === chosen.length && uavs.every(({ name }) => chosen.some((uav) => uav.name === name));

/** @param {UavNumber} row @param {boolean} isChosen @param {boolean} isBest @param {MissionActions} actions */
function rowOf(row, isChosen, isBest, actions) {
  const { uavs, done_s, length_m, flights, missed } = row;
  const names = uavs.map(({ name }) => name).join(", ");
  const count = countText(row);
  return h(
    "tr",
    { class: isChosen ? "present" : "" },
    h(
      "th",
      { scope: "row" },
      numberText(uavs.length),
      h("span", { class: "uav-names", translate: "no", title: names }, names),
    ),
    h(
      "td",
      { class: isBest ? "best" : "" },
      durationText(done_s),
      missed > 0 &&
        h("span", { class: "caption" }, tn(missed, "{count} target not reached", "{count} targets not reached")),
    ),
    h("td", {}, numberText(flights)),
    h("td", {}, lengthText(length_m)),
    h(
      "td",
      {},
      isChosen
        ? icon("check", "small")
        : h(
            "button",
            {
              type: "button",
              class: "text-button",
              "aria-label": t("Use {count}: {names}", { count, names }),
              onclick: () => actions.useUavNumber(row),
            },
            t("Use"),
          ),
    ),
  );
}
