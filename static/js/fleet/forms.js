/** The forms of a UAV, a type and a base. */

import { h, icon } from "../dom.js";
import { choiceField, numberField, switchField, textField } from "../page/fields.js";
import { t } from "../text.js";
import { BOUNDS, boundsIn, IRIS, USUAL_RESERVE_PERCENT, usualOf } from "../uav_figures.js";
import { coordinateText, LONG_UNIT, lengthText, SPEED_UNIT, speedText } from "../units.js";
import { ENDS, LINKS } from "./words.js";

const pair = (...fields) =>
  h(
    "div",
    { class: "pair" },
    fields.map((field) => field.element),
  );
const own = (uav, field) => (uav.from_type.includes(field) ? null : uav[field]);
const words = (text) =>
  text
    .split(",")
    .map((part) => part.trim())
    .filter(Boolean);

/** What can be changed of a row, as the API takes it. */
export const bodies = {
  uavs: (uav) => ({
    name: uav.name,
    type: uav.type,
    base: uav.base,
    position: uav.position,
    serial_number: uav.serial_number,
    mavlink_system_id: uav.mavlink_system_id,
    max_range_m: own(uav, "max_range_m"),
    cruise_speed_mps: own(uav, "cruise_speed_mps"),
    battery_wh: own(uav, "battery_wh"),
    mass_kg: own(uav, "mass_kg"),
    reserve_percent: own(uav, "reserve_percent"),
    max_airspeed_mps: own(uav, "max_airspeed_mps"),
    battery_percent: uav.battery_percent,
    sensor: uav.sensor,
    end_action: uav.end_action,
    link: uav.link,
    allows_unsigned: uav.allows_unsigned,
    is_simulated: uav.is_simulated,
  }),
  types: ({
    name,
    max_range_m,
    cruise_speed_mps,
    battery_wh,
    mass_kg,
    reserve_percent,
    max_airspeed_mps,
    rotor_disk_m2,
    hover_power_w,
    sensors,
  }) => ({
    name,
    max_range_m,
    cruise_speed_mps,
    battery_wh,
    mass_kg,
    reserve_percent,
    max_airspeed_mps,
    rotor_disk_m2,
    hover_power_w,
    sensors,
  }),
  bases: ({ name, position, note }) => ({ name, position, note }),
};

const AIRSPEED_BOUNDS = boundsIn("max_airspeed_mps", SPEED_UNIT.mps);

export const BLANK = {
  uavs: {
    name: "",
    type: null,
    base: null,
    position: null,
    serial_number: "",
    mavlink_system_id: null,
    max_range_m: null,
    cruise_speed_mps: null,
    battery_wh: null,
    mass_kg: null,
    reserve_percent: null,
    max_airspeed_mps: null,
    battery_percent: null,
    sensor: "",
    end_action: "hover",
    link: "mavlink",
    allows_unsigned: false,
    is_simulated: false,
    from_type: [],
  },
  types: {
    name: "",
    max_range_m: null,
    cruise_speed_mps: 12,
    battery_wh: null,
    mass_kg: null,
    reserve_percent: USUAL_RESERVE_PERCENT,
    max_airspeed_mps: null,
    rotor_disk_m2: null,
    hover_power_w: null,
    sensors: [],
  },
  bases: { name: "", position: null, note: "" },
};

/** Latitude and longitude, which the pin on the map follows and sets. */
function placeFields(position, onMove) {
  const latitude = numberField("latitude", t("Latitude"), position[1], {
    digits: 6,
    required: true,
    min: -90,
    max: 90,
    unit: "°",
  });
  const longitude = numberField("longitude", t("Longitude"), position[0], {
    digits: 6,
    required: true,
    min: -180,
    max: 180,
    unit: "°",
  });
  const read = () => [longitude.read(), latitude.read()];
  for (const field of [latitude, longitude])
    field.input.addEventListener("input", () => read().every(Number.isFinite) && onMove(read()));
  return {
    element: h(
      "div",
      {},
      h("div", { class: "pair" }, latitude.element, longitude.element),
      h("p", { class: "caption" }, t("Or drag the pin on the map, or click into it.")),
    ),
    fields: [latitude, longitude],
    read,
    set([lon, lat]) {
      longitude.input.value = Number(lon.toFixed(6));
      latitude.input.value = Number(lat.toFixed(6));
    },
  };
}

/** By which door a UAV is told what to do, and what is taken for its word. */
function linkFields(uav, isAdministrator) {
  const waiver = (name, label, hint) =>
    switchField(name, label, uav[name], {
      hint: isAdministrator ? hint : t("Only an administrator changes this."),
      disabled: !isAdministrator,
    });
  return [
    choiceField(
      "link",
      t("Told what to do by"),
      uav.link,
      Object.entries(LINKS).map(([value, { words }]) => [value, words]),
    ),
    waiver("is_simulated", t("Simulated"), t("No real aircraft: it may fly where there is no terrain data.")),
    waiver(
      "allows_unsigned",
      t("MAVLink without a signature"),
      t("Whoever reaches the gateway can then fly it: only on a closed network."),
    ),
  ];
}

