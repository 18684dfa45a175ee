/** Questions that confirm each command to a UAV, with its effect. */

import { t } from "../text.js";
import { durationText, lengthText, speedText } from "../units.js";
import {
  holdLine,
  landingLines,
  returnLines,
  returnLinesOfAll,
  saferReturn,
  separateReturns,
  togetherLine,
} from "./rtl_check.js";

/** @import { CommandKind, LandingHere, PresentReturn, ReturnCheck, Route } from "../api_types.d.ts" */

/**
 * A field of a question.
 *
 * @typedef {object} QuestionField
 * @property {string} name
 * @property {string} label
 * @property {"text" | "number"} [type]
 * @property {string | number} [value]
 * @property {number} [min]
 * @property {number} [max]
 * @property {number | "any"} [step]
 * @property {boolean} [isNeeded]
 */
/**
 * A required choice without a default.
 *
 * @typedef {object} QuestionChoices
 * @property {string} name
 * @property {string} legend
 * @property {{ value: string, words: string, detail?: string }[]} of
 */
/**
 * A safer alternative with fewer obstructions; it is then the primary button.
 *
 * @typedef {{ words: string, kind: CommandKind, parameters: Record<string, any> }} Safer
 */
/**
 * A question before an act; page/confirm.js asks it.
 *
 * @typedef {object} Question
 * @property {string} title
 * @property {(string | Element | null | false | undefined)[]} lines
 * @property {string} act text of the button
 * @property {string} [keep] text of the cancel button
 * @property {string} [hint] the tooltip of the act
 * @property {QuestionField | null | false} [field]
 * @property {QuestionField | null} [option] a second field, which may stay empty
 * @property {QuestionChoices | null} [choices]
 * @property {{ name: string, words: string, isNeeded?: boolean }[]} [checks] done with the act unless unticked; isNeeded: ticked before it
 * @property {Safer | null} [safer]
 * @property {Promise<Pick<Question, "lines" | "act" | "safer">>} [later] update of the question once more is known
 * @property {Promise<string>} [overtaken] the reason once the question is obsolete; it can then only be closed
 * @property {boolean} [isDanger]
 * @property {boolean} [isBack] whether the act can be undone: then it has the focus, else the cancel button
 * @property {string | null} [image] name of an icon
 * @property {HTMLElement | null} [opener] the button that opens the question
 */

export const LATE = t("The command expires if it is not delivered in time.");
// what a gateway sends: mavlink/commands/actions.py
const ABORT_DOES = t(
  "In the air: it returns and lands where it took off; an autopilot that refuses to return lands where it is. On the ground: its motors are switched off.",
);
const WHY = { name: "why", label: t("Why (kept in the history)") };

/**
 * The UAV of a question, with the facts that the command needs. `returns`: from where it is now; `planned`: from all along its route.
 * `landing`: what lies below it; `hold_s`: how long it can stay where it is.
 *
 * @typedef {{ name: string, route: Pick<Route, "length_m" | "duration_s">, speed_mps: number, returns?: PresentReturn | null,
 *   planned?: ReturnCheck | null, landing?: LandingHere | null, hold_s?: number | null }} AskedFlyer
 */
/** @typedef {Partial<AskedFlyer> & { name: string }} AskedOf */

/** @typedef {Exclude<CommandKind, "upload-mission" | "clear-mission" | "set-return-height" | "pause">} AskedKind */

