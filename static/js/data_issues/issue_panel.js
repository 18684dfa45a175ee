/** The dock: the chosen issue in one sentence, its facts, and its acts. */

import { byId, h, icon, setChildren } from "../dom.js";
import { t, tn } from "../text.js";
import { coordinateText, whenText } from "../units.js";
import { cautionOf, dismissWords, factsOf } from "./kinds.js";

/** @import { Collection, DataIssue, DataIssueOffer } from "./types.d.ts" */

const MAX_NOTE_LENGTH = 500;

/**
 * Handlers of the panel's acts, which are offered to curators.
 *
 * @typedef {object} PanelHandlers
 * @property {(body: Record<string, unknown> & { action: string }) => void} repair
 * @property {(note: string) => void} dismiss
 * @property {() => void} reopen
 * @property {(collection: Collection | null) => void} preview
 * @property {(notify: (count: number) => void) => void} place begins to take places from the map and reports their count
 * @property {(offer: DataIssueOffer) => void} placeDone
 * @property {() => void} placeBack
 * @property {() => void} placeCancel
 * @property {() => void} next
 * @property {() => void} close
 */

/** @param {boolean} canCurate @param {PanelHandlers} on */
export const mountIssuePanel = (canCurate, on) => new DataIssuePanel(canCurate, on);

class DataIssuePanel {
  #canCurate;
  #on;
  #dock = byId("dock");
  #panel = byId("issue-panel");
  #acts = h("div", { class: "issue-acts" });
  #fault = h("p", { class: "field-error", role: "alert" });
  #drawn = ""; // the issue as it is shown
  /** The form of a note, with the issue's id: it outlives a new drawing of the issue. @type {{ id: number, form: HTMLElement } | null} */
  #noting = null;

  /** @param {boolean} canCurate @param {PanelHandlers} on */
  constructor(canCurate, on) {
    this.#canCurate = canCurate;
    this.#on = on;
  }

