/** The fleet to choose from: who flies in this mission, with letter, base, battery, range, sensors and how its flight ends. */

import { byId, h, icon, keyedList } from "../../../dom.js";
import { routeNumber } from "../../../domain/palette.js";
import { markSimulated } from "../../../simulated.js";
import { t, tn } from "../../../text.js";
import { percentText } from "../../../units.js";
import { canFly, choicesOf, factsOfUav, inFleetOrder, isAskedFor, standingUavs } from "../../fleet.js";
import { isPlanCurrent } from "../../plan_view.js";
import { GROUNDING, inWords } from "../../plan_words.js";
import { saidInMission } from "../../uav_changes.js";
import { uavDialog } from "./dialog.js";

const LEAST_TO_NARROW = 4; // a fleet of fewer is seen at a glance
const SHOWN_FIRST = 30;
const LOW_BATTERY_PERCENT = 30;

/** One that is not of the fleet, as a program may put it into a mission, is known by its place alone. */
const keyOf = ({ id, sequence }) => (id === null ? `at ${sequence}` : `${id}`);

export function mountUavs(store, actions, canPlan, { mapCentre }) {
  let asked = { base: "", sensor: "", type: "" };
  let showAll = false;

  const draw = keyedList(
    byId("uav-list"),
    keyOf,
    (uav) => {
      const box =
        canPlan &&
        h("input", {
          type: "checkbox",
          class: "check",
          onchange: () => (box.checked ? actions.addUavOfFleet(uav.id) : actions.removeUav(sequenceOf(uav))),
        });
      return h(
        "li",
        { class: "uav", onpointerenter: () => look(uav), onpointerleave: () => store.update({ lookedAt: null }) },
        h(
          canPlan ? "label" : "div",
          { class: "who" },
          box,
          h("span", { class: "letter" }),
          h("span", { class: "name" }, h("span", { class: "called" }), h("small", {}), h("span", { class: "facts" })),
        ),
        h("span", { class: "battery" }),
        canPlan &&
          h(
            "button",
            {
              type: "button",
              class: "icon-button tight",
              title: t("Start, range, speed, battery, end, targets"),
              onclick: () => changeUav(sequenceOf(uav)),
            },
            icon("pencil", "small"),
          ),
      );
    },
    (row, uav) => {
      const isChosen = uav.sequence !== null;
      if (canPlan) {
        row.querySelector("input").checked = isChosen;
        row.querySelector("input").disabled = !isChosen && !canFly(uav);
      }
      const letter = row.querySelector(".letter");
      letter.className = `letter ${isChosen ? `route-${routeNumber(uav.sequence)}` : "none"}`;
      letter.textContent = uav.letter;
      row.querySelector(".called").textContent = uav.name;
      markSimulated(row.querySelector(".called"), uav.is_simulated);
      row.querySelector("small").textContent = uav.base_name ?? "";
      const facts = row.querySelector(".facts");
      const trouble = uav.grounded || troubleOf(uav);
      facts.classList.toggle("grounded", Boolean(trouble));
      facts.textContent = trouble || factsOfUav(uav, store.state.selection.return_to_start);
      row.querySelector(".name").title = [uav.name, uav.base_name, facts.textContent].filter(Boolean).join(", ");
      const battery = row.querySelector(".battery");
      const known = uav.battery_percent !== null && uav.battery_percent !== undefined;
      battery.textContent = known ? percentText(uav.battery_percent) : "";
      battery.title = known ? t("Battery {percent}", { percent: percentText(uav.battery_percent) }) : "";
      battery.classList.toggle("low", known && uav.battery_percent < LOW_BATTERY_PERCENT);
      const change = row.querySelector("button");
      change?.setAttribute("aria-label", t("Change {name} in this mission", { name: uav.name }));
      change?.classList.toggle("absent", !isChosen);
    },
  );

  /** Its place in the mission now, −1 where it does not fly. */
  const sequenceOf = (uav) =>
    uav.id === null ? uav.sequence : store.state.selection.uavs.findIndex((chosen) => chosen.id === uav.id);

  function look(uav) {
    const sequence = sequenceOf(uav);
    store.update({ lookedAt: sequence >= 0 && store.state.plan ? sequence : null });
  }

  function changeUav(sequence) {
    const uav = standingUavs(store.state)[sequence];
    const known = store.state.fleet.find(({ id }) => id === uav.id);
    uavDialog({
      title: uav.name,
      note: t("In this mission only; the fleet stays as it is. Its start can be dragged on the map as well."),
      uav,
      act: t("Change"),
      submit: ({ name, base_name, cruise_speed_mps, ...values }) =>
        actions.changeUav(
          sequence,
          saidInMission(uav, { ...values, ...(cruise_speed_mps === null ? {} : { cruise_speed_mps }) }, known),
        ),
    });
  }

  /** Those to choose from, as narrowed; who flies already stays in sight. */
  function shownOf(state) {
    const warnings = isPlanCurrent(state) ? (state.plan.result.warnings ?? []) : [];
    const grounded = (uav) =>
      inWords(
        warnings.find((warning) => GROUNDING.includes(warning.code) && warning.uav === uav.sequence)?.message ?? "",
      );
    const fleet = inFleetOrder(state).map((uav) => ({ ...uav, grounded: grounded(uav) }));
    if (state.mission && !canPlan) return fleet.filter((uav) => uav.sequence !== null); // who does not fly is of use only to who plans
    return fleet.filter((uav) => uav.sequence !== null || isAskedFor(uav, asked));
  }

  function refresh(state) {
    const uavs = shownOf(state);
    const visible = showAll ? uavs : uavs.filter((uav, index) => index < SHOWN_FIRST || uav.sequence !== null);
    draw(visible);
    byId("uavs-empty").hidden = state.fleet.length > 0 || uavs.length > 0;
    const total = Math.max(state.fleet.length, uavs.length);
    byId("uav-count").textContent = total
      ? canPlan
        ? t("{chosen} of {total}", { chosen: state.selection.uavs.length, total })
        : uavs.length
      : "";
    if (!canPlan) return;
    drawFilters(state.fleet);
    const more = byId("more-uavs");
    more.hidden = visible.length === uavs.length;
    more.textContent = tn(uavs.length - visible.length, "Show {count} more", "Show {count} more");
    const free = uavs.filter((uav) => uav.sequence === null && canFly(uav));
    const all = byId("choose-uavs");
    all.hidden = state.fleet.length < LEAST_TO_NARROW || free.length === 0;
    all.textContent = tn(free.length, "Choose {count} more", "Choose all {count}");
    byId("no-uav-found").hidden = visible.length > 0 || state.fleet.length === 0;
  }

  let narrowedBy = "";
  /** One list for each thing by which this fleet can be told apart. */
  function drawFilters(fleet) {
    const choices = choicesOf(fleet);
    const place = byId("uav-filters");
    const key = JSON.stringify([choices, fleet.length < LEAST_TO_NARROW]);
    if (key === narrowedBy) return;
    narrowedBy = key;
    const words = {
      base: [t("Base"), t("Every base")],
      sensor: [t("Sensor"), t("Every sensor")],
      type: [t("Type"), t("Every type")],
    };
    const lists = Object.entries(choices).filter(
      ([, names]) => names.length > 1 || (names.length === 1 && fleet.length >= LEAST_TO_NARROW),
    );
    place.replaceChildren(
      ...lists.map(([name, names]) => {
        const list = h(
          "select",
          {
            class: "input",
            "aria-label": words[name][0],
            onchange: () => ((asked = { ...asked, [name]: list.value }), refresh(store.state)),
          },
          h("option", { value: "" }, words[name][1]),
          names.map((value) => h("option", { value, selected: asked[name] === value }, value)),
        );
        return list;
      }),
    );
    place.hidden = fleet.length < LEAST_TO_NARROW || lists.length === 0;
  }

  if (canPlan) {
    byId("add-uav").addEventListener("click", () => store.update({ tool: "place" }));
    byId("more-uavs").addEventListener("click", () => ((showAll = true), refresh(store.state)));
    byId("choose-uavs").addEventListener("click", () =>
      actions.addUavsOfFleet(
        shownOf(store.state)
          .filter((uav) => uav.sequence === null && canFly(uav))
          .map(({ id }) => id),
      ),
    );
    byId("all-uavs").addEventListener("click", () => {
      asked = { base: "", sensor: "", type: "" };
      narrowedBy = "";
      refresh(store.state);
    });
  }
  store.listen(["fleet", "selection", "plan", "mission"], refresh);

  return {
    /** Asks for the name of a UAV that takes off at a place; Enter takes the middle of the map. */
    askForUav(position = mapCentre()) {
      store.update({ tool: "point" });
      uavDialog({
        title: t("Add a UAV"),
        note: t("It stays in the fleet for other missions."),
        uav: {
          position,
          name: t("UAV {number}", { number: store.state.fleet.length + 1 }),
          base_name: "",
          max_range_m: null,
          cruise_speed_mps: null,
          end_action: "hover",
        },
        isNew: true,
        act: t("Add"),
        submit: ({ cruise_speed_mps, ...body }) =>
          actions.addUav(cruise_speed_mps === null ? body : { ...body, cruise_speed_mps }),
      });
    },
  };
}

/** What keeps a UAV on the ground whatever is planned. */
function troubleOf({ state, isGone }) {
  if (isGone) return t("No longer in the fleet, or retired");
  return state === "maintenance" ? t("In maintenance") : "";
}
