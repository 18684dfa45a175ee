/** The six figures of a UAV's card, each in its place whatever is known. Values in, words out. */

import { MEASURED } from "../domain/certainty.js";
import { distance_m } from "../domain/geodesy.js";
import { inAir } from "../domain/in_air.js";
import { MIN_HOLD_S } from "../domain/rtl_check.js";
import { t } from "../text.js";
import { clockText, durationText, exactClockText, heightText, lengthText, percentText, speedText } from "../units.js";
import { ageWords, isHeld } from "./text/uav_text.js";

/** @import { LiveUav, Route } from "../api_types.d.ts" */
/** @import { Certainty } from "../domain/certainty.js" */

/** `title` is the tooltip: its meaning, or why it is unknown. @typedef {{ figure: string, unit: string, words: string, level: string, title: string }} Figure */
/**
 * Facts beside the UAV itself: take-off place, planned route, and the name of its next target.
 *
 * @typedef {object} Beside
 * @property {number} now_ms
 * @property {readonly number[] | null} home
 * @property {Pick<Route, "length_m" | "battery_percent"> | null} route
 * @property {(target: number) => { pill: string, label: string } | null} targetOf
 */

export const UNKNOWN = "—";
const NO_REPORT = () => t("It has not reported this.");
const NO_MISSION = () => t("It flies no mission.");

/** @param {string} words @param {string} why @returns {Figure} */
const unknown = (words, why) => ({ figure: UNKNOWN, unit: "", words, level: "", title: why });

/** @param {string} text with its unit behind a no-break space @param {string} words @param {Partial<Figure>} [more] @returns {Figure} */
function known(text, words, more = {}) {
  const [figure, unit = ""] = text.split(/\u00a0(?=[^\u00a0]*$)/);
  return { figure, unit, words, level: "", title: "", ...more };
}

/** "12 min to the reserve, 4 min home"; empty where unknown, and on the ground. @param {LiveUav} uav */
export function batteryWords(uav) {
  const battery = uav.estimated?.battery;
  if (!battery || inAir(uav) === false) return "";
  const reserve = durationText(battery.reserve_in_s);
  return battery.home_s === null
    ? t("Battery: {reserve} to the reserve", { reserve })
    : t("Battery: {reserve} to the reserve, {home} home", { reserve, home: durationText(battery.home_s) });
}

/**
 * Battery percent at landing: from its present drain in flight, else from the plan's consumption on the rest of its route; null where
 * neither is known.
 *
 * @param {LiveUav} uav
 * @param {Beside["route"]} route
 */
export function landingPercent({ measured, estimated }, route) {
  const forecast = estimated?.battery?.lands_percent ?? null;
  if (forecast !== null) return forecast;
  const percent = measured?.battery_percent ?? null;
  if (percent === null || !route || route.battery_percent === null || !route.length_m) return null;
  const to_go_m = estimated?.to_go_m ?? null;
  return to_go_m === null ? null : percent - ((100 - route.battery_percent) * to_go_m) / route.length_m;
}

/** Now, and at landing against the reserve. @param {LiveUav} uav @param {Beside} beside @param {string} mark */
function batteryFigure(uav, { route }, mark) {
  const percent = uav.measured?.battery_percent ?? null;
  if (percent === null) return unknown(t("battery"), t("It does not report its battery."));
  const battery = uav.estimated?.battery;
  const level = battery?.level ?? "";
  const lands = landingPercent(uav, route);
  const levels = { critical: t("Battery critical"), warning: t("Battery low"), "": "" };
  const isForecast = typeof battery?.lands_percent === "number";
  const percentAtLanding = lands === null ? "" : percentText(Math.max(0, Math.round(lands)));
  const atLanding =
    lands === null
      ? t("At landing: not known")
      : isForecast
        ? t("At landing about {percent}, by its own drain", { percent: percentAtLanding })
        : t("At landing about {percent}, by the plan", { percent: percentAtLanding });
  const reserveText = typeof battery?.reserve_percent === "number" ? percentText(battery.reserve_percent) : "";
  const reserve = reserveText && t("Reserve {percent}", { percent: reserveText });
  return known(`${mark}${percentText(percent)}`, t("battery"), {
    level,
    title: [levels[level], atLanding, reserve, batteryWords(uav)].filter(Boolean).join(". "),
    words:
      lands === null || inAir(uav) === false
        ? t("battery")
        : reserveText
          ? t("lands {percent}, reserve {reserve}", { percent: percentAtLanding, reserve: reserveText })
          : t("lands {percent}", { percent: percentAtLanding }),
  });
}

