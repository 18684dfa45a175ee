/** The dialogs of a UAV: a new one, or one with figures for this mission alone. */

import { ApiError, get, signInAddress } from "../../../api.js";
import { h, setChildren } from "../../../dom.js";
import { open } from "../../../page/keyboard.js";
import { t } from "../../../text.js";
import { usualOf } from "../../../uav_figures.js";
import { LONG_UNIT, SPEED_UNIT } from "../../../units.js";
import { createFields, createLimits, field, showFault } from "./fields.js";

/** @import { Answer } from "../../../api.js" */
/** @import { BasePage, UavType, UavTypePage } from "../../../api_types.d.ts" */
/** @import { Child } from "../../../dom.js" */
/** @import { DialogUav, Fields, Input, TypedUav } from "./fields.js" */

/** @typedef {{ title: string, note: string, uav: DialogUav, act: string }} DialogHow */
/** @typedef {TypedUav & { type: number | null }} NewUav */
/** @typedef {TypedUav & { most_targets: number | null, sorties: number }} ChangedUav */

/** A UAV for this mission alone. @param {DialogHow & { submit: (typed: ChangedUav) => unknown }} how */
export function changeDialog({ uav, submit, ...how }) {
  const fields = createFields(uav);
  const limits = createLimits(uav);
  fields.showUsual(uav.usual ?? usualOf(null));
  showDialog(fields, how, {
    ownHint: t("Blank: value of the fleet (grey). Without a battery, energy is not calculated."),
    rest: h(
      "div",
      {},
      limits.element,
      h(
        "p",
        { class: "caption" },
        t("More than one flight only where it returns to its start; each on a full battery."),
        " ",
        uav.sensors?.length
          ? t("Sensors: {names}", { names: uav.sensors.join(", ") })
          : t("No sensor is stated for it."),
      ),
    ),
    submit: () => submit({ ...fields.read(), ...limits.read() }),
  });
}

/** A UAV that is new in the fleet. @param {DialogHow & { submit: (typed: NewUav) => unknown }} how */
export function newDialog({ uav, submit, ...how }) {
  const fields = createFields(uav);
  const type = h("select", { class: "input", required: true }, h("option", { value: "" }, t("Choose a type")));
  const noTypes = h(
    "p",
    { class: "caption", hidden: true },
    t("There are no types yet."),
    " ",
    h("a", { href: "/uavs?tab=types" }, t("Add a type")),
  );
  const ofType = h("div", {}, field(t("Type"), type), noTypes);
  /** @type {UavType[]} */
  let types = [];
  fields.showUsual(uav.usual ?? usualOf(null));
  const { showRange } = showDialog(fields, how, {
    others: { type },
    ownHint: t("Blank: value of the type (grey). Without a battery, energy is not calculated."),
    head: [h("div", { class: "pair" }, field(t("Name"), fields.name), field(t("Base"), fields.base_name)), ofType],
    submit: () => submit({ ...fields.read(), type: type.value ? Number(type.value) : null }),
  });
  type.addEventListener("change", () => {
    const chosen = types.find(({ id }) => `${id}` === type.value);
    fields.showUsual(usualOf(chosen));
    fields.showUsualFlight(chosen);
    showRange(chosen);
  });
  fields.name.select();
  void get("/bases?limit=1000")
    .then((answer) => {
      const { results } = /** @type {Answer<BasePage>} */ (answer).data;
      fields.base_name.append(...results.map(({ name }) => h("option", { value: name }, name)));
    })
    .catch(() => {}); // it is added without one
  get("/uav-types?limit=100").then(
    (answer) => {
      types = /** @type {Answer<UavTypePage>} */ (answer).data.results;
      type.append(...types.map((row) => h("option", { value: row.id }, row.name)));
      noTypes.hidden = types.length > 0;
    },
    () => {
      type.required = false; // it is added without one
    },
  );
}

