/** A page of records, assets or zones: search, view, draw, edit, history, undo. RecordKind holds the differences between the two. */

import { ApiError } from "../api.js";
import { byId } from "../dom.js";
import { piecesOf } from "../map/click_router.js";
import { menuOf, toggleMenu } from "../page/chrome.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { mountGroundPage } from "./ground_page.js";
import { RecordEdit } from "./record_edit.js";
import { RecordList } from "./record_list.js";
import { RecordView } from "./record_view.js";

/** @import { Geometry } from "../map/types.d.ts" */
/** @import { Binding } from "../page/keyboard.js" */
/** @import { RecordFeature, RecordKind } from "./types.d.ts" */

/** @param {unknown} error @param {() => unknown} [again] */
function failed(error, again) {
  if (!(error instanceof ApiError)) throw error;
  toast(error.message, again ? { label: t("Try again"), act: again } : null);
}

/**
 * @template {RecordFeature} Feature
 * @template {{ id: number, geometry: any }} Row
 * @param {RecordKind<Feature, Row>} kind
 */
export const mountRecordPage = (kind) => new RecordPage(kind);

/**
 * @template {RecordFeature} Feature
 * @template {{ id: number, geometry: any }} Row
 */
class RecordPage {
  #kind;
  #ground;
  #list;
  #view;
  #edit;
  #views = { find: byId("record-find"), show: byId("record-show"), edit: byId("record-edit") };
  /** What the pointer is at. @type {number | undefined} */
  #pointed;

