/** The layer of what can be inspected: asked for when it is switched on and when what decides over it changes, with a legend of reasons. */

import { post } from "../../api.js";
import { h, icon, svg } from "../../dom.js";
import * as layer from "../../map/layers/reach.js";
import { t, tn } from "../../text.js";
import { numberText } from "../../units.js";
import { questionOf, reachText, verdictOf } from "./reachable.js";

const REST_MS = 400; // after the last change
const PROGRESS_AFTER_MS = 1000;

const sample = (drawing) => svg("svg", { width: 34, height: 12, viewBox: "0 0 34 12", "aria-hidden": "true" }, drawing);
const LEGEND = [
  {
    words: t("Can be inspected"),
    draw: () =>
      sample([
        svg("path", { d: "M1 6H19", stroke: "var(--accent)", "stroke-width": 4 }),
        svg("circle", { cx: 27, cy: 6, r: 4, fill: "var(--accent)" }),
      ]),
  },
  {
    words: t("In part"),
    draw: () =>
      sample([
        svg("path", { d: "M1 6H19", stroke: "var(--ink-2)", "stroke-width": 2.5 }),
        svg("circle", { cx: 27, cy: 6, r: 3, fill: "var(--ink-2)" }),
      ]),
  },
  {
    words: t("Cannot be inspected"),
    draw: () =>
      sample([
        svg("path", { d: "M1 3.5H19M1 8.5H19", stroke: "var(--warning-mark)", "stroke-width": 1.5 }),
        svg("circle", {
          cx: 27,
          cy: 6,
          r: 3.5,
          fill: "var(--raised)",
          stroke: "var(--warning-mark)",
          "stroke-width": 2,
        }),
      ]),
  },
];

/** Returns { entry: for the layers menu, textOf(id), verdict(id), recolour(), close(): whether it was on }. */
export function mountReachLayer(map, frame, store) {
  const card = h("section", { class: "reach-card float", "aria-label": t("What can be inspected"), hidden: true });
  frame.append(card);
  let isOn = false;
  let answer = null;
  let askedAs = ""; // the question in hand or answered
  let uavs = [];
  let stopping = null;
  let timer = 0;

  const close = h(
    "button",
    {
      type: "button",
      class: "icon-button tight",
      "aria-label": t("Close"),
      title: t("Close"),
      onclick: () => turn(false),
    },
    icon("x", "small"),
  );
  const head = (words) => h("div", { class: "reach-head" }, h("p", { role: "status" }, words), close);

  function showWorking() {
    card.replaceChildren(
      head(t("Working out what can be inspected")),
      h(
        "div",
        { class: "progress busy", role: "progressbar", "aria-label": t("Working out what can be inspected") },
        h("i", {}),
      ),
      h(
        "div",
        {},
        h("button", { type: "button", class: "button", onclick: () => (stopping?.abort(), turn(false)) }, t("Cancel")),
      ),
    );
  }

  function showAnswer() {
    const { reachable, of, reasons, grounded } = answer;
    const summary = of
      ? t("{reachable} of {all} assets can be inspected, each in a flight of its own.", {
          reachable: numberText(reachable),
          all: numberText(of),
        })
      : t("There is no asset to inspect.");
    const parts = [
      head(h("strong", {}, summary)),
      h(
        "ul",
        { class: "reach-legend", "aria-label": t("Legend") },
        LEGEND.map(({ words, draw }) => h("li", {}, draw(), words)),
      ),
      reasons.length > 0 &&
        h(
          "ul",
          { class: "reach-reasons", "aria-label": t("Reasons") },
          [...reasons]
            .sort((a, b) => b.count - a.count)
            .map(({ message, count }) =>
              h("li", {}, h("span", {}, message), h("span", { class: "count" }, numberText(count))),
            ),
        ),
      grounded.length > 0 &&
        h(
          "ul",
          { class: "reach-reasons", "aria-label": t("UAVs that cannot take off") },
          grounded.map(({ uav, message }) => h("li", {}, `${uavs[uav]?.name ?? ""}: ${message}`)),
        ),
      h(
        "p",
        { class: "quiet-text" },
        t("Point at an asset for its reason. Not all together: a plan says which ones fit."),
      ),
    ];
    card.replaceChildren(...parts.filter(Boolean));
  }

  function showFault(title, words, again = true) {
    card.replaceChildren(
      head(h("strong", {}, title)),
      h("p", { role: "alert" }, words),
      again
        ? h("div", {}, h("button", { type: "button", class: "button", onclick: () => void ask() }, t("Ask again")))
        : "",
    );
  }

  function draw() {
    if (isOn && answer) layer.update(map, (id) => verdictOf(answer, id));
  }

  function clear() {
    answer = null;
    if (map.getLayer("reach-lines")) layer.remove(map);
  }

  async function ask() {
    stopping?.abort();
    const { selection } = store.state;
    const question = questionOf(selection);
    if (!question) {
      askedAs = "";
      clear();
      showFault(
        t("No UAV is chosen."),
        t("Tick one in the list: what can be inspected is worked out from where it starts."),
        false,
      );
      return;
    }
    const own = new AbortController();
    stopping = own;
    askedAs = JSON.stringify(question);
    const slow = setTimeout(showWorking, answer ? PROGRESS_AFTER_MS : 0);
    try {
      const { data } = await post("/reachability", question, { signal: own.signal });
      if (stopping !== own || !isOn) return;
      clear();
      [answer, uavs] = [data, selection.uavs];
      showAnswer();
      draw();
    } catch (error) {
      if (error.name === "AbortError" || stopping !== own) return;
      clear();
      showFault(t("Not worked out."), error.message);
    } finally {
      clearTimeout(slow);
    }
  }

  function turn(next) {
    isOn = next;
    card.hidden = !isOn;
    if (isOn) void ask();
    else {
      stopping?.abort();
      clearTimeout(timer);
      clear();
    }
  }

  store.listen(["selection"], ({ selection }) => {
    if (!isOn || JSON.stringify(questionOf(selection)) === (askedAs || "null")) return;
    clearTimeout(timer);
    timer = setTimeout(ask, REST_MS);
  });
  let isDue = true;
  map.on("sourcedata", () => (isDue = true));
  map.on("idle", () => {
    if (isDue) draw();
    isDue = false;
  });

  return {
    entry: { words: t("What can be inspected"), isOn: () => isOn, turn },
    textOf: (id) => (isOn && answer ? reachText(answer, id, uavs) : ""),
    verdict: (id) => (isOn && answer ? verdictOf(answer, id) : ""),
    recolour: () => isOn && layer.recolour(map),
    close: () => isOn && (turn(false), true),
  };
}
