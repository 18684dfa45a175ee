/** Figures of a manually edited route as text: length, time, battery, and the speed on a leg. Values in, text out. */

import { t } from "../../text.js";
import { durationText, lengthText, percentText, speedText } from "../../units.js";
import { isFlownTo } from "./hand_route.js";

/** @import { HandLook, Route } from "../../api_types.d.ts" */
/** @import { HandPoint } from "../types.d.ts" */

const SAME_MPS = 0.1;
const MIN_M = 1;
const MIN_S = 30;
const MIN_PERCENT = 0.5;

/** @param {number} difference @param {number} least @param {(value: number) => string} textOf */
const signed = (difference, least, textOf) =>
  Math.abs(difference) < least ? "" : ` (${difference < 0 ? "−" : "+"}${textOf(Math.abs(difference))})`;

/**
 * "21.7 km (+412 m) · 32 min (+1 min) · 51 % at landing (−2 %)"; empty where the route cannot be flown. `stored` is the saved route.
 *
 * @param {HandLook | null} look
 * @param {Pick<Route, "length_m" | "duration_s" | "battery_percent"> | null | undefined} stored
 */
export function figuresOfCheck(look, stored) {
  if (!look || look.length_m === null || look.duration_s === null || !stored) return "";
  const reported = [
    `${lengthText(look.length_m)}${signed(look.length_m - stored.length_m, MIN_M, lengthText)}`,
    `${durationText(look.duration_s)}${signed(look.duration_s - stored.duration_s, MIN_S, durationText)}`,
  ];
  if (look.battery_percent !== null) {
    const difference = stored.battery_percent === null ? 0 : look.battery_percent - stored.battery_percent;
    reported.push(
      t("{percent} at landing", {
        percent: `${percentText(look.battery_percent)}${signed(difference, MIN_PERCENT, percentText)}`,
      }),
    );
  }
  return reported.join(" · ");
}

/**
 * Speed over the leg to a point: as edited, or the UAV's own. own_mps is its speed in still air, flown_mps over ground; null: unknown.
 *
 * @param {Pick<HandPoint, "kind" | "speed_mps">} point
 * @param {number | null | undefined} own_mps
 * @param {number | null} flown_mps
 */
export function speedWords(point, own_mps, flown_mps) {
  if (!isFlownTo(point)) return t("No leg leads here.");
  if (point.speed_mps !== null)
    return own_mps ? t("By hand; empty: {speed} as planned.", { speed: speedText(own_mps) }) : t("By hand.");
  const speed_mps = flown_mps ?? own_mps;
  if (!speed_mps) return t("As planned.");
  const values = { speed: speedText(speed_mps), own: speedText(own_mps ?? speed_mps) };
  if (flown_mps !== null && own_mps && flown_mps < own_mps - SAME_MPS)
    return t("{speed} over ground: the wind leaves no more of {own}.", values);
  if (flown_mps !== null && own_mps && flown_mps > own_mps + SAME_MPS)
    return t("{speed} over ground: the wind carries it, {own} are planned.", values);
  return t("{speed} over ground, as planned.", values);
}
