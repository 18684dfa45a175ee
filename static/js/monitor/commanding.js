/** What an operator tells UAVs from the live page. Each asks first; nothing acts at once. */

import { ApiError } from "../api.js";
import { certaintyOf, MEASURED } from "../domain/certainty.js";
import { questionOf } from "../domain/command_questions.js";
import { KINDS } from "../domain/flying.js";
import { returnOf } from "../domain/own_return.js";
import { confirmAct } from "../page/confirm.js";
import { tellUav } from "../page/tell_uav.js";
import { say, toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { clockText, lengthText, percentText } from "../units.js";
import { createBatch, returnsOf } from "./batch_commanding.js";
import { unheardLines } from "./unheard.js";

/** @import { CommandKind, LiveMission, LiveUav, Mission, ReturnCheck } from "../api_types.d.ts" */
/** @import { Commanding, MonitorPage, MonitorStore } from "./types.d.ts" */

/**
 * Figures of now in a question: the battery, what is left, the targets that stay open.
 *
 * @param {Pick<LiveUav, "measured" | "estimated" | "place">} uav
 * @param {LiveMission | undefined} mission
 */
export function figuresLine({ measured, estimated, place }, mission) {
  const open = (mission?.targets ?? []).filter(
    ({ uav, state }) => uav === place && (state === "pending" || state === "in-progress"),
  ).length;
  const said = [
    typeof measured?.battery_percent === "number" &&
      t("battery {figure}", { figure: percentText(measured.battery_percent) }),
    typeof estimated?.to_go_m === "number" &&
      t("{distance} of its route to go", { distance: lengthText(estimated.to_go_m) }),
    estimated?.ends_at && t("would land {time}", { time: clockText(estimated.ends_at) }),
    open > 0 && tn(open, "{count} target open", "{count} targets open"),
  ].filter(Boolean);
  return said.length ? `${said.join(", ")}.`.replace(/^./, (first) => first.toLocaleUpperCase()) : "";
}

/** The UAV in its mission's plan. @param {LiveUav} uav @param {Map<string, Mission>} details */
const plannedOf = ({ mission, place }, details) => details.get(mission ?? "")?.uavs[place ?? -1];

/** @param {MonitorStore} store @param {MonitorPage} page @returns {Commanding} */
export function createCommanding(store, page) {
  /** @param {LiveUav} uav */
  const certainty = (uav) => certaintyOf(uav, store.state.now_ms);

  /** @param {LiveUav} uav @param {CommandKind} kind @param {Record<string, any>} [filled] what was filled in */
  async function told(uav, kind, filled = {}) {
    try {
      const isTold = await tellUav(uav.id, uav.name, kind, filled);
      if (isTold) say(t("{act}: {name} is being told.", { act: KINDS[kind], name: uav.name }));
      return isTold;
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      toast(`${t("{name} was not told: {act}.", { name: uav.name, act: KINDS[kind] })} ${error.message}`);
      return false;
    }
  }

  /** @param {LiveUav} uav @param {CommandKind} kind @returns {Promise<ReturnCheck | undefined>} */
  async function wayHome(uav, kind) {
    if (!["return", "abort"].includes(kind) || uav.mission === null || uav.place === null) return undefined;
    return returnOf(await returnsOf(uav.mission), uav.place);
  }

  /** @type {Commanding["ask"]} */
  async function ask(id, kind, opener = null) {
    const uav = store.state.uavs.find((entry) => entry.id === id);
    if (!uav) return;
    const mission = store.state.missions.find((entry) => entry.id === uav.mission);
    const planned = plannedOf(uav, store.state.details);
    const question = questionOf(kind, {
      name: uav.name,
      speed_mps: planned?.cruise_speed_mps ?? uav.measured?.speed_mps ?? 5,
      returns: await wayHome(uav, kind),
    });
    const late = certainty(uav) === MEASURED ? null : unheardLines([uav], kind, store.state.now_ms)[0];
    const [first, ...rest] = question.lines;
    const asked = await confirmAct({ ...question, lines: [first, figuresLine(uav, mission), late, ...rest], opener });
    if (asked) await told(uav, kind, asked);
  }

  return { ask, askAll: createBatch(store, page) };
}
