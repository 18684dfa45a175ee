/** Server checks of edited waypoints: one request at a time, cached by their input. */

import { post } from "../../api.js";
import { t } from "../../text.js";
import * as hand from "./hand_route.js";

/** @import { Answer } from "../../api.js" */
/** @import { HandLook } from "../../api_types.d.ts" */
/** @import { HandEdit, HandFaults, HandPoint, MissionContext } from "../types.d.ts" */

const MAX_KNOWN = 50; // checked routes with the server's answer
/** @type {HandFaults} */
export const NO_FAULTS = hand.faultsOf(null);

/** @param {HandPoint[]} points */
const keyOf = (points) => JSON.stringify(hand.bodyOf(points));

/** @param {Pick<MissionContext, "store" | "wordsOf">} context */
export function createManualEditChecks({ store, wordsOf }) {
  /** @type {Map<string, HandLook>} by the request */
  const looks = new Map();
  let isAsking = false;

  /** @param {Partial<HandEdit>} change */
  const put = (change) => {
    const { hand: edit } = store.state;
    if (edit) store.update({ hand: { ...edit, ...change } });
  };

  /**
   * The check of these points, exactly or from a moment ago.
   *
   * @param {HandEdit} edit
   * @param {HandPoint[]} points
   */
  function knownOf({ look: last, dragged, original }, points) {
    const exact = looks.get(keyOf(points)) ?? null;
    const look = exact ?? (last?.waypoints.length === points.length ? last : null);
    const isKnown = look !== null && (exact !== null || Boolean(dragged));
    const faults = isKnown ? hand.faultsOf(look.faults) : NO_FAULTS;
    const legs = new Map(
      hand
        .changedLegs(points, original)
        .map((index) => [index, isKnown ? { is_clear: hand.isLegClear(faults, index) } : null]),
    );
    return { look: exact ?? last, isCheckOld: exact === null, faults, legs, unknown: "" };
  }

  /** Request the check of the points on the map at this moment, dragged or not. */
  async function ask() {
    const { hand: asked, mission } = store.state;
    if (isAsking || !asked || !mission) return;
    const points = asked.dragged ?? asked.points;
    if (looks.has(keyOf(points))) return;
    isAsking = true;
    try {
      const { data } = /** @type {Answer<HandLook>} */ (
        await post(`/missions/${mission.id}/routes/${asked.sequence}/waypoints/look`, hand.bodyOf(points))
      );
      looks.set(keyOf(points), data);
      const [oldest] = looks.keys();
      if (looks.size > MAX_KNOWN) looks.delete(oldest);
      if (store.state.hand?.sequence !== asked.sequence) return;
      put({ look: data });
      const now = store.state.hand;
      if (now) put(knownOf(now, now.dragged ?? now.points));
    } catch (error) {
      put({ unknown: t("Not checked: {reason}", { reason: wordsOf(error) }) });
      return;
    } finally {
      isAsking = false;
    }
    void ask();
  }

  return { ask, knownOf, put, forget: () => looks.clear() };
}
