/** The fleet: who flies in this mission, with letter, base, range, speed and how its flight ends. */

import { ApiError, signInAddress } from "../../api.js";
import { byId, h, icon, keyedList } from "../../dom.js";
import { routeNumber } from "../../map/palette.js";
import { open } from "../../page/keyboard.js";
import { factsOfUav, inFleetOrder } from "../fleet.js";
import { isPlanCurrent } from "../plan_view.js";

/** One that is not of the fleet, as a program may put it into a mission, is known by its place alone. */
const keyOf = ({ id, sequence }) => (id === null ? `at ${sequence}` : `${id}`);

export function mountUavs(store, actions, canPlan, { mapCentre }) {
  const draw = keyedList(
    byId("uav-list"),
    keyOf,
    (uav) => {
      const box = canPlan && h("input", { type: "checkbox", class: "check", onchange: () => (box.checked ? actions.addUavOfFleet(uav.id) : actions.removeUav(sequenceOf(uav))) });
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
        canPlan && h("button", { type: "button", class: "icon-button tight", title: "Start, range, speed, end", onclick: () => changeUav(sequenceOf(uav)) }, icon("pencil", "small")),
      );
    },
    (row, uav) => {
      if (canPlan) row.querySelector("input").checked = uav.sequence !== null;
      const letter = row.querySelector(".letter");
      letter.className = `letter ${uav.sequence === null ? "none" : `route-${routeNumber(uav.sequence)}`}`;
      letter.textContent = uav.letter;
      row.querySelector(".called").textContent = uav.name;
      row.querySelector("small").textContent = uav.base_name;
      const facts = row.querySelector(".facts");
      facts.classList.toggle("grounded", Boolean(uav.grounded));
      facts.textContent = uav.grounded || factsOfUav(uav, store.state.selection.return_to_start);
      row.querySelector(".name").title = [uav.name, uav.base_name, facts.textContent].filter(Boolean).join(", ");
      const change = row.querySelector("button");
      change?.setAttribute("aria-label", `Change ${uav.name} in this mission`);
      change?.classList.toggle("absent", uav.sequence === null);
    },
  );

  /** Its place in the mission now, −1 where it does not fly. */
  const sequenceOf = (uav) => (uav.id === null ? uav.sequence : store.state.selection.uavs.findIndex((chosen) => chosen.id === uav.id));

  function look(uav) {
    const sequence = sequenceOf(uav);
    store.update({ lookedAt: sequence >= 0 && store.state.plan ? sequence : null });
  }

  function changeUav(sequence) {
    const uav = store.state.selection.uavs[sequence];
    uavDialog({
      title: uav.name,
      note: "In this mission only; the fleet stays as it is. Its start can be dragged on the map as well.",
      uav,
      act: "Change",
      submit: ({ position, max_range_m, cruise_speed_mps, end_action }) =>
        actions.changeUav(sequence, { position, max_range_m, end_action, ...(cruise_speed_mps === null ? {} : { cruise_speed_mps }) }),
    });
  }

  document.getElementById("add-uav")?.addEventListener("click", () => store.update({ tool: "place" }));

  store.listen(["fleet", "selection", "plan", "mission"], (state) => {
    const warnings = isPlanCurrent(state) ? (state.plan.result.warnings ?? []) : [];
    const grounded = (uav) => warnings.find((warning) => warning.code === "uav_inside_zone" && warning.uav === uav.sequence)?.message ?? "";
    const fleet = inFleetOrder(state).map((uav) => ({ ...uav, grounded: grounded(uav) }));
    const uavs = state.mission && !canPlan ? fleet.filter((uav) => uav.sequence !== null) : fleet; // who does not fly is of use only to who plans
    draw(uavs);
    byId("uavs-empty").hidden = uavs.length > 0;
    byId("uav-count").textContent = uavs.length ? (canPlan ? `${state.selection.uavs.length} of ${uavs.length}` : uavs.length) : "";
  });

  return {
    /** Asks for the name of a UAV that takes off at a place; Enter takes the middle of the map. */
    askForUav(position = mapCentre()) {
      store.update({ tool: "point" });
      const number = store.state.fleet.length + 1;
      uavDialog({
        title: "Add a UAV",
        note: "It stays in the fleet for other missions.",
        uav: { position, name: `UAV ${number}`, base_name: "", max_range_m: null, cruise_speed_mps: null, end_action: "hover" },
        isNew: true,
        act: "Add",
        submit: ({ cruise_speed_mps, ...body }) => actions.addUav(cruise_speed_mps === null ? body : { ...body, cruise_speed_mps }),
      });
    },
  };
}