  /** @param {DataIssue | null} issue */
  show(issue) {
    this.#dock.hidden = !issue;
    this.#drawn = JSON.stringify(issue);
    if (issue?.id !== this.#noting?.id || issue?.properties.state !== "open") this.#noting = null;
    if (!issue) {
      this.#panel.replaceChildren();
      return;
    }
    const words = t("Close");
    const close = {
      class: "icon-button tight issue-close",
      type: "button",
      "aria-label": words,
      onclick: this.#on.close,
    };
    this.fault("");
    setChildren(this.#acts, this.#actsOf(issue));
    setChildren(
      this.#panel,
      wordsOf(issue.properties),
      h("div", { class: "issue-do" }, this.#acts, this.#fault),
      h("button", { ...close, title: t("Close (Esc)") }, icon("x")),
    );
  }

  /** Update the same issue without interrupting an act in the panel. @param {DataIssue} issue */
  refresh(issue) {
    if (JSON.stringify(issue) === this.#drawn) return;
    const { activeElement } = document;
    const focused = activeElement instanceof HTMLElement && this.#panel.contains(activeElement) ? activeElement : null;
    this.show(issue);
    if (focused?.isConnected) focused.focus();
  }

  /** @param {boolean} isBusy */
  busy(isBusy) {
    this.#panel.setAttribute("aria-busy", String(isBusy));
    for (const button of this.#acts.querySelectorAll("button")) button.setAttribute("aria-disabled", String(isBusy));
  }

  /** @param {string} sentence "" clears it */
  fault(sentence) {
    setChildren(this.#fault, sentence && [icon("circle-alert"), sentence]);
  }

  /** @param {DataIssue} issue @returns {(Node | null)[]} */
  #actsOf(issue) {
    const { repairs, state } = issue.properties;
    if (!this.#canCurate) return [h("p", { class: "caption" }, state === "open" ? t("Curators can repair this.") : "")];
    const next = h("button", { class: "button primary", type: "button", onclick: this.#on.next }, t("Next issue"));
    const reopen = { class: "button", type: "button", onclick: this.#on.reopen };
    if (state === "dismissed") return [next, h("button", reopen, icon("undo-2"), t("Open it again"))];
    if (state === "repaired") return [next];
    return [...repairs.flatMap((offer, index) => this.#offerActs(offer, index === 0)), this.#dismissAct(issue)];
  }

  /** @param {DataIssueOffer} offer @param {boolean} isFirst @returns {(HTMLElement | null)[]} */
  #offerActs(offer, isFirst) {
    if (offer.parameter === "way") return [this.#choiceOf(offer)];
    const { refused, preview, action } = offer;
    const style = isFirst ? "button primary" : "button";
    const how = { class: style, type: "button", disabled: Boolean(refused), title: refused || null };
    const act = h("button", { ...how, onclick: () => this.#on.repair({ action }) }, offer.words);
    if (preview) {
      for (const come of ["pointerenter", "focus"]) act.addEventListener(come, () => this.#on.preview(preview));
      for (const go of ["pointerleave", "blur"]) act.addEventListener(go, () => this.#on.preview(null));
    }
    if (offer.parameter === "voltages_v")
      return [offer.choices.length ? act : null, this.#voltageForm(offer, !offer.choices.length)];
    if (offer.parameter !== "positions") return [act];
    const place = () => {
      this.#on.place((count) => this.#placing(offer, count));
      this.#placing(offer, 0);
    };
    const placing = { class: "button", type: "button", onclick: place };
    return [act, h("button", placing, icon("map-pin"), t("Place them on the map"))];
  }

  /** @param {DataIssueOffer} offer */
  #choiceOf({ action, parameter, choices, words: question }) {
    const buttons = choices.map(({ value, words }) => {
      const act = () => this.#on.repair({ action, [parameter]: value });
      return h("button", { class: "button", type: "button", onclick: act }, words);
    });
    return h(
      "div",
      { class: "issue-choice", role: "group", "aria-label": question },
      h("span", { class: "field-label" }, question),
      buttons,
    );
  }

  /** @param {DataIssueOffer} offer @param {boolean} isFirst */
  #voltageForm({ action }, isFirst) {
    const input = h("input", {
      class: "input",
      id: "issue-volts",
      inputmode: "decimal",
      placeholder: "110, 20",
      autocomplete: "off",
      required: true,
    });
    const submit = (/** @type {Event} */ event) => {
      event.preventDefault();
      const parts = input.value.split(/[,;\s]+/).filter(Boolean);
      const kilovolts = parts.map(Number);
      if (!kilovolts.length || kilovolts.some((value) => !(value > 0)))
        this.fault(t("Give one voltage or several in kV, with commas."));
      else this.#on.repair({ action, voltages_v: kilovolts.map((value) => Math.round(value * 1000)) });
    };
    return h(
      "form",
      { class: "issue-form", onsubmit: submit },
      h("label", { for: "issue-volts" }, t("Voltage")),
      h("span", { class: "with-unit" }, input, h("span", { class: "unit" }, "kV")),
      h("button", { class: isFirst ? "button primary" : "button" }, t("Set")),
    );
  }

  /** @param {DataIssue} issue */
  #dismissAct({ id, properties }) {
    if (this.#noting) return this.#noting.form;
    const opener = h("button", { class: "button quiet", type: "button" }, dismissWords(properties.kind));
    opener.addEventListener("click", () => this.#note(id, opener));
    return opener;
  }

  /** Asks for a note in the place of the button that opened it. @param {number} id @param {HTMLElement} opener */
  #note(id, opener) {
    const note = h("input", {
      class: "input",
      id: "issue-note",
      maxlength: MAX_NOTE_LENGTH,
      placeholder: t("Why it is right"),
      "aria-label": t("Note"),
      autocomplete: "off",
    });
    const submit = (/** @type {Event} */ event) => {
      event.preventDefault();
      this.#on.dismiss(note.value.trim());
    };
    const cancel = () => {
      this.#noting = null;
      form.replaceWith(opener);
      opener.focus();
    };
    /** @type {HTMLFormElement} */
    const form = h(
      "form",
      { class: "issue-form", onsubmit: submit },
      note,
      h("button", { class: "button primary" }, t("Leave it")),
      h("button", { class: "button quiet", type: "button", onclick: cancel }, t("Cancel")),
    );
    this.#noting = { id, form };
    opener.replaceWith(form);
    note.focus();
  }

  /** Show the count of places that are clicked on the map. @param {DataIssueOffer} offer @param {number} count */
  #placing(offer, count) {
    this.#drawn = "";
    const words = count ? tn(count, "Place {count} tower", "Place {count} towers") : t("Click along the span");
    /** @param {string} kind @param {() => void} act @param {boolean} disabled */
    const how = (kind, act, disabled) => ({ class: kind, type: "button", disabled, onclick: act });
    setChildren(
      this.#acts,
      h(
        "button",
        how("button primary", () => this.#on.placeDone(offer), !count),
        words,
      ),
      h("button", how("button", this.#on.placeBack, !count), icon("undo-2"), t("Take one back")),
      h("button", how("button quiet", this.#on.placeCancel, false), t("Cancel")),
    );
  }
}

/** @param {DataIssue["properties"]} properties */
function wordsOf(properties) {
  const { state, sentence, position } = properties;
  const facts = [...factsOf(properties), [t("Place"), coordinateText(position)]];
  const caution = state === "open" ? cautionOf(properties) : "";
  const decided = () => [icon(state === "repaired" ? "circle-check" : "hand"), decidedWords(properties)];
  return h(
    "div",
    { class: "issue-words" },
    h("h2", { class: "issue-sentence" }, sentence),
    h("p", { class: "issue-assets" }, assetWords(properties)),
    h(
      "dl",
      { class: "issue-facts" },
      facts.map(([term, value]) => h("div", {}, h("dt", {}, term), h("dd", {}, value))),
    ),
    caution && h("p", { class: "caption" }, caution),
    state !== "open" && h("p", { class: "issue-decided" }, decided()),
  );
}

/** @param {DataIssue["properties"]} properties */
function assetWords({ asset, other_asset: other }) {
  return [asset, other]
    .flatMap((thing) => (thing ? [[thing.label, thing.detail].filter(Boolean).join(", ")] : []))
    .join(" · ");
}

/** @param {DataIssue["properties"]} properties */
function decidedWords({ state, decided_by: who, decided_at: when, note }) {
  const repaired = who ? t("Repaired by {name}", { name: who }) : t("No longer found");
  const dismissed = who ? t("Ignored by {name}", { name: who }) : t("Ignored");
  return `${state === "repaired" ? repaired : dismissed}${when ? `, ${whenText(when)}` : ""}${note ? `: ${note}` : ""}`;
}
