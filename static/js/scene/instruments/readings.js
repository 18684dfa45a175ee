/** The instruments of one UAV in words and figures: [{ name, words, value, note }]. */

import { t } from "../../text.js";
import { exactClockText, exactHeightText, heightText, lengthText, percentText, speedText } from "../../units.js";
import { ESTIMATED, LOST, PLANNED } from "../sources/pieces.js";

const POINTS = [
  t("north"),
  t("north-east"),
  t("east"),
  t("south-east"),
  t("south"),
  t("south-west"),
  t("west"),
  t("north-west"),
];
export const NONE = "–";

/** "214°, south-west". */
export function headingText(degrees) {
  const whole = Math.round(degrees) % 360;
  return `${`${whole}`.padStart(3, "0")}°, ${POINTS[Math.round(whole / 45) % 8]}`;
}

/** task: of task.js; labels: Map of target → { label, name }. */
export function taskText({ kind, target }, labels) {
  const name = labels.get(target)?.label ?? (target === null ? "" : `${target + 1}`);
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

export function certaintyText({ kind, bound, since_ms }) {
  if (kind === ESTIMATED)
    return t("estimated, ±{bound}", { bound: heightText(Math.max(bound?.along_m ?? 0, bound?.across_m ?? 0)) });
  if (kind === LOST) return since_ms ? t("no report since {time}", { time: exactClockText(since_ms) }) : t("no report");
  return kind === PLANNED ? t("planned") : t("measured");
}

const near = (found, words) =>
  found
    ? { value: found.away_m < 100 ? exactHeightText(found.away_m) : lengthText(found.away_m), note: words(found) }
    : { value: NONE, note: "" };

/**
 * drawn: a moment of drawn_flight.js; nearest: { wire, tower, zone } of distances.js, each null where none is near; wind or null.
 * A figure that is estimated has "~".
 */
export function readingsOf(drawn, { nearest, task, wind, labels }) {
  const { moment } = drawn;
  const guess = moment.kind === ESTIMATED ? "~" : "";
  const known = (value, text) =>
    typeof value === "number" && Number.isFinite(value) ? `${guess}${text(value)}` : NONE;
  const zone = near(nearest.zone, ({ zone: { name }, isInside }) =>
    isInside ? t("inside {zone}", { zone: name }) : name,
  );
  const tower = near(nearest.tower, ({ tower: { label } }) => label ?? "");
  const wire = near(nearest.wire, ({ isCounted }) => (isCounted ? t("as high as planners count") : ""));
  return [
    { name: "task", words: t("Task"), value: taskText(task, labels), note: labels.get(task.target)?.name ?? "" },
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
    {
      name: "wire",
      words: t("Nearest wire"),
      value: guess && wire.value !== NONE ? `${guess}${wire.value}` : wire.value,
      note: wire.note,
    },
    {
      name: "tower",
      words: t("Nearest tower"),
      value: guess && tower.value !== NONE ? `${guess}${tower.value}` : tower.value,
      note: tower.note,
    },
    {
      name: "zone",
      words: t("Nearest zone"),
      value: guess && zone.value !== NONE ? `${guess}${zone.value}` : zone.value,
      note: zone.note,
      isBad: nearest.zone?.isInside ?? false,
    },
    {
      name: "wind",
      words: t("Wind"),
      value: wind ? speedText(Math.round(wind.speed_mps * 10) / 10) : NONE,
      note: wind && wind.speed_mps > 0.2 ? t("from {degrees}°", { degrees: Math.round(wind.from_deg) }) : "",
    },
  ];
}

function climbText(climb_mps) {
  if (typeof climb_mps !== "number" || Math.abs(climb_mps) < 0.2) return "";
  const speed = speedText(Math.round(Math.abs(climb_mps) * 10) / 10);
  return climb_mps > 0 ? t("{speed} up", { speed }) : t("{speed} down", { speed });
}
