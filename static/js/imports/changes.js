/** The lines of a difference: counts as filters, old and new values, linked with the map. */

import { byId, find, h, keyedList, setChildren } from "../dom.js";
import { t, tn } from "../text.js";
import { numberText } from "../units.js";
import { ACTIONS, factLines } from "./words.js";

/** @import { Store } from "../store.js" */
/** @import { Action, Change, ImportsState, Proposal } from "./types.d.ts" */

/** @type {Record<string, string>} */
const SUBJECTS = {
  tower: t("Tower"),
  line: t("Line"),
  railway: t("Railway"),
  bridge: t("Bridge"),
  zone: t("Zone"),
  terrain: t("Terrain"),
};

/** @type {Record<string, string>} */
const PLURALS = {
  tower: t("Towers"),
  line: t("Lines"),
  railway: t("Railways"),
  bridge: t("Bridges"),
  zone: t("Zones"),
  terrain: t("Terrain"),
};

/** @typedef {{ action: string, subject: string }} Filter */
/**
 * @typedef {object} ChangeActs
 * @property {(filter: Filter) => void} filter
 * @property {(change: Change, isLeftOut: boolean) => void} leaveOut
 * @property {(change: Change | null) => void} point
 * @property {(change: Change) => void} show
 * @property {() => void} more
 */

/** @param {Store<ImportsState>} store @param {ChangeActs} acts */
export function mountChanges(store, acts) {
  const list = byId("changes");
  const draw = keyedList(
    list,
    (/** @type {Change} */ change) => change.id,
    (change) => row(change, acts),
    mark,
  );

  /** @param {HTMLElement} element @param {Change} change */
  function mark(element, change) {
    const isSelected = change.id === store.state.selected;
    find(element, "button").setAttribute("aria-expanded", String(isSelected));
    element.dataset.lit = String(change.id === store.state.lit);
    const box = element.querySelector("input");
    const { key } = change.properties;
    if (box && key) {
      box.checked = !store.state.excluded.includes(key);
      /** @type {HTMLElement} */ (box.parentElement).hidden = store.state.current?.state !== "ready";
      element.classList.toggle("left-out", !box.checked);
    }
    const facts = element.querySelector(".change-facts");
    if (isSelected === !facts) {
      if (facts) facts.remove();
      else element.append(factsOf(change.properties));
    }
  }

  store.listen(["current", "action", "subject"], ({ current, action, subject }) =>
    drawTable(current, { action, subject }, acts),
  );
  store.listen(["current", "changes", "action", "subject", "listed", "lit", "selected", "excluded"], (state) => {
    const { changes, action, subject, listed } = state;
    const wanted = changes.filter(
      ({ properties }) => (!action || properties.action === action) && (!subject || properties.subject === subject),
    );
    draw(wanted.slice(0, listed));
    byId("more-changes").hidden = wanted.length <= listed;
  });
  byId("more-changes").addEventListener("click", acts.more);
  list.addEventListener("keydown", (event) => {
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    if (!step) return;
    event.preventDefault();
    /** @type {NodeListOf<HTMLElement>} */
    const rows = list.querySelectorAll("button.change");
    const place = [...rows].findIndex((row) => row.matches(":focus"));
    rows[place + step]?.focus();
  });
}

/** @param {Change} change @param {ChangeActs} acts */
function row(change, acts) {
  const { action, label, subject = "" } = change.properties;
  const { words, sign } = ACTIONS[action];
  const button = h(
    "button",
    { type: "button", class: "change", "aria-expanded": "false", onclick: () => acts.show(change) },
    h("span", { class: `change-mark ${action}`, "aria-hidden": "true" }, sign),
    h(
      "span",
      { class: "change-what" },
      h("strong", {}, label || SUBJECTS[subject] || subject),
      h("span", { class: "caption" }, `${SUBJECTS[subject] ?? subject}, ${words}${shortOf(change.properties)}`),
    ),
  );
  const box = h("input", { class: "check", type: "checkbox", checked: true });
  box.addEventListener("change", () => acts.leaveOut(change, !box.checked));
  const name = label || SUBJECTS[subject] || subject;
  const apply = h(
    "label",
    { class: "leave-out", title: t("Apply this change") },
    box,
    h("span", { class: "unseen" }, t("Apply: {name}", { name })),
  );
  const canLeaveOut = Boolean(change.properties.key) && action !== "not_read";
  const element = h("li", {}, button, canLeaveOut && apply);
  for (const come of ["pointerenter", "focusin"]) element.addEventListener(come, () => acts.point(change));
  for (const go of ["pointerleave", "focusout"]) element.addEventListener(go, () => acts.point(null));
  return element;
}