/** @type {Record<AskedKind, (flyer: AskedFlyer) => Omit<Question, "opener">>} */
const ASKED = {
  start: ({ name, route, planned }) => ({
    title: t("Start {name}?", { name }),
    lines: [
      t("It takes off and flies its approved route: {length}, {time}.", {
        length: lengthText(route.length_m),
        time: durationText(route.duration_s),
      }),
      planned?.fence_warning,
    ],
    act: t("Start {name}", { name }),
    image: "plane-takeoff",
  }),
  arm: ({ name }) => ({
    title: t("Arm {name}?", { name }),
    lines: [t("Its rotors may start at once. Keep people clear of it.")],
    act: t("Arm {name}", { name }),
  }),
  "take-off": ({ name }) => ({
    title: t("Let {name} take off?", { name }),
    lines: [t("It climbs straight up and hovers until the next command.")],
    act: t("Let {name} take off", { name }),
    field: {
      name: "altitude_relative_m",
      label: t("Height above take-off [m]"),
      type: "number",
      value: 10,
      min: 1,
      max: 120,
      step: "any",
      isNeeded: true,
    },
    image: "plane-takeoff",
  }),
  resume: ({ name }) => ({
    title: t("Resume the flight of {name}?", { name }),
    lines: [t("It continues its route from its present position.")],
    act: t("Resume {name}", { name }),
    isBack: true,
  }),
  hold: ({ name, hold_s }) => ({
    title: t("Hold {name}?", { name }),
    lines: [t("It stops where it is and waits for Resume, as long as its battery lasts."), holdLine(hold_s)],
    keep: t("Keep flying"),
    act: t("Hold {name}", { name }),
    isBack: true,
    image: "hand",
  }),
  return: ({ name, returns }) => ({
    title: t("Return {name}?", { name }),
    lines: [t("It returns to its take-off place and lands. Its remaining targets stay open."), ...returnLines(returns)],
    keep: t("Keep flying"),
    act: returns && saferReturn(returns) ? t("Return straight now") : t("Return {name}", { name }),
    safer: returns && saferReturn(returns),
    isBack: true,
    image: "rotate-ccw",
  }),
  land: ({ name, landing }) => ({
    title: t("Land {name} here?", { name }),
    lines: [t("It lands where it is now. Its remaining targets stay open."), ...landingLines(landing)],
    keep: t("Keep flying"),
    act: t("Land {name} here", { name }),
    isDanger: true,
    image: "plane-landing",
  }),
  abort: ({ name, returns }) => ({
    title: t("Abort the flight of {name}?", { name }),
    lines: [
      ABORT_DOES,
      t("Earlier commands are cancelled. Its remaining targets stay open; the other UAVs continue."),
      ...returnLines(returns),
    ],
    keep: t("Keep flying"),
    act: t("Abort {name}", { name }),
    safer: returns && saferReturn(returns),
    isDanger: true,
    field: WHY,
    image: "octagon-alert",
  }),
  "change-speed": ({ name, speed_mps }) => ({
    title: t("Change the speed of {name}?", { name }),
    lines: [t("Over ground, until its route says otherwise. Planned times no longer hold.")],
    act: t("Change the speed of {name}", { name }),
    field: {
      name: "speed_mps",
      label: t("Speed [m/s]; now planned with {speed}", { speed: speedText(speed_mps) }),
      type: "number",
      value: Math.round(speed_mps * 10) / 10,
      min: 0.5,
      max: 100,
      step: "any",
      isNeeded: true,
    },
    isBack: true,
  }),
};

/**
 * The question after a start was refused because others in the air come near its route.
 *
 * @param {string} name of the UAV
 * @param {string} why text of the server
 * @returns {Omit<Question, "opener">}
 */
export const outOfSlotQuestion = (name, why) => ({
  title: t("Start {name} outside its slot?", { name }),
  lines: [why, t("The plan separates UAVs by time. Started now, you have to separate them: hold one, or return one.")],
  keep: t("Wait"),
  act: t("Start {name} all the same", { name }),
  isDanger: true,
});

/**
 * The question before a mission is aborted: the effect on each aircraft, and obstructions of its RTL path.
 *
 * @param {{ name: string, isActive: boolean, uavs: { name: string, check: PresentReturn | null | undefined }[] }} mission
 * @returns {Omit<Question, "opener">}
 */
export const abortQuestion = ({ name, isActive, uavs }) => {
  const separate = separateReturns(uavs.flatMap(({ check }) => check ?? []));
  return {
    title: t("Abort “{name}”?", { name }),
    lines: [
      t(
        "Sent to {names} ahead of all other commands. Remaining targets stay open, and the mission cannot be resumed.",
        { names: uavs.map((uav) => uav.name).join(", ") },
      ),
      ABORT_DOES,
      togetherLine(uavs.map(({ check }) => check)),
      ...returnLinesOfAll(uavs),
      ...(separate ? [...separate.lines, t("The mission then stays open: close it once all UAVs are down.")] : []),
    ],
    field: WHY,
    keep: isActive ? t("Keep flying") : t("Keep it"),
    act: t("Abort the mission"),
    hint: LATE,
    safer: separate && { words: t("Return on separate ways"), kind: "return", parameters: { ways: separate.ways } },
    isDanger: true,
    image: "octagon-alert",
  };
};

/**
 * The question for confirmAct.
 *
 * @param {AskedKind} kind
 * @param {AskedOf} flyer
 */
export const questionOf = (kind, flyer) => ({ ...ASKED[kind](/** @type {AskedFlyer} */ (flyer)), hint: LATE });
