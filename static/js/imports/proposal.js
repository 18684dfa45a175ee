/** One import: the sentence first, then why it was refused or its changes, and the decision. */

import { byId, h, icon, setChildren } from "../dom.js";
import { open as openDialog } from "../page/keyboard.js";
import { t, tn } from "../text.js";
import { coordinateText, numberText, whenText } from "../units.js";
import { columnMapping } from "./column_mapping.js";
import { jobLine } from "./job_line.js";
import { stateChip, titleOf } from "./list.js";
import { notRead } from "./not_read.js";
import { otherSystem } from "./other_system.js";
import { regionChoice } from "./region_choice.js";
import { whereNext } from "./where_next.js";
import {
  differenceSentence,
  isOpen,
  KINDS,
  notesOf,
  ORIGINS,
  sizeText,
  summaryLines,
  terrainSentence,
  touched,
} from "./words.js";

/** @import { ZoneSetVersion } from "../api_types.d.ts" */
/** @import { Child } from "../dom.js" */
/** @import { Store } from "../store.js" */
/** @import { ImportsState, Proposal, ProposalActs } from "./types.d.ts" */

const MAX_LISTED = 2_000; // of each action; the numbers are of all

/** @param {Store<ImportsState>} store @param {ProposalActs} acts */
export const mountProposal = (store, acts) => new ProposalPanel(store, acts);

class ProposalPanel {
  #acts;
  #panel = byId("proposal");
  #foot = byId("proposal-foot");
  #drawn = "";
  /** @type {ReturnType<typeof jobLine> | null} */
  #line = null;
  #overwrites = false;
  /** places in the file of records that are not read @type {Set<string>} */
  #seen = new Set();

