/** Commands to several UAVs at once: one question that names them, one request that names their missions. */

import { ApiError, freshKey, get, post } from "../api.js";
import { certaintyOf, MEASURED } from "../domain/certainty.js";
import { LATE } from "../domain/command_questions.js";
import { KINDS } from "../domain/flying.js";
import { confirmAct } from "../page/confirm.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { answerWords, batchRequest, batchScopes, leftLines, returnLinesOf, scopeChoices } from "./batch.js";
import { unheardLines } from "./unheard.js";

/** @import { BatchAnswers, ReturnCheck, ReturnChecks } from "../api_types.d.ts" */
/** @import { Answer } from "../api.js" */
/** @import { BatchScope } from "./batch.js" */
/** @import { Commanding, MonitorPage, MonitorStore } from "./types.d.ts" */

const CHECK_TIMEOUT_MS = 3000; // the question waits no longer for what is in the way home

/** @type {Record<"pause" | "return", { title: (uavs: number) => string, lines: string[], act: string }>} */
const ALL = {
  pause: {
    title: (uavs) => tn(uavs, "Pause {count} UAV?", "Pause all {count} UAVs?"),
    lines: [t("Each stops on its route and waits for Resume, as long as its battery lasts.")],
    act: t("Pause all"),
  },
  return: {
    title: (uavs) => tn(uavs, "Return {count} UAV?", "Return all {count} UAVs?"),
    lines: [t("Each flies back to where it took off and lands there. Targets that are not reached stay undone.")],
    act: t("Return all"),
  },
};

/**
 * What is in the way home of each UAV of a mission; undefined where that could not be read: the question then says that nobody has looked.
 *
 * @param {string} mission
 * @returns {Promise<ReturnCheck[] | undefined>}
 */
export async function returnsOf(mission) {
  const signal = AbortSignal.timeout(CHECK_TIMEOUT_MS);
  try {
    return /** @type {Answer<ReturnChecks>} */ (await get(`/missions/${mission}/returns`, { signal })).data.results;
  } catch (error) {
    if (!(error instanceof ApiError || signal.aborted)) throw error;
    return undefined;
  }
}

/** Checks of the way home of each mission. @param {BatchScope[]} scopes */
async function waysHome(scopes) {
  const checks = await Promise.all(scopes.map(({ id }) => returnsOf(id)));
  return new Map(scopes.map(({ id }, at) => [id, checks[at]]));
}

/** One request, whatever its number of UAVs. @param {"pause" | "return"} kind @param {BatchScope[]} scopes */
async function tellBatch(kind, scopes) {
  const { path, body } = batchRequest(kind, scopes);
  try {
    const headers = { "Idempotency-Key": freshKey() };
    const { data } = /** @type {Answer<BatchAnswers>} */ (await post(path, body, { headers }));
    toast(answerWords(data.results));
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(`${t("{act}: not confirmed.", { act: ALL[kind].act })} ${error.message}`);
  }
}

/**
 * On Live it asks of which mission, with nothing chosen beforehand.
 *
 * @param {MonitorStore} store
 * @param {MonitorPage} page
 * @returns {Commanding["askAll"]}
 */
export function createBatch(store, page) {
  /** Whom it may be for: on the page of one mission its UAVs and no others. */
  function scopesNow() {
    const { uavs, missions } = store.state;
    return batchScopes(uavs, page.mission === null ? missions : missions.filter(({ id }) => id === page.mission));
  }

  return async function askAll(kind, opener = null) {
    const scopes = scopesNow();
    if (!scopes.length) return void toast(t("No UAV is in the air."));
    const { title, lines, act } = ALL[kind];
    const uavs = scopes.flatMap((scope) => scope.uavs);
    const silent = uavs.filter((uav) => certaintyOf(uav, store.state.now_ms) !== MEASURED);
    const asked = await confirmAct({
      title: page.mission === null ? t("{act}: of which mission?", { act }) : title(uavs.length),
      lines: [
        page.mission !== null && `${uavs.map(({ name }) => name).join(", ")}.`,
        ...lines,
        kind === "return" && uavs.length > 1 && t("All return at once: nothing keeps them apart on the way home."),
        ...(kind === "return" ? returnLinesOf(scopes, await waysHome(scopes)) : []),
        ...leftLines(scopes),
        ...unheardLines(silent, kind, store.state.now_ms),
        LATE,
      ],
      choices: page.mission === null ? { name: "scope", legend: t("Whom it is for"), of: scopeChoices(scopes) } : null,
      act: page.mission === null ? act : `${KINDS[kind]}: ${uavs.length}`,
      keep: t("Keep flying"),
      isBack: true,
      opener,
    });
    if (asked)
      await tellBatch(
        kind,
        asked.scope && asked.scope !== "all" ? scopes.filter(({ id }) => id === asked.scope) : scopes,
      );
  };
}