/** Above ground where that is measured or the terrain is known, else above take-off. @param {LiveUav} uav @param {Certainty | null} certainty @param {string} mark */
function heightFigure({ measured, estimated }, certainty, mark) {
  const agl_m = certainty === MEASURED ? (measured?.altitude_agl_m ?? null) : null;
  if (agl_m !== null) return known(`${mark}${heightText(agl_m)}`, t("AGL"), { title: t("Height above ground") });
  const reported = certainty === MEASURED ? measured : (estimated ?? measured);
  const relative_m = reported?.altitude_relative_m ?? null;
  const why =
    certainty === MEASURED
      ? t("Height above ground not known: it does not report it, and there is no terrain data here.")
      : t("Height above ground not known: its position is estimated.");
  if (relative_m !== null) return known(`${mark}${heightText(relative_m)}`, t("above take-off"), { title: why });
  const amsl_m = reported?.altitude_amsl_m ?? null;
  return amsl_m === null
    ? unknown(t("AGL"), NO_REPORT())
    : known(`${mark}${heightText(amsl_m)}`, t("AMSL"), { title: why });
}

/** @param {LiveUav} uav @param {Beside} beside @param {Certainty | null} certainty @param {string} mark */
function homeFigure({ measured, estimated }, { home }, certainty, mark) {
  const position = (certainty === MEASURED ? measured?.position : estimated?.position) ?? measured?.position ?? null;
  if (!home) return unknown(t("home"), NO_MISSION());
  if (!position) return unknown(t("home"), t("It has told no position."));
  const away_m = distance_m(position, home);
  return known(`${mark}${lengthText(away_m)}`, t("home"), {
    title: t("Distance to where it took off, in a straight line"),
  });
}

/**
 * While it holds, the remaining time it can; else its next target and when.
 * @param {LiveUav} uav @param {Beside} beside @param {string} mark
 */
function nextFigure(uav, { targetOf }, mark) {
  const { estimated } = uav;
  if (isHeld(uav)) {
    const hold_s = estimated?.battery?.hold_s ?? null;
    if (hold_s === null) return unknown(t("can hold"), t("How long it can hold is not known."));
    const level = hold_s < MIN_HOLD_S ? "critical" : "";
    return known(hold_s < MIN_HOLD_S ? durationText(0) : durationText(hold_s), t("can hold"), {
      level,
      title: level ? t("Battery: too low to hold longer") : t("Until it has to return to land with its reserve"),
    });
  }
  if (!estimated) return unknown(t("next"), NO_MISSION());
  const arrival = estimated.arrivals.find(({ target }) => target !== null);
  const target = arrival?.target ?? null;
  const named = target === null ? null : targetOf(target);
  const at = arrival?.at ?? (target === null ? estimated.ends_at : null);
  if (target === null && !estimated.ends_at)
    return unknown(t("next"), t("Nothing is left on its route, or it left it."));
  const toGo = estimated.to_go_m === null ? "" : t("{distance} to go", { distance: lengthText(estimated.to_go_m) });
  return {
    figure: at ? `${mark}${clockText(at)}` : UNKNOWN,
    unit: "",
    words: named ? t("next {target}", { target: named.pill }) : t("landing"),
    level: "",
    title: [named?.label, at && exactClockText(at), toGo].filter(Boolean).join(", "),
  };
}

/** @param {LiveUav} uav @param {number} now_ms */
function ageFigure(uav, now_ms) {
  const { figure, isLate } = ageWords(uav, now_ms);
  if (figure === null) return unknown(t("age"), t("It has not reported yet."));
  const title = uav.measured ? t("Last report {time}.", { time: exactClockText(uav.measured.measured_at) }) : "";
  return known(figure, t("age"), { level: isLate ? "warning" : "", title });
}

/**
 * Battery, height, speed, distance home, next target, age of the report; "~" before values that are not measured.
 *
 * @param {LiveUav} uav
 * @param {Certainty | null} certainty
 * @param {Beside} beside
 * @returns {Figure[]}
 */
export function figuresOf(uav, certainty, beside) {
  const mark = certainty === MEASURED ? "" : "~\u2009";
  const reported = certainty === MEASURED ? uav.measured : (uav.estimated ?? uav.measured);
  const speed_mps = reported?.speed_mps ?? null;
  return [
    batteryFigure(uav, beside, mark),
    heightFigure(uav, certainty, mark),
    speed_mps === null ? unknown(t("speed"), NO_REPORT()) : known(`${mark}${speedText(speed_mps)}`, t("speed")),
    homeFigure(uav, beside, certainty, mark),
    nextFigure(uav, beside, mark),
    ageFigure(uav, beside.now_ms),
  ];
}
