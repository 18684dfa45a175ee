/** A guided tour of five steps over the list of missions: started once automatically, then from the account's menu. */

import { h, icon } from "../dom.js";
import { t } from "../text.js";

/**
 * @typedef {object} Step
 * @property {string} title
 * @property {string} text
 * @property {string[]} at selectors of the elements described; the first that is shown is marked
 */

/** @type {Step[]} */
const STEPS = [
  {
    title: t("Missions"),
    text: t(
      "A mission is planned, rehearsed in simulation, approved and flown, and then has a report. Open one to see its stages.",
    ),
    at: ["#missions", ".page-head h1"],
  },
  {
    title: t("Plan"),
    text: t(
      "Pick towers, lines or bridges on the map and choose UAVs. Routes keep to batteries, wind, terrain and no-fly zones.",
    ),
    at: [".page-head a[href='/missions/new']", ".tabs a[href='/missions/new']"],
  },
  {
    title: t("Live"),
    text: t("Follow UAVs in flight, acknowledge alerts, and hold, return or land a UAV."),
    at: [".bar a[href='/live']", ".tabs a[href='/live']"],
  },
  {
    title: t("Assets and zones"),
    text: t("Your network and the no-fly zones. Import your own from OpenStreetMap, GIS files or zone services."),
    at: [".bar a[href='/assets']", "#open-more"],
  },
  {
    title: t("UAVs"),
    text: t("Connect your own UAV by MAVLink, or fly simulated ones. The account menu starts this tour again."),
    at: [".bar a[href='/uavs']", "#open-more"],
  },
];

/** @param {number | string} userId */
const keyOf = (userId) => `tour-seen-${userId}`;

/** @param {number | string} userId */
export function isTourSeen(userId) {
  try {
    return localStorage.getItem(keyOf(userId)) !== null;
  } catch {
    return true; // without a memory it would come again on each page
  }
}

/** @param {number | string} userId */
function remember(userId) {
  try {
    localStorage.setItem(keyOf(userId), new Date().toISOString());
  } catch {
    // A browser without storage does not start the tour automatically.
  }
}

/** @param {{ userId: number | string, takesFocus: boolean }} how */
export function startTour({ userId, takesFocus }) {
  const opener = document.activeElement;
  let number = 0;
  const title = h("h2", { id: "tour-title" });
  const text = h("p", { id: "tour-text" });
  const count = h("span", { class: "caption" });
  const back = h("button", { type: "button", class: "button quiet", onclick: () => show(number - 1) }, t("Back"));
  const next = h("button", { type: "button", class: "button primary", onclick: () => show(number + 1) });
  const close = h(
    "button",
    { type: "button", class: "button quiet icon-button", "aria-label": t("End the tour"), onclick: () => end() },
    icon("x", "small"),
  );
  const card = h(
    "section",
    { class: "tour float", role: "dialog", "aria-labelledby": "tour-title", "aria-describedby": "tour-text" },
    h("header", {}, title, close),
    h("div", { "aria-live": "polite" }, text),
    h("footer", {}, count, back, next),
  );

  function unmark() {
    for (const marked of document.querySelectorAll(".tour-target")) marked.classList.remove("tour-target");
  }

  function end() {
    remember(userId);
    unmark();
    card.remove();
    document.removeEventListener("keydown", onKey);
    if (opener instanceof HTMLElement) opener.focus();
  }

  /** @param {number} step */
  function show(step) {
    if (step >= STEPS.length) return end();
    number = Math.max(step, 0);
    const { title: words, text: more, at } = STEPS[number];
    title.textContent = words;
    text.textContent = more;
    count.textContent = t("{number} of {all}", { number: String(number + 1), all: String(STEPS.length) });
    back.disabled = number === 0;
    next.textContent = number === STEPS.length - 1 ? t("Done") : t("Next step");
    unmark();
    const targets = at.map((selector) => document.querySelector(selector));
    targets.find((element) => element?.getClientRects().length)?.classList.add("tour-target");
  }

  /** @param {KeyboardEvent} event */
  function onKey(event) {
    if (event.key === "Escape" && !document.querySelector("dialog[open]")) end();
    if (!card.contains(document.activeElement)) return;
    if (event.key === "ArrowRight") show(number + 1);
    if (event.key === "ArrowLeft") show(number - 1);
  }

  document.querySelector(".tour")?.remove();
  document.body.append(card);
  document.addEventListener("keydown", onKey);
  show(0);
  if (takesFocus) next.focus();
}
