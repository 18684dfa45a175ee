/** A mission that is approved: its stage, what each UAV has on board and was told, and the buttons for what can be done. */

import { byId, h, icon } from "../../dom.js";
import {
  boardOf,
  boardWords,
  commandWords,
  flightOf,
  flightToSend,
  flyersOf,
  isMixed,
  isOnItsWay,
  isOpen,
  KINDS,
  stageActs,
  stageWords,
  timesOf,
  whyNoStart,
  whyNotMoved,
} from "../../domain/flying.js";
import { returnOf, returnSaid } from "../../domain/own_return.js";
import { routeNumber } from "../../domain/palette.js";
import { menuOf, toggleMenu } from "../../page/chrome.js";
import { simulatedMark } from "../../simulated.js";
import { t } from "../../text.js";
import { exactClockText, exactText, heightText } from "../../units.js";

/** @import { Command, Mission, ReturnCheck } from "../../api_types.d.ts" */
/** @import { AskedKind } from "../../domain/command_questions.js" */
/** @import { Flyer, Said } from "../../domain/flying.js" */
/** @import { Binding } from "../../page/keyboard.js" */
/** @import { MissionPageState, MissionStore } from "../types.d.ts" */
/** @import { Flying } from "./approve.js" */

/** @typedef {Flyer & { speed_mps: number }} FlyerHere */
/** @typedef {{ store: MissionStore, flying: Flying, canFly: boolean, saveCopy: () => unknown }} FlyingContext */

const READING = t("Reading what is on the UAV…");
/** @type {AskedKind[]} */
const BESIDE = ["hold", "return", "land"];
/** @type {[AskedKind, string][]} */
const MORE = [
  ["arm", "plane-takeoff"],
  ["take-off", "plane-takeoff"],
  ["pause", "timer"],
  ["resume", "refresh-cw"],
  ["change-speed", "settings"],
  ["abort", "octagon-alert"],
];

/** @param {Mission} mission */
const isFlown = ({ state }) => ["approved", "dispatched", "active"].includes(state);

/** @param {Mission} mission @param {Flyer} flyer @returns {FlyerHere} */
const withSpeed = (mission, flyer) => ({ ...flyer, speed_mps: mission.uavs[flyer.place].cruise_speed_mps });

/**
 * flying: see flying_actions.js; saveCopy(): saves the mission as another one.
 *
 * @param {MissionStore} store
 * @param {Flying} flying
 * @param {{ canFly: boolean, saveCopy: () => unknown }} how
 * @returns {Binding[]}
 */
export function mountFlying(store, flying, { canFly, saveCopy }) {
  const context = { store, flying, canFly, saveCopy };
  store.listen(["mission", "commands", "returns", "connections", "isDispatching"], (state) => draw(state, context));
  if (!canFly) return [];
  byId("send").addEventListener("click", () => void flying.send());
  byId("revoke").addEventListener("click", () => void flying.revoke());
  byId("abort").addEventListener("click", () => void flying.abort());

  /**
   * For the route that is chosen, or the only one: the question opens, nothing is done at once.
   *
   * @param {AskedKind} kind
   */
  function ask(kind) {
    const { mission, chosenRoute } = store.state;
    if (!mission || !isOnItsWay(mission)) return false;
    const flyers = flyersOf(mission);
    const flyer = flyers.find(({ place }) => place === chosenRoute) ?? (flyers.length === 1 ? flyers[0] : null);
    if (!flyer) return false;
    void flying.command(withSpeed(mission, flyer), kind);
    return true;
  }
  return [
    { keys: ["shift+p"], words: t("Pause the chosen UAV"), act: () => ask("pause") },
    { keys: ["shift+h"], words: t("Hold the chosen UAV"), act: () => ask("hold") },
    { keys: ["shift+r"], words: t("Return the chosen UAV"), act: () => ask("return") },
    { keys: ["shift+l"], words: t("Land the chosen UAV here"), act: () => ask("land") },
  ];
}

