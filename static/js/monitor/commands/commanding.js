/** Commands from the live page. Each asks for confirmation; none is sent at once. */

import { ApiError, freshKey } from "../../api.js";
import { certaintyOf, MEASURED } from "../../domain/certainty.js";
import { KINDS } from "../../domain/flying.js";
import { commandUav } from "../../page/command_uav.js";
import { confirmAct } from "../../page/confirm.js";
import { presentQuestion } from "../../page/present_returns.js";
import { announce, toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import { clockText, lengthText, percentText } from "../../units.js";
import { overtakenWords } from "../text/alert_text.js";
import { createBatch } from "./batch_commanding.js";
import { dropSent, markSending } from "./sending.js";
import { unreachableLines } from "./unreachable.js";

/** @import { AskedKind } from "../../domain/command_questions.js" */
/** @import { CommandKind, LiveMission, LiveUav, Mission } from "../../api_types.d.ts" */
/** @import { Commanding, MonitorPage, MonitorStore, UnsentCommand } from "../types.d.ts" */

/**
 * Present figures in a question: the battery, the distance left, the open targets.
 *
 * @param {Pick<LiveUav, "measured" | "estimated" | "place">} uav
 * @param {LiveMission | undefined} mission
 */
export function figuresLine({ measured, estimated, place }, mission) {
  const open = (mission?.targets ?? []).filter(
    ({ uav, state }) => uav === place && (state === "pending" || state === "in-progress"),
  ).length;
  const summary = [
    typeof measured?.battery_percent === "number" &&
      t("battery {figure}", { figure: percentText(measured.battery_percent) }),
    typeof estimated?.to_go_m === "number" &&
      t("{distance} of its route to go", { distance: lengthText(estimated.to_go_m) }),
    estimated?.ends_at && t("would land {time}", { time: clockText(estimated.ends_at) }),
    open > 0 && tn(open, "{count} target open", "{count} targets open"),
  ].filter(Boolean);
  return summary.length ? `${summary.join(", ")}.`.replace(/^./, (first) => first.toLocaleUpperCase()) : "";
}

const ANSWER_WITHIN_MS = 8_000; // timeout for a frozen connection

/** The UAV in its mission's plan. @param {LiveUav} uav @param {Map<string, Mission>} details */
const plannedOf = ({ mission, place }, details) => details.get(mission ?? "")?.uavs[place ?? -1];

/** @param {MonitorStore} store @param {number} id of a UAV @param {UnsentCommand | null} unsent null: it was sent or dropped */
function keptUnsent(store, id, unsent) {
  const unsentNow = new Map(store.state.unsent);
  if (unsent) unsentNow.set(id, unsent);
  else unsentNow.delete(id);
  store.update({ unsent: unsentNow });
}

/** Drop unsent commands that reached the server after all, as the feed reports once it is back. @param {MonitorStore} store */
function dropArrived(store) {
  dropSent(store);
  store.listen(["commands"], ({ commands, unsent }) => {
    for (const [id, { kind, at_ms }] of unsent)
      if (commands.some((one) => one.uav.id === id && one.kind === kind && Date.parse(one.created_at) >= at_ms))
        keptUnsent(store, id, null);
  });
}

/**
 * While a question is open: `overtaken` resolves once the UAV does what is asked, by itself or on another user's command.
 *
 * @param {MonitorStore} store
 * @param {LiveUav} asked its state when the question opened
 * @param {AskedKind} kind
 */
export function watchOvertaken(store, asked, kind) {
  let stop = () => {};
  /** @type {Promise<string>} */
  const overtaken = new Promise((resolve) => {
    if (overtakenWords(kind, asked)) return; // true before, and the question states it
    stop = store.listen(["uavs"], ({ uavs }) => {
      const uav = uavs.find(({ id }) => id === asked.id);
      const words = uav && overtakenWords(kind, uav);
      if (words) resolve(`${words} ${t("This command was not sent.")}`);
    });
  });
  return { overtaken, stop: () => stop() };
}

/** @param {MonitorStore} store @param {MonitorPage} page @returns {Commanding} */
export function createCommanding(store, page) {
  /** @param {LiveUav} uav */
  const certainty = (uav) => certaintyOf(uav, store.state.now_ms);

  /**
   * Send a command. One that could not be sent stays on the UAV's card until it is sent or dropped.
   *
   * @param {LiveUav} uav
   * @param {CommandKind} kind
   * @param {Record<string, any>} [filled] what was filled in
   * @param {string} [key] idempotency key of the command, the same in a retry
   */
  async function order(uav, kind, filled = {}, key = freshKey()) {
    markSending(store, [uav.id], kind);
    try {
      const isOrdered = await commandUav(uav.id, uav.name, kind, filled, { key, within_ms: ANSWER_WITHIN_MS });
      keptUnsent(store, uav.id, null);
      if (!isOrdered) markSending(store, [uav.id], null);
      if (isOrdered) announce(t("{act}: sending to {name}.", { act: KINDS[kind], name: uav.name }));
      return isOrdered;
    } catch (error) {
      markSending(store, [uav.id], null);
      if (!(error instanceof ApiError)) throw error;
      if (error.isAway) {
        keptUnsent(store, uav.id, {
          kind,
          filled,
          key,
          message: error.message,
          isBusy: false,
          at_ms: store.state.now_ms,
        });
        return false;
      }
      keptUnsent(store, uav.id, null);
      toast(`${t("{act}: not sent to {name}.", { name: uav.name, act: KINDS[kind] })} ${error.message}`);
      return false;
    }
  }

  /** @type {Commanding["ask"]} */
  async function ask(id, kind, opener = null) {
    const uav = store.state.uavs.find((entry) => entry.id === id);
    if (!uav) return;
    const mission = store.state.missions.find((entry) => entry.id === uav.mission);
    const planned = plannedOf(uav, store.state.details);
    const isStop = kind === "hold"; // the feed reports its requests
    const flyer = {
      name: uav.name,
      speed_mps: planned?.cruise_speed_mps ?? uav.measured?.speed_mps ?? 5,
      hold_s: uav.estimated?.battery?.hold_s,
      route: store.state.details.get(uav.mission ?? "")?.plan?.routes[uav.place ?? -1],
    };
    const late = certainty(uav) === MEASURED ? null : unreachableLines([uav], kind, store.state.now_ms)[0];
    const already = overtakenWords(kind, uav);
    const question = presentQuestion(isStop ? null : uav.id, kind, flyer, ([first, ...rest]) => [
      already,
      first,
      figuresLine(uav, mission),
      late,
      ...rest,
    ]);
    const watch = watchOvertaken(store, uav, kind);
    const asked = await confirmAct({ ...question, opener, overtaken: watch.overtaken });
    watch.stop();
    if (asked?.safer) await order(uav, asked.safer.kind, asked.safer.parameters);
    else if (asked) await order(uav, kind, asked);
  }

  dropArrived(store);

  /** @type {Commanding["tryAgain"]} */
  async function tryAgain(id) {
    const unsent = store.state.unsent.get(id);
    const uav = store.state.uavs.find((entry) => entry.id === id);
    if (!unsent || !uav || unsent.isBusy) return;
    keptUnsent(store, id, { ...unsent, isBusy: true });
    await order(uav, unsent.kind, unsent.filled, unsent.key);
  }

  return { ask, askAll: createBatch(store, page), tryAgain, giveUp: (id) => keptUnsent(store, id, null) };
}