function uavFields(uav, { types, bases, place, isNew, isAdministrator }) {
  const typeOf = (id) => types.find((type) => type.id === id);
  const usual = (type) =>
    type
      ? t("Empty: {range} and {speed}, as its type.", {
          range: type.max_range_m === null ? t("no limit") : lengthText(type.max_range_m),
          speed: speedText(type.cruise_speed_mps),
        })
      : t("Empty: the range is not limited, the speed is the usual one.");
  const name = textField("name", t("Name"), uav.name, { required: true });
  const type = choiceField("type", t("Type"), uav.type, [["", t("none")], ...types.map((row) => [row.id, row.name])], {
    isNumber: true,
  });
  const base = choiceField("base", t("Base"), uav.base, [["", t("none")], ...bases.map((row) => [row.id, row.name])], {
    isNumber: true,
  });
  const range = numberField("max_range_m", t("Own range"), uav.max_range_m, {
    factor: LONG_UNIT.metres,
    unit: LONG_UNIT.unit,
    min: 0.1,
  });
  const speed = numberField("cruise_speed_mps", t("Own speed"), uav.cruise_speed_mps, {
    factor: SPEED_UNIT.mps,
    unit: SPEED_UNIT.unit,
    min: 0.5,
  });
  const hint = h("p", { class: "caption", role: "status" }, usual(typeOf(uav.type)));
  const power = [
    numberField("battery_wh", t("Own battery"), uav.battery_wh, { unit: "Wh", ...BOUNDS.battery_wh }),
    numberField("mass_kg", t("Own mass"), uav.mass_kg, { unit: "kg", ...BOUNDS.mass_kg }),
    numberField("reserve_percent", t("Own reserve"), uav.reserve_percent, {
      unit: "%",
      digits: 1,
      ...BOUNDS.reserve_percent,
    }),
    numberField("max_airspeed_mps", t("Own highest airspeed"), uav.max_airspeed_mps, {
      factor: SPEED_UNIT.mps,
      unit: SPEED_UNIT.unit,
      ...AIRSPEED_BOUNDS,
    }),
  ];
  const powerHint = h("p", { class: "caption", role: "status" });
  /** What counts in an empty field stands in it in grey. */
  function showUsual() {
    const chosen = typeOf(type.read());
    for (const field of power) field.usual(usualOf(chosen)[field.name]);
    range.usual(chosen?.max_range_m);
    speed.usual(chosen?.cruise_speed_mps);
    const isCounted = Boolean(chosen?.battery_wh) || power[0].read() !== null;
    const grey = chosen ? t("Empty: as its type, in grey.") : t("Empty: the usual, in grey.");
    powerHint.textContent = isCounted ? grey : t("{grey} Without a battery no energy is counted.", { grey });
  }
  const rest = [
    numberField("battery_percent", t("Charged to"), uav.battery_percent, { unit: "%", min: 0, max: 100, digits: 1 }),
    textField("sensor", t("Sensor besides those of its type"), uav.sensor),
    choiceField("end_action", t("At the end, where a mission does not say “Return to start”"), uav.end_action, ENDS),
    textField("serial_number", t("Serial number"), uav.serial_number),
    numberField("mavlink_system_id", t("MAVLink system id"), uav.mavlink_system_id, {
      min: 1,
      max: 254,
      step: 1,
      digits: 0,
    }),
  ];
  const link = linkFields(uav, isAdministrator);
  type.input.addEventListener("change", () => {
    hint.textContent = usual(typeOf(type.read()));
    showUsual();
  });
  power[0].input.addEventListener("input", showUsual);
  showUsual();
  const toBase = () => {
    const chosen = bases.find((row) => row.id === base.read());
    if (chosen) place.move(chosen.position);
  };
  const button = h("button", { type: "button", class: "text-button", onclick: toBase }, t("Put it at its base"));
  const showButton = () => (button.hidden = base.read() === null);
  base.input.addEventListener("change", () => {
    showButton();
    if (isNew && !place.isTouched()) toBase();
  });
  showButton();
  return {
    fields: [name, type, base, range, speed, ...power, ...rest, ...link],
    elements: [
      name.element,
      pair(type, base),
      place.element,
      button,
      h("div", {}, pair(range, speed), hint),
      h("div", { class: "stack-tight" }, pair(power[0], power[1]), pair(power[2], power[3]), powerHint),
      pair(rest[0], rest[4]),
      rest[1].element,
      rest[2].element,
      rest[3].element,
      ...link.map((field) => field.element),
    ],
  };
}

