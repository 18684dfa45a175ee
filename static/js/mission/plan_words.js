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

/** @param {string} kilometres */
const km = (kilometres) => `${figure(kilometres)}\u00a0km`;

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
    new RegExp(`^It takes ([\\d,.]+) Wh ${THERE}, ([\\d,.]+) Wh more than the battery of (.+) may give\\.$`),
    (needed, there, missing, name) =>
      t("It takes {needed} Wh {there}, {missing} Wh more than the battery of {name} may give.", {
        needed: figure(needed),
        there: WAYS[there],
        missing: figure(missing),
        name,
      }),
  ],
  [
    new RegExp(`^It is ([\\d,.]+) (k?m) ${THERE}, ([\\d,.]+) (k?m) more than the range of (.+)\\.$`),
    (needed, unit, there, missing, other, name) =>
      t("It is {needed} {there}, {missing} more than the range of {name}.", {
        needed: `${figure(needed)}\u00a0${unit}`,
        there: WAYS[there],
        missing: `${figure(missing)}\u00a0${other}`,
        name,
      }),
  ],
  [
    /^The battery of (.+) does not last for it\.$/,
    (name) => t("The battery of {name} does not last for it.", { name: name.replaceAll(" or ", ` ${t("or|list")} `) }),
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
    /^(.+) is reported to be in the air: the plan begins with a take-off from the ground at the place where it was last seen\.$/,
    (name) =>
      t(
        "{name} is reported to be in the air: the plan begins with a take-off from the ground at the place where it was last seen.",
        { name },
      ),
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
  [/^There is no permitted route for (.+)\.$/, (names) => t("There is no permitted route for {names}.", { names })],
  [
    /^No UAV can get there: no way on the network keeps clear of every zone\.$/,
    () => t("No permitted route from any base."),
  ],
  [
    /^There is no way from it to a base that lies outside every no-fly zone\.$/,
    () => t("There is no way from it to a base that lies outside every no-fly zone."),
  ],
  [
    /^Every straight way to it from the network within ([\d.]+) km meets a no-fly zone\.$/,
    (reach) => t("Every straight way to it from the network within {reach} meets a no-fly zone.", { reach: km(reach) }),
  ],
  [
    /^It is more than ([\d.]+) km from the network\.$/,
    (reach) => t("It is more than {reach} from the network.", { reach: km(reach) }),
  ],
  [
    /^No UAV has a clear way of up to ([\d.]+) km to the network from where it stands\.$/,
    (reach) => t("No UAV has a clear way of up to {reach} to the network from where it stands.", { reach: km(reach) }),
  ],
  [
    /^To land there is to fly through (.+)\.$/,
    (zone) => t("To land there is to fly through {zone}.", { zone: zoneOf(zone) }),
  ],
  [
    /^It is (\d+) m high: a UAV would have to fly at (\d+) m, above the limit of (\d+) m\.$/,
    (height, needed, limit) =>
      t("It is {height} high. A UAV would have to fly at {needed}; the limit is {limit}.", {
        height: `${height}\u00a0m`,
        needed: `${needed}\u00a0m`,
        limit: `${limit}\u00a0m`,
      }),
  ],
  [
    /^It is locked to others of which one cannot be reached: the run is left out as a whole\.$/,
    () => t("It is locked to others of which one cannot be reached: the run is left out as a whole."),
  ],
  [
    /^It is tied to (.+), which has as many targets as it may have\.$/,
    (name) => t("It is tied to {name}, which has as many targets as it may have.", { name }),
  ],
  [
    /^It is tied to (.+), which does not have the sensor (.+)\.$/,
    (name, sensor) => t("It is tied to {name}, which does not have the sensor {sensor}.", { name, sensor }),
  ],
  [
    /^It is tied to (.+), which cannot take off\.$/,
    (name) => t("It is tied to {name}, which cannot take off.", { name }),
  ],
  [
    /^It is tied to (.+), which cannot fly to it\.$/,
    (name) => t("It is tied to {name}, which cannot fly to it.", { name }),
  ],
  [
    /^It is locked to (.+), which cannot take off\.$/,
    (name) => t("It is locked to {name}, which cannot take off.", { name }),
  ],
  [
    /^No UAV of the plan has the sensor (.+)\.$/,
    (sensor) => t("No UAV of the plan has the sensor {sensor}.", { sensor }),
  ],
  [
    /^No UAV that can take off has the sensor (.+)\.$/,
    (sensor) => t("No UAV that can take off has the sensor {sensor}.", { sensor }),
  ],
  [/^There is no UAV that can take off\.$/, () => t("There is no UAV that can take off.")],
  [/^It is tied to (.+)\.$/, (name) => t("It is tied to {name}.", { name })],
  [/^It is locked to (.+)\.$/, (name) => t("It is locked to {name}.", { name })],
];

/** What keeps the other UAVs of a mission from a target. @type {Record<string, string>} */
const LIMITS = {
  "cannot take off": t("cannot take off"),
  "without the sensor": t("without the sensor"),
  "no permitted route": t("no permitted route"),
  "wind too strong": t("wind too strong"),
  "range too short": t("range too short"),
  "battery too small": t("battery too small"),
  "mast or wires in the way": t("mast or wires in the way"),
};
const OTHERS = /^(.+[.]) Other UAVs: (.+)\.$/;
const NEXT_LIMIT = new RegExp(`; (?=(?:${Object.keys(LIMITS).join("|")}) \\()`);

/** "no permitted route (Tern); battery too small (Kite)" in the reader's language. @param {string} said */
function limitsOfOthers(said) {
  const limits = said.split(NEXT_LIMIT).map((one) => {
    const [, limit, names] = /^(.+?) \((.+)\)$/.exec(one) ?? [];
    return LIMITS[limit] ? `${LIMITS[limit]} (${names})` : one;
  });
  return t("Other UAVs: {limits}.", { limits: limits.join("; ") });
}

/** Why a UAV stays on the ground stands behind who it is. */
const GROUNDED =
  /^((?:It is (?:tied|locked) to .+?|No UAV that can take off has the sensor .+?|There is no UAV that can take off)\.) (.+ (?:cannot take off|flies no more|does not fly)\.)$/;
const ONE_GROUNDED = /(?<=(?:cannot take off|flies no more|does not fly)\.) /;

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
  const others = OTHERS.exec(message);
  if (others) {
    const words = inWords(others[1], "");
    return words ? `${words} ${limitsOfOthers(others[2])}` : fallback;
  }
  const grounded = GROUNDED.exec(message);
  if (grounded) {
    const why = grounded[2].split(ONE_GROUNDED).map((one) => inWords(one));
    return [inWords(grounded[1]), ...why].join(" ");
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