/** @param {MissionPageState} state @param {FlyingContext} context */
function draw({ mission, commands, isDispatching }, context) {
  if (!mission) return;
  const known = commands ?? [];
  const { canFly, saveCopy } = context;
  const hasEnded = ["completed", "aborted", "failed"].includes(mission.state);
  byId("flying-said").replaceChildren(
    h(
      "p",
      { class: "notice advisory" },
      icon("lock"),
      h(
        "span",
        {},
        stageWords(mission),
        " ",
        canFly &&
          hasEnded &&
          h("button", { type: "button", class: "text-button", onclick: saveCopy }, t("Save a copy")),
      ),
    ),
  );
  const list = byId("flyers");
  const buttons = () => [...list.querySelectorAll("button")];
  const focused = buttons().indexOf(/** @type {HTMLButtonElement} */ (document.activeElement));
  list.replaceChildren(...flyersOf(mission).map((flyer) => flyerRow(flyer, mission, commands, context)));
  if (focused >= 0) buttons()[focused]?.focus({ preventScroll: true });
  byId("commands").hidden = known.length === 0;
  byId("command-count").textContent = `${known.length}`;
  byId("command-list").replaceChildren(...known.map(commandRow));
  if (canFly) drawFoot(mission, commands, isDispatching);
}

/** @param {Mission} mission @param {Command[] | null} commands null: not read yet @param {boolean} isBusy */
function drawFoot(mission, commands, isBusy) {
  const acts = stageActs(mission, commands ?? []);
  const wanted = commands === null && acts.send ? { ...acts, send: READING } : acts; // what is on board is not known yet
  const whyNot = typeof wanted.send === "string" ? wanted.send : "";
  const [send, revoke, abort] = ["send", "revoke", "abort"].map((id) => byId(id, HTMLButtonElement));
  send.hidden = !wanted.send;
  send.disabled = isBusy || wanted.send !== true;
  send.title = whyNot;
  send.textContent = mission.state === "approved" || commands === null ? t("Send to UAVs") : t("Send again");
  revoke.hidden = !wanted.revoke;
  abort.hidden = !wanted.abort;
  for (const button of [revoke, abort]) button.disabled = isBusy;
  byId("no-stage").hidden = !whyNot;
  byId("no-stage").textContent = whyNot;
}

/** @param {Said} said @param {{ role?: string | null, title?: string | null }} [how] */
const saidLine = ({ words, image, level }, { role = null, title = null } = {}) =>
  h("p", { class: `flyer-board ${level ?? ""}`, role, title }, icon(image, "small"), h("span", {}, words));

/** @param {Flyer} flyer @param {Mission} mission @param {Command[] | null} read null: not read yet @param {FlyingContext} context */
function flyerRow(flyer, mission, read, context) {
  const { connections, returns } = context.store.state;
  const { name, place, uav } = flyer;
  const commands = read ?? [];
  const board = read === null ? undefined : boardOf(commands, uav);
  const onBoard = boardWords(board, (uav !== null && connections.get(uav)) || null);
  const flight = flightOf(commands, uav);
  const check = isFlown(mission) ? returnOf(returns, place) : null;
  const home = check && returnSaid(check);
  const height = commands.find((command) => command.kind === "set-return-height" && command.uav.id === uav);
  return h(
    "li",
    { class: `flyer route-${routeNumber(place)}`, "aria-label": name },
    h("span", { class: "letter" }, flyer.letter),
    h(
      "div",
      { class: "flyer-said" },
      h(
        "p",
        { class: "flyer-name" },
        h("strong", {}, name),
        mission.uavs[place].is_simulated && [" ", simulatedMark()],
      ),
      saidLine(onBoard, { role: board && isMixed(board) ? "alert" : null }),
      onBoard.share !== undefined && uploadBar(name, onBoard.share),
      flight && saidLine(commandWords(flight), { title: timesOf(flight, exactClockText) }),
      home && saidLine(home),
      height && saidLine(commandWords(height), { title: timesOf(height, exactClockText) }),
      context.canFly && check && heightButton(flyer, check, height, context),
    ),
    context.canFly &&
      isOnItsWay(mission) &&
      h(
        "div",
        { class: "flyer-acts", role: "group", "aria-label": t("Commands to {name}", { name }) },
        actsOf(withSpeed(mission, flyer), mission, read, context),
      ),
  );
}

