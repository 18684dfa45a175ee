/** A dialog with the organisation's saved selections: keep the present targets under a name, load, rename, bring up to date, delete. */

import { ApiError, get, patch, post, remove } from "../../api.js";
import { find, h, icon, setChildren } from "../../dom.js";
import { open } from "../../page/keyboard.js";
import { t, tn } from "../../text.js";
import { dayText } from "../../units.js";
import { EMPTY, requestOf, storedTarget } from "../selection.js";

/** @import { Answer, Options } from "../../api.js" */
/** @import { Selection, SelectionPage, SelectionSummary } from "../../api_types.d.ts" */
/** @import { MissionActions, MissionStore, PickedTarget } from "../types.d.ts" */

/**
 * @typedef {object} RowActs
 * @property {(row: SelectionSummary, instead: boolean) => unknown} load `instead` of the present selection
 * @property {(row: SelectionSummary) => unknown} rename
 * @property {(row: SelectionSummary) => unknown} bringUpToDate
 * @property {(row: SelectionSummary) => unknown} drop
 */

async function allSelections() {
  /** @type {SelectionSummary[]} */
  const rows = [];
  for (let next = /** @type {string | null} */ ("/selections?limit=200"); next; ) {
    const { data } = /** @type {Answer<SelectionPage>} */ (await get(next));
    rows.push(...data.results);
    next = data.next;
  }
  return rows;
}

/** @param {number} id */
async function selectionWith(id) {
  const { data } = /** @type {Answer<Selection>} */ (await get(`/selections/${id}`));
  return { ...data, targets: data.targets.map(storedTarget) };
}

/** As the API takes them. @param {PickedTarget[]} targets */
const asked = (targets) => requestOf({ ...EMPTY, targets }).targets;

/** @param {SelectionSummary} row @returns {Options} */
const etag = ({ revision }) => ({ headers: { "If-Match": `"${revision}"` } });

/** @param {SelectionSummary} row @param {boolean} canKeep whether targets are picked @param {RowActs} acts */
function selectionRow(row, canKeep, acts) {
  const { name } = row;
  const facts = [tn(row.target_count, "{count} target", "{count} targets"), row.author, dayText(row.updated_at)];
  /** @param {string} words @param {string} label @param {string} kind @param {boolean} instead */
  const load = (words, label, kind, instead) =>
    h(
      "button",
      { type: "button", class: `button ${kind}`.trim(), "aria-label": label, onclick: () => acts.load(row, instead) },
      words,
    );
  /** @param {string} sign @param {(row: SelectionSummary) => unknown} work @param {string} words */
  const act = (sign, work, words) =>
    h(
      "button",
      {
        type: "button",
        class: "icon-button tight",
        "aria-label": t("{act}: {name}", { act: words, name }),
        title: words,
        onclick: () => work(row),
      },
      icon(sign, "small"),
    );
  return h(
    "li",
    { "data-selection": row.id },
    h("div", { class: "what" }, h("strong", {}, name), h("small", {}, facts.filter(Boolean).join(" · "))),
    load(t("Add"), t("Add {name}", { name }), "", false),
    canKeep && load(t("Instead"), t("Take {name} instead", { name }), "quiet", true),
    act("pencil", acts.rename, t("Rename")),
    canKeep && act("refresh-cw", acts.bringUpToDate, t("Keep the present targets in it")),
    act("trash-2", acts.drop, t("Delete")),
  );
}

/**
 * The form of another name in the place of the name.
 *
 * @param {HTMLElement} place
 * @param {string} name
 * @param {{ give: (name: string) => unknown, end: () => void }} acts
 */
function showRenaming(place, name, { give, end }) {
  const input = h("input", {
    class: "input",
    value: name,
    maxlength: "100",
    required: true,
    "aria-label": t("New name of {name}", { name }),
  });
  const form = h("form", { class: "rename" }, input, h("button", { class: "button" }, t("Rename")));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    give(input.value.trim());
  });
  input.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    event.preventDefault();
    event.stopPropagation();
    end();
  });
  place.replaceChildren(form);
  input.select();
}

class SelectionsDialog {
  #list = h("ul", { class: "selection-list", "aria-label": t("Saved selections") });
  #wrong = h("p", { class: "field-error", role: "alert" });
  #done = h("p", { class: "selection-done", role: "status" });
  #close = h("button", { class: "button" }, t("Close"));
  #dialog = h("dialog", { class: "selections", "aria-labelledby": "selections-title" });
  /** @type {SelectionSummary[]} */
  #rows = [];
  #store;
  #actions;

  /** @param {MissionStore} store @param {MissionActions} actions */
  constructor(store, actions) {
    this.#store = store;
    this.#actions = actions;
  }

