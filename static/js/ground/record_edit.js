/** Drawing and editing of a record: shape and facts, kept in the browser until they are stored. Never overwrites another user's change. */

import { ApiError, patch, post } from "../api.js";
import { byId, h, icon, setChildren } from "../dom.js";
import { createDrawPanel } from "../draw/draw_panel.js";
import { createEditor } from "../draw/editor.js";
import { circleOf, empty, geometryOf, shapeOf } from "../draw/shape.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { whenText } from "../units.js";
import { askWhich } from "./conflict.js";
import { createDraft } from "./draft.js";
import { ifMatch } from "./record_view.js";

/** @import { Answer } from "../api.js" */
/** @import { GeometryCheckResult } from "../api_types.d.ts" */
/** @import { EditorState, Shape } from "../draw/types.d.ts" */
/** @import { MapLibreMap } from "../map/types.d.ts" */
/** @import { DrawnGeometry } from "../draw/shape.js" */
/** @import { Facts, KeptEdit, RecordFeature, RecordForm, RecordKind } from "./types.d.ts" */

const CHECK_AFTER_MS = 700;

/**
 * @template {RecordFeature} Feature
 * @typedef {object} EditHandlers
 * @property {number} userId whose draft it is
 * @property {() => void} opened called when an edit begins
 * @property {(position: number[]) => void} showPlace
 * @property {(id: number, how?: { stay?: boolean }) => Promise<void>} choose
 * @property {() => { feature: Feature, etag: string | null } | null} chosen
 * @property {() => void} forget clears the selection
 * @property {() => void} cancelled called when an edit without a chosen record is left
 * @property {() => void} back to the list
 * @property {() => Promise<void>} reload the list and the map
 */

/**
 * @template {RecordFeature} Feature
 * @typedef {object} Edit
 * @property {string} choice
 * @property {Feature | null} feature null for a new one
 * @property {string | null} etag
 * @property {RecordForm} form
 * @property {{ shape: string, facts: Facts }} began
 * @property {boolean} isKept in the browser
 * @property {boolean} isSaving
 * @property {{ text: string, key: string } | null} sent the last request to create it
 */

/** @param {Shape} shape */
const textOf = (shape) => JSON.stringify([geometryOf(shape) ?? shape.parts, circleOf(shape)]);

/** @param {string} message of the server */
const sentence = (message) => `${message[0].toUpperCase()}${message.slice(1)}.`;

/** @template {RecordFeature} Feature */
export class RecordEdit {
  #kind;
  #on;
  #draft;
  #panel;
  #element = byId("record-edit");
  #saveButton = byId("record-save");
  /** @type {Edit<Feature> | null} */
  #edit = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #checkTimer;

