/** The panel of rehearsals: conditions, progress, and the assessment by route and by target. Its content is marked as simulated. */

import { byId, h, refill } from "../../../dom.js";
import { t } from "../../../text.js";
import { percentText, whenText } from "../../../units.js";
import { whyNotRehearsed } from "../../flying/next_act.js";
import { isRunning, levelWords } from "../../rehearsal/rehearsal.js";
import { createAssessment } from "./assessment.js";
import { mountForm } from "./form.js";
import { mountRehearsedPhotos } from "./photos.js";

/** @import { Rehearsal, RehearsalDetail } from "../../../api_types.d.ts" */
/** @import { Binding } from "../../../page/keyboard.js" */
/** @import { createRehearsing } from "../../rehearsal/rehearsal_actions.js" */
/** @import { MissionActions, MissionPageState, MissionStore, RehearsalState } from "../../types.d.ts" */

/** @typedef {ReturnType<typeof createRehearsing>} Rehearsing */
/**
 * @typedef {object} RehearsalHow
 * @property {boolean} canRehearse of operators
 * @property {boolean} isFrozen
 * @property {boolean} isStage the page shows only it
 * @property {() => unknown} seeInSpace opens the 3D view
 * @property {MissionActions} actions
 * @property {boolean} canPlan the plan may be changed
 * @property {(positions: number[][]) => void} showPlaces on the map
 */

/** @param {string} name */
const place = (name) => byId(`rehearsal-${name}`);

/** @param {MissionStore} store @param {Rehearsing} rehearsing @param {RehearsalHow} how @returns {{ bindings: Binding[], begin: () => void }} */
export function mountRehearsal(store, rehearsing, how) {
  const { canRehearse, isFrozen, isStage } = how;
  const section = byId("rehearsal");
  const earlier = byId("rehearsal-list", HTMLSelectElement);
  const assessment = createAssessment(store, rehearsing, how);
  mountRehearsedPhotos(store);
  const form = canRehearse ? mountForm({ onStart: start, onChange: () => draw(store.state) }) : null;
  if (form) place("cancel").addEventListener("click", () => void rehearsing.cancel());
  const choice = form ? byId("rehearsal-choice", HTMLDetailsElement) : null;
  let isFolded = false; // once: the result comes first
  earlier.addEventListener("change", () => void rehearsing.show(earlier.value));

  function start() {
    if (!form || byId("rehearsal-start", HTMLButtonElement).disabled || !form.isValid()) return;
    const conditions = form.read();
    if (conditions.length) void rehearsing.start(conditions);
  }

  /** @param {MissionPageState} state */
  function draw(state) {
    const { rehearsal, mission, plan } = state;
    section.hidden = !isStage && (!mission || (!plan && !isFrozen && !rehearsal.list?.length));
    if (section.hidden) return;
    if (form) drawStart(state, form.read().length > 0);
    drawRunning(rehearsal);
    place("fault").hidden = !rehearsal.fault;
    place("fault").textContent = rehearsal.fault;
    drawEarlier(earlier, rehearsal.list ?? [], rehearsal.detail);
    const isKnown = Boolean(rehearsal.detail?.runs);
    place("assessment").hidden = !isKnown;
    place("empty").hidden = isKnown || rehearsal.list === null || rehearsal.list.some(isRunning);
    if (choice && isKnown && !isFolded) {
      isFolded = true;
      choice.open = choice.contains(document.activeElement);
    }
    assessment.draw(rehearsal, mission?.revision);
  }

  store.listen(
    ["rehearsal", "mission", "plan", "planIsStored", "selection", "name", "savedBasis", "saving", "planning"],
    draw,
  );
  if (!form) return { bindings: [], begin: () => {} };
  const toSection = () => {
    const scrolled = section.closest(".side-scroll"); // the page itself stays where it is
    if (scrolled) scrolled.scrollTop += section.getBoundingClientRect().top - scrolled.getBoundingClientRect().top;
  };
  const open = () => {
    if (section.hidden) return false;
    toSection();
    if (choice) choice.open = true;
    form.focus();
    return true;
  };
  return {
    bindings: [{ keys: ["r"], words: t("Rehearse: choose conditions"), act: open }],
    begin() {
      start();
      toSection();
    },
  };
}

/** @param {MissionPageState} state @param {boolean} hasConditions */
function drawStart(state, hasConditions) {
  const { running } = state.rehearsal;
  const reason = whyNotRehearsed(state) || (hasConditions ? "" : t("Choose at least one of the conditions."));
  const start = byId("rehearsal-start", HTMLButtonElement);
  const cancel = byId("rehearsal-cancel", HTMLButtonElement);
  start.disabled = Boolean(reason) || running !== null;
  start.hidden = running !== null;
  place("why-not").textContent = running ? "" : reason;
  cancel.hidden = running === null;
  cancel.disabled = !running?.id;
}

/** @param {RehearsalState} rehearsal */
function drawRunning({ running }) {
  place("job").hidden = running === null;
  if (!running) return;
  const share = running.progress ?? 0;
  const bar = place("progress");
  place("what").textContent = running.message;
  place("how-far").textContent = running.progress === null ? "" : percentText(share * 100);
  bar.setAttribute("aria-valuenow", `${Math.round(share * 100)}`);
  /** @type {HTMLElement} */ (bar.firstElementChild).style.width = `${share * 100}%`;
}

/**
 * Draw the choice between several rehearsals.
 *
 * @param {HTMLSelectElement} select
 * @param {Rehearsal[]} list
 * @param {RehearsalDetail | null} detail
 */
function drawEarlier(select, list, detail) {
  place("earlier").hidden = list.length < 2;
  const key = JSON.stringify(list.map(({ id, state, level, is_outdated }) => [id, state, level, is_outdated]));
  refill(select, key, () =>
    list.map((one) =>
      h(
        "option",
        { value: one.id },
        [
          whenText(one.created_at),
          one.is_outdated ? t("out of date") : isRunning(one) ? t("under way") : levelWords(one.level),
          one.runs.map(({ words }) => words).join(", "),
        ].join(" · "),
      ),
    ),
  );
  if (detail && document.activeElement !== select) select.value = detail.id;
}
