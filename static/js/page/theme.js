/** Theme: light, dark or the system's. Stored in the account of a signed-in user, and in this browser for the pages before login. */

import { patch } from "../api.js";

const KEY = "spanwise.theme";
const ORDER = ["system", "light", "dark"];
/** @type {Record<string, string>} */
export const THEME_ICONS = { system: "monitor", light: "sun", dark: "moon" };
/** @type {Set<() => void>} */
const listeners = new Set();
/** @type {Promise<unknown>} */
let kept = Promise.resolve();

export function chosenTheme() {
  return document.documentElement.dataset.theme ?? "system";
}

/** @param {string} theme */
export function chooseTheme(theme) {
  if (theme === "system") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme;
  try {
    if (theme === "system") localStorage.removeItem(KEY);
    else localStorage.setItem(KEY, theme);
  } catch {
    /* storage is closed: the choice lasts as long as the page */
  }
  if (document.documentElement.dataset.themeOf === "account") {
    kept = kept.then(() => patch("/account", { theme })).catch(() => {}); // unavailable: the choice lasts as long as the page
  }
  for (const notify of listeners) notify();
}

export function nextTheme() {
  chooseTheme(ORDER[(ORDER.indexOf(chosenTheme()) + 1) % ORDER.length]);
}

/** Report each change of the theme, also of the system's. Returns a function that ends it. @param {() => void} notify */
export function onTheme(notify) {
  listeners.add(notify);
  return () => listeners.delete(notify);
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  if (chosenTheme() === "system") for (const notify of listeners) notify();
});
