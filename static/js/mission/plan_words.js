/**
 * Sentences of a plan in the reader's language. A plan is stored in English: what was put into a sentence is put into
 * the translated one.
 */

import { language, t } from "../text.js";
import { numberText } from "../units.js";

/** @import { Plan } from "../api_types.d.ts" */

const WALL = /^the \S+ m around a mast or wires that cannot be flown over$/;

/** A zone's name in the reader's language, where it is no name but a description. @param {string} words */
export function zoneOf(words) {
  if (WALL.test(words)) return t("the surroundings of a mast or wires that cannot be flown over");
  return /^the \S+ m around a no-fly zone$/.test(words) ? t("the margin round a no-fly zone") : words;
}
/** "1,234.5" of an English sentence as the reader writes it. @param {string} text */
function figure(text) {
  const decimals = text.split(".")[1]?.length ?? 0;
  return numberText(Number(text.replaceAll(",", "")), decimals);
}

const THERE = "(there and on to the nearest base|there and back|there)";
/** @type {Record<string, string>} */
const WAYS = {
  there: t("there|way"),
  "there and back": t("there and back|way"),
  "there and on to the nearest base": t("there and on to the nearest base|way"),
};

/** @type {[RegExp, (...parts: string[]) => string][]} */
const SENTENCES = [
  [/^It stands inside (.+)\.$/, (zone) => t("It stands inside {zones}.", { zones: zoneOf(zone) })],
  [/^It runs through (.+)\.$/, (zone) => t("It runs through {zones}.", { zones: zoneOf(zone) })],
  [
    /^(.+) stands inside (.+) and cannot take off\.$/,
    (name, zone) => t("{name} stands inside {zone} and cannot take off.", { name, zone: zoneOf(zone) }),
  ],
  [/^(.+) is retired and flies no more\.$/, (name) => t("{name} is retired and flies no more.", { name })],
  [/^(.+) is in maintenance and does not fly\.$/, (name) => t("{name} is in maintenance and does not fly.", { name })],
  [
    /^(.+) has as many targets as it may have \((\d+)\), and no other UAV has the range for it\.$/,
    (name, count) =>
      t("{name} has as many targets as it may have ({count}), and no other UAV has the range for it.", { name, count }),
  ],
  [
    /^(.+) has as many targets as it may have \((\d+)\)\.$/,
    (name, count) => t("{name} has as many targets as it may have ({count}).", { name, count }),
  ],
  [
    /^(.+) and (.+) have as many targets as they may have, and no other UAV has the range for it\.$/,
    (names, last) =>
      t("{names} and {last} have as many targets as they may have, and no other UAV has the range for it.", {
        names,
        last,
      }),
  ],
  [
    /^(.+) and (.+) have as many targets as they may have\.$/,
    (names, last) => t("{names} and {last} have as many targets as they may have.", { names, last }),
  ],
  [
    new RegExp(
      `^It takes ([\\d,.]+) Wh ${THERE}, ([\\d,.]+) Wh more than the battery of the UAV that comes nearest to it may give\\.$`,
    ),
    (needed, there, missing) =>
      t(
        "It takes {needed} Wh {there}, {missing} Wh more than the battery of the UAV that comes nearest to it may give.",
        { needed: figure(needed), there: WAYS[there], missing: figure(missing) },
      ),
  ],
  [
    new RegExp(
      `^Over the ground and what stands tall it takes ([\\d,.]+) Wh ${THERE}, ([\\d,.]+) Wh more than the battery of (.+) may give\\.$`,
    ),
    (needed, there, missing, name) =>
      t(
        "Over the ground and what stands tall it takes {needed} Wh {there}, {missing} Wh more than the battery of {name} may give.",
        { needed: figure(needed), there: WAYS[there], missing: figure(missing), name },
      ),
  ],
  [
    new RegExp(
      `^It is ([\\d,.]+) (k?m) ${THERE}, ([\\d,.]+) (k?m) more than the range of the UAV that comes nearest to it\\.$`,
    ),
    (needed, unit, there, missing, other) =>
      t("It is {needed} {there}, {missing} more than the range of the UAV that comes nearest to it.", {
        needed: `${figure(needed)}\u00a0${unit}`,
        there: WAYS[there],
        missing: `${figure(missing)}\u00a0${other}`,
      }),
  ],
  [
    /^However (.+) charges on the way, it alone takes up to ([\d,.]+) Wh more than the battery of .+ may give\.$/,
    (name, missing) =>
      t("However {name} charges on the way, it alone takes up to {missing} Wh more than its battery may give.", {
        name,
        missing: figure(missing),
      }),
  ],
  [
    /^However (.+) charges on the way, the battery does not last for it\.$/,
    (name) =>
      t("However {name} charges on the way, the battery does not last for it.", {
        name: name.replaceAll(" or ", ` ${t("or|list")} `),
      }),
  ],
  [
    /^As drawn, over the ground and what stands tall, all routes that were tried with it take more than the battery may give\.$/,
    () =>
      t(
        "Over the ground and what stands tall, all routes that were tried with it take more than the battery may give.",
      ),
  ],
  [
    /^It is within (?:what the battery may give|range and battery) alone, but not within what is left after the other targets\.$/,
    () => t("The battery lasts for it alone, but not after the other targets."),
  ],
  [
    /^It is within range alone, but not within the range that is left after the other targets\.$/,
    () => t("It is within range alone, but not after the other targets."),
  ],
  [
    /^Each UAV that can do it has as many targets as it may have\.$/,
    () => t("Each UAV that can do it has as many targets as it may have."),
  ],
  [
    /^(.+) states no top airspeed: it is taken to fly no faster than its speed, through the air\.$/,
    (name) =>
      t("{name} states no top airspeed: it is taken to fly no faster than its speed, through the air.", { name }),
  ],
  [
    /^The wind is too strong on every way to it, or back\.$/,
    () => t("The wind is too strong on every way to it, or back."),
  ],
  [
    /^The routes take shorter ways than preferred, farther from the lines: along the lines, not all targets are in reach\.$/,
    () =>
      t(
        "The routes take shorter ways than preferred, farther from the lines: along the lines, not all targets are in reach.",
      ),
  ],
  [
    /^As drawn, over the ground and what stands tall, a route with it takes ([\d,.]+) Wh more than the battery of (.+) may give\.$/,
    (missing, name) =>
      t(
        "As drawn, over the ground and what stands tall, a route with it takes {missing} Wh more than the battery of {name} may give.",
        { missing: figure(missing), name },
      ),
  ],
  [
    /^Drawn over the ground and what stands tall, routes take more than is counted on the network; with that kept back no battery lasts for it\.$/,
    () =>
      t(
        "Drawn over the ground and what stands tall, routes take more than is counted on the network; with that kept back no battery lasts for it.",
      ),
  ],
  [
    /^From its other targets (.+) would have to pass a mast or wires that cannot be flown over\.$/,
    (name) =>
      t("From its other targets {name} would have to pass a mast or wires that cannot be flown over.", { name }),
  ],
  [
    /^(.+) would have to pass a mast or wires that cannot be flown over\.$/,
    (name) => t("{name} would have to pass a mast or wires that cannot be flown over.", { name }),
  ],
  [
    /^A UAV can get there, but not on one route with its other targets\. Add a UAV\.$/,
    () => t("A UAV can get there, but not on one route with its other targets. Add a UAV."),
  ],
  [
    /^Legs of (.+) that were changed by hand and are as planned again: (\d+) of (\d+)\. Their ends differ, or something bars them now\.$/,
    (name, missed, count) =>
      t(
        "Legs of {name} that were changed by hand and are as planned again: {missed} of {count}. Their ends differ, or something bars them now.",
        { name, missed, count },
      ),
  ],
  [
    /^The asset has been deleted since it was picked\.$/,
    () => t("It has been deleted from the data since it was picked."),
  ],
];

