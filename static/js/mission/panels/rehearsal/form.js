/** The form that chooses in which conditions a mission is rehearsed. */

import { byId, find, h } from "../../../dom.js";
import { t } from "../../../text.js";
import { SPEED_UNIT } from "../../../units.js";
import { CONDITIONS, conditionWords, ownConditions } from "../../rehearsal/rehearsal.js";

const [MAX_WIND_MPS, MAX_GUSTS_MPS] = [60, 10]; // simulation/rehearsing/weather_scenario.py
/** @param {number} mps */
const typedSpeed = (mps) => Math.floor(mps / SPEED_UNIT.mps);
const FIGURES = [
  { name: "wind_mps", label: t("Wind speed"), unit: SPEED_UNIT.unit, min: 0, max: typedSpeed(MAX_WIND_MPS) },
  { name: "from_deg", label: t("Wind from"), unit: "°", min: 0, max: 360 },
  { name: "gusts_mps", label: t("Gusts"), unit: SPEED_UNIT.unit, min: 0, max: typedSpeed(MAX_GUSTS_MPS) },
  { name: "battery_percent", label: t("Battery holds"), unit: "%", min: 10, max: 100 },
];

/**
 * Fills the form. `onStart` and `onChange` are called as it is sent and changed.
 *
 * @param {{ onStart: () => void, onChange: () => void }} acts
 */
export function mountForm({ onStart, onChange }) {
  const form = byId("rehearsal-form", HTMLFormElement);
  const own = h("input", { type: "checkbox", name: "own" });
  const figures = FIGURES.map(({ name, label, unit, min, max }) => {
    const input = h("input", { class: "input", type: "number", name, step: "any", min, max });
    input.addEventListener("input", () => {
      own.checked = true;
    });
    const element = h(
      "label",
      { class: "field" },
      h("span", { class: "field-label" }, label),
      h("span", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)),
    );
    return { input, element };
  });
  const [wind, from, gusts, battery] = figures.map(({ input }) => input);
  const checks = CONDITIONS.map((code) => {
    const box = h("input", { type: "checkbox", name: "condition", value: code, checked: code === "as-planned" });
    return { box, element: h("label", { class: "rehearsal-check" }, box, h("span", {}, conditionWords(code))) };
  });
  form.append(
    h(
      "fieldset",
      { class: "rehearsal-conditions" },
      h("legend", { class: "unseen" }, t("Conditions")),
      checks.map(({ element }) => element),
      h("label", { class: "rehearsal-check" }, own, h("span", {}, t("Custom conditions"))),
    ),
    h(
      "details",
      { class: "rehearsal-own" },
      h("summary", {}, t("Custom conditions")),
      h(
        "div",
        { class: "rehearsal-figures" },
        figures.map(({ element }) => element),
      ),
      h("p", { class: "caption" }, t("What is empty is as planned.")),
    ),
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    onStart();
  });
  form.addEventListener("input", onChange);
  return {
    isValid: () => form.reportValidity(),
    focus: () => find(form, "input", HTMLInputElement).focus({ preventScroll: true }),
    /** The conditions as a request names them. */
    read() {
      const conditions = checks.filter(({ box }) => box.checked).map(({ box }) => box.value);
      if (!own.checked) return conditions;
      return [
        ...conditions,
        ownConditions({
          wind_mps: wind.valueAsNumber * SPEED_UNIT.mps,
          from_deg: from.valueAsNumber,
          gusts_mps: gusts.valueAsNumber * SPEED_UNIT.mps,
          battery_percent: battery.valueAsNumber,
        }),
      ];
    },
  };
}
