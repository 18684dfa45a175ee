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
import { exactClockText, exactText } from "../../units.js";

const BESIDE = ["hold", "return", "land"];
const MORE = [
  ["arm", "plane-takeoff"],
  ["take-off", "plane-takeoff"],
  ["pause", "timer"],
  ["resume", "refresh-cw"],
  ["change-speed", "settings"],
  ["abort", "octagon-alert"],
];

const isFlown = ({ state }) => ["approved", "dispatched", "active"].includes(state);
/** flying: see flying_actions.js; save(): a copy. */
export function mountFlying(store, flying, { canFly, saveCopy }) {
  const list = byId("flyers");
  const connectionOf = ({ uav }) => store.state.connections.get(uav) ?? null;
  const speedOf = (place) => store.state.mission.uavs[place].cruise_speed_mps;

  function row(flyer, mission, commands) {
    const board = boardOf(commands, flyer.uav);
    const { words, image, level, share } = boardWords(board, connectionOf(flyer));
    const flight = flightOf(commands, flyer.uav);
    const said = flight && commandWords(flight);
    const home = isFlown(mission) && returnSaid(returnOf(store.state.returns, flyer.place));
    return h(
      "li",
      { class: `flyer route-${routeNumber(flyer.place)}`, "aria-label": flyer.name },
      h("span", { class: "letter" }, flyer.letter),
      h(
        "div",
        { class: "flyer-said" },
        h(
          "p",
          { class: "flyer-name" },
          h("strong", {}, flyer.name),
          mission.uavs[flyer.place].is_simulated && [" ", simulatedMark()],
        ),
        h(
          "p",
          { class: `flyer-board ${level ?? ""}`, role: board && isMixed(board) ? "alert" : null },
          icon(image, "small"),
          h("span", {}, words),
        ),
        share !== undefined &&
          h(
            "div",
            {
              class: "progress",
              role: "progressbar",
              "aria-label": t("Sending to {name}", { name: flyer.name }),
              "aria-valuemin": 0,
              "aria-valuemax": 100,
              "aria-valuenow": Math.round(share * 100),
            },
            h("i", { style: `width:${Math.max(4, share * 100)}%` }),
          ),
        said &&
          h(
            "p",
            { class: `flyer-board ${said.level ?? ""}`, title: timesOf(flight, exactClockText) },
            icon(said.image, "small"),
            h("span", {}, said.words),
          ),
        home &&
          h("p", { class: `flyer-board ${home.level ?? ""}` }, icon(home.image, "small"), h("span", {}, home.words)),
      ),
      canFly &&
        isOnItsWay(mission) &&
        h(
          "div",
          { class: "flyer-acts", role: "group", "aria-label": t("Commands to {name}", { name: flyer.name }) },
          acts({ ...flyer, speed_mps: speedOf(flyer.place) }, mission, commands),
        ),
    );
  }

  function acts(flyer, mission, commands) {
    const next = flightToSend(flyer, commands, connectionOf(flyer));
    const whyNot = whyNoStart(mission, flyer, commands);
    const button = (words, act, { image = null, reason = "" } = {}) =>
      h(
        "button",
        { type: "button", class: "button small", disabled: Boolean(reason), title: reason || null, onclick: act },
        image && icon(image, "small"),
        words,
      );
    const more = h(
      "button",
      {
        type: "button",
        class: "icon-button tight",
        "aria-haspopup": "true",
        "aria-expanded": "false",
        "aria-label": t("More for {name}", { name: flyer.name }),
      },
      icon("ellipsis"),
    );
    more.addEventListener("click", () =>
      toggleMenu(more, () =>
        menuOf(
          t("Commands to {name}", { name: flyer.name }),
          MORE.map(([kind, image]) => ({
            icon: image,
            label: KINDS[kind],
            reason: whyNotMoved(kind, mission, flyer, commands),
            act: () => void flying.command(flyer, kind),
          })),
        ),
      ),
    );
    const isBeingRevoked = Boolean(mission.approval?.revoke_requested_at);
    return [
      next !== null && !isBeingRevoked
        ? button(
            next > 1 ? t("Send flight {flight}", { flight: next }) : t("Send again"),
            () => void flying.send(flyer, next),
            { image: "send" },
          )
        : button(KINDS.start, () => void flying.command(flyer, "start"), { image: "plane-takeoff", reason: whyNot }),
      ...BESIDE.map((kind) => button(KINDS[kind], () => void flying.command(flyer, kind))),
      more,
    ];
  }

  function entry(command) {
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

  function draw({ mission, commands, isDispatching }) {
    if (!mission) return;
    const known = commands ?? [];
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
            ["completed", "aborted", "failed"].includes(mission.state) &&
            h("button", { type: "button", class: "text-button", onclick: saveCopy }, t("Save a copy")),
        ),
      ),
    );
    const shown = document.activeElement;
    const place = list.contains(shown) ? [...list.querySelectorAll("button")].indexOf(shown) : -1;
    list.replaceChildren(...flyersOf(mission).map((flyer) => row(flyer, mission, known)));
    if (place >= 0) list.querySelectorAll("button")[place]?.focus({ preventScroll: true });
    byId("commands").hidden = known.length === 0;
    byId("command-count").textContent = known.length;
    byId("command-list").replaceChildren(...known.map(entry));
    if (canFly) drawFoot(mission, known, isDispatching);
  }

  function drawFoot(mission, commands, isBusy) {
    const wanted = stageActs(mission, commands);
    const [send, revoke, abort] = ["send", "revoke", "abort"].map(byId);
    send.hidden = !wanted.send;
    send.disabled = isBusy || wanted.send !== true;
    send.title = typeof wanted.send === "string" ? wanted.send : "";
    send.textContent = mission.state === "approved" ? t("Send to UAVs") : t("Send again");
    revoke.hidden = !wanted.revoke;
    abort.hidden = !wanted.abort;
    for (const button of [revoke, abort]) button.disabled = isBusy;
    const reason = byId("no-stage");
    reason.hidden = typeof wanted.send !== "string";
    reason.textContent = typeof wanted.send === "string" ? wanted.send : "";
  }

  if (canFly) {
    byId("send").addEventListener("click", () => void flying.send());
    byId("revoke").addEventListener("click", () => void flying.revoke());
    byId("abort").addEventListener("click", () => void flying.abort());
  }
  store.listen(["mission", "commands", "returns", "connections", "isDispatching"], draw);

  /** Shift+P H R L for the route that is chosen, or the only one: the question opens, nothing is done at once. */
  function ask(kind) {
    const { mission, chosenRoute } = store.state;
    if (!mission || !isOnItsWay(mission)) return false;
    const flyers = flyersOf(mission);
    const flyer = flyers.find(({ place }) => place === chosenRoute) ?? (flyers.length === 1 ? flyers[0] : null);
    if (!flyer) return false;
    void flying.command({ ...flyer, speed_mps: speedOf(flyer.place) }, kind);
    return true;
  }
  if (!canFly) return [];
  return [
    { keys: ["shift+p"], words: t("Pause the chosen UAV"), act: () => ask("pause") },
    { keys: ["shift+h"], words: t("Hold the chosen UAV"), act: () => ask("hold") },
    { keys: ["shift+r"], words: t("Return the chosen UAV"), act: () => ask("return") },
    { keys: ["shift+l"], words: t("Land the chosen UAV here"), act: () => ask("land") },
  ];
}