  /** @param {Store<ImportsState>} store @param {ProposalActs} acts */
  constructor(store, acts) {
    this.#acts = acts;
    store.listen(["current", "busy"], ({ current, busy }) => this.#show(current, busy));
    store.listen(["excluded"], ({ current, busy }) => current && this.#drawDecision(current, busy));
  }

  /** @param {Proposal | null} current @param {string | null} busy */
  #show(current, busy) {
    byId("imports-home").hidden = current !== null;
    document.title = `${current ? `${titleOf(current)} · ` : ""}${t("Imports")} · Spanwise`;
    for (const part of [this.#panel, this.#foot, byId("changes-panel")]) part.hidden = current === null;
    if (!current) {
      this.#drawn = "";
      this.#panel.replaceChildren();
      return;
    }
    const { job, ...rest } = current;
    const shape = JSON.stringify([rest, busy, job?.id, isOpen(current) ? 0 : job?.message]);
    if (shape !== this.#drawn) {
      if (JSON.parse(this.#drawn || "[{}]")[0].id !== current.id) {
        this.#overwrites = false;
        this.#seen = new Set();
      }
      this.#drawn = shape;
      this.#draw(current, busy);
    }
    this.#line?.refresh(job);
  }

  /** @param {Proposal} proposal @param {string | null} busy */
  #draw(proposal, busy) {
    const { state, kind } = proposal;
    const focused = this.#panel.querySelector(":focus")?.id;
    const what = state === "reading" ? t("Reading") : t("Applying");
    this.#line = isOpen(proposal) ? jobLine(what, () => this.#acts.cancel(proposal)) : null;
    setChildren(this.#panel, head(proposal, this.#acts), this.#body(proposal));
    byId("changes-panel").hidden = kind === "terrain" || !["ready", "applying", "applied"].includes(state);
    this.#drawDecision(proposal, busy);
    if (focused) document.getElementById(focused)?.focus();
  }

  /** @param {Proposal} proposal @param {string | null} busy */
  #drawDecision(proposal, busy) {
    setChildren(this.#foot, this.#decision(proposal, busy));
    this.#foot.hidden = this.#foot.children.length === 0;
  }

  /** @param {Proposal} proposal @returns {Child} */
  #body(proposal) {
    const { kind, state, difference, summary, job } = proposal;
    const { readAgain } = this.#acts;
    if (state === "refused") {
      return [refusal(proposal, this.#acts), otherSystem(proposal, readAgain) ?? leaveOut(proposal, readAgain)];
    }
    const isNew = job?.message && state === "ready" && job.state === "done" && job.why[0]?.code !== "file_read";
    const isDecided = state === "ready" || state === "applied" || state === "applying";
    const sentence = { class: "import-sentence", id: "import-sentence", role: "status" };
    return [
      this.#line?.element,
      isNew && h("div", { class: "notice warning" }, icon("triangle-alert"), h("p", {}, job.message)),
      isDecided && h("p", sentence, sentenceOf(proposal)),
      heldBack(proposal),
      difference.unchanged > 0 &&
        state !== "discarded" &&
        h("p", { class: "caption" }, tn(difference.unchanged, "{count} is as it was.", "{count} are as they were.")),
      Boolean(summary.external_ids) &&
        h(
          "p",
          { class: "caption" },
          tn(summary.external_ids ?? 0, "{count} external id given", "{count} external ids given"),
        ),
      notesOf(summary).map((note) => h("p", { class: "caption" }, note)),
      kind === "assets" && Array.isArray(summary.columns) && columnMapping(proposal, readAgain),
      regionChoice(proposal, readAgain),
      this.#overwriteChoice(proposal),
      this.#notRead(proposal),
      facts(proposal),
      Boolean(proposal.parameters.excluded?.length) &&
        h(
          "p",
          { class: "caption" },
          tn(
            proposal.parameters.excluded?.length ?? 0,
            "{count} change was left out.",
            "{count} changes were left out.",
          ),
        ),
      state === "applied" && whereNext(proposal),
      state === "applied" &&
        ["osm", "assets"].includes(kind) &&
        !proposal.parameters.undo &&
        h(
          "button",
          { type: "button", class: "button", id: "undo-import", onclick: () => this.#acts.undo(proposal) },
          icon("undo-2", "small"),
          t("Undo this import"),
        ),
      kind === "zones" && state === "applied" && summary.set && versions(summary.set, this.#acts),
      Object.values(difference).some((count) => count > MAX_LISTED) &&
        h("p", { class: "caption" }, t("Showing the first {count} per group.", { count: numberText(MAX_LISTED) })),
    ];
  }

  /** @param {Proposal} proposal */
  #overwriteChoice(proposal) {
    const kept = proposal.difference.kept ?? 0;
    if (proposal.state !== "ready" || !kept) return null;
    const box = h("input", { class: "check", type: "checkbox", id: "overwrite", checked: this.#overwrites });
    box.addEventListener("change", () => {
      this.#overwrites = box.checked;
      this.#drawDecision(proposal, null);
    });
    const words = t("Overwrite what was edited by hand ({count})", { count: numberText(kept) });
    return h("label", { class: "overwrite" }, box, h("span", {}, words));
  }

  /** Records with a fault: each is to be seen before the rest counts. @param {Proposal} proposal */
  #notRead(proposal) {
    const records = proposal.summary.not_read ?? [];
    const changed = () => this.#drawDecision(proposal, null);
    return notRead(records, { seen: proposal.state === "ready" ? this.#seen : null, changed, acts: this.#acts });
  }

  /** The buttons. @param {Proposal} proposal @param {string | null} busy */
  #decision(proposal, busy) {
    const { state, difference, summary, kind } = proposal;
    const discard = h(
      "button",
      { type: "button", class: "button", id: "discard", disabled: Boolean(busy), onclick: () => this.#acts.discard() },
      t("Discard"),
    );
    if (state === "refused") return [h("div", { class: "foot-buttons" }, discard)];
    if (state !== "ready") return [];
    const count = touched(difference, { overwrites: this.#overwrites }) - this.#acts.leftOut(this.#overwrites);
    const needsMapping = Boolean(summary.needs_mapping);
    const isIdle = needsMapping || (count === 0 && Object.keys(difference).length > 0 && !summary.external_ids);
    const unseen = (summary.not_read ?? []).filter(({ place }) => !this.#seen.has(place)).length;
    const isCounted = count > 0 && kind !== "terrain";
    const words = isCounted ? tn(count, "Apply {count} change", "Apply {count} changes") : t("Apply");
    const reason = needsMapping
      ? t("Say first what the columns are")
      : isIdle
        ? t("Nothing would change")
        : unseen
          ? tn(
              unseen,
              "{count} record that is not read is to be seen first",
              "{count} records that are not read are to be seen first",
            )
          : null;
    const apply = h(
      "button",
      {
        type: "button",
        class: needsMapping ? "button" : "button primary",
        id: "apply",
        disabled: isIdle || unseen > 0 || Boolean(busy),
        "aria-busy": String(busy === "apply"),
        title: reason,
      },
      busy === "apply" ? t("Applying") : words,
    );
    apply.addEventListener("click", () => {
      if (this.#overwrites) askToOverwrite(difference.kept, () => this.#acts.apply(true, [...this.#seen]));
      else this.#acts.apply(false, [...this.#seen]);
    });
    return [h("div", { class: "foot-buttons" }, discard, apply)];
  }
}

/** @param {number} kept manually edited rows @param {() => void} apply */
function askToOverwrite(kept, apply) {
  const question = tn(kept, "Overwrite {count} edit by hand?", "Overwrite {count} edits by hand?");
  const effect = tn(
    kept,
    "{count} row that was edited by hand is set to what the file says.",
    "{count} rows that were edited by hand are set to what the file says.",
  );
  const dialog = h(
    "dialog",
    { "aria-labelledby": "overwrite-title" },
    h("h2", { id: "overwrite-title" }, question),
    h("p", {}, effect, " ", t("The edits stay in the history, and can be brought back one by one.")),
    h(
      "form",
      { method: "dialog", class: "acts" },
      h("button", { class: "button", autofocus: true }, t("Keep the edits")),
      h("button", { class: "button danger filled", onclick: apply }, t("Overwrite and apply")),
    ),
  );
  openDialog(dialog);
}

/** @param {Proposal} proposal @param {ProposalActs["readAgain"]} readAgain */
function leaveOut({ kind, summary, parameters, size_bytes }, readAgain) {
  if (!summary.can_leave_out || parameters.leave_out_faulty || size_bytes === null) return null;
  const again = () => readAgain({ leave_out_faulty: true });
  return h(
    "button",
    { type: "button", class: "button", id: "leave-out", onclick: again },
    kind === "zones" ? t("Read again without the faulty records") : t("Read again without the faulty rows"),
  );
}

/** @param {Proposal} proposal */
function sentenceOf({ kind, state, difference, summary }) {
  if (kind === "terrain" && summary.vertical_datum) return terrainSentence(summary, difference);
  const sentence = Object.keys(difference).length ? differenceSentence(difference) : "";
  if (summary.needs_mapping) return summary.words || t("Say what the columns are.");
  return state === "ready" && !sentence ? t("Ready to be applied.") : sentence;
}

/** Who decided, and when. @param {Proposal} proposal */
function decidedText({ decided_by: name, decided_at, state }) {
  if (!name || !["applied", "discarded", "applying"].includes(state)) return "";
  const values = { name, when: decided_at && whenText(decided_at) };
  return state === "discarded" ? t("Discarded by {name}, {when}", values) : t("Applied by {name}, {when}", values);
}

/** @param {Proposal} proposal @param {ProposalActs} acts */
function head(proposal, acts) {
  const parts = [KINDS[proposal.kind].words, ORIGINS[proposal.origin], sizeText(proposal.size_bytes)].filter(Boolean);
  const who = [proposal.created_by, whenText(proposal.created_at)].filter(Boolean).join(", ");
  const decided = decidedText(proposal);
  const back = (/** @type {Event} */ event) => {
    event.preventDefault();
    acts.back();
  };
  return [
    h(
      "a",
      { class: "back", id: "back-to-imports", href: "/imports", onclick: back },
      icon("arrow-left", "small"),
      t("All imports"),
    ),
    h(
      "div",
      { class: "proposal-head" },
      h("h2", { id: "proposal-title", tabindex: "-1" }, titleOf(proposal)),
      stateChip(proposal),
    ),
    h("p", { class: "caption" }, `${parts.join(" · ")} · ${who}`),
    decided && h("p", { class: "caption" }, decided),
  ];
}

/** @param {Proposal} proposal @param {ProposalActs} acts */
function refusal({ faults }, acts) {
  const [first, ...rest] = faults.length
    ? faults
    : [{ place: "", message: t("The file could not be read."), position: null }];
  /** @param {Pick<Proposal["faults"][number], "place" | "message" | "position">} fault @param {boolean} isFirst */
  const faultLine = ({ place, message, position }, isFirst) => [
    h(isFirst ? "strong" : "span", {}, place ? `${place}: ${message}` : message),
    isFirst && ` ${t("Nothing was imported.")} `,
    position &&
      h(
        "button",
        {
          type: "button",
          class: "text-button",
          title: coordinateText(position),
          onclick: () => acts.place(position),
        },
        t("See the place"),
      ),
  ];
  return h(
    "div",
    {},
    h("div", { class: "notice critical", role: "alert" }, icon("octagon-alert"), h("p", {}, faultLine(first, true))),
    rest.length > 0 &&
      h(
        "ul",
        { class: "faults", "aria-label": t("Further faults") },
        rest.map((fault) => h("li", {}, faultLine(fault, false))),
      ),
  );
}

/** @param {Proposal} proposal */
function facts({ summary, provenance, state }) {
  if (state === "reading") return null;
  const { licence, attribution, source_address, fetched_at } = provenance;
  const lines = [
    ...summaryLines(summary),
    { words: t("licence"), value: licence },
    { words: t("attribution"), value: attribution },
    { words: t("address"), value: source_address },
    { words: t("fetched"), value: fetched_at && whenText(fetched_at) },
  ].filter(({ value }) => value);
  if (!lines.length) return null;
  return h(
    "details",
    { class: "import-facts" },
    h("summary", {}, t("File contents")),
    h(
      "dl",
      {},
      lines.map(({ words, value }) => h("div", {}, h("dt", {}, words), h("dd", {}, value))),
    ),
  );
}

/** Earlier states of a zone set, with a button that proposes each again. @param {string} setName @param {ProposalActs} acts */
function versions(setName, acts) {
  const list = h("ol", { class: "versions" });
  const details = h("details", { class: "import-facts" }, h("summary", {}, t("Roll the set back")), list);
  details.addEventListener("toggle", async () => {
    if (!details.open || list.children.length) return;
    const { set, rows } = await acts.versions(setName);
    if (!set || rows.length < 2) {
      list.replaceChildren(h("li", { class: "caption" }, t("There is no earlier version.")));
      return;
    }
    const row = (/** @type {ZoneSetVersion} */ version, /** @type {number} */ place) =>
      versionRow(version, place === 0 ? null : () => acts.rollBack(set, version.version));
    list.replaceChildren(...rows.map(row));
  });
  return details;
}

/** @param {ZoneSetVersion} version @param {(() => void) | null} rollBack null for the present one */
function versionRow({ version: number, zone_count, created_by, created_at }, rollBack) {
  const who = [created_by, whenText(created_at)].filter(Boolean).join(", ");
  const name = `${t("Version {number}", { number })}: ${tn(zone_count, "{count} zone", "{count} zones")}`;
  const button = { type: "button", class: "button", onclick: rollBack };
  return h(
    "li",
    {},
    h("span", {}, name, h("span", { class: "caption" }, who)),
    rollBack
      ? h("button", button, icon("rotate-ccw", "small"), t("Roll back"))
      : h("span", { class: "caption" }, t("now")),
  );
}

/** Why it was not applied automatically, although that was requested. @param {Proposal} proposal */
function heldBack({ state, held_back }) {
  if (state !== "ready" || !held_back.length) return null;
  const reasons = held_back.map(({ message }) => h("li", {}, message));
  const words = t("It was to be applied once it was read, and waits for you:");
  return h(
    "div",
    { class: "notice warning", id: "held-back" },
    icon("triangle-alert"),
    h("div", {}, h("p", {}, words), h("ul", {}, reasons)),
  );
}