/**
 * @param {Fields} fields
 * @param {Omit<DialogHow, "uav">} how
 * @param {{ others?: Record<string, Input>, ownHint: string, head?: Child, rest?: Child, submit: () => unknown }} parts `others`: fields besides
 */
function showDialog(fields, { title, note, act }, { others = {}, ownHint, head, rest, submit }) {
  const { max_range_m: range, cruise_speed_mps: speed } = fields;
  const unlimited = h("p", { class: "caption", role: "status" });
  const wrong = h("p", { class: "field-error", role: "alert" });
  const dialog = h("dialog", { "aria-labelledby": "place-title" });
  let isLimited = "type" in others; // a new UAV without a range is incomplete, unless its type is unlimited
  /** @param {UavType} [type] */
  const showRange = (type) => {
    if (type) isLimited = !type.range_unlimited;
    const isCounted = range.value || range.placeholder || fields.battery_wh.value || fields.battery_wh.placeholder;
    if (isCounted) unlimited.textContent = "";
    else if (isLimited) unlimited.textContent = t("State a range or a battery: without them it cannot be planned.");
    else unlimited.textContent = t("Unlimited range.");
  };
  for (const input of [range, fields.battery_wh]) input.addEventListener("input", () => showRange());
  showRange();
  const form = h(
    "form",
    { method: "dialog" },
    h("div", {}, h("h2", { id: "place-title" }, title), h("p", { class: "quiet-text" }, note)),
    head,
    h(
      "div",
      {},
      h("div", { class: "pair" }, field(t("Range"), range, LONG_UNIT.unit), field(t("Speed"), speed, SPEED_UNIT.unit)),
      unlimited,
    ),
    ownFigures(fields, ownHint),
    field(t("End, where “Return to start” is off"), fields.end_action),
    rest,
    h(
      "div",
      { class: "pair" },
      field(t("Latitude"), fields.latitude, "°"),
      field(t("Longitude"), fields.longitude, "°"),
    ),
    wrong,
    h(
      "div",
      { class: "acts" },
      h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Cancel")),
      h("button", { class: "button primary" }, act),
    ),
  );
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    const shown = Object.entries({ ...fields.byName, ...others }).filter(([, input]) => form.contains(input));
    for (const [, input] of shown) showFault(input, "");
    wrong.replaceChildren();
    try {
      await submit();
      dialog.close();
    } catch (error) {
      showRefusal(error, new Map(shown), wrong);
    }
  });
  dialog.append(form);
  open(dialog);
  return { showRange };
}

/** @param {Fields} fields @param {string} hint */
const ownFigures = ({ battery_wh, reserve_percent, mass_kg, max_airspeed_mps }, hint) =>
  h(
    "div",
    { class: "stack", role: "group", "aria-label": t("Battery and airspeed") },
    h(
      "div",
      { class: "pair" },
      field(t("Battery"), battery_wh, "Wh"),
      field(t("Kept in reserve"), reserve_percent, "%"),
    ),
    h(
      "div",
      { class: "pair" },
      field(t("Mass at take-off"), mass_kg, "kg"),
      field(t("Maximum airspeed"), max_airspeed_mps, SPEED_UNIT.unit),
    ),
    h("p", { class: "caption own-values" }, hint),
  );

/**
 * Show the refusal beside the fields that it concerns, else below them all.
 *
 * @param {unknown} error
 * @param {Map<string, Input>} inputs
 * @param {HTMLElement} wrong
 */
function showRefusal(error, inputs, wrong) {
  /** @type {Record<string, string | string[]>} */
  const details = (error instanceof ApiError && error.details) || {};
  const known = Object.entries(details).flatMap(([part, words]) => {
    const input = inputs.get(part);
    return input ? [{ input, words: [words].flat().join(" ") }] : [];
  });
  for (const { input, words } of known) showFault(input, words);
  if (known.length) known[0].input.focus();
  else
    setChildren(
      wrong,
      error instanceof ApiError ? error.message : t("It could not be added."),
      error instanceof ApiError && error.isSignedOut && h("a", { href: signInAddress() }, t("Sign in")),
    );
}
