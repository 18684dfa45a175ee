/** Over the map: what a box or a lasso has found, with ticks by kind, line and voltage, before it is added. */

import { h } from "../../dom.js";
import { t, tn } from "../../text.js";
import { numberText } from "../../units.js";
import { MAX_TARGETS } from "../selection.js";
import { areLines, caughtWords, groupsOf, linesOf, rowsWithout } from "../targets/caught.js";

/** @import { Group, GroupName } from "../targets/caught.js" */
/** @import { Caught, MissionActions, MissionStore } from "../types.d.ts" */

/** @type {Record<GroupName, string>} */
const TITLES = { kind: t("Kind"), line: t("Line"), voltage: t("Voltage") };

/** @param {HTMLElement} frame @param {MissionStore} store @param {MissionActions} actions */
export function mountCaught(frame, store, actions) {
  /** @type {Set<string>} keys of groups that are not wanted */
  let off = new Set();
  /** @type {Caught["rows"] | null} */
  let shown = null;
  const title = h("h2", { id: "caught-title" });
  const covered = h("p", { class: "caption" });
  const groups = h("div", { class: "caught-groups" });
  const why = h("p", { class: "caption", role: "status" });
  const add = h("button", { type: "submit", class: "button primary" });
  const along = h("button", { type: "button", class: "button", onclick: () => void actions.addCaughtLines() });
  const cancel = h("button", { type: "button", class: "button", onclick: actions.dropCaught }, t("Cancel"));
  /** @type {Element | null} */
  let opener = null;
  const form = h("form", {}, title, covered, groups, why, h("div", { class: "caught-acts" }, add, along, cancel));
  const panel = h(
    "div",
    { class: "caught float", role: "dialog", "aria-labelledby": "caught-title", hidden: true },
    form,
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    actions.addCaught();
  });
  panel.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    actions.dropCaught();
  });
  frame.append(panel);

  /** @param {Group} group */
  const tick = ({ key, words, count }) => {
    const box = h("input", { type: "checkbox", class: "check", checked: true });
    box.addEventListener("change", () => {
      if (box.checked) off.delete(key);
      else off.add(key);
      const { caught } = store.state;
      if (caught) store.update({ caught: { ...caught, chosen: rowsWithout(caught.rows, off) } });
    });
    return h("label", {}, box, h("span", {}, words), h("span", { class: "caption" }, numberText(count)));
  };

  store.listen(["caught", "selection"], ({ caught, selection }) => {
    const isOpened = caught !== null && panel.hidden;
    const isLeft = caught === null && panel.contains(document.activeElement);
    if (isOpened) opener = document.activeElement;
    panel.hidden = caught === null;
    if (isLeft) focusAgain(opener, frame);
    if (caught && caught.rows !== shown) {
      off = new Set();
      groups.replaceChildren(
        ...groupsOf(caught.rows).map(([name, found]) =>
          h("fieldset", {}, h("legend", {}, TITLES[name]), found.map(tick)),
        ),
      );
      covered.textContent = coveredWords(caught.covered);
    }
    const isNew = caught !== null && caught.rows !== shown;
    shown = caught?.rows ?? null;
    if (!caught) return;
    const { length: count } = caught.chosen;
    const room = MAX_TARGETS - selection.targets.length;
    title.textContent = caughtWords(caught.rows);
    add.textContent = tn(count, "Add {count} target", "Add {count} targets");
    add.disabled = count === 0 || count > room;
    add.hidden = areLines(caught.rows); // in parts inside the area alone
    along.classList.toggle("primary", add.hidden);
    const lines = linesOf(caught.chosen).length;
    along.hidden = lines === 0;
    along.disabled = lines > room;
    along.textContent = tn(lines, "Fly along its line", "Fly along their {count} lines");
    why.textContent =
      !add.hidden && count > room ? t("A mission takes {most} targets.", { most: numberText(MAX_TARGETS) }) : "";
    if (isNew) (add.hidden ? along : add.disabled ? cancel : add).focus({ preventScroll: true });
  });
}

/** Where the focus was, else the map. @param {Element | null} opener @param {HTMLElement} frame */
function focusAgain(opener, frame) {
  const isThere = opener instanceof HTMLElement && opener !== document.body && opener.isConnected;
  const place = isThere ? opener : frame.querySelector("canvas");
  /** @type {HTMLElement | null} */ (place)?.focus({ preventScroll: true });
}

/** @param {number} count */
const coveredWords = (count) =>
  count
    ? tn(
        count,
        "{count} tower of a line that is picked already is left out.",
        "{count} towers of lines that are picked already are left out.",
      )
    : "";
