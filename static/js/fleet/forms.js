/** The forms of a UAV, a type and a base. */

import { camerasField } from "../cameras/cameras_field.js";
import { h, icon } from "../dom.js";
import { numberField, switchField, textField } from "../page/fields.js";
import { t } from "../text.js";
import { BOUNDS, IRIS } from "../uav_figures.js";
import { coordinateText, LONG_UNIT, lengthText, SPEED_UNIT, speedText } from "../units.js";
import { AIRSPEED_BOUNDS, pair, placeFields, uavFields } from "./uav_form.js";
import { LINKS } from "./words.js";

/** @import { Camera, LinkKind } from "../api_types.d.ts" */
/** @import { BaseBody, Body, Field, FleetBase, FleetType, Form, FormFields, Position, Tab, TypeBody, UavBody } from "./types.d.ts" */
/** @import { FormContext } from "./uav_form.js" */

/** @param {string} text divided by commas */
const listOf = (text) =>
  text
    .split(",")
    .map((part) => part.trim())
    .filter(Boolean);

/** @param {TypeBody} type @returns {FormFields} */
function typeFields(type) {
  const name = textField("name", t("Name"), type.name, { required: true });
  const range = numberField("max_range_m", t("Range"), type.max_range_m, {
    factor: LONG_UNIT.metres,
    unit: LONG_UNIT.unit,
    min: 0.1,
    hint: t("On one battery. Blank: its UAVs are incomplete, unless a battery is stated."),
  });
  const unlimited = switchField("range_unlimited", t("Unlimited range"), type.range_unlimited, {
    hint: t("Plans then set no limit to the length of its flights."),
  });
  const turnOff = () => {
    range.input.disabled = unlimited.read();
    if (unlimited.read()) range.input.value = "";
  };
  unlimited.input.addEventListener("change", turnOff);
  turnOff();
  const speed = numberField("cruise_speed_mps", t("Speed"), type.cruise_speed_mps, {
    factor: SPEED_UNIT.mps,
    unit: SPEED_UNIT.unit,
    min: 0.5,
    required: true,
  });
  const battery = numberField("battery_wh", t("Battery"), type.battery_wh, {
    unit: "Wh",
    ...BOUNDS.battery_wh,
    hint: t("When full. Blank: energy is not calculated."),
  });
  const mass = numberField("mass_kg", t("Mass"), type.mass_kg, {
    unit: "kg",
    ...BOUNDS.mass_kg,
    hint: t("At take-off; needed with a battery."),
  });
  const reserve = numberField("reserve_percent", t("Kept in reserve"), type.reserve_percent, {
    unit: "%",
    ...BOUNDS.reserve_percent,
    digits: 1,
    required: true,
    hint: t("Of the battery; a plan does not use it."),
  });
  const airspeed = numberField("max_airspeed_mps", t("Maximum airspeed"), type.max_airspeed_mps, {
    factor: SPEED_UNIT.mps,
    unit: SPEED_UNIT.unit,
    ...AIRSPEED_BOUNDS,
    hint: t("Against the wind. Blank: cruise speed."),
  });
  const disk = numberField("rotor_disk_m2", t("Rotor area"), type.rotor_disk_m2, {
    unit: "m²",
    ...BOUNDS.rotor_disk_m2,
    digits: 4,
    usual: IRIS.rotor_disk_m2,
    hint: t("Circles of all rotors together. Blank: those of a PX4 Iris (grey)."),
  });
  const hover = numberField("hover_power_w", t("Power in a hover"), type.hover_power_w, {
    unit: "W",
    ...BOUNDS.hover_power_w,
    digits: 1,
    hint: t("As measured in still air, with this mass. Blank: calculated from mass and rotors."),
  });
  const sensors = textField("sensors", t("Sensors"), type.sensors.join(", "), {
    maxlength: 600,
    hint: t("Divided by commas."),
  });
  const sensorList = { ...sensors, read: () => listOf(sensors.read()) };
  const cameras = camerasField(type.cameras);
  return {
    fields: [name, range, unlimited, speed, battery, mass, reserve, airspeed, disk, hover, sensorList, cameras],
    elements: [
      name.element,
      pair(range, speed),
      unlimited.element,
      pair(battery, mass),
      pair(reserve, airspeed),
      pair(disk, hover),
      sensors.element,
      cameras.element,
    ],
  };
}

