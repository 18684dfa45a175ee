/** The bar around every page: theme, keys, account. */

import { byId, find, h, icon } from "../dom.js";
import { showCopyBanner } from "../offline/banner.js";
import { keepForOffline } from "../offline/keeping.js";
import { copiedAt } from "../offline_copy.js";
import { t } from "../text.js";
import { startBell } from "./bell.js";
import { listenToKeys, showKeys } from "./keyboard.js";
import { watchSessionEnd } from "./session_end.js";
import { askBeforeSigningOut } from "./signing_out.js";
import { chosenTheme, nextTheme, onTheme, THEME_ICONS } from "./theme.js";

/** @type {Record<string, string>} */
const THEME_WORDS = { system: t("as the system"), light: t("light"), dark: t("dark") };

/** No rights in an offline copy. */
const NO_RIGHTS = { canPlan: false, canFly: false, canCurate: false };

/** @returns {any} what the server has written into the page for its script */
export function readPage() {
  const page = JSON.parse(byId("page").textContent ?? "");
  return copiedAt === null ? page : { ...page, ...NO_RIGHTS };
}

/** @import { Binding } from "./keyboard.js" */

/** Everywhere the same keys, and the page's own before them; strangers have no places to go to. @param {{ bindings?: Binding[] }} [own] */
export function startChrome({ bindings = [] } = {}) {
  /** @param {string} address */
  const go = (address) => () => {
    location.href = address;
  };
  /** @type {Binding[]} */
  const places = [
    { keys: ["n"], words: readPage().canPlan ? t("New mission") : t("Go to the map"), act: go("/missions/new") },
    { keys: ["g m"], words: t("Go to the missions"), act: go("/") },
    { keys: ["g l"], words: t("Go to what flies"), act: go("/live") },
    { keys: ["g a"], words: t("Go to the assets"), act: go("/assets") },
    { keys: ["g z"], words: t("Go to the zones"), act: go("/zones") },
    { keys: ["g u"], words: t("Go to the UAVs"), act: go("/uavs") },
  ];
  const isSignedIn = readPage().userId !== undefined;
  /** @type {Binding[]} */
  const all = [
    ...bindings,
    ...(isSignedIn ? places : []),
    { keys: ["?"], words: t("Show the keys"), act: () => showKeys(all) },
  ];
  listenToKeys(all);

  byId("open-keys").addEventListener("click", () => showKeys(all));
  const themeButton = byId("switch-theme");
  const label = () => {
    const theme = chosenTheme();
    themeButton.replaceChildren(icon(THEME_ICONS[theme]));
    themeButton.setAttribute("aria-label", t("Theme: {theme}", { theme: THEME_WORDS[theme] }));
    themeButton.title = t("Theme: {theme}", { theme: THEME_WORDS[theme] });
    for (const place of document.querySelectorAll("[data-theme-name]")) place.textContent = THEME_WORDS[theme];
  };
  themeButton.addEventListener("click", nextTheme);
  onTheme(label);
  label();

  if (isSignedIn) startAccount(all);
}

/** What only users have: alerts, their menu, the session's end and offline copies. @param {Binding[]} bindings */
function startAccount(bindings) {
  startBell();
  const account = byId("open-account");
  account.addEventListener("click", () => toggleMenu(account, () => accountMenu(bindings)));
  if (copiedAt === null) {
    watchSessionEnd(readPage().sessionEndsIn_s);
    keepForOffline(readPage());
  } else showCopyBanner(copiedAt);
  byId("open-more").addEventListener("click", () => toggleMenu(account, () => accountMenu(bindings)));
}

/** @param {Binding[]} bindings */
function accountMenu(bindings) {
  const template = byId("account-menu", HTMLTemplateElement);
  const menu = /** @type {HTMLElement} */ (document.importNode(template.content, true).firstElementChild);
  find(menu, "[data-theme-name]").textContent = THEME_WORDS[chosenTheme()];
  find(menu, "[data-act=theme]").addEventListener("click", nextTheme);
  askBeforeSigningOut(find(menu, "form", HTMLFormElement), readPage().userId);
  find(menu, "[data-act=keys]").addEventListener("click", () => {
    closeMenu();
    showKeys(bindings);
  });
  return menu;
}

/** @type {{ opener: HTMLElement, menu: HTMLElement } | null} */
let openMenu = null;

/**
 * A menu below its opener; Escape and a click elsewhere close it.
 *
 * @param {HTMLElement} opener
 * @param {() => HTMLElement} make
 */
export function toggleMenu(opener, make) {
  const wasOpen = openMenu?.opener === opener;
  closeMenu();
  if (wasOpen) return;
  const menu = make();
  document.body.append(menu);
  const box = opener.getBoundingClientRect();
  const left = Math.min(Math.max(8, box.right - menu.offsetWidth), innerWidth - menu.offsetWidth - 8);
  const below = box.bottom + 6 + scrollY;
  menu.style.left = `${left}px`;
  menu.style.top = `${box.bottom + menu.offsetHeight + 12 > innerHeight ? Math.max(8, box.top + scrollY - menu.offsetHeight - 6) : below}px`;
  opener.setAttribute("aria-expanded", "true");
  openMenu = { opener, menu };
  const first = /** @type {HTMLElement | null} */ (menu.querySelector("button, a, input"));
  first?.focus({ preventScroll: true });
  menu.addEventListener("keydown", (event) => {
    const items = /** @type {HTMLElement[]} */ ([...menu.querySelectorAll("button, a")]);
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    const place = items.indexOf(/** @type {HTMLElement} */ (document.activeElement));
    if (step && place >= 0) {
      event.preventDefault();
      items[(place + step + items.length) % items.length].focus();
    }
  });
}

export function closeMenu() {
  if (!openMenu) return false;
  const { opener, menu } = openMenu;
  openMenu = null;
  const hadFocus = menu.contains(document.activeElement);
  menu.remove();
  opener.setAttribute("aria-expanded", "false");
  if (hadFocus) opener.focus({ preventScroll: true });
  return true;
}

document.addEventListener("pointerdown", (event) => {
  const target = /** @type {Node | null} */ (event.target);
  if (openMenu && !openMenu.menu.contains(target) && !openMenu.opener.contains(target)) closeMenu();
});
document.addEventListener("keydown", (event) => {
  if (event.key === "Escape" && closeMenu()) event.preventDefault();
});

/** @typedef {{ icon: string, label: string, act: () => unknown, reason?: string | null }} MenuItem `reason`: why it is disabled */

/** A menu of buttons. @param {string} label @param {MenuItem[]} items */
export function menuOf(label, items) {
  return h(
    "div",
    { class: "menu float", role: "group", "aria-label": label },
    items.map((item) =>
      h(
        "button",
        {
          type: "button",
          disabled: Boolean(item.reason),
          title: item.reason || null,
          onclick: () => {
            closeMenu();
            item.act();
          },
        },
        icon(item.icon),
        item.label,
      ),
    ),
  );
}
