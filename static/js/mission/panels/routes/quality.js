/** Above the strips: the quality of the plan, separation of its UAVs, the cost of locks, and the way back. */

import { byId, h, icon, keepingFocus, setChildren } from "../../../dom.js";
import { t } from "../../../text.js";
import { percentText } from "../../../units.js";
import { checkStateOf, checkText } from "../../options/lost_link.js";
import { qualityOf, wishWordsOf } from "../../plan/plan_quality.js";
import { isPlanCurrent } from "../../plan/plan_view.js";
import { separationOf } from "../../plan/route_times.js";

/** @import { Child } from "../../../dom.js" */
/** @import { MissionActions, MissionPageState, PlanProof, ShownPlan } from "../../types.d.ts" */

/** @param {string} image @param {boolean} isFault @param {...Child} words */
const bound = (image, isFault, ...words) =>
  h("span", { class: `plan-bound${isFault ? " fault" : ""}` }, icon(image, "small"), h("span", {}, words));

/**
 * @param {MissionPageState} state
 * @param {ShownPlan} plan
 * @param {{ canPlan: boolean, actions: MissionActions }} how
 */
export function drawQuality(state, plan, { canPlan, actions }) {
  const isCurrent = isPlanCurrent(state);
  const quality = isCurrent ? qualityOf(plan.result) : null;
  const separation = isCurrent ? separationOf(plan.result) : null;
  const locked = state.selection.locks?.length ?? 0;
  const linkState = checkStateOf(state.selection.lost_link, plan, isCurrent);
  const isLost = linkState === "lost";
  const place = byId("plan-quality");
  const proof = isCurrent ? proofOf(state, plan.result.is_proven, actions) : null;
  place.hidden = !quality && !locked && !separation && !isLost && !proof;
  keepingFocus(place, () =>
    setChildren(
      place,
      quality &&
        bound(quality.isProven ? "circle-check" : "info", false, h("strong", {}, quality.words), " ", quality.detail),
      proof,
      separation && bound(separation.isFault ? "triangle-alert" : "replace", separation.isFault, separation.words),
      isLost &&
        bound(
          "triangle-alert",
          true,
          t("On link loss:"),
          " ",
          checkText(linkState, plan),
          h("button", { type: "button", class: "text-button", onclick: showLostLink }, t("Show")),
        ),
      locked > 0 &&
        h(
          "span",
          { class: "plan-wish" },
          icon("lock", "small"),
          h("span", {}, isCurrent ? wishWordsOf(plan.result) : t("Change not planned yet.")),
          canPlan && [
            !isCurrent && h("button", { type: "button", class: "text-button", onclick: actions.plan }, t("Plan again")),
            h("button", { type: "button", class: "text-button", onclick: actions.unlockAll }, t("Unlock all")),
          ],
        ),
    ),
  );
}

/** @param {PlanProof} proof */
const progressWords = ({ progress }) =>
  t("Looking for a better plan … {percent}", { percent: percentText(progress * 100) });

/**
 * Draw what a proof tells. Its progress, which changes every second, leaves the button beside it in place.
 *
 * @param {MissionPageState} state
 * @param {Parameters<typeof drawQuality>[2]} how
 */
export function drawProof(state, how) {
  const { plan, proof } = state;
  if (!plan) return;
  const running = byId("plan-quality").querySelector(".proof-progress");
  if (running && proof?.job && !proof.isOver && !proof.isStopping && !proof.better)
    running.textContent = progressWords(proof);
  else drawQuality(state, plan, how);
}

/**
 * That a better plan is looked for, or was found; null where the plan stays as it is.
 *
 * @param {MissionPageState} state
 * @param {boolean} isProven
 * @param {MissionActions} actions
 */
function proofOf({ proof }, isProven, actions) {
  if (proof?.better)
    return bound(
      "circle-check",
      false,
      t("A better plan was found: {difference}.", { difference: proof.words }),
      " ",
      h("button", { type: "button", class: "text-button", onclick: actions.showBetterPlan }, t("Show it")),
    );
  if (!proof?.job) return null;
  if (proof.isOver)
    return isProven || !proof.isFinished ? null : bound("search", false, t("No better plan was found."));
  if (proof.isStopping) return null;
  return bound(
    "search",
    false,
    h("span", { class: "proof-progress" }, progressWords(proof)),
    " ",
    h("button", { type: "button", class: "text-button", onclick: actions.stopProof }, t("Stop")),
  );
}

function showLostLink() {
  const place = byId("lost-link");
  const scroll = place.closest(".side-scroll"); // alone: scrollIntoView would move what must not scroll
  scroll?.scrollBy({ top: place.getBoundingClientRect().top - scroll.getBoundingClientRect().top });
  /** @type {HTMLElement | null} */ (place.querySelector(".link-failures button"))?.focus({ preventScroll: true });
}
