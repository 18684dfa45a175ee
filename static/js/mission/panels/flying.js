/** An approved mission: its stage, the onboard list and commands of each UAV, and the link to the page on which it is flown. */

import { byId, h, icon, keepingFocus } from "../../dom.js";
import {
  boardOf,
  boardWords,
  canBeRevoked,
  commandWords,
  flightOf,
  flyersOf,
  isFlown,
  isMixed,
  stageWords,
  timesOf,
} from "../../domain/flying.js";
import { routeNumber } from "../../domain/palette.js";
import { returnOf, returnStatus } from "../../domain/rtl_check.js";
import { simulatedMark } from "../../simulated.js";
import { t } from "../../text.js";
import { exactClockText, exactText } from "../../units.js";
import { approvedStep, flyWords, isDoneHere } from "../flying/next_act.js";

/** @import { Command, Mission, Preflight } from "../../api_types.d.ts" */
/** @import { Flyer, StatusText } from "../../domain/flying.js" */
/** @import { MissionPageState, MissionStore } from "../types.d.ts" */
/** @import { createFlying } from "../flying/flying_actions.js" */

/** @typedef {ReturnType<typeof createFlying>} Flying */
/** @typedef {{ store: MissionStore, canFly: boolean, saveCopy: () => unknown }} FlyingContext */

/**
 * flying: see flying_actions.js; saveCopy(): saves the mission as a copy.
 *
 * @param {MissionStore} store
 * @param {Flying} flying
 * @param {{ canFly: boolean, saveCopy: () => unknown }} how
 */
export function mountFlying(store, flying, { canFly, saveCopy }) {
  const context = { store, canFly, saveCopy };
  store.listen(["mission", "commands", "returns", "connections", "isDispatching", "preflight"], (state) =>
    draw(state, context),
  );
  if (!canFly) return;
  byId("revoke").addEventListener("click", () => void flying.revoke());
  byId("next-act").addEventListener("click", () => void flying.next(byId("next-act")));
}

/** @param {MissionPageState} state @param {FlyingContext} context */
function draw({ mission, commands, isDispatching, preflight }, context) {
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
  const rows = flyersOf(mission).map((flyer) => flyerRow(flyer, mission, commands, context));
  keepingFocus(list, () => list.replaceChildren(...rows));
  byId("commands").hidden = known.length === 0;
  byId("command-count").textContent = `${known.length}`;
  byId("command-list").replaceChildren(...known.map(commandRow));
  if (canFly) drawFoot(mission, preflight, isDispatching);
}

/** @param {Mission} mission @param {Preflight | null} preflight null: not read yet @param {boolean} isBusy */
function drawFoot(mission, preflight, isBusy) {
  const step = isFlown(mission) ? approvedStep(mission, preflight) : null;
  const fly = byId("to-fly", HTMLAnchorElement);
  fly.hidden = !isFlown(mission) || isDoneHere(step);
  fly.href = `/missions/${mission.id}/fly`;
  fly.textContent = flyWords(step);
  const next = byId("next-act", HTMLButtonElement);
  next.hidden = !isDoneHere(step);
  next.textContent = step?.words ?? "";
  next.disabled = isBusy || step?.act === "wait" || Boolean(step?.why);
  byId("why-not-next").textContent = next.hidden ? "" : (step?.why ?? "");
  const revoke = byId("revoke", HTMLButtonElement);
  revoke.hidden = !canBeRevoked(mission);
  revoke.disabled = isBusy;
}

/** @param {StatusText} said @param {{ role?: string | null, title?: string | null }} [how] */
const statusLine = ({ words, image, level }, { role = null, title = null } = {}) =>
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
  const home = check && returnStatus(check);
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
      statusLine(onBoard, { role: board && isMixed(board) ? "alert" : null }),
      onBoard.share !== undefined && uploadBar(name, onBoard.share),
      flight && statusLine(commandWords(flight), { title: timesOf(flight, exactClockText) }),
      home && statusLine(home, { title: home.title }),
      height && statusLine(commandWords(height), { title: timesOf(height, exactClockText) }),
    ),
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
