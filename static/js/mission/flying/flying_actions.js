/** Acts of an operator on a planned mission: approve, upload, start and revoke. Each asks for confirmation; the flight is led from the page Fly. */

import { ApiError, freshKey, get, post, signInAddress } from "../../api.js";
import { h } from "../../dom.js";
import { flyersOf, isFrozen, isOnItsWay } from "../../domain/flying.js";
import { returnOf, warningsOfAll } from "../../domain/rtl_check.js";
import { askForUpload, checkLines, start, upload } from "../../page/before_start.js";
import { confirmAct } from "../../page/confirm.js";
import { t, tn } from "../../text.js";
import { briefingOf, needsReason } from "./briefing.js";
import { createFlightReading } from "./flight_reading.js";
import { approvedStep } from "./next_act.js";

/** @import { Answer } from "../../api.js" */
/** @import { Mission, NearestZone, NearestZoneAnswer, Rehearsal, RehearsalPage } from "../../api_types.d.ts" */
/** @import { BriefingFact } from "./briefing.js" */
/** @import { Flyer } from "../../domain/flying.js" */
/** @import { MissionContext, MissionPageData, MissionPageState, MissionStore } from "../types.d.ts" */

/** @typedef {{ store: MissionStore, failed: MissionContext["failed"], readCommands: () => Promise<void> }} Acting */

/**
 * @param {MissionStore} store
 * @param {{ failed: MissionContext["failed"], page: Pick<MissionPageData, "isFrozen"> }} options
 */
export function createFlying(store, { failed, page }) {
  const { readCommands, readReturns, readPreflight, watch } = createFlightReading(store, page);
  const acting = { store, failed, readCommands };

  // Approved missions are read-only, others are not: the page is reloaded for either.
  store.listen(["mission"], ({ mission }) => {
    if (mission && isFrozen(mission) !== page.isFrozen) location.reload();
  });

  return {
    async approve() {
      const [rehearsals, nearest] = await Promise.all([rehearsalsOf(store), nearestZoneOf(store), readReturns()]);
      await approve(acting, rehearsals, nearest);
    },
    revoke: () => revoke(acting),
    /** Upload, then start. @param {HTMLElement} opener */
    async next(opener) {
      await next(acting, opener);
      await readPreflight();
    },
    watch,
  };
}

/** The act is of the revision on the page, and done once. @param {MissionStore} store */
const asSeen = ({ state: { mission } }) => ({
  headers: { "If-Match": `"${mission?.revision}"`, "Idempotency-Key": freshKey() },
});
/** @param {Flyer[]} flyers */
const uavsWords = (flyers) => flyers.map(({ name }) => name).join(", ");

/** @param {BriefingFact[]} facts */
const briefingList = (facts) =>
  h(
    "dl",
    { class: "approval-facts" },
    facts.flatMap(({ term, words, isBad }) => [h("dt", {}, term), h("dd", { class: isBad ? "bad" : "" }, words)]),
  );

/** @param {MissionPageState["returns"]} returns @param {Flyer[]} flyers */
function returnsOf(returns, flyers) {
  const checks = flyers.flatMap(({ place }) => returnOf(returns, place) ?? []);
  const isWhole = checks.length === flyers.length;
  const unchecked = t("Return path not checked: it flies straight, at its own return altitude.");
  return [...(isWhole ? [] : [unchecked]), ...warningsOfAll(checks)];
}

/**
 * Run an act; reports a refusal with the server's text.
 *
 * @param {Acting} acting
 * @param {string} title
 * @param {() => Promise<void>} act
 */
async function tried({ store, failed, readCommands }, title, act) {
  store.update({ isDispatching: true });
  try {
    await act();
    store.update({ problem: null });
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (error.isSignedOut) failed(title, error, [{ label: t("Sign in"), href: signInAddress }]);
    else if (error.status === 412)
      failed(title, new ApiError(t("The mission was changed by someone else. Review it again."), { status: 412 }), [
        { label: t("Load again"), act: () => location.reload() },
      ]);
    else failed(title, error);
  } finally {
    store.update({ isDispatching: false });
    void readCommands();
  }
}

