/** The fleet to choose from: who flies in this mission, narrowed by base, sensor and type. */

import { byId, h, keyedList } from "../../../dom.js";
import { t, tn } from "../../../text.js";
import { GROUNDING, isPlanCurrent } from "../../plan/plan_view.js";
import { canFly, choicesOf, inFleetOrder, isAskedFor, standingUavs } from "../../uavs/fleet.js";
import { figuresInMission } from "../../uavs/uav_changes.js";
import { changeDialog, newDialog } from "./dialog.js";
import { mountUavNumbers } from "./numbers.js";
import { refreshRow, uavRow } from "./row.js";

/** @import { FleetUav, MissionActions, MissionPageState, MissionStore, StandingUav } from "../../types.d.ts" */
/** @import { ShownUav } from "./row.js" */

/** @typedef {{ base: string, sensor: string, type: string }} Asked filters of the list */

const MIN_UAVS_TO_FILTER = 8; // a fleet of fewer is seen at a glance
const MIN_UAVS_TO_CHOOSE_ALL = 4;
const SHOWN_FIRST = 30;

/**
 * One that is not of the fleet, as a program may put it into a mission, is known by its place alone.
 *
 * @param {StandingUav} uav
 */
const keyOf = ({ id, sequence }) => (id === null ? `at ${sequence}` : `${id}`);

/** Its place in the mission now, −1 where it does not fly. @param {MissionPageState} state @param {StandingUav} uav */
const sequenceOf = ({ selection }, { id, sequence }) =>
  id === null ? (sequence ?? -1) : selection.uavs.findIndex((chosen) => chosen.id === id);

/** @param {ShownUav} uav */
const isFree = (uav) => uav.sequence === null && canFly(uav);

/**
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {boolean} canPlan
 * @param {{ mapCentre: () => number[] }} how
 */
export function mountUavs(store, actions, canPlan, { mapCentre }) {
  let showAll = false;
  const filters = createFilters(() => refresh(store.state));

  const draw = keyedList(
    byId("uav-list"),
    /** @param {ShownUav} uav */ (uav) => keyOf(uav),
    (uav) =>
      uavRow(canPlan, {
        look() {
          const sequence = sequenceOf(store.state, uav);
          store.update({ lookedAt: sequence >= 0 && store.state.plan ? sequence : null });
        },
        leave: () => store.update({ lookedAt: null }),
        choose(isChosen) {
          if (!isChosen) actions.removeUav(sequenceOf(store.state, uav));
          else if (uav.id !== null) actions.addUavOfFleet(uav.id);
        },
        change: () => askForChange(store, actions, sequenceOf(store.state, uav)),
      }),
    (row, uav) => refreshRow(row, uav, { canPlan, returnsToStart: store.state.selection.return_to_start }),
  );

  /**
   * Those to choose from, as narrowed; who flies already stays in sight.
   *
   * @param {MissionPageState} state
   * @returns {ShownUav[]}
   */
  function shownOf(state) {
    const fleet = inFleetOrder(state).map((uav) => ({ ...uav, grounded: groundedWords(state, uav) }));
    if (state.mission && !canPlan) return fleet.filter((uav) => uav.sequence !== null); // who does not fly is of use only to who plans
    return fleet.filter((uav) => uav.sequence !== null || isAskedFor(uav, filters.asked()));
  }

  /** @param {MissionPageState} state */
  function refresh(state) {
    const uavs = shownOf(state);
    const visible = showAll ? uavs : uavs.filter((uav, index) => index < SHOWN_FIRST || uav.sequence !== null);
    draw(visible);
    byId("uavs-empty").hidden = state.fleet.length > 0 || uavs.length > 0 || state.arrival !== "whole";
    byId("uav-count").textContent = countText(state, uavs, canPlan);
    if (!canPlan) return;
    filters.draw(state.fleet);
    const more = byId("more-uavs");
    more.hidden = visible.length === uavs.length;
    more.textContent = tn(uavs.length - visible.length, "Show {count} more", "Show {count} more");
    const free = uavs.filter(isFree);
    const all = byId("choose-uavs");
    all.hidden = state.fleet.length < MIN_UAVS_TO_CHOOSE_ALL || free.length === 0;
    all.textContent = tn(free.length, "Select {count} more", "Select the remaining {count}");
    byId("no-uav-found").hidden = visible.length > 0 || state.fleet.length === 0;
  }

  if (canPlan) {
    byId("add-uav").addEventListener("click", () => store.update({ tool: "place" }));
    byId("more-uavs").addEventListener("click", () => {
      showAll = true;
      refresh(store.state);
    });
    byId("choose-uavs").addEventListener("click", () => {
      const free = shownOf(store.state).filter(isFree);
      actions.addUavsOfFleet(free.flatMap(({ id }) => id ?? []));
    });
    byId("all-uavs").addEventListener("click", filters.clear);
    mountUavNumbers(store, actions);
  }
  store.listen(["fleet", "selection", "plan", "mission", "arrival"], refresh);

  return {
    /** Ask for the name of a UAV that takes off at a place; Enter uses the middle of the map. */
    askForUav(position = mapCentre()) {
      store.update({ tool: "point" });
      askForNew(store, actions, position);
    },
  };
}