  /** @param {MapLibreMap} map @param {RecordKind<Feature, any>} kind @param {EditHandlers<Feature>} on */
  constructor(map, kind, on) {
    this.#kind = kind;
    this.#on = on;
    this.#draft = createDraft(`spanwise.${kind.key}-draft.${on.userId}`);
    this.editor = createEditor(map, {
      onChange: (state) => this.#reshaped(state),
      onPreview: (shape) => this.#panel.preview(shape),
    });
    this.#panel = createDrawPanel(this.editor, { show: on.showPlace });
    this.#saveButton.addEventListener("click", () => this.save());
    byId("record-cancel").addEventListener("click", () => this.cancel());
    addEventListener("beforeunload", (event) => {
      if (this.#isChanged() && !this.#edit?.isKept) event.preventDefault(); // storage is closed: ask
    });
  }

  isOpen = () => this.#edit !== null;

  /**
   * @param {Feature | null} feature null for a new one
   * @param {{ choice?: string, shape?: Shape | null, facts?: Facts | null }} [kept] values of an edit that is resumed
   */
  start(feature, { choice = feature ? this.#kind.choiceOf(feature) : "", shape = null, facts = null } = {}) {
    const { form: makeForm, newTitle, shapeKind, title } = this.#kind;
    const stored = feature
      ? shapeOf(/** @type {DrawnGeometry} */ (feature.geometry), feature.properties.circle)
      : empty(shapeKind(choice));
    const form = makeForm(feature, choice, facts);
    this.#edit = {
      choice,
      feature,
      etag: feature ? (this.#on.chosen()?.etag ?? null) : null,
      form,
      began: { shape: textOf(stored), facts: facts ? makeForm(feature, choice, null).read() : form.read() },
      isKept: false,
      isSaving: false,
      sent: null,
    };
    form.element.addEventListener("input", () => this.#keep());
    const heading = h("h2", { class: "record-title", tabindex: -1 }, feature ? title(feature) : newTitle(choice));
    setChildren(
      this.#element,
      heading,
      h("div", { id: "edit-fault" }),
      h("h3", {}, t("Shape")),
      this.#panel.element,
      h("h3", {}, t("Facts")),
      form.element,
    );
    this.#on.opened();
    this.editor.start(shape ?? stored, { without: feature?.id ?? null });
    heading.focus({ preventScroll: true });
  }

  cancel() {
    const left = this.#isChanged() ? this.#now() : null;
    this.#leave();
    const chosen = this.#on.chosen();
    if (chosen) this.#on.choose(chosen.feature.id, { stay: true });
    else this.#on.cancelled();
    const act = () => (this.#edit ? false : this.#goOnWith(/** @type {KeptEdit} */ (left)));
    if (left) toast(t("Your edit is dropped."), { label: t("Undo"), act });
  }

  async save() {
    const edit = this.#edit;
    if (!edit || edit.isSaving || !this.#mayBeSaved(this.editor.state)) return;
    if (!edit.form.element.reportValidity()) return;
    if (edit.feature && !this.#isChanged()) {
      this.cancel();
      return;
    }
    const body = { ...(edit.feature ? this.#changedFacts(edit) : edit.form.read()), ...this.#changedShape() };
    edit.isSaving = true;
    this.#saveButton.setAttribute("aria-busy", "true");
    try {
      const { data } = /** @type {Answer<Feature>} */ (await this.#send(edit, body));
      this.#leave();
      toast(t("Saved."));
      this.#on.reload();
      await this.#on.choose(data.id, { stay: true });
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      edit.isSaving = false;
      if (error.status === 412 && error.details?.changed_by) await this.#settleConflict(edit, error.details, body);
      else this.#showFault(error);
    } finally {
      this.#saveButton.setAttribute("aria-busy", "false");
    }
  }

  /** Offer to resume an unsaved edit of last time. */
  offerDraft() {
    const kept = /** @type {KeptEdit | null} */ (this.#draft.read());
    if (!kept?.shape) return;
    const notices = byId("notices");
    const goOn = () => {
      notices.replaceChildren();
      return this.#goOnWith(kept);
    };
    const drop = () => {
      this.#draft.drop();
      notices.replaceChildren();
    };
    const when = kept.kept_at ? `${t("From {when}.", { when: whenText(kept.kept_at) })} ` : "";
    setChildren(
      notices,
      h(
        "div",
        { class: "notice advisory" },
        icon("info"),
        h(
          "p",
          {},
          h("strong", {}, `${t("Unsaved edit.")} `),
          when,
          h("button", { type: "button", class: "text-button", onclick: goOn }, t("Go on")),
          h("button", { type: "button", class: "text-button", onclick: drop }, t("Discard")),
        ),
      ),
    );
  }

  /** @param {EditorState} state */
  #reshaped(state) {
    this.#panel?.update(state);
    if (this.#edit) {
      this.#keep();
      this.#checkSoon(state);
    }
    this.#saveButton.toggleAttribute("disabled", !this.#mayBeSaved(state));
  }

  #isReshaped() {
    const { shape } = this.editor.state;
    return shape !== null && textOf(shape) !== this.#edit?.began.shape;
  }

  /** Only the changed facts are sent, so that other users' changes are kept. @param {Edit<Feature>} edit @returns {Facts} */
  #changedFacts({ form, began }) {
    const isChanged = (/** @type {string} */ name, /** @type {unknown} */ value) =>
      JSON.stringify(value) !== JSON.stringify(began.facts[name]);
    return Object.fromEntries(Object.entries(form.read()).filter(([name, value]) => isChanged(name, value)));
  }

  #changedShape() {
    const { shape } = this.editor.state;
    if (!shape || !this.#isReshaped()) return {};
    const circle = circleOf(shape);
    return circle ? { circle } : { geometry: geometryOf(shape) };
  }

  #isChanged() {
    return this.#edit !== null && (this.#isReshaped() || Object.keys(this.#changedFacts(this.#edit)).length > 0);
  }

  /** @param {EditorState} state */
  #mayBeSaved({ shape, isDrawing, faults }) {
    if (!this.#edit || !shape || isDrawing) return false;
    return !faults.length || (this.#edit.feature !== null && !this.#isReshaped());
  }

  /** @returns {KeptEdit | null} */
  #now() {
    if (!this.#edit) return null;
    const { feature, choice, form, etag } = this.#edit;
    return { id: feature?.id ?? null, choice, shape: this.editor.state.shape, facts: form.read(), etag };
  }

  #keep() {
    if (!this.#edit) return;
    if (this.#isChanged()) this.#edit.isKept = this.#draft.keep(this.#now());
    else if (this.#edit.isKept) {
      this.#edit.isKept = false;
      this.#draft.drop();
    }
  }

  #leave() {
    if (this.#edit?.isKept) this.#draft.drop();
    this.#edit = null;
    this.editor.stop();
  }

  /** Request a check of the shape from the server, once it has not changed for a moment. @param {EditorState} state */
  #checkSoon({ shape, faults, isDrawing }) {
    clearTimeout(this.#checkTimer);
    if (faults.length || isDrawing || !shape) return;
    this.#checkTimer = setTimeout(async () => {
      if (!this.#edit || this.editor.state.shape !== shape) return;
      const kind = this.#kind.checkKind(this.#edit.choice);
      const body = { kind, geometry: geometryOf(shape) ?? undefined, circle: circleOf(shape) };
      try {
        const { data } = /** @type {Answer<GeometryCheckResult>} */ (await post("/geometry-checks", body));
        if (this.#edit && this.editor.state.shape === shape) this.#panel.showCheck(data);
      } catch {
        /* it is checked again when it is saved */
      }
    }, CHECK_AFTER_MS);
  }

  /** The same request to create it again gets the same answer: a lost one leaves no twin behind. @param {Edit<Feature>} edit @param {Facts} changes */
  #send(edit, changes) {
    const { path, fixedFacts } = this.#kind;
    if (edit.feature) return patch(`${path}/${edit.feature.id}`, changes, ifMatch(edit.etag));
    const body = { ...fixedFacts(edit.choice), ...changes };
    const text = JSON.stringify(body);
    if (edit.sent?.text !== text) edit.sent = { text, key: crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}` };
    return post(path, body, { headers: { "Idempotency-Key": edit.sent.key } });
  }

  /** @param {ApiError} error */
  #showFault(error) {
    const fault = error.code === "invalid_geometry" ? error.details : null;
    const see = fault?.position && (() => this.#on.showPlace(fault.position));
    setChildren(
      byId("edit-fault"),
      h(
        "div",
        { class: "notice critical", role: "alert" },
        icon("circle-alert"),
        h(
          "p",
          {},
          h("strong", {}, `${t("Not saved.")} `),
          fault?.message ? sentence(fault.message) : error.message,
          " ",
          see && h("button", { type: "button", class: "text-button", onclick: see }, t("See the place")),
        ),
      ),
    );
    byId("side-scroll").scrollTop = 0;
  }

  /**
   * @param {Edit<Feature>} edit
   * @param {{ changed_by: string, changed_at: string | null, current: Feature | null }} details
   * @param {Facts} body
   */
  async #settleConflict(edit, { changed_by, changed_at, current }, body) {
    const { factsOf, factsOfBody } = this.#kind;
    const theirs = current && factsOf(current);
    const seen = edit.feature && factsOf(edit.feature);
    const mine = theirs && { ...theirs, ...factsOfBody(body) };
    const which = await askWhich({ changed_by, changed_at, seen, theirs, mine });
    if (which === "theirs" && edit.feature) {
      this.#leave();
      if (current) await this.#on.choose(edit.feature.id, { stay: true });
      else this.#on.back();
    } else if (which === "mine" && current) {
      edit.etag = `"${current.properties.revision}"`;
      await this.save();
    }
  }

  /** @param {KeptEdit} kept */
  async #goOnWith({ id, choice, shape, facts, etag }) {
    if (!id) {
      this.#on.forget();
      this.start(null, { choice, shape, facts });
      return;
    }
    await this.#on.choose(id);
    const chosen = this.#on.chosen();
    if (chosen?.feature.id !== id) return;
    this.start(chosen.feature, { shape, facts });
    if (this.#edit) this.#edit.etag = etag; // the version seen then: a later change is detected when it is saved
  }
}
