/** The fleet: who flies in this mission, with letter, base and battery. */

import { ApiError } from "../../api.js";
import { byId, h, icon, keyedList } from "../../dom.js";
import { routeNumber } from "../../map/palette.js";
import { open } from "../../page/keyboard.js";
import { lengthText } from "../../units.js";
import { inFleetOrder } from "../fleet.js";

export function mountUavs(store, actions, canPlan, { mapCentre }) {
  const draw = keyedList(
    byId("uav-list"),
    (uav) => `${uav.id}`,
    (uav) => {
      const box = h("input", { type: "checkbox", class: "check", disabled: !canPlan, onchange: () => actions.toggleUav(uav.id, box.checked) });
      return h(
        "li",
        { class: "uav", onpointerenter: () => look(uav.id), onpointerleave: () => store.update({ lookedAt: null }) },
        h("label", {}, box, h("span", { class: "letter" }), h("span", { class: "name" }, uav.name, h("small", {}, uav.base_name))),
        h("span", { class: "end" }),
        canPlan && h("button", { type: "button", class: "icon-button tight", "aria-label": `Move the start of ${uav.name}`, title: "Move its start", onclick: () => moveStart(uav.id) }, icon("locate-fixed", "small")),
      );
    },
    (row, uav) => {
      const box = row.querySelector("input");
      box.checked = uav.sequence !== null;
      const letter = row.querySelector(".letter");
      letter.className = `letter ${uav.sequence === null ? "none" : `route-${routeNumber(uav.sequence)}`}`;
      letter.textContent = uav.letter;
      row.querySelector(".end").textContent = uav.max_range_m ? `range ${lengthText(uav.max_range_m)}` : "";
      row.querySelector("button")?.classList.toggle("absent", uav.sequence === null);
    },
  );

  const sequenceOf = (id) => store.state.selection.uavs.findIndex((uav) => uav.id === id);

  function look(id) {
    const sequence = sequenceOf(id);
    store.update({ lookedAt: sequence >= 0 && store.state.plan ? sequence : null });
  }

  function moveStart(id) {
    const sequence = sequenceOf(id);
    const uav = store.state.selection.uavs[sequence];
    positionDialog({ title: `Start of ${uav.name}`, note: "Or drag its square on the map.", position: uav.position, act: "Move", submit: ({ position }) => actions.moveUav(sequence, position) });
  }

  document.getElementById("add-uav")?.addEventListener("click", () => store.update({ tool: "place" }));

  store.listen(["fleet", "selection"], (state) => {
    const uavs = inFleetOrder(state);
    draw(uavs);
    byId("uavs-empty").hidden = uavs.length > 0;
    byId("uav-count").textContent = uavs.length ? `${state.selection.uavs.length} of ${uavs.length}` : "";
  });

  return {
    /** Asks for the name of a UAV that takes off at a place; Enter takes the middle of the map. */
    askForUav(position = mapCentre()) {
      store.update({ tool: "point" });
      const number = store.state.fleet.length + 1;
      positionDialog({
        title: "Add a UAV",
        note: "It stays in the fleet for other missions.",
        position,
        name: `UAV ${number}`,
        act: "Add",
        submit: ({ name, base_name, range_km, position: place }) =>
          actions.addUav({ name, base_name, position: place, ...(range_km ? { max_range_m: range_km * 1000 } : {}) }),
      });
    },
  };
}

function field(label, input, unit = "") {
  input.id = `field-${label.toLowerCase().replaceAll(" ", "-")}`;
  return h("div", { class: "field" }, h("label", { for: input.id }, label), unit ? h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)) : input);
}

function number(value, min, max, required = true) {
  return h("input", { class: "input", type: "number", step: "any", min, max, required, value: value ?? "" });
}

/** A place with longitude and latitude, and with `name` a whole UAV. */
function positionDialog({ title, note, position, name, act, submit }) {
  const longitude = number(Number(position[0].toFixed(6)), -180, 180);
  const latitude = number(Number(position[1].toFixed(6)), -90, 90);
  const nameInput = h("input", { class: "input", required: true, maxlength: 100, value: name ?? "" });
  const base = h("input", { class: "input", maxlength: 100 });
  const range = number("", 0.1, 1000, false);
  const wrong = h("p", { class: "field-error", role: "alert" });
  const dialog = h("dialog", { "aria-labelledby": "place-title" });
  const form = h(
    "form",
    { method: "dialog" },
    h("div", {}, h("h2", { id: "place-title" }, title), h("p", { class: "quiet-text" }, note)),
    name && field("Name", nameInput),
    name && h("div", { class: "pair" }, field("Base", base), field("Range", range, "km")),
    h("div", { class: "pair" }, field("Latitude", latitude, "°"), field("Longitude", longitude, "°")),
    wrong,
    h("div", { class: "acts" }, h("button", { type: "button", class: "button", onclick: () => dialog.close() }, "Cancel"), h("button", { class: "button primary" }, act)),
  );
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    try {
      await submit({ name: nameInput.value.trim(), base_name: base.value.trim(), range_km: range.valueAsNumber, position: [longitude.valueAsNumber, latitude.valueAsNumber] });
      dialog.close();
    } catch (error) {
      wrong.textContent = error instanceof ApiError ? error.message : "It could not be added.";
    }
  });
  dialog.append(form);
  open(dialog);
  if (name) nameInput.select();
}