/** Why the plan does not use a UAV. @param {MissionPageState} state @param {StandingUav} uav */
function groundedWords(state, { sequence }) {
  const warnings = (isPlanCurrent(state) && state.plan?.result.warnings) || [];
  const warning = warnings.find(({ code, uav }) => GROUNDING.includes(code) && uav === sequence);
  return warning?.message ?? "";
}

/** @param {MissionPageState} state @param {ShownUav[]} uavs @param {boolean} canPlan */
function countText({ fleet, selection }, uavs, canPlan) {
  const total = Math.max(fleet.length, uavs.length);
  if (!total) return "";
  if (canPlan) return t("{chosen} of {total}", { chosen: selection.uavs.length, total });
  return uavs.length ? `${uavs.length}` : "";
}

/** One choice for each property by which this fleet can be filtered. @param {() => void} onChange */
function createFilters(onChange) {
  /** @type {Asked} */
  const nothing = { base: "", sensor: "", type: "" };
  let asked = nothing;
  let narrowedBy = "";
  const words = {
    base: [t("Base"), t("Every base")],
    sensor: [t("Sensor"), t("All sensors")],
    type: [t("Type"), t("Every type")],
  };

  /** @param {keyof Asked} name @param {string[]} values */
  function select(name, values) {
    const [label, all] = words[name];
    const list = h(
      "select",
      { class: "input", "aria-label": label },
      h("option", { value: "" }, all),
      values.map((value) => h("option", { value, selected: asked[name] === value }, value)),
    );
    list.addEventListener("change", () => {
      asked = { ...asked, [name]: list.value };
      onChange();
    });
    return list;
  }

  return {
    asked: () => asked,
    clear() {
      asked = nothing;
      narrowedBy = "";
      onChange();
    },
    /** @param {FleetUav[]} fleet */
    draw(fleet) {
      const isSmall = fleet.length < MIN_UAVS_TO_FILTER;
      const choices = choicesOf(fleet);
      const key = JSON.stringify([choices, isSmall]);
      if (key === narrowedBy) return;
      narrowedBy = key;
      const lists = /** @type {[keyof Asked, string[]][]} */ (Object.entries(choices)).filter(
        ([, names]) => names.length > 1 || (names.length === 1 && !isSmall),
      );
      const place = byId("uav-filters");
      place.replaceChildren(...lists.map(([name, names]) => select(name, names)));
      place.hidden = isSmall || lists.length === 0;
    },
  };
}

/** @param {MissionStore} store @param {MissionActions} actions @param {number} sequence */
function askForChange(store, actions, sequence) {
  const uav = standingUavs(store.state)[sequence];
  const known = store.state.fleet.find(({ id }) => id === uav.id);
  changeDialog({
    title: uav.name,
    note: t("In this mission only; the fleet stays as it is. Its start can be dragged on the map as well."),
    uav,
    act: t("Change"),
    submit({ name, base_name, cruise_speed_mps, ...values }) {
      const speed = cruise_speed_mps === null ? {} : { cruise_speed_mps };
      return actions.changeUav(sequence, figuresInMission(uav, { ...values, ...speed }, known));
    },
  });
}

/** @param {MissionStore} store @param {MissionActions} actions @param {number[]} position */
function askForNew(store, actions, position) {
  newDialog({
    title: t("Add a UAV"),
    note: t("It stays in the fleet for other missions."),
    uav: {
      position,
      name: t("UAV {number}", { number: store.state.fleet.length + 1 }),
      base_name: "",
      max_range_m: null,
      cruise_speed_mps: null,
      end_action: "return",
    },
    act: t("Add"),
    submit: ({ cruise_speed_mps, ...body }) =>
      actions.addUav(cruise_speed_mps === null ? body : { ...body, cruise_speed_mps }),
  });
}
