/** The check of lost-link actions: each group of waypoints that fails is a row that can be shown on the map. */

import { h, icon } from "../../../dom.js";
import { routeNumber } from "../../../domain/palette.js";
import { t, tn } from "../../../text.js";
import * as link from "../../options/lost_link.js";
import { isPlanCurrent } from "../../plan/plan_view.js";

/** @import { FailureGroup } from "../../options/lost_link.js" */
/** @import { MissionPageState, MissionStore, ShownPlan } from "../../types.d.ts" */

const SHOWN_FIRST = 6; // groups of waypoints that fail
/** @type {Record<string, string>} */
const ICONS = { home: "circle-check", lost: "triangle-alert" };

/**
 * Returns its element; it follows the store.
 *
 * @param {MissionStore} store
 * @param {(positions: number[][]) => void} showPlaces
 */
export function createLinkCheck(store, showPlaces) {
  const summary = h("p", { class: "link-said", role: "status" });
  const heights = h("p", { class: "caption" });
  const uncounted = h("p", { class: "caption" });
  const rows = h("ul", { class: "link-failures", "aria-label": t("From where a UAV would not get home") });
  const more = h("button", { type: "button", class: "text-button" });
  const barred = h("p", { class: "field-error", role: "alert" });
  const element = h("div", { class: "link-check" }, summary, barred, rows, more, heights, uncounted);
  const row = createRow(store, showPlaces);
  let showsAll = false;
  more.addEventListener("click", () => {
    showsAll = true;
    draw(store.state);
  });

  /** @param {MissionPageState} state */
  function draw(state) {
    const { plan, selection } = state;
    const now = link.checkStateOf(selection.lost_link, plan, isPlanCurrent(state));
    const checked = now === "home" || now === "lost" ? plan : null;
    element.hidden = now === "go-on";
    const inZones = checked ? link.inZonesText(checked) : "";
    const seen = inZones ? "lost" : now; // no tick over a place where landing is forbidden
    element.dataset.state = seen;
    summary.replaceChildren(
      ...(ICONS[seen] ? [icon(ICONS[seen], "small")] : []),
      h("span", {}, link.checkText(now, plan)),
    );
    barred.hidden = !inZones;
    barred.replaceChildren(icon("circle-alert", "small"), inZones);
    const groups = plan && now === "lost" ? link.failuresOf(plan) : [];
    const shown = showsAll ? groups : groups.slice(0, SHOWN_FIRST);
    rows.hidden = !groups.length;
    rows.replaceChildren(...(plan ? shown.map((group) => row(plan, group)) : []));
    more.hidden = shown.length === groups.length;
    more.textContent = tn(groups.length - shown.length, "Show {count} more", "Show {count} more");
    heights.textContent = checked ? link.heightsText(checked) : "";
    heights.hidden = !heights.textContent;
    uncounted.textContent = checked ? link.uncountedText(checked) : "";
    uncounted.hidden = !uncounted.textContent;
  }

  store.listen(["plan", "selection"], draw);
  return element;
}

/**
 * Returns what makes the row of a group of failures.
 *
 * @param {MissionStore} store
 * @param {(positions: number[][]) => void} showPlaces
 */
function createRow(store, showPlaces) {
  /** @type {FailureGroup | null} */
  let held = null; // the group that was clicked stays lit while its row has focus

  /** @param {FailureGroup | null} group */
  const light = (group) =>
    store.update({ litReturn: group?.key ?? null, litZones: group?.zone_id ? [group.zone_id] : [] });
  /** @param {FailureGroup | null} group */
  const hold = (group) => {
    held = group;
    light(group);
  };

  /** @param {ShownPlan} plan @param {FailureGroup} group */
  return (plan, group) => {
    const { where, why } = link.failureText(group);
    const places = plan.result.routes[group.sequence].waypoints;
    const look = () => {
      hold(group);
      const ways = link.returnLinesOf(plan).filter(({ key }) => key === group.key);
      showPlaces([
        ...ways.flatMap(({ from, to }) => [from, to]),
        ...group.waypoints.slice(0, 1).map((index) => places[index].position),
      ]);
    };
    return h(
      "li",
      {},
      h(
        "button",
        {
          type: "button",
          title: t("Show on the map"),
          onclick: look,
          onpointerenter: () => light(group),
          onpointerleave: () => light(held),
          onfocus: () => light(group),
          onblur: () => hold(null),
        },
        h("span", { class: `letter route-${routeNumber(group.sequence)}` }, group.letter),
        h("span", {}, h("strong", {}, `${group.name}: ${where}`), h("small", {}, why)),
      ),
    );
  };
}
