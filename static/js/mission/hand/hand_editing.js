/** Changing one route by hand: its points with undo and redo, what flying them would take asked about at once, and keeping them. */

import { post, request } from "../../api.js";
import { say, toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { isPlanCurrent } from "../plan_view.js";
import * as hand from "./hand_route.js";

const MOST_KNOWN = 50; // routes as they were wished, with what the server said of them
const NO_FAULTS = hand.faultsOf(null);

/**
 * saving: { save(), keepOpen(mission, asked) }. While somebody changes a route, store.state.hand says all of it; else it is null.
 *
 * hand.look is what the server said last of the route as it is shown, and of as many points as it has now; hand.isLookOld tells that the
 * points have moved on since. hand.legs has the changed legs, and whether each is clear; null while that is not known.
 */
export function createHandEditing({ store, history, selection, problem, wordsOf }, { save, keepOpen }) {
  const looks = new Map(); // body → { faults, length_m, … } as asked
  let [past, future] = [[], []];
  let isAsking = false;

  const state = () => store.state.hand;
  const put = (change) => store.update({ hand: { ...state(), ...change } });

  /** Opens a route; the plan has to be the stored one, and is stored first where it is not. */
  async function begin(sequence) {
    if (!store.state.planIsStored || !isPlanCurrent(store.state)) await save({ byItself: true });
    const { plan, planIsStored, mission } = store.state;
    const route = plan?.result.routes[sequence];
    if (!mission || !planIsStored || !isPlanCurrent(store.state) || !route?.geometry) {
      toast(t("A route is changed by hand once its plan is saved."));
      return;
    }
    [past, future] = [[], []];
    looks.clear();
    const original = hand.pointsOf(route);
    store.update({
      hand: {
        sequence,
        original,
        points: original,
        chosen: null,
        dragged: null,
        look: null,
        isLookOld: true,
        unknown: "",
        faults: NO_FAULTS,
        legs: new Map(),
        canUndo: false,
        canRedo: false,
        isSaving: false,
      },
      why: { byHand: sequence },
      tool: "point",
    });
    void ask();
  }

  function end() {
    if (state()) store.update({ hand: null, why: store.state.why?.byHand === undefined ? store.state.why : null });
  }

  const show = (points, chosen) => {
    put({
      points,
      chosen: chosen !== null && points[chosen] ? chosen : null,
      canUndo: past.length > 0,
      canRedo: future.length > 0,
      ...knownOf(points),
    });
    void ask();
  };

  /** One step of the history. */
  function take(points, chosen = state().chosen) {
    if (points === state().points) return false;
    past.push(state().points);
    future = [];
    show(points, chosen);
    return true;
  }

  const keyOf = (points) => JSON.stringify(hand.bodyOf(points));

  /** What is known of these points, exactly or from a moment ago. */
  function knownOf(points) {
    const exact = looks.get(keyOf(points)) ?? null;
    const { look: last, dragged, original } = state();
    const look = exact ?? (last?.waypoints.length === points.length ? last : null);
    const faults = look && (exact || dragged) ? hand.faultsOf(look.faults) : NO_FAULTS;
    const isKnown = look !== null && (exact !== null || Boolean(dragged));
    const legs = new Map(
      hand
        .changedLegs(points, original)
        .map((index) => [index, isKnown ? { is_clear: hand.isLegClear(faults, index) } : null]),
    );
    return { look: exact ?? last, isLookOld: exact === null, faults, legs, unknown: "" };
  }

  /** What is shown on the map at this moment, dragged or not, is asked about: one request after the other. */
  async function ask() {
    const asked = state();
    if (isAsking || !asked) return;
    const points = asked.dragged ?? asked.points;
    if (looks.has(keyOf(points))) return;
    isAsking = true;
    try {
      const { data } = await post(
        `/missions/${store.state.mission.id}/routes/${asked.sequence}/waypoints/look`,
        hand.bodyOf(points),
      );
      looks.set(keyOf(points), data);
      if (looks.size > MOST_KNOWN) looks.delete(looks.keys().next().value);
      if (state()?.sequence !== asked.sequence) return;
      put({ look: data });
      put(knownOf(state().dragged ?? state().points));
    } catch (error) {
      if (state()) put({ unknown: t("Not checked: {reason}", { reason: wordsOf(error) }) });
      return;
    } finally {
      isAsking = false;
    }
    void ask();
  }

  function step(from, to) {
    if (!state() || !from.length) return false;
    to.push(state().points);
    show(from.pop(), state().chosen);
    return true;
  }

  async function stored(mission, sequence, points) {
    const answer = await request("PUT", `/missions/${mission.id}/routes/${sequence}/waypoints`, {
      body: hand.bodyOf(points),
      headers: { "If-Match": `"${mission.revision}"` },
    });
    return answer.data;
  }

  /** The route as it was before it was changed by hand last; who has changed the mission since is told so. */
  async function takeBack(sequence) {
    const { mission, name } = store.state;
    if (state()) put({ isSaving: true });
    try {
      const { data } = await request("POST", `/missions/${mission.id}/routes/${sequence}/waypoints/undo`, {
        headers: { "If-Match": `"${mission.revision}"` },
      });
      end();
      keepOpen(data, { selection: selection(), name });
      history.startFrom(selection());
      store.update({ problem: null }); // what planning again would take away may be there no more
      toast(t("The last change by hand is taken back."));
    } catch (error) {
      if (state()) put({ isSaving: false });
      toast(t("Not undone: {reason}", { reason: wordsOf(error) }));
    }
  }

  async function keep() {
    const { sequence, points, original } = state();
    if (!hand.changesOf(points, original)) return end();
    const { mission, name } = store.state;
    put({ isSaving: true });
    try {
      const data = await stored(mission, sequence, points);
      end();
      keepOpen(data, { selection: selection(), name });
      history.startFrom(selection()); // a step back from here would plan anew, and the change by hand would be gone
      say(t("The route is kept as changed by hand."));
      toast(t("The route is kept as changed by hand."), { label: t("Undo"), act: () => takeBack(sequence) });
    } catch (error) {
      if (!state()) return undefined;
      const faults = hand.faultsOf(error.details);
      const places = faults.points.size + faults.legs.size;
      const told = places || faults.other.length ? faults : { ...faults, other: [wordsOf(error)] };
      toast(t("Not kept: {reason}", { reason: [...told.other, ...told.points.values(), ...told.legs.values()][0] }));
      put({
        isSaving: false,
        faults: told,
        chosen: [...faults.points.keys(), ...faults.legs.keys()][0] ?? state().chosen,
      });
      if (error.isSignedOut) problem(t("You are signed out."), wordsOf(error));
    }
    return undefined;
  }

  // Who plans anew, picks something else or closes the panel is not changing this route any more.
  store.listen(["plan", "why"], ({ hand: now, why, plan }) => {
    if (
      now &&
      (why?.byHand !== now.sequence ||
        !plan?.result.routes[now.sequence]?.geometry ||
        hand.pointsOf(plan.result.routes[now.sequence]).length !== now.original.length)
    )
      end();
  });

  return {
    beginByHand: begin,
    endByHand: end,
    keepByHand: keep,
    chooseByHand: (chosen) => state() && put({ chosen }),
    /** While it is dragged: shown and asked about, no step of the history. */
    dragByHand(points, chosen) {
      put({ dragged: points, chosen });
      put(knownOf(points));
      void ask();
    },
    dropByHand(points, chosen) {
      put({ dragged: null });
      if (!points || !take(points, chosen)) put(knownOf(state().points));
    },
    moveByHand: (index, position) => take(hand.moved(state().points, index, position), index),
    raiseByHand: (index, height_m) => take(hand.raised(state().points, index, height_m), index),
    paceByHand: (index, speed_mps) => take(hand.paced(state().points, index, speed_mps), index),
    insertByHand: (index) => take(hand.inserted(state().points, index), index + 1),
    removeByHand: (index) => take(hand.dropped(state().points, index), null),
    takeBackByHand: () => takeBack(state().sequence),
    undoByHand: () => step(past, future),
    redoByHand: () => step(future, past),
  };
}
