/** Texts on what the server refuses of a selection, without paths of fields, and the changes that would help. */

import { t } from "../../text.js";
import { withoutLocks, withWishes } from "../selection.js";
import { withUavAs } from "../uavs/mission_uavs.js";

/** @import { ApiError } from "../../api.js" */
/** @import { Lock, MissionSelection, PickedTarget, PickedUav } from "../types.d.ts" */

/** @typedef {{ label: string, href?: () => string, changed?: (now: MissionSelection) => MissionSelection }} Way */
/** @typedef {{ part: string, field: string, uav: PickedUav | null, target: PickedTarget | null }} Fault */

/**
 * The first fault of an answer's details: { place: ["uavs", "0", "end_action"], words }; null where there is none.
 *
 * @param {unknown} details
 * @param {string[]} [place]
 * @returns {{ place: string[], words: string } | null}
 */
function firstFault(details, place = []) {
  if (typeof details === "string") return { place, words: details };
  if (!details || typeof details !== "object") return null;
  const entries =
    Array.isArray(details) && details.every((entry) => typeof entry === "string")
      ? details.map((entry) => [[], entry])
      : Object.entries(details).map(([key, value]) => [key.split("."), value]);
  for (const [names, value] of entries) {
    const found = firstFault(value, [...place, ...names]);
    if (found) return found;
  }
  return null;
}

/**
 * asked: the refused selection. Returns { words, ways }, null where the answer names no fault.
 *
 * A way is { label, href } or { label, changed }: `changed` makes the corrected selection from the present one.
 *
 * @param {Pick<ApiError, "details">} error
 * @param {MissionSelection} asked
 * @returns {{ words: string, ways: Way[] } | null}
 */
export function refusalOf({ details }, asked) {
  const fault = firstFault(details);
  if (!fault) return null;
  const [part, number, field] = fault.place;
  const uav = part === "uavs" ? asked.uavs[Number(number)] : null;
  const target = part === "targets" ? asked.targets[Number(number)] : null;
  const name = uav?.name ?? target?.label;
  const words = name && !fault.words.includes(name) ? `${name}: ${fault.words}` : fault.words;
  return { words, ways: waysOf({ part, field, uav, target }, asked) };
}

/** @param {Fault} fault @param {MissionSelection} asked @returns {Way[]} */
function waysOf({ part, field, uav, target }, asked) {
  if (uav && field === "most_targets") {
    /** @param {Lock} lock */
    const isOfUav = (lock) => lock.uav === uav.name;
    const locked = asked.locks.filter(isOfUav).flatMap(({ targets }) => targets).length;
    return [
      {
        label: t("Raise its limit to {count}", { count: locked }),
        changed: (now) =>
          withUavAs(
            now,
            now.uavs.findIndex(({ name }) => name === uav.name),
            { most_targets: locked },
          ),
      },
      {
        label: t("Unlock its targets"),
        changed: (now) => ({ ...now, locks: now.locks.filter((lock) => !isOfUav(lock)) }),
      },
    ];
  }
  if (uav && field === "end_action") {
    return [
      { label: t("Add a base"), href: () => "/uavs" },
      { label: t("Let all return to the start"), changed: (now) => ({ ...now, return_to_start: true }) },
    ];
  }
  if (target && field === "uav")
    return [{ label: t("Let any UAV fly it"), changed: (now) => withWishes(now, [target.key], { uav: null }) }];
  return part === "locks" ? [{ label: t("Unlock all"), changed: withoutLocks }] : [];
}
