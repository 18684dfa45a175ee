/** The board and the log of events, one of them at a time. */

import { byId, h, icon, keyedList } from "../../dom.js";
import { routeNumber } from "../../domain/palette.js";
import { simulatedMark } from "../../simulated.js";
import { t } from "../../text.js";
import { clockText, exactClockText, exactText } from "../../units.js";
import { boardRows, STATES } from "../board.js";
import { eventsOf } from "../event_log.js";

/** show(mission, place of a target) brings it into view on the map. */
export function mountBoard(store, { show }) {
  const body = h("tbody", {});
  const table = h(
    "table",
    { class: "board-table" },
    h("caption", { class: "unseen" }, t("Targets")),
    h(
      "thead",
      {},
      h(
        "tr",
        {},
        h("th", { scope: "col" }, t("Target")),
        h("th", { scope: "col" }, t("State")),
        h("th", { scope: "col", class: "number" }, t("At|time")),
      ),
    ),
    body,
  );
  byId("board").append(table);
  const log = byId("event-log");
  const button = byId("switch-log");

  const draw = keyedList(body, ({ key }) => key, make, refresh);

  function make({ mission, place }) {
    return h(
      "tr",
      {},
      h(
        "td",
        {},
        h(
          "div",
          { class: "board-target" },
          h("span", { class: "pill" }),
          h("button", { type: "button", class: "text-button", onclick: () => show(mission, place) }),
        ),
      ),
      h("td", { class: "board-state" }),
      h("td", { class: "number" }),
    );
  }

  function refresh(row, { uav, pill, label, state, at, isExpected, reason }) {
    const { words, image } = STATES[state];
    const key = JSON.stringify([uav, pill, label, state, at, reason]);
    if (row.dataset.key === key) return;
    row.dataset.key = key;
    row.className = `${state} ${uav === null ? "" : `route-${routeNumber(uav)}`}`;
    row.querySelector(".pill").textContent = pill;
    row.querySelector("button").textContent = label;
    row.cells[1].replaceChildren(h("span", {}, icon(image, "small"), words), reason && h("small", {}, reason));
    row.cells[2].replaceChildren(
      at
        ? h("time", { datetime: at, title: exactText(at) }, isExpected ? `~\u2009${clockText(at)}` : exactClockText(at))
        : "—",
    );
  }

  const drawLog = keyedList(
    log,
    ({ key }) => key,
    () => h("li", {}),
    (row, { at, image, level, isSimulated, words }) => {
      if (row.dataset.words === words) return;
      row.dataset.words = words;
      row.className = level ?? "";
      row.replaceChildren(
        icon(image, "small"),
        h("span", {}, words, isSimulated && [" ", simulatedMark()]),
        h("time", { datetime: at, title: exactText(at) }, exactClockText(at)),
      );
    },
  );

  button.addEventListener("click", () => store.update({ showsLog: !store.state.showsLog }));
  store.listen(
    ["showsLog", "missions", "uavs", "details", "alerts", "commands"],
    ({ showsLog, missions, uavs, details, alerts, commands }) => {
      const counts = missions.reduce(
        (sum, { counts: { complete, all } }) => ({ complete: sum.complete + complete, all: sum.all + all }),
        { complete: 0, all: 0 },
      );
      byId("board-count").textContent = counts.all
        ? t("{done} of {all} complete", { done: counts.complete, all: counts.all })
        : "";
      button.setAttribute("aria-pressed", `${showsLog}`);
      button.textContent = showsLog ? t("Back to the board") : t("Event log");
      byId("board").hidden = showsLog;
      log.hidden = !showsLog;
      if (showsLog) drawLog(eventsOf({ commands, alerts, missions }));
      else draw(boardRows(missions, uavs, details));
    },
  );
}
