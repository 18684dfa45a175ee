/** Commands for the chosen UAV, over the map's lower edge; on a phone at thumb height. */

import { byId, h, icon } from "../../dom.js";
import { KINDS } from "../../domain/flying.js";
import { routeNumber } from "../../domain/palette.js";
import { t } from "../../text.js";
import { batchScopes, whyNot } from "../batch.js";
import { letterOf } from "../call_signs.js";
import { isHeld } from "../uav_words.js";

/** @import { AskedKind } from "../../domain/command_questions.js" */
/** @import { Binding } from "../../page/keyboard.js" */
/** @import { Commanding, LiveUav, MonitorState, MonitorStore } from "../types.d.ts" */

/** @typedef {{ kind: AskedKind, image: string, words: string, isWide?: boolean, isDanger?: boolean }} CommandButton */

/** @type {CommandButton[]} */
const BUTTONS = [
  { kind: "pause", image: "pause", words: KINDS.pause },
  { kind: "hold", image: "hand", words: KINDS.hold, isWide: true },
  { kind: "return", image: "house", words: KINDS.return },
  { kind: "land", image: "plane-landing", words: KINDS.land },
  { kind: "change-speed", image: "gauge", words: t("Speed"), isWide: true },
  { kind: "abort", image: "octagon-alert", words: KINDS.abort, isDanger: true },
];

/** @param {Readonly<MonitorState>} state @returns {LiveUav | null} */
const chosenUav = (state) => state.uavs.find(({ id }) => id === state.chosen) ?? null;

/** That can be told something now. @param {Readonly<MonitorState>} state @returns {LiveUav | null} */
function chosenFlyer(state) {
  const uav = chosenUav(state);
  return uav && !whyNot(uav) ? uav : null;
}

/** What Pause asks for now: a UAV that holds is resumed. @param {LiveUav} uav */
const pauseOrResume = (uav) => (isHeld(uav) ? "resume" : "pause");

/** @param {MonitorStore} store @param {Commanding} commanding */
function makeButtons(store, commanding) {
  return BUTTONS.map(({ kind, image, words, isWide, isDanger }) => {
    /** @param {Event} event */
    const ask = ({ currentTarget }) => {
      const uav = chosenFlyer(store.state);
      const opener = /** @type {HTMLElement} */ (currentTarget);
      if (uav) void commanding.ask(uav.id, kind === "pause" ? pauseOrResume(uav) : kind, opener);
    };
    const look = `command-button ${isWide ? "wide" : ""} ${isDanger ? "danger" : ""}`;
    const properties = { type: "button", class: look, "data-kind": kind, onclick: ask };
    return h("button", properties, icon(image), h("span", {}, words));
  });
}

/** "Pause all" and "Return all" in the head of the page. @param {MonitorStore} store @param {Commanding} commanding */
function mountAll(store, commanding) {
  const pause = byId("pause-all", HTMLButtonElement);
  const home = byId("return-all", HTMLButtonElement);
  pause.addEventListener("click", () => void commanding.askAll("pause", pause));
  home.addEventListener("click", () => void commanding.askAll("return", home));
  store.listen(["uavs", "missions"], (state) => {
    const isIdle = batchScopes(state.uavs, state.missions).length === 0;
    for (const button of [pause, home]) {
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
  const [pause] = buttons;
  const who = h("span", { class: "command-who" }, letter, name);
  const why = h("p", { class: "command-why caption", hidden: true });
  const bar = h("div", { class: "command-bar float", role: "group", hidden: true }, who, buttons, why);
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
      letter.className = `letter route-${routeNumber(uav.place)}`;
    }
    name.textContent = uav.name;
    const reason = whyNot(uav);
    for (const button of buttons) {
      button.disabled = reason !== "";
      button.title = reason;
    }
    why.hidden = reason === "";
    why.textContent = reason;
    const kind = pauseOrResume(uav);
    if (pause.dataset.kind === kind) return;
    pause.dataset.kind = kind;
    pause.replaceChildren(icon(kind === "resume" ? "play" : "pause"), h("span", {}, KINDS[kind]));
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
    key("shift+p", "pause", t("Pause the chosen UAV")),
    key("shift+h", "hold", t("Hold the chosen UAV")),
    key("shift+r", "return", t("Return the chosen UAV")),
    key("shift+l", "land", t("Land the chosen UAV here")),
  ];
}
