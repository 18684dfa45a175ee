/** Commands to several UAVs at once: one question that names them, one request that names their missions. */

import { ApiError, freshKey, post } from "../../api.js";
import { certaintyOf, MEASURED } from "../../domain/certainty.js";
import { LATE } from "../../domain/command_questions.js";
import { KINDS } from "../../domain/flying.js";
import { holdLinesOfAll, separateReturns, togetherLine } from "../../domain/rtl_check.js";
import { confirmAct } from "../../page/confirm.js";
import { CHECKING_HOME, returnsNow } from "../../page/present_returns.js";
import { toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import { answerWords, batchRequest, batchScopes, leftLines, returnLinesOf, scopeChoices } from "./batch.js";
import { markSending } from "./sending.js";
import { unreachableLines } from "./unreachable.js";

/** @import { BatchAnswers, PresentReturn } from "../../api_types.d.ts" */
/** @import { Question } from "../../domain/command_questions.js" */
/** @import { Answer } from "../../api.js" */
/** @import { BatchScope } from "./batch.js" */
/** @import { Commanding, MonitorPage, MonitorStore } from "../types.d.ts" */

/** @type {Record<"hold" | "return", { title: (uavs: number) => string, lines: string[], act: string }>} */
const ALL = {
  hold: {
    title: (uavs) => tn(uavs, "Hold {count} UAV?", "Hold all {count} UAVs?"),
    lines: [t("Each stops where it is and waits for Resume, as long as its battery lasts.")],
    act: t("Hold all"),
  },
  return: {
    title: (uavs) => tn(uavs, "Return {count} UAV?", "Return all {count} UAVs?"),
    lines: [t("Each returns to its take-off place and lands. Remaining targets stay open.")],
    act: t("Return all"),
  },
};

/**
 * One request, whatever its number of UAVs.
 *
 * @param {MonitorStore} store
 * @param {"hold" | "return"} kind
 * @param {BatchScope[]} scopes
 * @param {Map<number, Record<string, any>> | null} [ways] how each returns
 */
export async function commandBatch(store, kind, scopes, ways = null) {
  const { path, body } = batchRequest(kind, scopes, ways);
  const ids = scopes.flatMap(({ uavs }) => uavs.map(({ id }) => id));
  markSending(store, ids, kind);
  try {
    const headers = { "Idempotency-Key": freshKey() };
    const { data } = /** @type {Answer<BatchAnswers>} */ (await post(path, body, { headers }));
    toast(answerWords(data.results));
    const refused = data.results.filter(({ command }) => !command);
    markSending(
      store,
      refused.map(({ uav }) => uav),
      null,
    );
  } catch (error) {
    markSending(store, ids, null);
    if (!(error instanceof ApiError)) throw error;
    toast(`${t("{act}: not confirmed.", { act: ALL[kind].act })} ${error.message}`);
  }
}

/**
 * On Live it asks for the mission, without a default.
 *
 * @param {MonitorStore} store
 * @param {MonitorPage} page
 * @returns {Commanding["askAll"]}
 */
export function createBatch(store, page) {
  /** Recipients to choose from: on the page of one mission only its UAVs. */
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
    /** @param {string[]} seen facts read at this moment @param {Question["safer"]} safer */
    const asking = (seen, safer = null) => ({
      lines: [
        page.mission !== null && `${uavs.map(({ name }) => name).join(", ")}.`,
        ...lines,
        ...seen,
        ...leftLines(scopes),
        ...unreachableLines(silent, kind, store.state.now_ms),
      ],
      act: page.mission === null ? act : `${KINDS[kind]}: ${uavs.length}`,
      safer,
    });
    const holds = uavs.map(({ name, estimated }) => ({ name, hold_s: estimated?.battery?.hold_s }));
    const asked = await confirmAct({
      ...asking(kind === "return" ? [CHECKING_HOME] : holdLinesOfAll(holds)),
      title: page.mission === null ? t("{act}: of which mission?", { act }) : title(uavs.length),
      choices: page.mission === null ? { name: "scope", legend: t("Whom it is for"), of: scopeChoices(scopes) } : null,
      keep: t("Keep flying"),
      hint: LATE,
      isBack: true,
      opener,
      later:
        kind === "return"
          ? returnsNow(uavs.map(({ id }) => id)).then((returns) => asking(...found(returns)))
          : undefined,
    });
    /** @param {Map<number, PresentReturn>} returns @returns {[string[], Question["safer"]]} */
    function found(returns) {
      const separate = separateReturns([...returns.values()]);
      const together = togetherLine(uavs.map(({ id }) => returns.get(id)));
      const summary = [together, ...returnLinesOf(scopes, returns), ...(separate?.lines ?? [])];
      return [
        summary,
        separate && { words: t("Return on separate ways"), kind: "return", parameters: { ways: separate.ways } },
      ];
    }
    if (asked)
      await commandBatch(
        store,
        kind,
        asked.scope && asked.scope !== "all" ? scopes.filter(({ id }) => id === asked.scope) : scopes,
        asked.safer?.parameters.ways,
      );
  };
}