function typeFields(type) {
  const name = textField("name", t("Name"), type.name, { required: true });
  const range = numberField("max_range_m", t("Range"), type.max_range_m, {
    factor: LONG_UNIT.metres,
    unit: LONG_UNIT.unit,
    min: 0.1,
    hint: t("On one battery; empty: not limited."),
  });
  const speed = numberField("cruise_speed_mps", t("Speed"), type.cruise_speed_mps, {
    factor: SPEED_UNIT.mps,
    unit: SPEED_UNIT.unit,
    min: 0.5,
    required: true,
  });
  const battery = numberField("battery_wh", t("Battery"), type.battery_wh, {
    unit: "Wh",
    ...BOUNDS.battery_wh,
    hint: t("When full; empty: no energy is counted."),
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
  const airspeed = numberField("max_airspeed_mps", t("Highest airspeed"), type.max_airspeed_mps, {
    factor: SPEED_UNIT.mps,
    unit: SPEED_UNIT.unit,
    ...AIRSPEED_BOUNDS,
    hint: t("Against the wind; empty: its speed."),
  });
  const disk = numberField("rotor_disk_m2", t("Rotor area"), type.rotor_disk_m2, {
    unit: "m²",
    ...BOUNDS.rotor_disk_m2,
    digits: 4,
    usual: IRIS.rotor_disk_m2,
    hint: t("Circles of all rotors together; empty: those of a PX4 Iris, in grey."),
  });
  const hover = numberField("hover_power_w", t("Power in a hover"), type.hover_power_w, {
    unit: "W",
    ...BOUNDS.hover_power_w,
    digits: 1,
    hint: t("As measured in still air, with this mass; empty: worked out from mass and rotors."),
  });
  const sensors = textField("sensors", t("Sensors"), type.sensors.join(", "), {
    maxlength: 600,
    hint: t("Divided by commas."),
  });
  const list = sensors.read;
  sensors.read = () => words(list());
  return {
    fields: [name, range, speed, battery, mass, reserve, airspeed, disk, hover, sensors],
    elements: [
      name.element,
      pair(range, speed),
      pair(battery, mass),
      pair(reserve, airspeed),
      pair(disk, hover),
      sensors.element,
    ],
  };
}

function baseFields(base, { place }) {
  const name = textField("name", t("Name"), base.name, { required: true });
  const note = textField("note", t("Note"), base.note, { maxlength: 300, hint: t("How to get there, whom to call.") });
  return { fields: [name, note], elements: [name.element, place.element, note.element] };
}

const MAKERS = { uavs: uavFields, types: typeFields, bases: baseFields };

/** Returns { element, body(), tell(error), notice(…), setPlace(position), label(name), words(name, value) }. onMove(position): the place was typed. */
export function createForm({ tab, body, types, bases, isNew, isAdministrator, onMove, onSave, onCancel }) {
  const notice = h("div", {});
  let touched = false;
  const place = body.position && placeFields(body.position, (position) => ((touched = true), onMove(position)));
  if (place) {
    place.isTouched = () => touched;
    place.move = (position) => (place.set(position), onMove(position));
  }
  const { fields, elements } = MAKERS[tab](body, { types, bases, place, isNew, isAdministrator });
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
  const names = (name, value) => ({ type: types, base: bases })[name]?.find((row) => row.id === value)?.name;

  return {
    element,
    first: fields[0].input,
    body: () => ({
      ...Object.fromEntries(fields.map((field) => [field.name, field.read()])),
      ...(place ? { position: place.read() } : {}),
    }),
    busy: (isBusy) => save.setAttribute("aria-busy", `${isBusy}`),
    setPlace(position) {
      touched = true;
      place.set(position);
      element.dispatchEvent(new Event("input"));
    },
    clear() {
      notice.replaceChildren();
      all.forEach((field) => field.tell(""));
    },
    /** Says at the field what is wrong with it; what has no field stands above the form. */
    tell(message, details) {
      const known = Object.entries(details ?? {}).filter(([name]) => all.some((field) => field.name === name));
      for (const [name, [words]] of known) all.find((field) => field.name === name).tell(words);
      notice.replaceChildren(
        h(
          "div",
          { class: "notice critical", role: "alert" },
          icon("circle-alert"),
          h("p", {}, h("strong", {}, t("Not saved.")), ` ${known.length ? known[0][1][0] : message}`),
        ),
      );
      all.find((field) => field.name === known[0]?.[0])?.input.focus();
    },
    ask: (content) => notice.replaceChildren(content),
    label: (name) => all.find((field) => field.name === name)?.label ?? (name === "position" ? t("Place") : name),
    words(name, value) {
      if (value === null || value === "" || (Array.isArray(value) && !value.length)) return t("not stated");
      if (name === "position") return coordinateText(value);
      if (name === "max_range_m") return lengthText(value);
      if (name === "cruise_speed_mps" || name === "max_airspeed_mps") return speedText(value);
      if (name === "link") return LINKS[value].words;
      if (typeof value === "boolean") return value ? t("yes") : t("no");
      return names(name, value) ?? (Array.isArray(value) ? value.join(", ") : `${value}`);
    },
  };
}