/** Whether a plan leaves the preferred ways for the shortest ones. @param {Pick<Plan, "warnings">} plan */
export const takesShortestWays = ({ warnings }) => (warnings ?? []).some(({ code }) => code === "shortest_ways");
/** What a plan warns of where a UAV stays on the ground. @type {string[]} */
export const GROUNDING = ["uav_inside_zone", "uav_out_of_service"];

const LOCKED = " It is locked to others: the run is left out as a whole.";
const MINUTES = /^(.+): ([\d,.]+) min of flight\.$/;

/**
 * `fallback` where a language has no sentence for it; English as it is stored.
 *
 * @param {string} message
 * @param {string} [fallback]
 * @returns {string}
 */
export function inWords(message, fallback = message) {
  if (language === "en" || !message) return message || fallback;
  if (message.endsWith(LOCKED)) {
    const words = inWords(message.slice(0, -LOCKED.length), "");
    return words ? `${words} ${t("It is locked to others: the run is left out as a whole.")}` : fallback;
  }
  const missing = MINUTES.exec(message);
  if (missing) {
    const words = inWords(`${missing[1]}.`, "");
    return words
      ? `${words.replace(/\.$/, "")}: ${t("{minutes} min of flight.", { minutes: figure(missing[2]) })}`
      : fallback;
  }
  for (const [pattern, say] of SENTENCES) {
    const found = pattern.exec(message);
    if (found) return say(...found.slice(1));
  }
  return fallback;
}