function field(label, input, unit = "") {
  input.id = `field-${label.toLowerCase().replaceAll(/[^a-z]+/g, "-")}`;
  return h("div", { class: "field" }, h("label", { for: input.id }, label), unit ? h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)) : input);
}

function number(value, min, max, required = true) {
  return h("input", { class: "input", type: "number", step: "any", min, max, required, value: value ?? "" });
}

const END_CHOICES = [
  ["hover", "Hover over its last target"],
  ["return", "Return to start"],
  ["land", "Land at its last target"],
];

const orNull = (input, factor = 1) => (Number.isFinite(input.valueAsNumber) ? input.valueAsNumber * factor : null);

/** Where a UAV starts, how far and how fast it flies and how it ends; a new one has a name and a base as well. */
function uavDialog({ title, note, uav, isNew = false, act, submit }) {
  const longitude = number(Number(uav.position[0].toFixed(6)), -180, 180);
  const latitude = number(Number(uav.position[1].toFixed(6)), -90, 90);
  const name = h("input", { class: "input", required: true, maxlength: 100, value: uav.name });
  const base = h("input", { class: "input", maxlength: 100, value: uav.base_name });
  const range = number(uav.max_range_m === null ? "" : uav.max_range_m / 1000, 0.1, 1000, false);
  const speed = number(uav.cruise_speed_mps ?? "", 0.5, 100, false);
  const end = h("select", { class: "input" }, END_CHOICES.map(([value, words]) => h("option", { value, selected: value === uav.end_action }, words)));
  const unlimited = h("p", { class: "caption", role: "status" });
  const wrong = h("p", { class: "field-error", role: "alert" });
  const sayWhatIsMissing = () => (unlimited.textContent = range.value ? "" : "Range not stated: it is planned as unlimited.");
  range.addEventListener("input", sayWhatIsMissing);
  sayWhatIsMissing();
  const dialog = h("dialog", { "aria-labelledby": "place-title" });
  const form = h(
    "form",
    { method: "dialog" },
    h("div", {}, h("h2", { id: "place-title" }, title), h("p", { class: "quiet-text" }, note)),
    isNew && h("div", { class: "pair" }, field("Name", name), field("Base", base)),
    h("div", {}, h("div", { class: "pair" }, field("Range", range, "km"), field("Speed", speed, "m/s")), unlimited),
    field("End, where “Return to start” is off", end),
    h("div", { class: "pair" }, field("Latitude", latitude, "°"), field("Longitude", longitude, "°")),
    wrong,
    h("div", { class: "acts" }, h("button", { type: "button", class: "button", onclick: () => dialog.close() }, "Cancel"), h("button", { class: "button primary" }, act)),
  );
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    try {
      await submit({
        name: name.value.trim(),
        base_name: base.value.trim(),
        position: [longitude.valueAsNumber, latitude.valueAsNumber],
        max_range_m: orNull(range, 1000),
        cruise_speed_mps: orNull(speed),
        end_action: end.value,
      });
      dialog.close();
    } catch (error) {
      wrong.replaceChildren(error instanceof ApiError ? error.message : "It could not be added.", error.isSignedOut ? h("a", { href: signInAddress() }, "Sign in") : "");
    }
  });
  dialog.append(form);
  open(dialog);
  if (isNew) name.select();
}