  open() {
    const keep = this.#keepForm();
    this.#dialog.append(
      h(
        "div",
        { class: "stack" },
        h("h2", { id: "selections-title" }, t("Saved selections")),
        keep?.form,
        this.#wrong,
        this.#done,
        this.#list,
        h("form", { method: "dialog", class: "acts" }, this.#close),
      ),
    );
    this.#list.append(h("li", { class: "quiet-text" }, t("Loading…")));
    open(this.#dialog);
    keep?.name.focus();
    void this.#attempt(() => this.#refresh());
  }

  /** The form that stores the present selection; null where it is empty. */
  #keepForm() {
    const count = this.#picked().length;
    if (!count) return null;
    const name = h("input", {
      class: "input",
      id: "selection-name",
      maxlength: "100",
      required: true,
      autocomplete: "off",
    });
    const form = h(
      "form",
      { class: "keep" },
      h(
        "div",
        { class: "field" },
        h(
          "label",
          { for: "selection-name" },
          tn(count, "Keep the {count} picked target as", "Keep the {count} picked targets as"),
        ),
        name,
      ),
      h("button", { class: "button primary" }, t("Keep")),
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.#keep(name);
    });
    return { form, name };
  }

  #picked() {
    return this.#store.state.selection.targets;
  }

  /**
   * Show a notice in the dialog: elements behind it cannot be reached.
   *
   * @param {string} words
   * @param {(() => unknown) | null} [undo]
   */
  #notify(words, undo = null) {
    setChildren(
      this.#done,
      words,
      undo && h("button", { type: "button", class: "text-button", onclick: undo }, t("Undo")),
    );
  }

  /** @param {() => Promise<unknown>} work */
  async #attempt(work) {
    this.#wrong.textContent = "";
    this.#done.replaceChildren();
    try {
      await work();
    } catch (error) {
      const status = error instanceof ApiError ? error.status : 0;
      this.#wrong.textContent = error instanceof ApiError ? error.message : t("That did not work. Try again.");
      if (status === 412 || status === 404) await this.#refresh().catch(() => {}); // the error is shown already
    }
  }

  async #refresh() {
    this.#rows = await allSelections();
    this.#draw();
  }

  /** @param {HTMLInputElement} name */
  #keep(name) {
    return this.#attempt(async () => {
      const body = { name: name.value.trim(), targets: asked(this.#picked()) };
      const { data } = /** @type {Answer<Selection>} */ (await post("/selections", body));
      name.value = "";
      await this.#refresh();
      this.#notify(t("“{name}” is kept.", { name: data.name }));
    });
  }

  /** @param {SelectionSummary} row @param {boolean} instead */
  #load(row, instead) {
    const actions = this.#actions;
    return this.#attempt(async () => {
      const { name, targets, missing } = await selectionWith(row.id);
      this.#dialog.close();
      if (instead) actions.replaceTargets(targets, t("The targets of “{name}” are picked.", { name }));
      else actions.addMany(targets, (added) => t("{added} from “{name}”.", { added, name }));
      if (missing.length)
        actions.notify(
          tn(missing.length, "{count} target is no longer in the data.", "{count} targets are no longer in the data."),
          missing.join(", "),
        );
    });
  }

  /** @param {SelectionSummary} row */
  #rename(row) {
    showRenaming(find(this.#list, `[data-selection="${row.id}"] .what`, HTMLElement), row.name, {
      end: () => this.#draw(),
      give: (name) =>
        this.#attempt(async () => {
          await patch(`/selections/${row.id}`, { name }, etag(row));
          await this.#refresh();
        }),
    });
  }

  /** @param {SelectionSummary} row */
  #bringUpToDate(row) {
    return this.#attempt(async () => {
      await patch(`/selections/${row.id}`, { targets: asked(this.#picked()) }, etag(row));
      await this.#refresh();
      this.#notify(t("“{name}” holds the present targets now.", { name: row.name }));
    });
  }

  /** @param {SelectionSummary} row */
  #drop(row) {
    return this.#attempt(async () => {
      const kept = await selectionWith(row.id);
      await remove(`/selections/${row.id}`, etag(row));
      await this.#refresh();
      const targets = asked(kept.targets);
      const back = () =>
        this.#attempt(async () => {
          await post("/selections", { name: row.name, targets });
          await this.#refresh();
        });
      this.#notify(t("“{name}” is deleted.", { name: row.name }), targets.length ? back : null);
      (this.#done.querySelector("button") ?? this.#close).focus();
    });
  }

  #draw() {
    const canKeep = this.#picked().length > 0;
    const acts = {
      load: this.#load.bind(this),
      rename: this.#rename.bind(this),
      bringUpToDate: this.#bringUpToDate.bind(this),
      drop: this.#drop.bind(this),
    };
    const nothing = t("Nothing is kept yet. Pick targets, then keep them under a name: everybody here can load them.");
    if (this.#rows.length) this.#list.replaceChildren(...this.#rows.map((row) => selectionRow(row, canKeep, acts)));
    else this.#list.replaceChildren(h("li", { class: "quiet-text" }, nothing));
  }
}

/** @param {MissionStore} store @param {MissionActions} actions */
export function showSelections(store, actions) {
  new SelectionsDialog(store, actions).open();
}
