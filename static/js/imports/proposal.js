/** One import: the sentence first, then why it was refused or what it would change, and the decision. */

import { byId, h, icon } from "../dom.js";
import { open as openDialog } from "../page/keyboard.js";
import { t, tn } from "../text.js";
import { coordinateText, countText, numberText, whenText } from "../units.js";
import { columnMapping } from "./column_mapping.js";
import { jobLine } from "./job_line.js";
import { stateChip, titleOf } from "./list.js";
import { otherSystem } from "./other_system.js";
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

const MOST_LISTED = 2_000; // of each action; the numbers are of all

/** acts: { back(), cancel(proposal), apply(overwrites), discard(), readAgain(parameters), place(position), versions(name), rollBack(set, version) } */
export function mountProposal(store, acts) {
  const panel = byId("proposal");
  const foot = byId("proposal-foot");
  let drawn = "";
  let line = null;
  let overwrites = false;

  store.listen(["current", "busy"], ({ current, busy }) => {
    byId("imports-home").hidden = current !== null;
    document.title = `${current ? `${titleOf(current)} · ` : ""}${t("Imports")} · Spanwise`;
    panel.hidden = foot.hidden = byId("changes-panel").hidden = current === null;
    if (!current) {
      drawn = "";
      panel.replaceChildren();
      return;
    }
    const { job, ...rest } = current;
    const shape = JSON.stringify([rest, busy, job?.id, isOpen(current) ? 0 : job?.message]);
    if (shape !== drawn) {
      if (JSON.parse(drawn || "[{}]")[0].id !== current.id) overwrites = false;
      drawn = shape;
      draw(current, busy);
    }
    line?.refresh(job);
  });

  function draw(proposal, busy) {
    const hadFocus = panel.contains(document.activeElement) && document.activeElement.id;
    line = isOpen(proposal)
      ? jobLine(proposal.state === "reading" ? t("Reading") : t("Applying"), () => acts.cancel(proposal))
      : null;
    panel.replaceChildren(...head(proposal, acts), ...body(proposal).filter(Boolean));
    byId("changes-panel").hidden =
      proposal.kind === "terrain" || !["ready", "applying", "applied"].includes(proposal.state);
    foot.replaceChildren(...decision(proposal, busy));
    foot.hidden = foot.children.length === 0;
    if (hadFocus) document.getElementById(hadFocus)?.focus();
  }

  function body(proposal) {
    const { state, difference, summary, job } = proposal;
    if (state === "refused")
      return [refusal(proposal, acts), otherSystem(proposal, acts.readAgain) ?? leaveOut(proposal)];
    const isNew = job?.message && state === "ready" && job.state === "done" && job.message !== "Read";
    return [
      line?.element,
      isNew && h("div", { class: "notice warning" }, icon("triangle-alert"), h("p", {}, job.message)),
      state === "ready" || state === "applied" || state === "applying"
        ? h("p", { class: "import-sentence", id: "import-sentence", role: "status" }, sentenceOf(proposal))
        : null,
      difference.unchanged > 0 &&
        state !== "discarded" &&
        h("p", { class: "caption" }, tn(difference.unchanged, "{count} is as it was.", "{count} are as they were.")),
      ...notesOf(summary).map((note) => h("p", { class: "caption" }, note)),
      mapping(proposal),
      regionChoice(proposal),
      overwriteChoice(proposal),
      facts(proposal),
      proposal.kind === "zones" && state === "applied" && typeof summary.set === "string"
        ? versions(summary.set, acts)
        : null,
      Object.values(difference).some((count) => count > MOST_LISTED) &&
        h("p", { class: "caption" }, t("Below are the first {count} of each.", { count: numberText(MOST_LISTED) })),
    ];
  }

  function mapping(proposal) {
    if (proposal.kind !== "assets" || !Array.isArray(proposal.summary.columns)) return null;
    return columnMapping(proposal, (parameters) => acts.readAgain(parameters));
  }

  function leaveOut({ kind, faults, parameters, size_bytes }) {
    if (kind !== "assets" || parameters.leave_out_faulty || size_bytes === null || !faults.length) return null;
    const again = () => acts.readAgain({ leave_out_faulty: true });
    return h(
      "button",
      { type: "button", class: "button", id: "leave-out", onclick: again },
      t("Read again without the faulty rows"),
    );
  }

  /** Another difference: the file is read again for it. */
  function regionChoice({ kind, state, parameters }) {
    if (kind !== "osm" || state !== "ready") return null;
    const box = h("input", {
      class: "check",
      type: "checkbox",
      id: "replace-region",
      checked: Boolean(parameters.replace_region),
    });
    box.addEventListener("change", () => acts.readAgain({ replace_region: box.checked }));
    return h(
      "label",
      {
        class: "overwrite",
        title: t("Also what another file brought in vanishes where this one covers the ground and does not have it"),
      },
      box,
      h("span", {}, t("Replace the whole region with this file")),
    );
  }

  function overwriteChoice(proposal) {
    const kept = proposal.difference.kept ?? 0;
    if (proposal.state !== "ready" || !kept) return null;
    const box = h("input", { class: "check", type: "checkbox", id: "overwrite", checked: overwrites });
    box.addEventListener("change", () => {
      overwrites = box.checked;
      foot.replaceChildren(...decision(proposal, null));
    });
    return h(
      "label",
      { class: "overwrite" },
      box,
      h("span", {}, t("Overwrite what was edited by hand ({count})", { count: numberText(kept) })),
    );
  }

  function decision(proposal, busy) {
    if (proposal.state === "refused") return [h("div", { class: "foot-buttons" }, discard(busy))];
    if (proposal.state !== "ready") return [];
    const count = touched(proposal.difference, { overwrites });
    const needsMapping = Boolean(proposal.summary.needs_mapping);
    const isIdle = needsMapping || (count === 0 && Object.keys(proposal.difference).length > 0);
    const words =
      busy === "apply"
        ? t("Applying")
        : count && proposal.kind !== "terrain"
          ? tn(count, "Apply {count} change", "Apply {count} changes")
          : t("Apply");
    const apply = h(
      "button",
      {
        type: "button",
        class: needsMapping ? "button" : "button primary",
        id: "apply",
        disabled: isIdle || Boolean(busy),
        "aria-busy": String(busy === "apply"),
        title: needsMapping ? t("Say first what the columns are") : isIdle ? t("Nothing would change") : null,
      },
      words,
    );
    apply.addEventListener("click", () => (overwrites ? askFirst(proposal) : acts.apply(false)));
    return [h("div", { class: "foot-buttons" }, discard(busy), apply)];
  }

  function discard(busy) {
    return h(
      "button",
      { type: "button", class: "button", id: "discard", disabled: Boolean(busy), onclick: () => acts.discard() },
      t("Discard"),
    );
  }

  function askFirst(proposal) {
    const kept = proposal.difference.kept;
    const dialog = h(
      "dialog",
      { "aria-labelledby": "overwrite-title" },
      h(
        "h2",
        { id: "overwrite-title" },
        tn(kept, "Overwrite {count} edit by hand?", "Overwrite {count} edits by hand?"),
      ),
      h(
        "p",
        {},
        `${tn(kept, "{count} row that was edited by hand is set to what the file says.", "{count} rows that were edited by hand are set to what the file says.")} ${t("The edits stay in the history, and can be brought back one by one.")}`,
      ),
      h(
        "form",
        { method: "dialog", class: "acts" },
        h("button", { class: "button", autofocus: true }, t("Keep the edits")),
        h("button", { class: "button danger filled", onclick: () => acts.apply(true) }, t("Overwrite and apply")),
      ),
    );
    openDialog(dialog);
  }

  return { forgetOverwrite: () => (overwrites = false) };
}