  /** @param {RecordKind<Feature, Row>} kind */
  constructor(kind) {
    this.#kind = kind;
    this.#ground = mountGroundPage({
      isBusy: () => this.#edit?.editor.isActive() ?? false,
      kinds: () => kind.pickKinds,
      click: (thing) => thing && this.choose(thing.id, { stay: true }),
      ringsItself: true,
      hover: (thing) => {
        if (thing?.id === this.#pointed) return;
        this.#pointed = thing?.id;
        this.#ring(thing ? piecesOf(this.#ground.map.map, thing) : []);
      },
    });
    const { page, map } = this.#ground;
    this.page = page;
    this.#list = new RecordList(kind, {
      box: map.box,
      choose: (id) => this.choose(id),
      ring: (geometries) => this.#ring(geometries),
      changed: () => this.#reload(),
      failed,
    });
    this.#view = new RecordView(kind, {
      canCurate: page.canCurate,
      go: (view) => this.go(view),
      ring: () => this.#ring(),
      ringAlso: (geometries) => this.#ring(geometries),
      fit: map.fit,
      reload: () => this.#reload(),
      edit: (feature) => this.#edit.start(feature),
      left: (id) => {
        this.#list.table?.choose(null);
        this.#list.focusRow(id);
      },
      chose: (id) => this.#list.table?.choose(id),
      failed,
    });
    this.#edit = new RecordEdit(map.map, kind, {
      userId: page.userId,
      opened: () => {
        this.go("edit");
        this.#ring();
      },
      showPlace: map.show,
      choose: (id, how) => this.choose(id, how),
      chosen: () => this.#view.chosen,
      forget: () => {
        this.#view.chosen = null;
      },
      cancelled: () => this.go("find"),
      back: () => this.#view.back(),
      reload: () => this.#reload(),
    });
    map.onRecolour(() => this.#edit.editor.recolour());
    if (page.canCurate) this.#mountNewButton();
  }

  /** @param {"find" | "show" | "edit"} view */
  go(view) {
    if (view !== "show") this.#kind.closed?.();
    for (const [name, element] of Object.entries(this.#views)) element.hidden = name !== view;
    byId("record-foot").hidden = view !== "edit";
    /** @type {NodeListOf<HTMLElement>} */
    const others = document.querySelectorAll("[data-only-without-edit]");
    for (const element of others) element.hidden = view === "edit";
    byId("side-scroll").scrollTop = 0;
  }

  get map() {
    return this.#ground.map;
  }

  /** The list again. */
  load() {
    return this.#list.load();
  }

  /** @param {number | string} id @param {{ stay?: boolean, keepScroll?: boolean }} [how] */
  async choose(id, how) {
    if (!this.#edit.isOpen()) await this.#view.choose(id, how);
  }

  /** The list instead of a record. */
  back() {
    this.#view.back();
  }

  async start() {
    const { page, map, open } = this.#ground;
    await open({
      bindings: this.#bindings(),
      load: async () => {
        this.#edit.editor.addTo();
        await this.load();
        map.map.on("moveend", () => {
          if (this.#list.followsView && !this.#views.find.hidden) this.load();
        });
        const id = new URL(location.href).searchParams.get("id");
        if (id && /^\d+$/.test(id)) await this.choose(id);
        if (page.canCurate) this.#edit.offerDraft();
      },
    });
  }

  /** The list and the map again. */
  reload() {
    return this.#reload();
  }

  async #reload() {
    this.#ground.map.refreshTiles();
    await this.load();
  }

  /** Keep the ring of the selection beside that of the pointer or a row. @param {Geometry[]} [geometries] */
  #ring(geometries = []) {
    const { chosen } = this.#view;
    const own = chosen && !this.#edit.isOpen() ? [chosen.feature.geometry] : [];
    this.#ground.map.ring([...own, ...(this.#list?.table?.marked() ?? []), ...geometries]);
  }

  #mountNewButton() {
    const opener = byId("record-new");
    opener.hidden = false;
    const items = this.#kind.newChoices.map(({ value, icon, words }) => ({
      icon,
      label: words,
      act: () => {
        this.#view.chosen = null;
        this.#edit.start(null, { choice: value });
      },
    }));
    opener.addEventListener("click", () => {
      if (items.length > 1) toggleMenu(opener, () => menuOf(t("New"), items));
      else items[0].act();
    });
  }

  /** @returns {Binding[]} */
  #bindings() {
    const { editor } = this.#edit;
    const isFinding = () => !this.#views.find.hidden;
    const whenEditing = (/** @type {() => unknown} */ act) => () => (this.#edit.isOpen() ? act() : false);
    const isIn = (/** @type {KeyboardEvent} */ { target }, /** @type {string} */ selector) =>
      target instanceof Element && target.matches(selector);
    const arrow = (/** @type {number} */ right, /** @type {number} */ down) => (/** @type {KeyboardEvent} */ event) => {
      if (!this.#edit.isOpen() || isIn(event, "input, textarea, select")) return false;
      const step_px = event.shiftKey ? 10 : 1;
      return editor.nudge(right * step_px, down * step_px);
    };
    const editChosen = () => {
      const { chosen } = this.#view;
      if (!chosen || this.#edit.isOpen() || !this.page.canCurate) return false;
      this.#edit.start(chosen.feature);
      return true;
    };
    const stepBack = () => {
      if (this.#edit.isOpen()) return editor.back() || this.#edit.cancel();
      return this.#view.chosen ? this.#view.back() : false;
    };
    return [
      { keys: ["/"], words: this.#kind.findWords, act: () => (isFinding() ? byId("record-text").focus() : false) },
      { keys: ["j"], words: t("Next in the list"), act: () => isFinding() && this.#list.step(1) },
      { keys: ["k"], words: t("Previous in the list"), act: () => isFinding() && this.#list.step(-1) },
      { keys: ["e"], words: t("Edit"), act: editChosen },
      { keys: ["mod+z"], words: t("Undo"), act: whenEditing(editor.undo) },
      { keys: ["mod+shift+z", "mod+y"], words: t("Redo"), act: whenEditing(editor.redo) },
      {
        keys: ["mod+s"],
        words: t("Save"),
        whileTyping: true,
        act: whenEditing(() => {
          this.#edit.save();
          return true;
        }),
      },
      {
        keys: ["enter"],
        words: t("End the drawing"),
        act: (event) => (this.#edit.isOpen() && !isIn(event, "button, a, summary, input") ? editor.finish() : false),
      },
      {
        keys: ["delete", "backspace"],
        words: t("Remove the chosen point"),
        act: whenEditing(() => (editor.state.isDrawing ? editor.back() : editor.removeChosen())),
      },
      { keys: ["arrowleft", "shift+arrowleft"], act: arrow(-1, 0) },
      { keys: ["arrowright", "shift+arrowright"], act: arrow(1, 0) },
      { keys: ["arrowup", "shift+arrowup"], act: arrow(0, -1) },
      { keys: ["arrowdown", "shift+arrowdown"], act: arrow(0, 1) },
      { keys: ["escape"], words: t("A step back"), act: stepBack },
    ];
  }
}
