/** The dialog with both versions of a mission side by side, and the ways out. */

import { h } from "../../dom.js";
import { open } from "../../page/keyboard.js";
import { t, tn } from "../../text.js";
import { clockText, powerText } from "../../units.js";
import { targetDifferences, uavDifferences } from "../actions/merge.js";
import { conditionsText, departureText } from "../options/flight_options.js";
import { lostLinkText } from "../options/lost_link.js";
import { OBJECTIVES } from "../plan/plan_view.js";

/** @import { Conflict, MissionSelection, PickedTarget, PickedUav, Version } from "../types.d.ts" */

/**
 * @template Item
 * @typedef {object} ListOf
 * @property {(count: number) => string} count
 * @property {(item: Item) => string} nameOf
 * @property {(selection: MissionSelection) => Item[]} itemsOf
 * @property {(before: MissionSelection, now: MissionSelection) => { added: Item[], removed: Item[], changed: Item[] }} differences
 */
/**
 * @typedef {object} WaysOut
 * @property {() => unknown} takeTheirs
 * @property {() => unknown} putMineOnTop
 * @property {(() => unknown) | null} [mergeBoth]
 * @property {() => unknown} keepMineAsCopy
 */

const MAX_NAMES = 6;

/** @template Item @param {readonly Item[]} items @param {(item: Item) => string} nameOf */
function listed(items, nameOf) {
  const names = items.slice(0, MAX_NAMES).map(nameOf).join(", ");
  return items.length > MAX_NAMES ? t("{names} and {count} more", { names, count: items.length - MAX_NAMES }) : names;
}

/**
 * The change of a list since `before`: its count, then additions and removals.
 *
 * @template Item
 * @param {MissionSelection} selection
 * @param {MissionSelection | null} before
 * @param {ListOf<Item>} list
 */
function listWords(selection, before, { count, nameOf, itemsOf, differences }) {
  const lines = [count(itemsOf(selection).length)];
  if (before) {
    const { added, removed, changed } = differences(before, selection);
    if (added.length) lines.push(t("added: {names}", { names: listed(added, nameOf) }));
    if (removed.length) lines.push(t("removed: {names}", { names: listed(removed, nameOf) }));
    if (changed.length) lines.push(t("changed: {names}", { names: listed(changed, nameOf) }));
  }
  return lines;
}

/** @type {ListOf<PickedTarget>} */
const TARGETS = {
  count: (count) => tn(count, "{count} target", "{count} targets"),
  nameOf: ({ label }) => label,
  itemsOf: ({ targets }) => targets,
  differences: targetDifferences,
};
/** @type {ListOf<PickedUav>} */
const UAVS = {
  count: (count) => tn(count, "{count} UAV", "{count} UAVs"),
  nameOf: ({ name }) => name,
  itemsOf: ({ uavs }) => uavs,
  differences: uavDifferences,
};
/** @param {string} value */
const objectiveWords = (value) => OBJECTIVES.find((objective) => objective.value === value)?.words ?? value;
/** @param {boolean} returns */
const returnWords = (returns) => (returns ? t("yes") : t("no"));

/** "Kite: Tower 4, Tower 2", a line for each lock. @param {MissionSelection} selection */
function lockWords({ targets, locks = [] }) {
  const labels = new Map(targets.map(({ key, label }) => [key, label]));
  return locks.length
    ? locks.map(({ uav, targets: keys }) => `${uav}: ${listed(keys, (key) => labels.get(key) ?? t("Target"))}`)
    : [t("nothing")];
}

/**
 * The compared parts: the name of each, and its lines in a version.
 *
 * @param {MissionSelection | null} before both versions
 * @returns {[string, (version: Version) => string[]][]}
 */
function rowsOf(before) {
  return [
    [t("Name"), ({ name }) => [name]],
    [t("Targets"), ({ selection }) => listWords(selection, before, TARGETS)],
    [t("UAVs"), ({ selection }) => listWords(selection, before, UAVS)],
    [t("Optimised for"), ({ selection }) => [objectiveWords(selection.objective)]],
    [t("Departure"), ({ selection }) => [selection.departs_at ? departureText(selection.departs_at) : t("any time")]],
    [t("Conditions"), ({ selection }) => [conditionsText(selection.conditions)]],
    [t("Charging on towers"), ({ selection }) => [selection.charging_w ? powerText(selection.charging_w) : t("no")]],
    [t("On link loss"), ({ selection }) => [lostLinkText(selection.lost_link)]],
    [t("Return to start"), ({ selection }) => [returnWords(selection.return_to_start)]],
    [t("Locked"), ({ selection }) => lockWords(selection)],
  ];
}

/** @param {Conflict} conflict see conflicts.js @param {Version} mine @param {WaysOut} ways */
export function showBoth(conflict, mine, ways) {
  const rows = rowsOf(conflict.before?.selection ?? null);
  /** @param {string} label @param {() => unknown} does @param {string} [kind] */
  const act = (label, does, kind = "") => {
    const button = h("button", { type: "button", class: `button ${kind}` }, label);
    button.addEventListener("click", () => {
      dialog.close();
      void does();
    });
    return button;
  };
  const dialog = h(
    "dialog",
    { class: "both", "aria-labelledby": "both-title" },
    h("h2", { id: "both-title" }, t("Both versions of this mission")),
    h(
      "table",
      {},
      h(
        "thead",
        {},
        h(
          "tr",
          {},
          h("td", {}),
          h("th", { scope: "col" }, t("Mine, not saved")),
          h(
            "th",
            { scope: "col" },
            t("Saved at {time}", { time: clockText(conflict.at) }),
            conflict.actor && h("span", { class: "caption" }, ` ${conflict.actor}`),
          ),
        ),
      ),
      h(
        "tbody",
        {},
        rows.map(([what, words]) => {
          const [own, their] = [words(mine), words(conflict.theirs)];
          const isSame = own.join() === their.join();
          return h(
            "tr",
            { class: isSame ? "same" : null },
            h("th", { scope: "row" }, what),
            [own, their].map((lines) =>
              h(
                "td",
                {},
                lines.map((line) => h("span", {}, line)),
              ),
            ),
          );
        }),
      ),
    ),
    h(
      "p",
      { class: "caption" },
      ways.mergeBoth
        ? t("Put together: what each added and removed, and mine where both changed the same.")
        : t("Mine is from an earlier visit: only one of the two can be kept under this name."),
    ),
    h(
      "div",
      { class: "acts" },
      act(t("Use theirs"), ways.takeTheirs),
      act(t("Put mine on top"), ways.putMineOnTop),
      act(t("Keep mine as a copy"), ways.keepMineAsCopy),
      ways.mergeBoth && act(t("Put together"), ways.mergeBoth, "primary"),
    ),
  );
  open(dialog);
}