/** @param {BaseBody} base @param {FormContext} context @returns {FormFields} */
function baseFields(base, { place }) {
  const name = textField("name", t("Name"), base.name, { required: true });
  const note = textField("note", t("Note"), base.note, { maxlength: 300, hint: t("How to get there, whom to call.") });
  return { fields: [name, note], elements: [name.element, place?.element, note.element] };
}

/** @param {Tab} tab @param {Body} body @param {FormContext} context */
function fieldsOf(tab, body, context) {
  if (tab === "uavs") return uavFields(/** @type {UavBody} */ (body), context);
  return tab === "types"
    ? typeFields(/** @type {TypeBody} */ (body))
    : baseFields(/** @type {BaseBody} */ (body), context);
}

/**
 * @param {object} options
 * @param {Tab} options.tab
 * @param {Body} options.body initial values
 * @param {FleetType[]} options.types
 * @param {FleetBase[]} options.bases
 * @param {boolean} options.isNew
 * @param {boolean} options.isAdministrator
 * @param {(position: Position) => void} options.onMove called when the place was typed
 * @param {() => unknown} options.onSave
 * @param {() => unknown} options.onCancel
 * @returns {Form}
 */
export function createForm({ tab, body, types, bases, isNew, isAdministrator, onMove, onSave, onCancel }) {
  const notice = h("div", {});
  const place = "position" in body && body.position ? placeFields(body.position, onMove) : null;
  const { fields, elements } = fieldsOf(tab, body, { types, bases, place, isNew, isAdministrator });
  const save = h("button", { class: "button primary" }, t("Save"));
  const element = h(
    "form",
    { class: "fleet-form" },
    notice,
    elements,
    h(
      "div",
      { class: "form-acts" },
      save,
      h("button", { type: "button", class: "button", onclick: onCancel }, t("Cancel")),
    ),
  );
  element.addEventListener("submit", (event) => {
    event.preventDefault();
    onSave();
  });
  const all = [...fields, ...(place?.fields ?? [])];
  /** @param {string} name */
  const fieldOf = (name) => all.find((field) => field.name === name) ?? fieldWithin(all, name);

  return {
    element,
    first: fields[0].input,
    body: () =>
      /** @type {Body} */ ({
        ...Object.fromEntries(fields.map((field) => [field.name, field.read()])),
        ...(place ? { position: place.read() } : {}),
      }),
    busy: (isBusy) => save.setAttribute("aria-busy", `${isBusy}`),
    setPlace(position) {
      place?.set(position);
      element.dispatchEvent(new Event("input"));
    },
    clear() {
      notice.replaceChildren();
      for (const field of all) field.notify("");
    },
    notify(message, details) {
      const known = Object.entries(details ?? {}).filter(([name]) => fieldOf(name));
      for (const [name, [words]] of known) fieldOf(name)?.notify(words);
      notice.replaceChildren(
        h(
          "div",
          { class: "notice critical", role: "alert" },
          icon("circle-alert"),
          h("p", {}, h("strong", {}, t("Not saved.")), ` ${known.length ? known[0][1][0] : message}`),
        ),
      );
      if (known.length) fieldOf(known[0][0])?.input.focus();
    },
    ask: (content) => notice.replaceChildren(content),
    label: (name) => fieldOf(name)?.label ?? (name === "position" ? t("Place") : name),
    words(name, value) {
      const row = { type: types, base: bases }[name]?.find(({ id }) => id === value);
      return row?.name ?? valueText(name, value);
    },
  };
}

/** The field of one figure of a list: "cameras.0.name". @param {Field[]} fields @param {string} name */
const fieldWithin = (fields, name) =>
  fields.map((field) => ("within" in field ? /** @type {any} */ (field).within(name) : undefined)).find(Boolean);

/** @param {string} name of a field @param {unknown} value */
function valueText(name, value) {
  if (value === null || value === "" || (Array.isArray(value) && !value.length)) return t("not stated");
  if (name === "position") return coordinateText(/** @type {Position} */ (value));
  if (name === "max_range_m") return lengthText(/** @type {number} */ (value));
  if (name === "cruise_speed_mps" || name === "max_airspeed_mps") return speedText(/** @type {number} */ (value));
  if (name === "link") return LINKS[/** @type {LinkKind} */ (value)].words;
  if (name === "cameras") return /** @type {Camera[]} */ (value).map((camera) => camera.name).join(", ");
  if (typeof value === "boolean") return value ? t("yes") : t("no");
  return Array.isArray(value) ? value.join(", ") : `${value}`;
}
