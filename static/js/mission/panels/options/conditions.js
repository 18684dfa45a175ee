/** The air that a mission is planned for: wind by height, and temperature. */

import { h, icon } from "../../../dom.js";
import { open } from "../../../page/keyboard.js";
import { t } from "../../../text.js";
import { compassText, SHORT_UNIT, SPEED_UNIT, TEMPERATURE_UNIT } from "../../../units.js";
import { conditionsOf, MAX_LAYERS, MILD_C } from "../../options/flight_options.js";
import { windArrow } from "../../options/wind_arrow.js";

/** @import { Conditions } from "../../types.d.ts" */

/** @typedef {Conditions["wind"][number]} WindLayer */
/**
 * @typedef {object} FigureHow
 * @property {string} label
 * @property {number} min
 * @property {number} max
 * @property {string} unit
 * @property {(si: number) => number} [typed]
 * @property {(typed: number) => number} [si]
 */

const FIRST_LAYER = { altitude_agl_m: 100, speed_mps: 5, from_deg: 270 };
const [MAX_HEIGHT_M, MAX_WIND_MPS] = [1000, 60]; // missions/serializers/limits.py
const [MIN_TEMPERATURE_C, HOTTEST_C] = [-60, 60];

/**
 * A field typed in the reader's unit, read in SI; one that was not touched keeps its value.
 *
 * @param {number} value
 * @param {FigureHow} how
 */
function figure(value, { label, min, max, unit, typed = (si) => si, si = (shown) => shown }) {
  const shown = Number(typed(value).toPrecision(5));
  const input = h("input", {
    class: "input",
    type: "number",
    step: "any",
    required: true,
    min: Math.round(typed(min)),
    max: Math.round(typed(max)),
    value: shown,
    "aria-label": label,
  });
  return {
    element: h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)),
    input,
    read: () => (input.valueAsNumber === shown ? value : si(input.valueAsNumber)),
  };
}

/** @param {number} unit @returns {Pick<FigureHow, "typed" | "si">} */
const per = (unit) => ({ typed: (si) => si / unit, si: (shown) => shown * unit });

/** The wind at one height. @param {WindLayer} layer @param {() => unknown} onRemove */
function windRow(layer, onRemove) {
  const height = figure(layer.altitude_agl_m, {
    label: t("Height above ground"),
    min: 0,
    max: MAX_HEIGHT_M,
    unit: SHORT_UNIT.unit,
    ...per(SHORT_UNIT.metres),
  });
  const speed = figure(layer.speed_mps, {
    label: t("Wind speed"),
    min: 0,
    max: MAX_WIND_MPS,
    unit: SPEED_UNIT.unit,
    ...per(SPEED_UNIT.mps),
  });
  const side = figure(layer.from_deg, {
    label: t("Wind from, degrees clockwise from north"),
    min: 0,
    max: 360,
    unit: "°",
  });
  const arrow = h("span", { class: "wind-from" });
  const showSide = () => {
    const from_deg = Number.isFinite(side.input.valueAsNumber) ? side.input.valueAsNumber : 0;
    arrow.replaceChildren(windArrow(from_deg), h("small", {}, compassText(from_deg)));
  };
  side.input.addEventListener("input", showSide);
  showSide();
  const drop = h(
    "button",
    {
      type: "button",
      class: "icon-button tight",
      "aria-label": t("Remove wind layer"),
      title: t("Remove wind layer"),
      onclick: onRemove,
    },
    icon("x", "small"),
  );
  return {
    element: h(
      "div",
      { class: "wind-row", role: "group", "aria-label": t("Wind at a height") },
      height.element,
      speed.element,
      side.element,
      arrow,
      drop,
    ),
    focus: () => height.input.focus(),
    /** @returns {WindLayer} */
    read: () => ({ altitude_agl_m: height.read(), speed_mps: speed.read(), from_deg: side.read() % 360 }),
  };
}

/** The wind by height. @param {WindLayer[]} wind */
function createWind(wind) {
  /** @type {ReturnType<typeof windRow>[]} */
  let rows = [];
  const list = h("div", { class: "wind-rows" });
  const calm = h("p", { class: "quiet-text" }, t("Calm at all heights."));
  const heads = h(
    "div",
    { class: "wind-row heads", "aria-hidden": "true" },
    [t("Height"), t("Speed"), t("From|wind")].map((words) => h("span", {}, words)),
  );
  const more = h(
    "button",
    { type: "button", class: "button", onclick: addLayer },
    icon("plus", "small"),
    t("Add wind layer"),
  );

  /** @param {WindLayer} layer */
  function add(layer) {
    const row = windRow(layer, () => {
      rows = rows.filter((other) => other !== row);
      draw();
      more.focus();
    });
    rows.push(row);
    return row;
  }

  function addLayer() {
    const last = rows.at(-1)?.read();
    const row = add(
      last ? { ...last, altitude_agl_m: Math.min(MAX_HEIGHT_M, last.altitude_agl_m + 100) } : FIRST_LAYER,
    );
    draw();
    row.focus();
  }

  function draw() {
    list.replaceChildren(...rows.map(({ element }) => element));
    heads.hidden = rows.length === 0;
    calm.hidden = rows.length > 0;
    more.disabled = rows.length >= MAX_LAYERS;
  }

  for (const layer of wind) add(layer);
  draw();
  return {
    element: h(
      "div",
      { class: "stack tight" },
      h("h3", { class: "field-label" }, t("Wind")),
      calm,
      heads,
      list,
      h("div", {}, more),
    ),
    read: () => rows.map((row) => row.read()),
  };
}

/**
 * The dialog of conditions.
 *
 * @param {Conditions | null} conditions
 * @param {(conditions: Conditions | null) => unknown} use null: calm and mild
 */
export function askForConditions(conditions, use) {
  const known = conditionsOf(conditions) ?? { wind: [], temperature_c: MILD_C };
  const wind = createWind(known.wind);
  const temperature = figure(known.temperature_c, {
    label: t("Temperature"),
    min: MIN_TEMPERATURE_C,
    max: HOTTEST_C,
    unit: TEMPERATURE_UNIT.unit,
    typed: TEMPERATURE_UNIT.typed,
    si: TEMPERATURE_UNIT.celsius,
  });
  temperature.input.id = "conditions-temperature";
  const dialog = h("dialog", { class: "conditions", "aria-labelledby": "conditions-title" });
  /** @param {Conditions | null} chosen */
  const finish = (chosen) => {
    dialog.close();
    use(chosen);
  };
  const wrong = h("p", { class: "field-error", role: "alert" });
  const form = h(
    "form",
    { method: "dialog" },
    h(
      "div",
      {},
      h("h2", { id: "conditions-title" }, t("Conditions")),
      h("p", { class: "quiet-text" }, t("Wind is interpolated between layers. Arrows show where it blows.")),
    ),
    wind.element,
    h(
      "div",
      { class: "field temperature" },
      h("label", { for: temperature.input.id }, t("Temperature")),
      temperature.element,
    ),
    wrong,
    h(
      "div",
      { class: "acts" },
      h("button", { type: "button", class: "button quiet", onclick: () => finish(null) }, t("Reset")),
      h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Cancel")),
      h("button", { class: "button primary" }, t("Apply")),
    ),
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const layers = wind.read();
    if (new Set(layers.map(({ altitude_agl_m }) => altitude_agl_m)).size < layers.length)
      wrong.textContent = t("Two wind layers have the same height.");
    else finish(conditionsOf({ wind: layers, temperature_c: temperature.read() }));
  });
  dialog.append(form);
  open(dialog);
}
