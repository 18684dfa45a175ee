/**
 * A page of records of the ground, assets or zones: find, look, draw, edit, history, undo. What differs between the two is in `about`:
 *
 * { path, key, noun, bindings, listQuery(map), row(feature), title(feature), details(feature), newChoices, shapeKind(choice), checkKind(choice),
 *   choiceOf(feature), form(feature or null, choice) → { element, read() } , pickKinds }
 */

import { ApiError, get, patch, post, remove } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { createDrawPanel } from "../draw/draw_panel.js";
import { createEditor } from "../draw/editor.js";
import { circleOf, empty, geometryOf, shapeOf } from "../draw/shape.js";
import { piecesOf } from "../map/click_router.js";
import { boxAround } from "../map/map_view.js";
import { menuOf, toggleMenu } from "../page/chrome.js";
import { say, toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { whenText } from "../units.js";
import { askWhich } from "./conflict.js";
import { createDraft } from "./draft.js";
import { mountGroundPage } from "./ground_page.js";
import { historyList } from "./history_list.js";

const CHECK_AFTER_MS = 700;
const ROUND_DEG = 0.0008;

const positionsOf = (coordinates) =>
  typeof coordinates[0] === "number" ? [coordinates] : coordinates.flatMap(positionsOf);

export function mountRecordPage(about) {
  let features = [];
  let next = null;
  let chosen = null; // { feature, etag }
  let edit = null; // { choice, feature, etag, form, began: { shape, facts }, isKept, isSaving, sent }
  let asked = 0;
  let pointed; // id of what the pointer is at
  let checkTimer = 0;

  const { page, map, layout, open } = mountGroundPage({
    isBusy: () => editor?.isActive() ?? false,
    kinds: () => about.pickKinds,
    click: (thing) => thing && choose(thing.id, { stay: true }),
    ringsItself: true,
    hover(thing) {
      if (thing?.id === pointed) return;
      pointed = thing?.id;
      ring(thing ? piecesOf(map.map, thing) : []);
    },
  });
  /** What is chosen stays ringed beside what the pointer or a row is at. */
  const ring = (geometries = []) => map.ring([...(chosen && !edit ? [chosen.feature.geometry] : []), ...geometries]);
  const draft = createDraft(`spanwise.${about.key}-draft.${page.userId}`);
  const views = { find: byId("record-find"), show: byId("record-show"), edit: byId("record-edit") };
  const list = byId("record-list");

  // the map's part of an edit
  const showPlace = (position) => map.show(position);
  let panel = null;
  const editor = createEditor(map.map, {
    onChange(state) {
      panel?.update(state);
      if (edit) keepDraft(), checkSoon(state);
      byId("record-save").toggleAttribute("disabled", !mayBeSaved(state));
    },
    onPreview: (shape) => panel.preview(shape),
  });
  panel = createDrawPanel(editor, { show: showPlace });

  function go(view) {
    for (const [name, element] of Object.entries(views)) element.hidden = name !== view;
    byId("record-foot").hidden = view !== "edit";
    document.querySelectorAll("[data-only-without-edit]").forEach((element) => (element.hidden = view === "edit"));
    byId("side-scroll").scrollTop = 0;
  }

  const failed = (error, act) => {
    toast(error.message, act ? { label: t("Try again"), act } : null);
    if (!(error instanceof ApiError)) throw error;
  };

  // find

  async function load({ more = false } = {}) {
    const turn = ++asked;
    try {
      const { data } = await get(more && next ? next : about.listQuery(map));
      if (turn !== asked) return;
      features = more ? [...features, ...data.features] : data.features;
      next = data.next;
      drawList();
    } catch (error) {
      failed(error, () => load({ more }));
    }
  }

  function drawList() {
    list.replaceChildren(
      ...features.map((feature) => {
        const row = about.row(feature);
        return h(
          "li",
          {},
          h(
            "button",
            {
              type: "button",
              class: "record-row",
              "data-id": feature.id,
              onclick: () => choose(feature.id),
              onpointerenter: () => ring([feature.geometry]),
              onpointerleave: () => ring(),
              onfocus: () => ring([feature.geometry]),
              onblur: () => ring(),
            },
            icon(row.icon),
            h(
              "span",
              { class: "what" },
              h("span", { class: "name" }, row.name),
              row.detail && h("small", {}, row.detail),
            ),
            row.chip && h("span", { class: "chip" }, row.chip),
          ),
        );
      }),
    );
    byId("record-more").hidden = next === null;
    const none = byId("record-none");
    none.hidden = features.length > 0;
    if (!features.length) none.replaceChildren(...about.nothing());
    byId("page-facts").textContent = features.length
      ? next
        ? t("{count} or more found", { count: features.length })
        : tn(features.length, "{count} found", "{count} found")
      : "";
  }

  // look

  async function choose(id, { stay = false, keepScroll = false } = {}) {
    if (edit) return;
    try {
      const [{ data: feature, etag }, { data: history }] = await Promise.all([
        get(`${about.path}/${id}`),
        get(`${about.path}/${id}/history`),
      ]);
      chosen = { feature, etag };
      const scroll = byId("side-scroll").scrollTop;
      drawChosen(history);
      go("show");
      if (keepScroll) byId("side-scroll").scrollTop = scroll;
      ring();
      if (!stay) map.fit(boxOf(feature.geometry));
      rememberAddress(id);
      say(about.title(feature));
    } catch (error) {
      if (error.status === 404) toast("It is no longer there.");
      else failed(error, () => choose(id));
    }
  }

  const boxOf = (geometry) => {
    const [west, south, east, north] = boxAround(positionsOf(geometry.coordinates));
    return [west - ROUND_DEG, south - ROUND_DEG, east + ROUND_DEG, north + ROUND_DEG];
  };

  function rememberAddress(id) {
    const address = new URL(location.href);
    if (id) address.searchParams.set("id", id);
    else address.searchParams.delete("id");
    history.replaceState(history.state, "", address);
  }

  /** The newest changes; earlier ones on demand. */
  function historyPart({ results, next: earlier }) {
    const part = h("div", {}, historyList(results, { revert: page.canCurate ? revert : null, ring }));
    const more = async () => {
      try {
        part.lastChild.replaceWith(historyPart((await get(earlier)).data));
      } catch (error) {
        failed(error, more);
      }
    };
    if (earlier)
      part.append(h("button", { type: "button", class: "text-button", onclick: more }, t("Earlier changes")));
    return part;
  }

  function drawChosen(history) {
    const { feature } = chosen;
    const isGone = feature.properties.vanished_at;
    const acts = page.canCurate && [
      h(
        "button",
        { type: "button", class: "button primary", onclick: () => startEdit(feature), disabled: Boolean(isGone) },
        icon("pencil", "small"),
        t("Edit"),
      ),
      feature.properties.follows &&
        h("button", { type: "button", class: "button", onclick: follow }, t("Follow the source again")),
      !isGone &&
        h(
          "button",
          { type: "button", class: "button danger", onclick: takeOff },
          icon("trash-2", "small"),
          t("Delete"),
        ),
    ];
    views.show.replaceChildren(
      h(
        "button",
        { type: "button", class: "text-button back", onclick: () => back() },
        icon("arrow-left", "small"),
        about.backWords,
      ),
      h("h2", { class: "record-title", tabindex: -1 }, about.title(feature)),
      ...about.details(feature),
      h("div", { class: "record-acts" }, acts || []),
      h("h3", {}, icon("history", "small"), t("History")),
      historyPart(history),
    );
  }

  function back() {
    chosen = null;
    ring();
    rememberAddress(null);
    go("find");
    list.querySelector("button")?.focus({ preventScroll: true });
  }

  async function change(act, words) {
    try {
      await act();
      map.refreshTiles();
      if (words) toast(words);
      await load();
    } catch (error) {
      if (error.status === 412) toast(`${error.message}`, { label: t("Look"), act: () => choose(chosen.feature.id) });
      else failed(error);
    }
  }

  const match = (etag) => ({ headers: { "If-Match": etag } });

  function follow() {
    const { id } = chosen.feature;
    change(
      async () => (
        await post(`${about.path}/${id}/follow-source`, undefined, match(chosen.etag)), await choose(id, { stay: true })
      ),
      t("It follows its source again."),
    );
  }

  function revert(entry) {
    const { id } = chosen.feature;
    change(
      async () => (
        await post(`${about.path}/${id}/revert`, { entry: entry.id }, match(chosen.etag)),
        await choose(id, { stay: true })
      ),
      t("What was before is back."),
    );
  }

  function takeOff() {
    const { id } = chosen.feature;
    const name = about.title(chosen.feature);
    change(async () => {
      await remove(`${about.path}/${id}`, match(chosen.etag));
      const { data } = await get(`${about.path}/${id}/history`);
      back();
      toast(t("{name} is taken off the ground.", { name }), {
        label: t("Undo"),
        act: () =>
          change(
            async () => (await post(`/history/${data.results[0].id}/undo`), await choose(id, { stay: true })),
            t("It is back."),
          ),
      });
    });
  }

  // edit

  function startEdit(feature, { choice = feature ? about.choiceOf(feature) : null, shape = null, facts = null } = {}) {
    const first =
      shape ?? (feature ? shapeOf(feature.geometry, feature.properties.circle) : empty(about.shapeKind(choice)));
    const form = about.form(feature, choice, facts);
    const there = feature ? shapeOf(feature.geometry, feature.properties.circle) : empty(about.shapeKind(choice));
    const factsThere = facts ? about.form(feature, choice, null).read() : form.read();
    edit = {
      choice,
      feature,
      etag: feature ? chosen.etag : null,
      form,
      began: { shape: textOf(there), facts: factsThere },
      isKept: false,
      isSaving: false,
      sent: null,
    };
    form.element.addEventListener("input", keepDraft);
    views.edit.replaceChildren(
      h("h2", { class: "record-title", tabindex: -1 }, feature ? about.title(feature) : about.newTitle(choice)),
      h("div", { id: "edit-fault" }),
      h("h3", {}, t("Shape")),
      panel.element,
      h("h3", {}, t("Facts")),
      form.element,
    );
    go("edit");
    ring();
    editor.start(first, { without: feature?.id ?? null });
    views.edit.querySelector("h2").focus({ preventScroll: true });
  }

  const textOf = (shape) => JSON.stringify([geometryOf(shape) ?? shape.parts, circleOf(shape)]);
  const isReshaped = () => textOf(editor.state.shape) !== edit.began.shape;
  /** Only what was changed is sent: what others change besides stays theirs. */
  const changedFacts = () =>
    Object.fromEntries(
      Object.entries(edit.form.read()).filter(
        ([name, value]) => JSON.stringify(value) !== JSON.stringify(edit.began.facts[name]),
      ),
    );
  const isChanged = () => edit !== null && (isReshaped() || Object.keys(changedFacts()).length > 0);
  const mayBeSaved = ({ shape, isDrawing, faults }) =>
    edit !== null && shape !== null && !isDrawing && (!faults.length || (edit.feature !== null && !isReshaped()));

  const draftNow = () => ({
    id: edit.feature?.id ?? null,
    choice: edit.choice,
    shape: editor.state.shape,
    facts: edit.form.read(),
    etag: edit.etag,
  });
  function keepDraft() {
    if (!edit) return;
    if (isChanged()) edit.isKept = draft.keep(draftNow());
    else if (edit.isKept) {
      edit.isKept = false;
      draft.drop();
    }
  }

  function checkSoon({ shape, faults, isDrawing }) {
    clearTimeout(checkTimer);
    if (faults.length || isDrawing || !shape) return;
    checkTimer = setTimeout(async () => {
      if (!edit || editor.state.shape !== shape) return;
      try {
        const { data } = await post("/geometry-checks", {
          kind: about.checkKind(edit.choice),
          geometry: geometryOf(shape) ?? undefined,
          circle: circleOf(shape),
        });
        if (edit && editor.state.shape === shape) panel.verdict(data);
      } catch {
        /* it is checked again when it is saved */
      }
    }, CHECK_AFTER_MS);
  }

  function leaveEdit() {
    if (edit.isKept) draft.drop();
    edit = null;
    editor.stop();
  }

  function cancel() {
    const left = isChanged() ? draftNow() : null;
    leaveEdit();
    if (chosen) choose(chosen.feature.id, { stay: true });
    else go("find");
    if (left) toast("Your edit is dropped.", { label: t("Undo"), act: () => !edit && goOnWith(left) });
  }

  function shapeChange(shape) {
    if (!isReshaped()) return {};
    return circleOf(shape) ? { circle: circleOf(shape) } : { geometry: geometryOf(shape) };
  }

  /** The same request again gets the same answer: a lost one leaves no twin behind. */
  function create(body) {
    const text = JSON.stringify(body);
    if (edit.sent?.text !== text) edit.sent = { text, key: crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}` };
    return post(about.path, body, { headers: { "Idempotency-Key": edit.sent.key } });
  }

  function tellFault(error) {
    const fault = error.code === "invalid_geometry" ? error.details : null;
    const words = fault?.message ? `${fault.message[0].toUpperCase()}${fault.message.slice(1)}.` : error.message;
    byId("edit-fault").replaceChildren(
      h(
        "div",
        { class: "notice critical", role: "alert" },
        icon("circle-alert"),
        h(
          "p",
          {},
          h("strong", {}, `${t("Not saved.")} `),
          words,
          " ",
          fault?.position &&
            h(
              "button",
              { type: "button", class: "text-button", onclick: () => showPlace(fault.position) },
              t("See the place"),
            ),
        ),
      ),
    );
    byId("side-scroll").scrollTop = 0;
  }

  async function save() {
    if (!edit || edit.isSaving || !mayBeSaved(editor.state)) return;
    const { feature, form } = edit;
    if (!form.element.reportValidity()) return;
    if (feature && !isChanged()) {
      cancel();
      return;
    }
    const button = byId("record-save");
    const body = { ...(feature ? changedFacts() : form.read()), ...shapeChange(editor.state.shape) };
    edit.isSaving = true;
    button.setAttribute("aria-busy", "true");
    try {
      const { data } = feature
        ? await patch(`${about.path}/${feature.id}`, body, match(edit.etag))
        : await create({ ...about.fixedFacts(edit.choice), ...body });
      leaveEdit();
      map.refreshTiles();
      toast("Saved.");
      load();
      await choose(data.id, { stay: true });
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      edit.isSaving = false;
      if (error.status === 412 && error.details?.changed_by) await settleConflict(error.details, body);
      else tellFault(error);
    } finally {
      button.setAttribute("aria-busy", "false");
    }
  }

  async function settleConflict({ changed_by, changed_at, current }, body) {
    const theirs = current && about.factsOf(current);
    const which = await askWhich({
      changed_by,
      changed_at,
      seen: about.factsOf(edit.feature),
      theirs,
      mine: theirs && { ...theirs, ...about.factsOfBody(body) },
    });
    if (which === "theirs") {
      const { id } = edit.feature;
      leaveEdit();
      if (current) await choose(id, { stay: true });
      else back();
    } else if (which === "mine") {
      edit.etag = `"${current.properties.revision}"`;
      await save();
    }
  }

  // what was not saved last time

  async function goOnWith(kept) {
    if (!kept.id) {
      chosen = null;
      startEdit(null, { choice: kept.choice, shape: kept.shape, facts: kept.facts });
      return;
    }
    await choose(kept.id);
    if (chosen?.feature.id !== kept.id) return;
    startEdit(chosen.feature, { shape: kept.shape, facts: kept.facts });
    edit.etag = kept.etag; // what was seen then: a change since comes to light when it is saved
  }

  addEventListener("beforeunload", (event) => {
    if (isChanged() && !edit.isKept) event.preventDefault(); // storage is closed: ask
  });

  async function offerDraft() {
    const kept = draft.read();
    if (!kept?.shape) return;
    const goOn = () => {
      byId("notices").replaceChildren();
      return goOnWith(kept);
    };
    byId("notices").replaceChildren(
      h(
        "div",
        { class: "notice advisory" },
        icon("info"),
        h(
          "p",
          {},
          h("strong", {}, `${t("An edit was not saved.")} `),
          `${t("It is from {when}.", { when: whenText(kept.kept_at) })} `,
          h("button", { type: "button", class: "text-button", onclick: goOn }, t("Go on")),
          h(
            "button",
            { type: "button", class: "text-button", onclick: () => (draft.drop(), byId("notices").replaceChildren()) },
            t("Throw it away"),
          ),
        ),
      ),
    );
  }

  byId("record-save").addEventListener("click", save);
  byId("record-cancel").addEventListener("click", cancel);
  byId("record-more").addEventListener("click", () => load({ more: true }));
  if (page.canCurate) {
    const opener = byId("record-new");
    opener.hidden = false;
    const items = () =>
      about.newChoices.map((choice) => ({
        icon: choice.icon,
        label: choice.words,
        act: () => ((chosen = null), startEdit(null, { choice: choice.value })),
      }));
    opener.addEventListener("click", () =>
      about.newChoices.length > 1 ? toggleMenu(opener, () => menuOf(t("New"), items())) : items()[0].act(),
    );
  }
  map.onRecolour(() => editor.recolour());

  const step = (by) => () => {
    const rows = [...list.querySelectorAll("button")];
    if (views.find.hidden || !rows.length) return false;
    rows[(rows.indexOf(document.activeElement) + by + rows.length) % rows.length].focus();
    return true;
  };
  const whenEditing = (act) => () => (edit ? act() : false);
  const arrow = (right, down) => (event) =>
    edit && !event.target.matches?.("input, textarea, select")
      ? editor.nudge(right * (event.shiftKey ? 10 : 1), down * (event.shiftKey ? 10 : 1))
      : false;
  const bindings = [
    { keys: ["/"], words: about.findWords, act: () => (views.find.hidden ? false : byId("record-text").focus()) },
    { keys: ["j"], words: t("Next in the list"), act: step(1) },
    { keys: ["k"], words: t("Previous in the list"), act: step(-1) },
    {
      keys: ["e"],
      words: t("Edit"),
      act: () => (chosen && !edit && page.canCurate ? startEdit(chosen.feature) : false),
    },
    { keys: ["mod+z"], words: t("Undo"), act: whenEditing(editor.undo) },
    { keys: ["mod+shift+z", "mod+y"], words: t("Redo"), act: whenEditing(editor.redo) },
    { keys: ["mod+s"], words: t("Save"), whileTyping: true, act: () => (edit ? (save(), true) : false) },
    {
      keys: ["enter"],
      words: t("End the drawing"),
      act: (event) => (edit && !event.target.matches?.("button, a, summary, input") ? editor.finish() : false),
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
    {
      keys: ["escape"],
      words: t("A step back"),
      act: () => (edit ? editor.back() || cancel() : chosen ? back() : false),
    },
  ];

  async function start() {
    await open({
      bindings,
      async load() {
        editor.addTo();
        await load();
        map.map.on("moveend", () => about.followsView() && views.find.hidden === false && load());
        const id = new URL(location.href).searchParams.get("id");
        if (id && /^\d+$/.test(id)) await choose(id);
        if (page.canCurate) await offerDraft();
      },
    });
  }

  return { page, map, layout, start, load, choose, go };
}
