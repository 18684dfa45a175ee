/** Adding and editing one row of the fleet: the form, the pin on the map, unsaved input, and conflicts with other users. */

import { ApiError, get, patch, post } from "../api.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { blankBody, bodyOf } from "./bodies.js";
import { createForm } from "./forms.js";
import { KINDS } from "./kinds.js";
import { conflictNotice } from "./panel.js";
import { readRow } from "./words.js";

/** @import { Answer, Options } from "../api.js" */
/** @import { Figures } from "../cameras/camera_form.js" */
/** @import { Panel } from "./panel.js" */
/** @import { Body, FleetMap, FleetPage, FleetState, FleetType, Form, KeptEdit, Position, Row, RowAnswer, Store, Tab } from "./types.d.ts" */

/**
 * Functions that the page offers to the edit.
 *
 * @typedef {object} EditingContext
 * @property {Store<FleetState>} store
 * @property {FleetPage} page
 * @property {Panel} panel
 * @property {() => boolean} isWide
 * @property {() => void} open
 * @property {() => FleetMap | null} map
 * @property {() => Promise<void>} showMap
 * @property {(tab: Tab) => void} turnTo
 * @property {(tab: Tab, id: number) => Promise<void>} choose
 * @property {() => void} close
 * @property {() => Promise<void>} load
 * @property {() => number} moment a number that changes once another act has begun
 */
/**
 * @typedef {object} Edit
 * @property {Tab} tab
 * @property {Row | null} row null: a new one
 * @property {Form} form
 * @property {Body} began
 * @property {Options | undefined} etag
 * @property {string} key
 * @property {boolean} isSaving
 */

/** @param {unknown} a @param {unknown} b */
const isSame = (a, b) => JSON.stringify(a) === JSON.stringify(b);
const newKey = () => crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;
/** @param {{ revision: number }} row @returns {Options} */
export const ifUnchanged = (row) => ({ headers: { "If-Match": `"${row.revision}"` } });

/** The stated values of a new row; the server fills in the rest. @param {Body} body */
const stated = (body) => Object.fromEntries(Object.entries(body).filter(([, value]) => value !== null));

export class Editing {
  /** @type {Edit | null} */
  #edit = null;
  #context;

  /** @param {EditingContext} context */
  constructor(context) {
    this.#context = context;
  }

  get isOpen() {
    return this.#edit !== null;
  }

