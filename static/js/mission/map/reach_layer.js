/** The layer of assets that can be inspected: requested when switched on and when its inputs change, with a legend of reasons. */

import { isAbort, post } from "../../api.js";
import { h, icon, setChildren, svg } from "../../dom.js";
import * as layer from "../../map/layers/reach.js";
import { t } from "../../text.js";
import { numberText } from "../../units.js";
import { questionOf, reachabilityOf, reachText } from "./reachable.js";

/** @import { Answer } from "../../api.js" */
/** @import { Reachability } from "../../api_types.d.ts" */
/** @import { Child } from "../../dom.js" */
/** @import { MapLibreMap } from "../../map/types.d.ts" */
/** @import { MissionStore, PickedUav } from "../types.d.ts" */

const REST_MS = 400; // after the last change
const PROGRESS_AFTER_MS = 1000;

/** @param {Child} drawing */
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

/** @typedef {{ answer: Reachability, uavs: PickedUav[] }} Answered uavs: as in the request */

/**
 * Returns { entry: for the layers menu, textOf(id), reachability(id), recolour(), close(): whether it was on }.
 *
 * @param {MapLibreMap} map
 * @param {HTMLElement} frame
 * @param {MissionStore} store
 */
export function mountReachLayer(map, frame, store) {
  let isOn = false;
  /** @type {Answered | null} */
  let answered = null;
  let askedAs = ""; // the question in hand or answered
  /** @type {AbortController | null} */
  let stopping = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  const card = createCard(frame, { close: () => turn(false), ask: () => void ask() });

  function draw() {
    const { answer } = answered ?? {};
    if (isOn && answer) layer.update(map, (id) => reachabilityOf(answer, id));
  }

  function clear() {
    answered = null;
    if (map.getLayer("reach-lines")) layer.remove(map);
  }

  async function ask() {
    stopping?.abort();
    const { selection } = store.state;
    const question = questionOf(selection);
    if (!question) {
      askedAs = "";
      clear();
      const words = t("Tick one in the list: what can be inspected is worked out from where it starts.");
      card.showFault(t("No UAV is chosen."), words, false);
      return;
    }
    const own = new AbortController();
    stopping = own;
    askedAs = JSON.stringify(question);
    const slow = setTimeout(() => card.showWorking(), answered ? PROGRESS_AFTER_MS : 0);
    try {
      const { data } = /** @type {Answer<Reachability>} */ (
        await post("/reachability", question, { signal: own.signal })
      );
      if (stopping !== own || !isOn) return;
      clear();
      answered = { answer: data, uavs: selection.uavs };
      card.showAnswer(answered);
      draw();
    } catch (error) {
      if (isAbort(error) || stopping !== own) return;
      clear();
      card.showFault(t("Not worked out."), error instanceof Error ? error.message : String(error));
    } finally {
      clearTimeout(slow);
    }
  }

  /** @param {boolean} next */
  function turn(next) {
    isOn = next;
    card.show(isOn);
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
  drawOnceRead(map, draw);

  return {
    entry: { words: t("What can be inspected"), isOn: () => isOn, turn },
    /** @param {number} id */
    textOf: (id) => (isOn && answered ? reachText(answered.answer, id, answered.uavs) : ""),
    /** @param {number} id */
    reachability: (id) => (isOn && answered ? reachabilityOf(answered.answer, id) : ""),
    recolour() {
      if (isOn) layer.recolour(map);
    },
    close() {
      const wasOn = isOn;
      if (wasOn) turn(false);
      return wasOn;
    },
  };
}

/** Redraw once tiles have been read. @param {MapLibreMap} map @param {() => void} draw */
function drawOnceRead(map, draw) {
  let isDue = true;
  map.on("sourcedata", () => {
    isDue = true;
  });
  map.on("idle", () => {
    if (isDue) draw();
    isDue = false;
  });
}

/** The legend with the reasons. @param {HTMLElement} frame @param {{ close: () => void, ask: () => void }} acts */
function createCard(frame, { close, ask }) {
  const card = h("section", { class: "reach-card float", "aria-label": t("What can be inspected"), hidden: true });
  frame.append(card);
  const closing = h(
    "button",
    { type: "button", class: "icon-button tight", "aria-label": t("Close"), title: t("Close"), onclick: close },
    icon("x", "small"),
  );
  /** @param {Child} words */
  const head = (words) => h("div", { class: "reach-head" }, h("p", { role: "status" }, words), closing);
  /** @param {string} words @param {() => void} onclick */
  const button = (words, onclick) => h("div", {}, h("button", { type: "button", class: "button", onclick }, words));

  return {
    /** @param {boolean} isShown */
    show(isShown) {
      card.hidden = !isShown;
    },
    showWorking() {
      const words = t("Working out what can be inspected");
      setChildren(
        card,
        head(words),
        h("div", { class: "progress busy", role: "progressbar", "aria-label": words }, h("i", {})),
        button(t("Cancel"), close),
      );
    },
    /** @param {Answered} answered */
    showAnswer({ answer, uavs }) {
      setChildren(card, head(h("strong", {}, summaryOf(answer))), answerParts(answer, uavs));
    },
    /** @param {string} title @param {string} words @param {boolean} [again] */
    showFault(title, words, again = true) {
      setChildren(
        card,
        head(h("strong", {}, title)),
        h("p", { role: "alert" }, words),
        again && button(t("Ask again"), ask),
      );
    },
  };
}

/** @param {Reachability} answer */
function summaryOf({ reachable, of }) {
  if (!of) return t("There is no asset to inspect.");
  const values = { reachable: numberText(reachable), all: numberText(of) };
  return t("{reachable} of {all} assets can be inspected, each in a flight of its own.", values);
}

/** @param {Reachability} answer @param {PickedUav[]} uavs */
function answerParts({ reasons, grounded }, uavs) {
  return [
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
}