function sentenceOf({ kind, state, difference, summary }) {
  if (kind === "terrain" && summary.vertical_datum) return terrainSentence(summary, difference);
  const sentence = Object.keys(difference).length ? differenceSentence(difference) : "";
  if (summary.needs_mapping) return summary.words || t("Say what the columns are.");
  return state === "ready" && !sentence ? t("Ready to be applied.") : sentence;
}

function head(proposal, acts) {
  const parts = [KINDS[proposal.kind].words, ORIGINS[proposal.origin], sizeText(proposal.size_bytes)].filter(Boolean);
  const who = [proposal.created_by, whenText(proposal.created_at)].filter(Boolean).join(", ");
  const decision = { name: proposal.decided_by, when: proposal.decided_at && whenText(proposal.decided_at) };
  const decided =
    proposal.decided_by && ["applied", "discarded", "applying"].includes(proposal.state)
      ? proposal.state === "discarded"
        ? t("Discarded by {name}, {when}", decision)
        : t("Applied by {name}, {when}", decision)
      : "";
  return [
    h(
      "a",
      {
        class: "back",
        id: "back-to-imports",
        href: "/imports",
        onclick: (event) => (event.preventDefault(), acts.back()),
      },
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
  ].filter(Boolean);
}

function refusal({ faults }, acts) {
  const [first, ...rest] = faults.length
    ? faults
    : [{ place: "", message: t("The file could not be read."), position: null }];
  const said = (fault, isFirst) => [
    h(isFirst ? "strong" : "span", {}, fault.place ? `${fault.place}: ${fault.message}` : fault.message),
    isFirst && ` ${t("Nothing was imported.")} `,
    fault.position &&
      h(
        "button",
        {
          type: "button",
          class: "text-button",
          title: coordinateText(fault.position),
          onclick: () => acts.place(fault.position),
        },
        t("See the place"),
      ),
  ];
  return h(
    "div",
    {},
    h("div", { class: "notice critical", role: "alert" }, icon("octagon-alert"), h("p", {}, said(first, true))),
    rest.length > 0 &&
      h(
        "ul",
        { class: "faults", "aria-label": t("Further faults") },
        rest.map((fault) => h("li", {}, said(fault, false))),
      ),
  );
}

function facts({ summary, provenance, state }) {
  if (state === "reading") return null;
  const lines = [
    ...summaryLines(summary),
    ...[
      ["licence", t("licence")],
      ["attribution", t("attribution")],
      ["source_address", t("address")],
    ]
      .filter(([name]) => provenance[name])
      .map(([name, words]) => ({ words, value: provenance[name] })),
    ...(provenance.fetched_at ? [{ words: t("fetched"), value: whenText(provenance.fetched_at) }] : []),
  ];
  if (!lines.length) return null;
  return h(
    "details",
    { class: "import-facts" },
    h("summary", {}, t("What is in the file")),
    h(
      "dl",
      {},
      lines.map(({ words, value }) => h("div", {}, h("dt", {}, words), h("dd", {}, value))),
    ),
  );
}

/** Earlier states of a zone set, each one press away from being proposed again. */
function versions(setName, acts) {
  const list = h("ol", { class: "versions" });
  const details = h("details", { class: "import-facts" }, h("summary", {}, t("Roll the set back")), list);
  details.addEventListener("toggle", async () => {
    if (!details.open || list.children.length) return;
    const { set, rows } = await acts.versions(setName);
    if (rows.length < 2) return list.replaceChildren(h("li", { class: "caption" }, t("There is no earlier version.")));
    list.replaceChildren(
      ...rows.map((row, place) =>
        h(
          "li",
          {},
          h(
            "span",
            {},
            `${t("Version {number}", { number: row.version })}: ${countText(row.zone_count, "zone")}`,
            h("span", { class: "caption" }, [row.created_by, whenText(row.created_at)].filter(Boolean).join(", ")),
          ),
          place === 0
            ? h("span", { class: "caption" }, t("now"))
            : h(
                "button",
                { type: "button", class: "button", onclick: () => acts.rollBack(set, row.version) },
                icon("rotate-ccw", "small"),
                t("Roll back"),
              ),
        ),
      ),
    );
  });
  return details;
}