/** The rehearsals of the mission, the newest first; those on the page where the server does not answer. @param {MissionStore} store */
async function rehearsalsOf({ state: { mission, rehearsal } }) {
  try {
    const { data } = /** @type {Answer<RehearsalPage>} */ (await get(`/missions/${mission?.id}/rehearsals`));
    return data.results;
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    return rehearsal.list ?? [];
  }
}

/** The zone that the plan comes nearest to; undefined where it cannot be read now. @param {MissionStore} store */
async function nearestZoneOf({ state: { mission } }) {
  try {
    const { data } = /** @type {Answer<NearestZoneAnswer>} */ (await get(`/missions/${mission?.id}/nearest-zone`));
    return data.nearest;
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    return undefined;
  }
}

/** @param {Acting} acting @param {Rehearsal[]} rehearsals @param {NearestZone | null | undefined} nearest */
async function approve(acting, rehearsals, nearest) {
  const { store } = acting;
  const { mission } = store.state;
  if (!mission) return;
  const flyers = flyersOf(mission);
  const simulated = flyers.filter(({ place }) => mission.uavs[place].is_simulated);
  const isAgainstRehearsal = needsReason(mission, rehearsals);
  const asked = await confirmAct({
    title: t("Approve “{name}”?", { name: mission.name }),
    lines: [
      briefingList(briefingOf(mission, rehearsals, nearest)),
      tn(flyers.length, "{count} UAV flies: {names}.", "{count} UAVs fly: {names}.", { names: uavsWords(flyers) }),
      simulated.length > 0 && t("Simulated, no real aircraft: {names}.", { names: uavsWords(simulated) }),
      t("Approval locks the mission. Only the approved mission can be uploaded to UAVs. The approval can be revoked."),
      ...returnsOf(store.state.returns, flyers),
    ],
    field: isAgainstRehearsal && {
      name: "acknowledges_failed_rehearsal",
      label: t("Why it is approved without a passed rehearsal (kept in the history)"),
      isNeeded: true,
    },
    option: {
      name: "longest_leg_m",
      label: t("Maximum waypoint spacing [m]; blank: as planned"),
      type: "number",
      min: 50,
      max: 5000,
      step: "any",
    },
    act: t("Approve"),
    isBack: !isAgainstRehearsal,
    image: "badge-check",
  });
  if (!asked) return;
  const { longest_leg_m, ...reason } = asked;
  const wishes = Number.isFinite(longest_leg_m) ? { longest_leg_m, ...reason } : reason;
  await tried(acting, t("Not approved."), async () => {
    const { data } = /** @type {Answer<Mission>} */ (
      await post(`/missions/${mission.id}/approve`, wishes, asSeen(store))
    );
    store.update({ mission: data });
  });
}

/** @param {Acting} acting @param {HTMLElement} opener */
async function next(acting, opener) {
  const { mission, preflight, isDispatching } = acting.store.state;
  const step = mission && approvedStep(mission, preflight);
  if (!preflight || !step || step.why || isDispatching) return;
  if (step.act === "upload") {
    const heights = await askForUpload(preflight, step, opener);
    if (heights) await tried(acting, t("Not sent."), () => upload(mission.id, heights));
  } else if (step.act === "start")
    await tried(acting, t("Not started."), () => start(mission.id, step, opener, checkLines(preflight, step)));
}

/** @param {Acting} acting */
async function revoke(acting) {
  const { store } = acting;
  const { mission } = store.state;
  if (!mission) return;
  const asked = await confirmAct({
    title: t("Revoke the approval of “{name}”?", { name: mission.name }),
    lines: isOnItsWay(mission)
      ? [
          t(
            "The mission is removed from every UAV that may have it. The approval ends once that is confirmed; then the mission can be changed again.",
          ),
          t("Until then it can be neither uploaded nor started."),
        ]
      : [t("The mission can be changed again, and must be approved again before it is uploaded.")],
    field: { name: "reason", label: t("Why (kept in the history)"), isNeeded: true },
    keep: t("Keep it approved"),
    act: t("Revoke"),
  });
  if (!asked) return;
  await tried(acting, t("Not revoked."), async () => {
    const { data } = /** @type {Answer<Mission>} */ (
      await post(`/missions/${mission.id}/revoke`, { reason: asked.reason }, asSeen(store))
    );
    store.update({ mission: data });
  });
}