/** The names of the differences, for the second line. @param {Change["properties"]} properties */
function shortOf(properties) {
  if (properties.action !== "changed" && properties.action !== "kept") return "";
  const names = factLines(properties).map(({ words }) => words);
  if (!names.length) return "";
  return `: ${names.slice(0, 3).join(", ")}${names.length > 3 ? ` ${tn(names.length - 3, "and {count} more", "and {count} more")}` : ""}`;
}

/** @param {Change["properties"]} properties */
function factsOf(properties) {
  const lines = factLines(properties);
  const isPair = properties.before !== null && properties.after !== null;
  if (!lines.length) return h("p", { class: "change-facts caption" }, t("Nothing else is known of it."));
  /** @param {string | null} text @param {string} kind */
  const value = (text, kind) => h("span", { class: kind }, text);
  return h(
    "dl",
    { class: "change-facts" },
    lines.map(({ words, before, after }) =>
      h(
        "div",
        {},
        h("dt", {}, words),
        h(
          "dd",
          {},
          isPair
            ? [
                h("span", { class: "unseen" }, `${t("before")} `),
                value(before, "before"),
                h("span", { "aria-hidden": "true" }, " → "),
                h("span", { class: "unseen" }, `${t(", after")} `),
                value(after, "after"),
              ]
            : value(after ?? before, "after"),
        ),
      ),
    ),
  );
}

/** Columns of the table; those of `ALWAYS` are shown also where nothing is in them. @type {(Action | "unchanged")[]} */
const COLUMNS = ["new", "changed", "vanished", "kept", "not_read", "unchanged"];
const ALWAYS = ["new", "changed", "vanished", "unchanged"];
/** In the order of the network, towers first. */
const KIND_ORDER = ["tower", "line", "railway", "bridge", "zone", "terrain"];

/**
 * Rows and columns of the table of a difference. A proposal of an earlier version has no numbers by kind: it has one row.
 *
 * @param {Pick<Proposal, "difference" | "summary">} proposal
 * @returns {{ columns: (Action | "unchanged")[], rows: { kind: string, words: string, counts: Record<string, number> }[] }}
 */
export function tableOf({ difference, summary }) {
  const byKind = summary.by_kind ?? {};
  const kinds = Object.keys(byKind).sort((one, other) => KIND_ORDER.indexOf(one) - KIND_ORDER.indexOf(other));
  const rows = kinds.map((kind) => ({ kind, words: PLURALS[kind] ?? kind, counts: byKind[kind] }));
  const total = { kind: "", words: rows.length ? t("All") : t("Rows"), counts: difference };
  const columns = COLUMNS.filter((name) => ALWAYS.includes(name) || difference[name] > 0);
  return { columns, rows: rows.length === 1 && !difference.not_read ? rows : [...rows, total] };
}

/** @param {Action | "unchanged"} name */
function columnHead(name) {
  if (name === "unchanged") return t("Unchanged");
  const { sign, short } = ACTIONS[name];
  return [h("b", { class: name, "aria-hidden": "true" }, sign), " ", name === "vanished" ? t("Removed") : short];
}

/** @param {Proposal | null} current @param {Filter} chosen @param {ChangeActs} acts */
function drawTable(current, chosen, acts) {
  const place = byId("change-table");
  const focused = place.querySelector("button:focus")?.getAttribute("data-cell");
  place.hidden = !current || Object.keys(current.difference).length === 0;
  if (!current || place.hidden) return;
  const { columns, rows } = tableOf(current);
  /** @param {string} kind @param {string} words @param {Action | "unchanged"} name @param {number} count */
  function cell(kind, words, name, count) {
    if (!count || name === "unchanged") return h("td", {}, count ? numberText(count) : "–");
    const isChosen = chosen.action === name && chosen.subject === kind;
    const choose = () => acts.filter(isChosen ? { action: "", subject: "" } : { action: name, subject: kind });
    const label = `${words}, ${ACTIONS[name].words}: ${numberText(count)}`;
    const properties = {
      type: "button",
      class: "cell",
      "aria-pressed": `${isChosen}`,
      "aria-label": label,
      onclick: choose,
    };
    return h("td", {}, h("button", { ...properties, "data-cell": `${kind} ${name}` }, numberText(count)));
  }
  setChildren(
    place,
    h("caption", { class: "unseen" }, t("Changes by kind; a number filters the list")),
    h(
      "thead",
      {},
      h(
        "tr",
        {},
        h("td", {}),
        columns.map((name) => h("th", { scope: "col" }, columnHead(name))),
      ),
    ),
    h(
      "tbody",
      {},
      rows.map(({ kind, words, counts }) =>
        h(
          "tr",
          { class: kind ? "" : "total" },
          h("th", { scope: "row" }, words),
          columns.map((name) => cell(kind, words, name, counts[name] ?? 0)),
        ),
      ),
    ),
  );
  if (focused) find(place, `[data-cell="${focused}"]`, HTMLElement).focus();
}
