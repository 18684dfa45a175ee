/** The instruments of one UAV as text and figures: [{ name, words, value, note }]. */

import { t } from "../../text.js";
import {
  compassText,
  exactClockText,
  exactHeightText,
  heightText,
  lengthText,
  percentText,
  speedText,
} from "../../units.js";
import { ESTIMATED, LOST, PLANNED } from "../sources/pieces.js";

/** @import { DrawnUav, Moment, Wind } from "../types.d.ts" */
/** @import { NearTower, NearWire, NearZone } from "./distances.js" */
/** @import { Task } from "./task.js" */

/** @typedef {{ name: string, words: string, value: string, note: string, isBad?: boolean }} Reading */
/** @typedef {ReadonlyMap<number, { label: string, name: string }>} TargetNames by the target's place */

export const NONE = "–";

/** "214°, south-west". @param {number} degrees */
export function headingText(degrees) {
  const whole = Math.round(degrees) % 360;
  return `${`${whole}`.padStart(3, "0")}°, ${compassText(whole)}`;
}

/** @param {Task} task @param {TargetNames} labels */
export function taskText({ kind, target }, labels) {
  const name = target === null ? "" : (labels.get(target)?.label ?? `${target + 1}`);
  switch (kind) {
    case "at":
      return t("at {target}", { target: name });
    case "to":
      return t("to {target}", { target: name });
    case "take-off":
      return t("takes off, then {target}", { target: name });
    case "home":
      return t("on its way to land");
    case "landing":
      return t("lands");
    case "ground":
      return t("on the ground");
    default:
      return t("not known");
  }
}

/** @param {Pick<Moment, "kind" | "bound" | "since_ms">} moment @param {boolean} isSimulated its UAV: nothing measures where it is */
export function certaintyText({ kind, bound, since_ms }, isSimulated) {
  if (kind === ESTIMATED)
    return t("estimated, ±{bound}", { bound: heightText(Math.max(bound?.along_m ?? 0, bound?.across_m ?? 0)) });
  if (kind === LOST) return since_ms ? t("no report since {time}", { time: exactClockText(since_ms) }) : t("no report");
  if (kind === PLANNED) return t("planned");
  return isSimulated ? t("simulated") : t("measured");
}

/**
 * @template {{ away_m: number }} Near
 * @param {Near | null} found
 * @param {string} guess
 * @param {(found: Near) => string} words
 */
const near = (found, guess, words) =>
  found
    ? {
        value: `${guess}${found.away_m < 100 ? exactHeightText(found.away_m) : lengthText(found.away_m)}`,
        note: words(found),
      }
    : { value: NONE, note: "" };

/**
 * A figure that is estimated has "~".
 *
 * @param {Pick<DrawnUav, "moment" | "height_agl_m">} drawn
 * @param {object} known
 * @param {{ wire: NearWire | null, tower: NearTower | null, zone: NearZone | null }} known.nearest each null where none is near
 * @param {Task} known.task
 * @param {Wind | null} known.wind
 * @param {TargetNames} known.labels
 * @returns {Reading[]}
 */
export function readingsOf(drawn, { nearest, task, wind, labels }) {
  const { moment } = drawn;
  const guess = moment.kind === ESTIMATED ? "~" : "";
  /** @param {number | null | undefined} value @param {(value: number) => string} text */
  const known = (value, text) =>
    typeof value === "number" && Number.isFinite(value) ? `${guess}${text(value)}` : NONE;
  const zone = near(nearest.zone, guess, ({ zone: { name }, isInside }) =>
    isInside ? t("inside {zone}", { zone: name }) : name,
  );
  const tower = near(nearest.tower, guess, ({ tower: { label } }) => label ?? "");
  const wire = near(nearest.wire, guess, ({ isCounted }) => (isCounted ? t("as high as planners count") : ""));
  return [
    { name: "task", words: t("Task"), value: taskText(task, labels), note: labels.get(task.target ?? NaN)?.name ?? "" },
    { name: "agl", words: t("Above ground"), value: known(drawn.height_agl_m, exactHeightText), note: "" },
    {
      name: "relative",
      words: t("Above take-off"),
      value: known(moment.altitude_relative_m, exactHeightText),
      note: "",
    },
    {
      name: "speed",
      words: t("Speed"),
      value: known(moment.speed_mps, (speed) => speedText(Math.round(speed * 10) / 10)),
      note: climbText(moment.climb_mps),
    },
    { name: "heading", words: t("Heading"), value: known(moment.heading_deg, headingText), note: "" },
    { name: "battery", words: t("Battery"), value: known(moment.battery_percent, percentText), note: "" },
    { name: "wire", words: t("Nearest wire"), ...wire },
    { name: "tower", words: t("Nearest tower"), ...tower },
    { name: "zone", words: t("Nearest zone"), ...zone, isBad: nearest.zone?.isInside ?? false },
    {
      name: "wind",
      words: t("Wind"),
      value: wind ? speedText(Math.round(wind.speed_mps * 10) / 10) : NONE,
      note: wind && wind.speed_mps > 0.2 ? t("from {degrees}°", { degrees: Math.round(wind.from_deg) }) : "",
    },
  ];
}

/** @param {number | null | undefined} climb_mps */
function climbText(climb_mps) {
  if (typeof climb_mps !== "number" || Math.abs(climb_mps) < 0.2) return "";
  const speed = speedText(Math.round(Math.abs(climb_mps) * 10) / 10);
  return climb_mps > 0 ? t("{speed} up", { speed }) : t("{speed} down", { speed });
}
