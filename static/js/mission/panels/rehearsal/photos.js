/** What the photos of a rehearsal show of each photographed target, beside what the plan promises. */

import { ApiError, isAbort } from "../../../api.js";
import { byId, h, icon, setChildren } from "../../../dom.js";
import { t } from "../../../text.js";
import { proofFaults, proofTable, readCoverage, shownOf } from "../../../view_plan/proof.js";
import { shareText } from "../../../view_plan/words.js";

/** @import { RehearsedCoverage, Shown, TargetCoverage } from "../../../api_types.d.ts" */
/** @import { MissionPageState, MissionStore } from "../../types.d.ts" */

const SHORT_SHARE = 0.02; // of what the plan can show: a target that shows less than promised by more is open

/** @param {MissionStore} store */
export function mountRehearsedPhotos(store) {
  const section = byId("rehearsal-photos");
  let key = ""; // of what is read or shown
  let reading = new AbortController();
  /** @type {TargetCoverage[] | null} */
  let targets = null;

  /** @param {MissionPageState} state */
  function draw({ rehearsal: { detail, run }, mission }) {
    const isPhotographed = mission?.targets.some(({ task }) => task?.views) ?? false;
    const isFlown = detail?.runs.some(({ level }) => level) ?? false;
    const wanted = mission && detail && isFlown && isPhotographed ? `${mission.id} ${detail.id} ${detail.state}` : "";
    if (wanted !== key) {
      key = wanted;
      targets = null;
      reading.abort();
      if (mission && detail && wanted) void read(mission.id, detail.id);
    }
    section.hidden = !wanted;
    if (wanted && targets) setChildren(section, title(), ...content(targets, run));
  }

  /** @param {string} mission @param {string} rehearsal */
  async function read(mission, rehearsal) {
    reading = new AbortController();
    const { signal } = reading;
    setChildren(section, title(), h("p", { class: "caption", role: "status" }, t("Computing coverage…")));
    try {
      const found = await readCoverage(mission, rehearsal, signal);
      if (signal.aborted) return;
      targets = found;
      draw(store.state);
    } catch (error) {
      if (isAbort(error)) return;
      if (!(error instanceof ApiError)) throw error;
      setChildren(section, title(), h("p", { class: "rehearsal-fault" }, error.message));
    }
  }

  store.listen(["rehearsal", "mission"], draw);
}

const title = () => h("h3", { class: "rehearsal-photos-title" }, t("Photos"));

/** @param {TargetCoverage[]} targets @param {number} run */
const content = (targets, run) =>
  targets.map((target) => {
    const rehearsed = target.rehearsed.find((one) => one.run === run);
    return target.promised && rehearsed
      ? targetPart(target, target.promised, rehearsed)
      : h("p", { class: "caption" }, `${target.target + 1} ${target.label}: ${t("no photos planned")}`);
  });

/** @param {TargetCoverage} target @param {Shown} promised @param {RehearsedCoverage} rehearsed */
function targetPart({ target, label }, promised, rehearsed) {
  const [before, after] = [shownOf(promised, promised), shownOf(promised, rehearsed)];
  const isShort = after < before - SHORT_SHARE;
  const words = t("{share} shown ({promised} promised)", { share: shareText(after), promised: shareText(before) });
  return h(
    "details",
    { class: "coverage-target", open: isShort },
    h(
      "summary",
      { class: isShort ? "short" : "whole" },
      icon(isShort ? "triangle-alert" : "circle-check", "small"),
      h("strong", {}, `${target + 1} ${label}`),
      h("span", { class: "caption" }, words),
      icon("chevron-down", "small"),
    ),
    proofTable(promised, [
      { words: t("Promised"), title: t("By the planned photos, of what a photo can show."), proof: promised },
      {
        words: t("Rehearsed"),
        title: t("By the photos of the rehearsal, from where they were taken."),
        proof: rehearsed,
      },
    ]),
    proofFaults(rehearsed, t("not taken in the rehearsal")),
  );
}
