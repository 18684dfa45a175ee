/** Light, dark or the system's: kept in this browser. */

const KEY = "spanwise.theme";
const ORDER = ["system", "light", "dark"];
export const THEME_ICONS = { system: "monitor", light: "sun", dark: "moon" };
const listeners = new Set();

export function chosenTheme() {
  return document.documentElement.dataset.theme ?? "system";
}

export function chooseTheme(theme) {
  if (theme === "system") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme;
  try {
    if (theme === "system") localStorage.removeItem(KEY);
    else localStorage.setItem(KEY, theme);
  } catch {
    /* storage is closed: the choice lasts as long as the page */
  }
  listeners.forEach((tell) => tell());
}

export function nextTheme() {
  chooseTheme(ORDER[(ORDER.indexOf(chosenTheme()) + 1) % ORDER.length]);
}

/** Tells of each change, the system's own included. */
export function onTheme(tell) {
  listeners.add(tell);
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  if (chosenTheme() === "system") listeners.forEach((tell) => tell());
});
