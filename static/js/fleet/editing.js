/** Adding and editing one row of the fleet: the form, the pin on the map, what was not saved, and who was faster. */

import { ApiError, patch, post } from "../api.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { BLANK, bodies, createForm } from "./forms.js";
import { KINDS } from "./kinds.js";
import { conflictNotice } from "./panel.js";

const isSame = (a, b) => JSON.stringify(a) === JSON.stringify(b);
const newKey = () => crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;
export const ifUnchanged = (row) => ({ headers: { "If-Match": `"${row.revision}"` } });

/** What a new row does not say is left to the server. */
const stated = (body) => Object.fromEntries(Object.entries(body).filter(([, value]) => value !== null));

/**
 * context: { store, page, panel, isWide(), open(), map(): the map or null, showMap(): a promise, turnTo(tab), choose(tab, id), close(), load(),
 * moment(): another number once something else was begun }.
 */
export function createEditing(context) {
  const { store } = context;
  let edit = null; // { tab, row or null, etag, form, began, key, isSaving }

  /** Where a new one stands at first: the middle of the map. */
  function placeOfNew() {
    const { bases, uavs } = store.state;
    const { extent } = context.page;
    if (context.map()) return context.map().centre();
    return (
      bases?.[0]?.position ??
      uavs?.[0]?.position ??
      (extent ? [(extent[0] + extent[2]) / 2, (extent[1] + extent[3]) / 2] : [0, 0])
    );
  }

  async function start(row, kept = null) {
    const { tab, types, bases } = store.state;
    context.open();
    await context.showMap();
    const began = row ? bodies[tab](row) : bodies[tab](BLANK[tab]);
    if ("position" in began && !began.position) began.position = placeOfNew();
    const body = { ...began, ...kept?.body };
    const form = createForm({
      tab,
      body,
      types: types ?? [],
      bases: bases ?? [],
      isNew: !row,
      isAdministrator: context.page.role === "administrator",
      onMove: (position) => context.map()?.movePin(position),
      onSave: save,
      onCancel: cancel,
    });
    edit = { tab, row, form, began, etag: kept?.etag ?? (row && ifUnchanged(row)), key: newKey(), isSaving: false };
    context.panel.edit(row ? t("Edit {name}", row) : KINDS[tab].one, form);
    const map = context.map();
    if (body.position) {
      map?.place(body.position, (position) => form.setPlace(position));
      map?.look(body.position);
    }
    map?.show(store.state, store.state.chosen);
    form.first.focus({ preventScroll: context.isWide() });
  }

  function changes() {
    if (!edit) return {};
    return Object.fromEntries(
      Object.entries(edit.form.body()).filter(([name, value]) => !isSame(value, edit.began[name])),
    );
  }

  const isChanged = () => Object.keys(changes()).length > 0;

  function end() {
    edit = null;
    context.map()?.place(null);
  }

  async function reopen({ tab, row }, kept) {
    context.turnTo(tab);
    store.update({ chosen: row && { tab, id: row.id } });
    await start(row, kept);
  }

  /** Ends the edit, with a way back where something was changed. What is just being stored is stored all the same. */
  function leave() {
    if (!edit) return;
    const left = edit;
    const kept = isChanged() && !left.isSaving && { body: left.form.body(), etag: left.etag };
    end();
    if (kept) toast(t("Your edit is dropped."), { label: t("Undo"), act: () => reopen(left, kept) });
  }

  function cancel() {
    const { row, tab } = edit;
    leave();
    if (row) context.choose(tab, row.id);
    else context.close();
  }

  /** Unless something else was begun in the meantime. */
  async function showAsStored(tab, id) {
    const moment = context.moment();
    await context.load();
    if (moment === context.moment()) await context.choose(tab, id);
  }

  async function save() {
    if (edit.isSaving) return;
    const mine = edit;
    const { tab, row, form, etag, key } = mine;
    const kind = KINDS[tab];
    if (row && !isChanged()) {
      cancel();
      return;
    }
    const body = form.body();
    form.clear();
    form.busy(true);
    mine.isSaving = true;
    try {
      const { data } = row
        ? await patch(`${kind.path}/${row.id}`, changes(), etag)
        : await post(kind.path, stated(body), { headers: { "Idempotency-Key": key } });
      toast(t("{name} is saved.", data.properties ?? data));
      if (edit === mine) {
        end();
        await showAsStored(tab, data.id);
      } else await context.load();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      mine.isSaving = false;
      if (!error.isAway) mine.key = newKey(); // an answer that was lost is asked for again under the same key
      if (edit !== mine)
        toast(t("Not saved: {message}", error), { label: t("Look"), act: () => reopen(mine, { body, etag }) });
      else if (error.status === 412 && error.details?.current) settle(error.details, kind);
      else
        form.tell(
          error.isAway ? t("The server cannot be reached. What you typed stays here.") : error.message,
          error.details,
        );
    } finally {
      form.busy(false);
    }
  }

  function settle({ current, changed_by }, kind) {
    const now = kind.read(current);
    const { form, began } = edit;
    form.ask(
      conflictNotice({
        who: changed_by,
        seen: began,
        theirs: bodies[kind.tab](now),
        form,
        onTheirs() {
          end();
          return showAsStored(kind.tab, now.id);
        },
        onMine() {
          edit.etag = ifUnchanged(now);
          save();
        },
      }),
    );
  }

  return {
    start,
    leave,
    cancel,
    isOpen: () => edit !== null,
    isChanged,
    submit: () => edit.form.element.requestSubmit(),
  };
}
