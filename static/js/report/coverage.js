/** What the photos of the mission achieved of what was promised and rehearsed, and planning what is missing. */

import { ApiError, isAbort, post } from "../api.js";
import { byId, h, icon, setChildren } from "../dom.js";
import { isOver } from "../record/sentence.js";
import { t, tn } from "../text.js";
import { missingText, proofFaults, proofTable, readCoverage, shownOf } from "../view_plan/proof.js";
import { shareText } from "../view_plan/words.js";

/** @import { Answer } from "../api.js" */
/** @import { Mission, MissionRecord, Shown, TargetCoverage } from "../api_types.d.ts" */
/** @import { Column } from "../view_plan/proof.js" */

/** @param {{ canPlan: boolean }} reader @returns {{ renew: (record: MissionRecord) => Promise<void> }} */
export function mountCoverage({ canPlan }) {
  const section = byId("report-coverage");
  const place = byId("report-coverage-body");
  let isReading = false;
  /** @type {boolean | null} whether the mission photographs any target; null: not known yet */
  let isPhotographed = null;
  /** @type {Set<number>} targets that were unfolded or folded by hand */
  const turned = new Set();

  /** @param {TargetCoverage[]} targets @param {MissionRecord} record */
  function draw(targets, record) {
    isPhotographed = targets.length > 0;
    section.hidden = !isPhotographed;
    byId("report-coverage-file").hidden = !isPhotographed;
    const short = targets.filter((target) => target.is_short);
    setChildren(
      place,
      ...targets.map((target) => targetPart(target, turned)),
      canPlan && isOver(record) && short.length > 0 && restPart(record.mission.id, short),
    );
  }

  return {
    async renew(record) {
      if (isReading || isPhotographed === false) return;
      isReading = true;
      try {
        draw(await readCoverage(record.mission.id), record);
      } catch (error) {
        if (isAbort(error)) return;
        if (!(error instanceof ApiError)) throw error;
        if (isPhotographed) setChildren(place, h("p", { class: "quiet-text", role: "status" }, error.message));
      } finally {
        isReading = false;
      }
    },
  };
}

/** @param {TargetCoverage} target @param {Shown} promised @returns {Column[]} */
function columnsOf({ rehearsed, achieved }, promised) {
  const runs = rehearsed.filter((run) => !run.is_outdated);
  const run = runs.find(({ code }) => code === "as-planned") ?? runs[0];
  return [
    { words: t("Promised"), title: t("By the planned photos, of what a photo can show."), proof: promised },
    ...(run
      ? [
          {
            words: t("Rehearsed"),
            title: t("By the photos of the rehearsal, from where they were taken."),
            proof: run,
          },
        ]
      : []),
    ...(achieved
      ? [
          {
            words: t("Achieved"),
            title: t("By the photos that UAVs reported, from where they were taken."),
            proof: achieved,
          },
        ]
      : []),
  ];
}

/** @param {TargetCoverage} target @param {Set<number>} turned */
function targetPart(target, turned) {
  const { target: number, label, promised, achieved, is_short: isShort } = target;
  if (!promised) return h("p", { class: "caption" }, `${number + 1} ${label}: ${t("no photos planned")}`);
  const before = shareText(shownOf(promised, promised));
  const words = achieved
    ? t("{share} shown ({promised} promised)", { share: shareText(shownOf(promised, achieved)), promised: before })
    : t("{share} promised", { share: before });
  const missing = missingText(target);
  const element = h(
    "details",
    { class: "coverage-target", open: Boolean(isShort) !== turned.has(number) },
    h(
      "summary",
      {
        class: achieved ? (isShort ? "short" : "whole") : "",
        onclick: () => (turned.has(number) ? turned.delete(number) : turned.add(number)),
      },
      icon(achieved ? (isShort ? "triangle-alert" : "circle-check") : "circle-dashed", "small"),
      h("strong", {}, `${number + 1} ${label}`),
      h("span", { class: "caption" }, words),
      icon("chevron-down", "small"),
    ),
    missing && h("p", { class: "coverage-missing" }, t("Missing: {components}.", { components: missing })),
    proofTable(promised, columnsOf(target, promised)),
    achieved && proofFaults(achieved, t("not reported")),
  );
  return element;
}

/** @type {string | null} */
let key = null; // of the request: the same until it is answered, so that there is one draft

/** @param {string} mission @param {TargetCoverage[]} short */
function restPart(mission, short) {
  const said = h("p", { class: "quiet-text", role: "status" });
  const button = h("button", { type: "button", class: "button" }, t("Plan the rest"));
  button.addEventListener("click", async () => {
    key ??= crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;
    button.disabled = true;
    said.textContent = "";
    try {
      const targets = short.map(({ target }) => target);
      const { data } = /** @type {Answer<Mission>} */ (
        await post(`/missions/${mission}/follow-up`, { targets }, { headers: { "Idempotency-Key": key } })
      );
      location.href = `/missions/${data.id}`;
    } catch (error) {
      const { status, message } = /** @type {ApiError} */ (error);
      if (status) key = null;
      said.textContent = `${t("No follow-up was made.")} ${message}`;
      button.disabled = false;
    }
  });
  return h(
    "div",
    { class: "coverage-rest" },
    h(
      "p",
      { class: "quiet-text" },
      tn(
        short.length,
        "{count} target shows less than promised. A new mission photographs it again.",
        "{count} targets show less than promised. A new mission photographs them again.",
      ),
    ),
    button,
    said,
  );
}