  get isChanged() {
    return Object.keys(this.#changes()).length > 0;
  }

  submit() {
    this.#edit?.form.element.requestSubmit();
  }

  /** @param {Row | null} row null: a new one @param {KeptEdit | null} [kept] input from before */
  async start(row, kept = null) {
    const context = this.#context;
    const { tab, types, bases } = context.store.state;
    context.open();
    await context.showMap();
    const began = row ? bodyOf(tab, row) : blankBody(tab);
    if ("position" in began && !began.position) began.position = this.#placeOfNew();
    const body = /** @type {Body} */ ({ ...began, ...kept?.body });
    const form = createForm({
      tab,
      body,
      types: types ?? [],
      bases: bases ?? [],
      isNew: !row,
      isAdministrator: context.page.role === "administrator",
      onMove: (position) => context.map()?.movePin(position),
      onSave: () => this.#save(),
      onCancel: () => this.cancel(),
    });
    const etag = kept?.etag ?? (row ? ifUnchanged(row) : undefined);
    this.#edit = { tab, row, form, began, etag, key: newKey(), isSaving: false };
    context.panel.edit(row ? t("Edit {name}", { name: row.name }) : KINDS[tab].one, form);
    const map = context.map();
    if ("position" in body && body.position) {
      map?.place(body.position, (position) => form.setPlace(position));
      map?.look(body.position);
    }
    map?.show(context.store.state, context.store.state.chosen);
    form.first.focus({ preventScroll: context.isWide() });
  }

  /** End the edit, with an undo where something was changed. A save in progress is completed. */
  leave() {
    const left = this.#edit;
    if (!left) return;
    const kept = this.isChanged && !left.isSaving && { body: left.form.body(), etag: left.etag };
    this.#end();
    if (kept) toast(t("Your edit is dropped."), { label: t("Undo"), act: () => this.#reopen(left, kept) });
  }

  cancel() {
    if (!this.#edit) return;
    const { row, tab } = this.#edit;
    this.leave();
    if (row) this.#context.choose(tab, row.id);
    else this.#context.close();
  }

  /** The initial place of a new row: the middle of the map. @returns {Position} */
  #placeOfNew() {
    const { store, page, map } = this.#context;
    const { bases, uavs } = store.state;
    const { extent } = page;
    return (
      map()?.centre() ??
      bases?.[0]?.position ??
      uavs?.[0]?.position ??
      (extent ? [(extent[0] + extent[2]) / 2, (extent[1] + extent[3]) / 2] : [0, 0])
    );
  }

  #changes() {
    if (!this.#edit) return {};
    const began = new Map(Object.entries(this.#edit.began));
    const body = Object.entries(this.#edit.form.body());
    return Object.fromEntries(body.filter(([name, value]) => !isSame(value, began.get(name))));
  }

  #end() {
    this.#edit = null;
    this.#context.map()?.endPlacing();
  }

  /** @param {Edit} edit @param {KeptEdit} kept */
  async #reopen({ tab, row }, kept) {
    this.#context.turnTo(tab);
    this.#context.store.update({ chosen: row && { tab, id: row.id } });
    await this.start(row, kept);
  }

  /** Edit a type, as it is stored now, with one camera more. @param {number} id @param {Figures} camera */
  async addCamera(id, camera) {
    const now = this.#context.moment();
    const { data: type } = /** @type {Answer<FleetType>} */ (await get(`${KINDS.types.path}/${id}`));
    if (now !== this.#context.moment()) return;
    const body = /** @type {Body} */ ({ ...bodyOf("types", type), cameras: [...type.cameras, camera] });
    this.#context.turnTo("types");
    this.#context.store.update({ chosen: { tab: "types", id: type.id } });
    await this.start(type, { body, etag: ifUnchanged(type) });
  }

  /** Show the stored row, unless another act has begun meanwhile. @param {Tab} tab @param {number} id */
  async #showAsStored(tab, id) {
    const { moment, load, choose } = this.#context;
    const now = moment();
    await load();
    if (now === moment()) await choose(tab, id);
  }

  async #save() {
    const mine = this.#edit;
    if (!mine || mine.isSaving) return;
    const { tab, row, form, etag, key } = mine;
    const { path } = KINDS[tab];
    if (row && !this.isChanged) {
      this.cancel();
      return;
    }
    const body = form.body();
    form.clear();
    form.busy(true);
    mine.isSaving = true;
    try {
      const { data } = /** @type {Answer<RowAnswer>} */ (
        row
          ? await patch(`${path}/${row.id}`, this.#changes(), etag)
          : await post(path, stated(body), { headers: { "Idempotency-Key": key } })
      );
      toast(t("{name} is saved.", { name: readRow(data).name }));
      if (this.#edit === mine) {
        this.#end();
        await this.#showAsStored(tab, data.id);
      } else await this.#context.load();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      this.#failed(mine, error, { body, etag });
    } finally {
      form.busy(false);
    }
  }

  /** @param {Edit} edit @param {ApiError} error @param {KeptEdit} kept */
  #failed(edit, error, kept) {
    edit.isSaving = false;
    if (!error.isAway) edit.key = newKey(); // after a lost answer the request is repeated with the same key
    if (this.#edit !== edit)
      toast(t("Not saved: {message}", { message: error.message }), {
        label: t("Look"),
        act: () => this.#reopen(edit, kept),
      });
    else if (error.status === 412 && error.details?.current)
      this.#settle(edit, readRow(error.details.current), error.details.changed_by);
    else
      edit.form.notify(
        error.isAway ? t("The server cannot be reached. What you typed stays here.") : error.message,
        error.details,
      );
  }

  /** Merge an edit with another user's. @param {Edit} edit @param {Row} now @param {string} who */
  #settle(edit, now, who) {
    const { tab, form, began } = edit;
    form.ask(
      conflictNotice({
        who,
        seen: began,
        theirs: bodyOf(tab, now),
        form,
        onTheirs: () => {
          this.#end();
          return this.#showAsStored(tab, now.id);
        },
        onMine: () => {
          edit.etag = ifUnchanged(now);
          return this.#save();
        },
      }),
    );
  }
}
