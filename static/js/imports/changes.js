/** The lines of a difference: counts as filters, what was and what would be, linked with the map. */

import { byId, h, keyedList } from "../dom.js";
import { t, tn } from "../text.js";
import { numberText } from "../units.js";
import { ACTIONS, factLines } from "./words.js";

const SUBJECTS = {
  tower: t("Tower"),
  line: t("Line"),
  railway: t("Railway"),
  bridge: t("Bridge"),
  zone: t("Zone"),
  terrain: t("Terrain"),
};

/** acts: { filter(action), point(change or null), show(change), more() } */
export function mountChanges(store, acts) {
  const list = byId("changes");
  const draw = keyedList(
    list,
    (change) => change.id,
    (change) => row(change, acts),
    mark,
  );

  function mark(element, change) {
    const isSelected = change.id === store.state.selected;
    element.querySelector("button").setAttribute("aria-expanded", String(isSelected));
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
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const rows = [...list.querySelectorAll("button.change")];
    rows[rows.indexOf(document.activeElement) + step]?.focus();
  });
}

function row(change, acts) {
  const { action, label, subject } = change.properties;
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

/** The names of what differs, for the second line. */
function shortOf(properties) {
  if (properties.action !== "changed" && properties.action !== "kept") return "";
  const names = factLines(properties).map(({ words }) => words);
  if (!names.length) return "";
  return `: ${names.slice(0, 3).join(", ")}${names.length > 3 ? ` ${tn(names.length - 3, "and {count} more", "and {count} more")}` : ""}`;
}

function factsOf(properties) {
  const lines = factLines(properties);
  const isPair = properties.before !== null && properties.after !== null;
  if (!lines.length) return h("p", { class: "change-facts caption" }, t("Nothing else is known of it."));
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

function drawFilters(current, action, acts) {
  const place = byId("change-filters");
  const counted = Object.keys(ACTIONS).filter((name) => current?.difference[name] > 0);
  place.hidden = counted.length === 0;
  const all = counted.reduce((sum, name) => sum + current.difference[name], 0);
  const choices = [
    ["", "", t("All"), all],
    ...counted.map((name) => [name, ACTIONS[name].sign, ACTIONS[name].short, current.difference[name]]),
  ];
  const had = place.contains(document.activeElement) ? document.activeElement.value : null;
  place.replaceChildren(
    h("legend", { class: "unseen" }, t("Which changes")),
    ...choices.map(([value, sign, words, count]) =>
      h(
        "label",
        {},
        h("input", {
          type: "radio",
          name: "change-filter",
          value,
          checked: action === value,
          onchange: () => acts.filter(value),
        }),
        h(
          "span",
          { class: "segment" },
          h("span", { class: "change-word" }, sign && h("b", { class: value, "aria-hidden": "true" }, sign), words),
          h("small", {}, numberText(count)),
        ),
      ),
    ),
  );
  if (had !== null) [...place.querySelectorAll("input")].find((input) => input.value === had)?.focus();
}
