/** Commands for the chosen UAV, over the map's lower edge; on a phone at thumb height. */

import { byId, h, icon } from "../../dom.js";
import { KINDS } from "../../domain/flying.js";
import { colourClass } from "../../domain/palette.js";
import { menuOf, toggleMenu } from "../../page/chrome.js";
import { t } from "../../text.js";
import { letterOf } from "../call_signs.js";
import { batchScopes, whyNot } from "../commands/batch.js";
import { isHeld } from "../text/uav_text.js";
import { uavMenu } from "../uav_menu.js";

/** @import { AskedKind } from "../../domain/command_questions.js" */
/** @import { Binding } from "../../page/keyboard.js" */
/** @import { Commanding, LiveUav, MonitorState, MonitorStore } from "../types.d.ts" */

/** @typedef {{ kind: AskedKind, image: string, words: string, isDanger?: boolean }} CommandButton */

/** @type {CommandButton[]} */
const BUTTONS = [
  { kind: "hold", image: "hand", words: KINDS.hold },
  { kind: "return", image: "house", words: KINDS.return },
  { kind: "land", image: "plane-landing", words: KINDS.land },
  { kind: "abort", image: "octagon-alert", words: KINDS.abort, isDanger: true },
];

/** @param {Readonly<MonitorState>} state @returns {LiveUav | null} */
const chosenUav = (state) => state.uavs.find(({ id }) => id === state.chosen) ?? null;

/** The chosen UAV if it can receive a command now. @param {Readonly<MonitorState>} state @returns {LiveUav | null} */
function chosenFlyer(state) {
  const uav = chosenUav(state);
  return uav && !whyNot(uav) ? uav : null;
}

/** The act of the Hold button: a UAV that holds is resumed. @param {LiveUav} uav */
const holdOrResume = (uav) => (isHeld(uav) ? "resume" : "hold");

/** @param {MonitorStore} store @param {Commanding} commanding */
function makeButtons(store, commanding) {
  return BUTTONS.map(({ kind, image, words, isDanger }) => {
    /** @param {Event} event */
    const ask = ({ currentTarget }) => {
      const uav = chosenFlyer(store.state);
      const opener = /** @type {HTMLElement} */ (currentTarget);
      if (uav) void commanding.ask(uav.id, kind === "hold" ? holdOrResume(uav) : kind, opener);
    };
    const look = `command-button ${isDanger ? "danger" : ""}`;
    const properties = { type: "button", class: look, "data-kind": kind, onclick: ask };
    return h("button", properties, icon(image), h("span", {}, words));
  });
}

/** The menu of rare commands, read when it is opened. @param {MonitorStore} store @param {Commanding} commanding */
function makeMore(store, commanding) {
  const more = h(
    "button",
    { type: "button", class: "command-button", "aria-haspopup": "true", "aria-expanded": "false" },
    icon("ellipsis"),
    h("span", {}, t("More")),
  );
  more.addEventListener("click", async () => {
    const uav = chosenUav(store.state);
    if (!uav?.mission) return;
    more.setAttribute("aria-busy", "true");
    const items = await uavMenu(
      { mission: uav.mission, uav: uav.id, silent: whyNot(uav) },
      { opener: more, ask: (kind) => commanding.ask(uav.id, kind, more) },
    );
    more.removeAttribute("aria-busy");
    const isStillAsked = chosenUav(store.state)?.id === uav.id && more.checkVisibility();
    if (items && isStillAsked) toggleMenu(more, () => menuOf(t("Commands to {name}", { name: uav.name }), items));
  });
  return more;
}

/** "Hold all" and "Return all" in the foot of the side. @param {MonitorStore} store @param {Commanding} commanding */
function mountAll(store, commanding) {
  const hold = byId("hold-all", HTMLButtonElement);
  const home = byId("return-all", HTMLButtonElement);
  hold.addEventListener("click", () => void commanding.askAll("hold", hold));
  home.addEventListener("click", () => void commanding.askAll("return", home));
  store.listen(["uavs", "missions"], (state) => {
    const isIdle = batchScopes(state.uavs, state.missions).length === 0;
    for (const button of [hold, home]) {
      button.disabled = isIdle;
      button.title = isIdle ? t("No UAV of a mission is in the air.") : "";
    }
  });
}

/** @param {MonitorStore} store @param {Commanding} commanding @returns {Binding[]} */
export function mountCommandBar(store, commanding) {
  const letter = h("span", { class: "letter" });
  const name = h("strong", {});
  const buttons = makeButtons(store, commanding);
  const more = makeMore(store, commanding);
  const [hold] = buttons;
  const who = h("span", { class: "command-who" }, letter, name);
  const why = h("p", { class: "command-why caption", hidden: true });
  const bar = h("div", { class: "command-bar float", role: "group", hidden: true }, who, buttons, more, why);
  byId("main").append(bar);

  store.listen(["chosen", "uavs", "missions"], (state) => {
    const uav = chosenUav(state);
    bar.hidden = uav === null;
    document.documentElement.toggleAttribute("data-commanding", uav !== null);
    if (!uav) return;
    bar.setAttribute("aria-label", t("Commands to {name}", { name: uav.name }));
    letter.hidden = uav.place === null;
    if (uav.place !== null) {
      letter.textContent = letterOf(uav, state.numbers);
      letter.className = `letter ${colourClass(uav.colour)}`;
    }
    name.textContent = uav.name;
    const reason = whyNot(uav);
    for (const button of buttons) {
      button.disabled = reason !== "";
      button.title = reason;
    }
    more.disabled = uav.mission === null;
    more.title = uav.mission === null ? t("{name} has no mission.", { name: uav.name }) : "";
    why.hidden = reason === "";
    why.textContent = reason;
    const kind = holdOrResume(uav);
    if (hold.dataset.kind === kind) return;
    hold.dataset.kind = kind;
    hold.replaceChildren(icon(kind === "resume" ? "play" : "hand"), h("span", {}, KINDS[kind]));
  });
  mountAll(store, commanding);

  /** @param {string} keys @param {AskedKind} kind @param {string} words @returns {Binding} */
  const key = (keys, kind, words) => ({
    keys: [keys],
    words,
    act() {
      const uav = chosenFlyer(store.state);
      if (!uav) return false;
      void commanding.ask(uav.id, kind, buttons.find((button) => button.dataset.kind === kind) ?? null);
      return true;
    },
  });
  return [
    key("shift+h", "hold", t("Hold the chosen UAV")),
    key("shift+r", "return", t("Return the chosen UAV")),
    key("shift+l", "land", t("Land the chosen UAV here")),
  ];
}
