/** The fields of a manually edited waypoint: height, speed on the leg to it, place. */

import { h } from "../../../dom.js";
import { t } from "../../../text.js";
import { SHORT_UNIT, SPEED_UNIT } from "../../../units.js";
import { speedWords } from "../../hand/hand_figures.js";
import { isFlownTo, isFree } from "../../hand/hand_route.js";

/** @import { HandEdit, HandPoint, MissionActions } from "../../types.d.ts" */

/** @param {number} metres */
const typed = (metres) => Number((metres / SHORT_UNIT.metres).toFixed(1));
/** @param {number} mps */
const typedSpeed = (mps) => Number((mps / SPEED_UNIT.mps).toFixed(1));

/** @param {string} id @param {{ min: number, max?: number }} bounds */
const numberInput = (id, bounds) => h("input", { class: "input", type: "number", step: "any", id, ...bounds });

/** @param {string} label @param {HTMLInputElement} input @param {string} unit */
const field = (label, input, unit) =>
  h(
    "div",
    { class: "field" },
    h("label", { for: input.id }, label),
    h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)),
  );

/**
 * Speed over the leg to a point as checked by the server; null while unknown.
 *
 * @param {HandEdit} hand
 * @param {number} index
 */
const flownSpeed = ({ look, points }, index) =>
  look?.waypoints.length === points.length ? (look.waypoints[index]?.speed_mps ?? null) : null;

/** @param {MissionActions} actions @param {() => number} chosen index of the waypoint */
export function createHandFields(actions, chosen) {
  const height = numberInput("hand-height", { min: 0 });
  const speed = numberInput("hand-speed", { min: 0 });
  const latitude = numberInput("hand-latitude", { min: -90, max: 90 });
  const longitude = numberInput("hand-longitude", { min: -180, max: 180 });
  const speedNote = h("p", { class: "caption", id: "hand-speed-said" });
  speed.setAttribute("aria-describedby", speedNote.id);

  height.addEventListener("change", () => {
    if (height.value && height.validity.valid)
      actions.raiseManually(chosen(), height.valueAsNumber * SHORT_UNIT.metres);
  });
  speed.addEventListener("change", () => {
    if (!speed.validity.valid) return;
    actions.setSpeedManually(
      chosen(),
      speed.value && speed.valueAsNumber > 0 ? speed.valueAsNumber * SPEED_UNIT.mps : null,
    );
  });
  for (const input of [latitude, longitude])
    input.addEventListener("change", () => {
      if ([latitude, longitude].every(({ value, validity }) => value && validity.valid))
        actions.moveManually(chosen(), [longitude.valueAsNumber, latitude.valueAsNumber]);
    });

  /** @type {number | null} */
  let shownPoint = null;
  /**
   * Write a value; a field with the focus is kept as long as its point is shown.
   *
   * @param {HTMLInputElement} input
   * @param {number | ""} value
   * @param {number} index
   */
  function write(input, value, index) {
    if (input !== document.activeElement || index !== shownPoint) input.value = `${value}`;
  }

  return {
    element: h(
      "div",
      { class: "hand-fields" },
      field(t("Height above ground"), height, SHORT_UNIT.unit),
      field(t("Speed on the way here"), speed, SPEED_UNIT.unit),
      speedNote,
      field(t("Latitude"), latitude, "°"),
      field(t("Longitude"), longitude, "°"),
    ),
    /**
     * @param {HandEdit} hand
     * @param {HandPoint} point
     * @param {number} index
     * @param {number | null} own_mps the UAV's own speed
     */
    refresh(hand, point, index, own_mps) {
      write(height, typed(point.altitude_agl_m), index);
      write(longitude, Number(point.position[0].toFixed(6)), index);
      write(latitude, Number(point.position[1].toFixed(6)), index);
      write(speed, point.speed_mps === null ? "" : typedSpeed(point.speed_mps), index);
      shownPoint = index;
      const flown_mps = flownSpeed(hand, index);
      const usual_mps = point.speed_mps === null ? (flown_mps ?? own_mps) : own_mps;
      speed.placeholder = usual_mps && isFlownTo(point) ? `${typedSpeed(usual_mps)}` : "";
      speed.disabled = !isFlownTo(point);
      speedNote.textContent = speedWords(point, own_mps, flown_mps);
      latitude.disabled = !isFree(point);
      longitude.disabled = !isFree(point);
    },
  };
}
