/** Recipients of a command to several UAVs by mission, and the text of its question. Values in, values out. */

import { inAir } from "../../domain/in_air.js";
import { returnLinesOfAll } from "../../domain/rtl_check.js";
import { t, tn } from "../../text.js";

/** @import { BatchAnswer, LiveMission, LiveUav, PresentReturn } from "../../api_types.d.ts" */

/**
 * UAVs of one mission that a batch would reach, and those it would not, with the reason.
 *
 * @typedef {{ id: string, name: string, uavs: LiveUav[], left: { name: string, why: string }[] }} BatchScope
 */

const REACHABLE = ["dispatched", "active", "aborted", "failed"];

/** Why a command to a UAV makes no sense now; "" where it does. @param {Pick<LiveUav, "name" | "measured" | "link">} uav */
export function whyNot({ name, measured, link }) {
  if (!measured && !link?.last_message_at) return t("{name} never connected.", { name });
  return inAir({ measured, link }) === false ? t("{name} is on the ground.", { name }) : "";
}

/**
 * Missions that have a UAV a batch can reach, in the order of the page. Only UAVs that fly the mission belong to it.
 *
 * @param {LiveUav[]} uavs
 * @param {LiveMission[]} missions
 * @returns {BatchScope[]}
 */
export function batchScopes(uavs, missions) {
  return missions
    .filter(({ state }) => REACHABLE.includes(state))
    .map(({ id, name }) => {
      const own = uavs.filter(({ mission }) => mission === id);
      return {
        id,
        name,
        uavs: own.filter((uav) => !whyNot(uav)),
        left: own.filter(whyNot).map((uav) => ({ name: uav.name, why: whyNot(uav) })),
      };
    })
    .filter((scope) => scope.uavs.length > 0);
}

/** @param {{ name: string }[]} uavs */
const names = (uavs) => uavs.map(({ name }) => name).join(", ");

/**
 * The choices of a scope: { value, words, detail }. Every choice names its mission and its UAVs.
 *
 * @param {BatchScope[]} scopes
 */
export function scopeChoices(scopes) {
  const each = scopes.map(({ id, name, uavs }) => ({
    value: id,
    words: `${name}: ${tn(uavs.length, "{count} UAV", "{count} UAVs")}`,
    detail: names(uavs),
  }));
  if (scopes.length < 2) return each;
  const all = scopes.flatMap(({ uavs }) => uavs);
  const words = t("All {missions} missions: {uavs}", {
    missions: scopes.length,
    uavs: tn(all.length, "{count} UAV", "{count} UAVs"),
  });
  return [...each, { value: "all", words, detail: scopes.map(({ name }) => name).join(", ") }];
}

/**
 * Obstructions of each UAV's RTL path, as the question of one UAV states them; equal ones are grouped.
 *
 * @param {BatchScope[]} scopes
 * @param {Map<number, PresentReturn>} returns by UAV
 */
export const returnLinesOf = (scopes, returns) =>
  returnLinesOfAll(scopes.flatMap(({ uavs }) => uavs.map(({ id, name }) => ({ name, check: returns.get(id) }))));

/** @param {BatchScope[]} scopes */
export const leftLines = (scopes) => scopes.flatMap(({ left }) => left.map(({ why }) => t("Not sent: {why}", { why })));

/**
 * The request of a batch: { path, body }. It names the UAVs that the question named, and no others.
 *
 * @param {"hold" | "return"} kind
 * @param {BatchScope[]} scopes
 * @param {Map<number, Record<string, any>> | null} [ways] how each returns, by UAV; the others straight
 */
export function batchRequest(kind, scopes, ways = null) {
  const missions = scopes.map(({ id, uavs }) => ({ mission: id, uavs: uavs.map((uav) => uav.id) }));
  const reported = new Set(missions.flatMap(({ uavs }) => uavs));
  const separate = ways && { ways: Object.fromEntries([...ways].filter(([uav]) => reported.has(uav))) };
  if (missions.length > 1) return { path: "/missions/commands", body: { kind, missions, ...separate } };
  const [{ mission, uavs }] = missions;
  return { path: `/missions/${mission}/commands`, body: { kind, uavs, ...separate } };
}

/** The outcome as text. @param {BatchAnswer[]} results */
export function answerWords(results) {
  const reported = results.filter((answer) => answer.is_accepted).length;
  const refused = results.filter((answer) => !answer.is_accepted);
  return [
    tn(reported, "Sending to {count} UAV.", "Sending to {count} UAVs."),
    ...refused.map(({ name, reasons }) =>
      t("Not sent to {name}: {why}", { name, why: reasons.map(({ message }) => message).join(" ") }),
    ),
  ].join(" ");
}
