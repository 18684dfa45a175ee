/** The list of imports, newest first. */

import { byId, h, icon, keyedList } from "../dom.js";
import { t } from "../text.js";
import { percentText, whenText } from "../units.js";
import { differenceSentence, isOpen, KINDS, ORIGINS, STATES, terrainSentence } from "./words.js";

/** @import { Store } from "../store.js" */
/** @import { ImportsState, Proposal } from "./types.d.ts" */

/** @param {Store<ImportsState>} store @param {{ open: (id: string) => void, more: () => void }} acts */
export function mountList(store, acts) {
  const list = byId("imports");
  const draw = keyedList(
    list,
    (/** @type {Proposal} */ proposal) => proposal.id,
    (proposal) => {
      const row = h("li", {});
      const link = h("a", { class: "import-row", href: `/imports/${proposal.id}` });
      link.addEventListener("click", (event) => {
        if (event.metaKey || event.ctrlKey || event.shiftKey || event.button) return;
        event.preventDefault();
        acts.open(proposal.id);
      });
      row.append(link);
      return row;
    },
    (row, proposal) => {
      const seen = JSON.stringify(proposal);
      if (row.dataset.seen === seen) return;
      row.dataset.seen = seen;
      row.firstElementChild?.replaceChildren(...content(proposal));
    },
  );

  store.listen(["proposals", "next"], ({ proposals, next }) => {
    if (proposals === null) return;
    draw(proposals);
    list.hidden = proposals.length === 0;
    byId("no-imports").hidden = proposals.length > 0;
    byId("more-imports").hidden = next === null;
  });
  byId("more-imports").addEventListener("click", acts.more);
}

/** @param {Pick<Proposal, "state">} proposal */
export function stateChip({ state }) {
  const { words, icon: name, chip } = STATES[state];
  return h("span", { class: `chip ${chip}`.trim() }, icon(name), words);
}

/** @param {Proposal} proposal */
function content(proposal) {
  return [
    h("span", { class: "import-kind", title: KINDS[proposal.kind].words }, icon(KINDS[proposal.kind].icon)),
    h("strong", {}, titleOf(proposal)),
    stateChip(proposal),
    h("span", { class: "caption" }, secondLine(proposal)),
  ];
}

/** @param {Pick<Proposal, "file_name" | "kind" | "origin">} proposal */
export const titleOf = (proposal) =>
  proposal.file_name || `${KINDS[proposal.kind].words} ${ORIGINS[proposal.origin]}`.trim();

/** @param {Proposal} proposal */
function whatOf({ kind, summary, difference }) {
  const sentence =
    kind === "terrain" && summary.vertical_datum ? terrainSentence(summary, {}) : differenceSentence(difference);
  return summary.needs_mapping ? t("Columns to be explained") : sentence.replace(/\.$/, "");
}

/** Its progress, or its result. @param {Proposal} proposal */
function progressOf(proposal) {
  const { state, job, faults } = proposal;
  if (isOpen(proposal)) return job?.state === "running" ? percentText(job.progress * 100) : t("waiting");
  if (state === "refused") return faults[0]?.message ?? "";
  return state === "discarded" ? "" : whatOf(proposal);
}

/** @param {Proposal} proposal */
function secondLine(proposal) {
  const who = proposal.decided_by ?? proposal.created_by;
  const when = whenText(proposal.decided_at ?? proposal.created_at);
  return [progressOf(proposal), [isOpen(proposal) ? "" : who, when].filter(Boolean).join(", ")]
    .filter(Boolean)
    .join(" · ");
}
