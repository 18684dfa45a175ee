/** Keys of the page, and the sheet that lists them. Single keys are off while the user types. */

import { h } from "../dom.js";
import { t } from "../text.js";

/**
 * What a key does. An act that returns false leaves the key to the browser.
 *
 * @typedef {{ keys: string[], words?: string, act: (event: KeyboardEvent) => unknown, whileTyping?: boolean }} Binding
 */

/** @type {Record<string, string>} */
const NAMES = {
  mod: "Ctrl",
  shift: t("Shift"),
  delete: t("Del"),
  escape: t("Esc"),
  alt: "Alt",
  arrowup: "↑",
  arrowdown: "↓",
};

/** @param {EventTarget | null} target */
export function isTyping(target) {
  return (
    target instanceof HTMLElement &&
    (target.isContentEditable ||
      target.matches("input:not([type=checkbox], [type=radio], [type=range]), textarea, select"))
  );
}

/**
 * "mod+shift+z", "/", "?" — a letter or sign names itself; Shift counts only with letters and with Ctrl.
 *
 * @param {KeyboardEvent} event
 */
export function keyName(event) {
  const key = event.key.toLowerCase();
  const parts = [];
  if (event.ctrlKey || event.metaKey) parts.push("mod");
  if (event.altKey) parts.push("alt");
  if (event.shiftKey && (parts.length || /^[a-z]$/.test(key))) parts.push("shift");
  return [...parts, key].join("+");
}

/**
 * Whether one or several plain characters suffice: WCAG 2.1.4 requires that these can be switched off.
 *
 * @param {string} keys
 */
export function isSingleKey(keys) {
  return keys.split(" ").every((key) => /^(shift\+)?.$/.test(key));
}

function singleKeysAreOff() {
  return document.documentElement.dataset.singleKeys === "off";
}

/**
 * Calls the acts of the keys that are pressed.
 *
 * @param {Binding[]} bindings
 */
export function listenToKeys(bindings) {
  let prefix = "";
  let prefixAt = 0;
  document.addEventListener("keydown", (event) => {
    if (event.defaultPrevented || event.isComposing) return;
    if (document.querySelector("dialog[open]")) return;
    const name = keyName(event);
    if (isSingleKey(name) && singleKeysAreOff()) return;
    const isChord = prefix && Date.now() - prefixAt < 1200;
    const whole = isChord ? `${prefix} ${name}` : name;
    prefix = "";
    const binding = bindings.find((candidate) => candidate.keys.includes(whole));
    if (!binding) {
      if (
        !isTyping(event.target) &&
        bindings.some((candidate) => candidate.keys.some((keys) => keys.startsWith(`${name} `)))
      ) {
        prefix = name;
        prefixAt = Date.now();
      }
      return;
    }
    if (isTyping(event.target) && !binding.whileTyping) return;
    if (binding.act(event) !== false) event.preventDefault();
  });
}

/** @param {string} keys */
function caps(keys) {
  return (keys.match(/[^+ ]+|\+$/g) ?? []).map((key) =>
    h("kbd", {}, NAMES[key] ?? (key.length === 1 ? key.toUpperCase() : key)),
  );
}

/** @param {Binding[]} bindings */
export function showKeys(bindings) {
  const dialog = h(
    "dialog",
    { class: "keys", "aria-labelledby": "keys-title" },
    h("h2", { id: "keys-title" }, t("Keyboard")),
    h(
      "p",
      { class: "caption" },
      singleKeysAreOff() ? t("Single keys are switched off in your account.") : t("Single keys rest while you type."),
    ),
    h(
      "dl",
      { class: "key-list" },
      bindings
        .filter((binding) => binding.words && !(singleKeysAreOff() && binding.keys.every(isSingleKey)))
        .map((binding) => h("div", {}, h("dt", {}, caps(binding.keys[0])), h("dd", {}, binding.words))),
    ),
    h("form", { method: "dialog", class: "acts" }, h("button", { class: "button" }, t("Close"))),
  );
  open(dialog);
}

/**
 * Show a dialog, remove it when it closes, and return the focus to where it was, unless another element has it by then: the event arrives
 * a frame late.
 *
 * @param {HTMLDialogElement} dialog
 */
export function open(dialog) {
  const opener = document.activeElement;
  document.body.append(dialog);
  dialog.addEventListener("close", () => {
    dialog.remove();
    const isFree = !document.activeElement || document.activeElement === document.body;
    if (isFree && opener instanceof HTMLElement && opener.isConnected) opener.focus();
  });
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
  dialog.showModal();
}