/**
 * One click to a height at which nothing is in the way home; null where it is high enough, or where none is.
 *
 * @param {Flyer} flyer
 * @param {ReturnCheck} check
 * @param {Command | undefined} command that was given for it last
 * @param {FlyingContext} context
 */
function heightButton(flyer, { safe_height_m }, command, { flying }) {
  if (safe_height_m === null || flyer.uav === null) return null;
  return h(
    "button",
    {
      type: "button",
      class: "button small",
      disabled: Boolean(command && isOpen(command)),
      title: command && isOpen(command) ? t("It is being set.") : null,
      onclick: () => void flying.setReturnHeight(flyer, safe_height_m),
    },
    icon("rotate-ccw", "small"),
    t("Set return height to {height}", { height: heightText(safe_height_m) }),
  );
}

/** @param {string} name @param {number} share of an upload, 0 to 1 */
const uploadBar = (name, share) =>
  h(
    "div",
    {
      class: "progress",
      role: "progressbar",
      "aria-label": t("Sending to {name}", { name }),
      "aria-valuemin": 0,
      "aria-valuemax": 100,
      "aria-valuenow": Math.round(share * 100),
    },
    h("i", { style: `width:${Math.max(4, share * 100)}%` }),
  );

/** @param {FlyerHere} flyer @param {Mission} mission @param {Command[] | null} read null: not read yet @param {FlyingContext} context */
function actsOf(flyer, mission, read, { store, flying }) {
  const { uav } = flyer;
  const commands = read ?? [];
  const next = flightToSend(flyer, commands, (uav !== null && store.state.connections.get(uav)) || null);
  const isBeingRevoked = Boolean(mission.approval?.revoke_requested_at);
  /** @param {string} words @param {() => void} act @param {{ image?: string, reason?: string }} [how] */
  const button = (words, act, { image, reason } = {}) =>
    h(
      "button",
      { type: "button", class: "button small", disabled: Boolean(reason), title: reason || null, onclick: act },
      image && icon(image, "small"),
      words,
    );
  return [
    next !== null && read !== null && !isBeingRevoked
      ? button(
          next > 1 ? t("Send flight {flight}", { flight: next }) : t("Send again"),
          () => void flying.send(flyer, next),
          { image: "send" },
        )
      : button(KINDS.start, () => void flying.command(flyer, "start"), {
          image: "plane-takeoff",
          reason: read === null ? READING : whyNoStart(mission, flyer, commands),
        }),
    ...BESIDE.map((kind) => button(KINDS[kind], () => void flying.command(flyer, kind))),
    moreButton(flyer, mission, commands, flying),
  ];
}

/**
 * The menu of the commands that are seldom given.
 *
 * @param {FlyerHere} flyer
 * @param {Mission} mission
 * @param {Command[]} commands
 * @param {Flying} flying
 */
function moreButton(flyer, mission, commands, flying) {
  const { name } = flyer;
  const more = h(
    "button",
    {
      type: "button",
      class: "icon-button tight",
      "aria-haspopup": "true",
      "aria-expanded": "false",
      "aria-label": t("More for {name}", { name }),
    },
    icon("ellipsis"),
  );
  more.addEventListener("click", () =>
    toggleMenu(more, () =>
      menuOf(
        t("Commands to {name}", { name }),
        MORE.map(([kind, image]) => ({
          icon: image,
          label: KINDS[kind],
          reason: whyNotMoved(kind, mission, flyer, commands),
          act: () => void flying.command(flyer, kind),
        })),
      ),
    ),
  );
  return more;
}

/** @param {Command} command */
function commandRow(command) {
  const { words, image, level } = commandWords(command);
  return h(
    "li",
    { class: `command ${level ?? ""}` },
    icon(image, "small"),
    h(
      "div",
      {},
      h("p", {}, h("strong", {}, command.uav.name), command.uav.is_simulated && [" ", simulatedMark()], ` ${words}`),
      h(
        "p",
        { class: "caption" },
        h(
          "time",
          { datetime: command.created_at, title: exactText(command.created_at) },
          timesOf(command, exactClockText),
        ),
        " · ",
        command.created_by ?? t("by the program"),
        command.why && ` · ${command.why}`,
      ),
    ),
  );
}
