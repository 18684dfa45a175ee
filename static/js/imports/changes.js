/** The lines of a difference: counts as filters, old and new values, linked with the map. */

import { byId, find, h, keyedList, setChildren } from "../dom.js";
import { t, tn } from "../text.js";
import { numberText } from "../units.js";
import { ACTIONS, factLines } from "./words.js";

/** @import { Store } from "../store.js" */
/** @import { Change, ImportsState, Proposal } from "./types.d.ts" */

/** @type {Record<string, string>} */
const SUBJECTS = {
  tower: t("Tower"),
  line: t("Line"),
  railway: t("Railway"),
  bridge: t("Bridge"),
  zone: t("Zone"),
  terrain: t("Terrain"),
};

/**
 * @typedef {object} ChangeActs
 * @property {(action: string) => void} filter
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
    const facts = element.querySelector(".change-facts");
    if (isSelected === !facts) {
      if (facts) facts.remove();
      else element.append(factsOf(change.properties));
    }
  }

  store.listen(["current", "action"], ({ current, action }) => drawFilters(current, action, acts));
  store.listen(["changes", "action", "listed", "lit", "selected"], ({ changes, action, listed }) => {
    const wanted = action ? changes.filter((change) => change.properties.action === action) : changes;
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
  const element = h("li", {}, button);
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

/** @param {Proposal | null} current @param {string} action that is chosen @param {ChangeActs} acts */
function drawFilters(current, action, acts) {
  const place = byId("change-filters");
  const difference = current?.difference ?? {};
  const counted = Object.entries(ACTIONS).filter(([name]) => difference[name] > 0);
  place.hidden = counted.length === 0;
  const all = counted.reduce((sum, [name]) => sum + difference[name], 0);
  const choices = [
    { value: "", sign: "", words: t("All"), count: all },
    ...counted.map(([value, { sign, short }]) => ({ value, sign, words: short, count: difference[value] })),
  ];
  /** @type {HTMLInputElement | null} */
  const focused = place.querySelector("input:focus");
  setChildren(
    place,
    h("legend", { class: "unseen" }, t("Which changes")),
    choices.map(({ value, sign, words, count }) => {
      const choose = () => acts.filter(value);
      const mark = sign && h("b", { class: value, "aria-hidden": "true" }, sign);
      return h(
        "label",
        {},
        h("input", { type: "radio", name: "change-filter", value, checked: action === value, onchange: choose }),
        h(
          "span",
          { class: "segment" },
          h("span", { class: "change-word" }, mark, words),
          h("small", {}, numberText(count)),
        ),
      );
    }),
  );
  if (focused) [...place.querySelectorAll("input")].find((input) => input.value === focused.value)?.focus();
}
