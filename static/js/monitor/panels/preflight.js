/** Before start: the checks of each UAV, what only a pilot can see, and one button that names the next act. */

import { ApiError, get } from "../../api.js";
import { byId, h, icon } from "../../dom.js";
import { canUploadToAll, firstStep, nextStep, summaryOf, worstOf } from "../../domain/preflight_step.js";
import { parametersText } from "../../domain/rtl_check.js";
import { heightsWanted, heightWords, setHeight, start, upload } from "../../page/before_start.js";
import { PILOT_CHECK } from "../../page/planned_starts.js";
import { announce, toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { heightText } from "../../units.js";

import { flyCopy } from "./simulation.js";

/** @import { Answer } from "../../api.js" */
/** @import { Preflight, PreflightCheck, Rehearsal, UavPreflight } from "../../api_types.d.ts" */
/** @import { StandIns } from "./simulation.js" */
/** @import { NextStep, Stand } from "../../domain/preflight_step.js" */
/** @import { MonitorPage, MonitorStore } from "../types.d.ts" */

const SEEN_AFTER_MS = 1_000; // a press that began before an element appeared under the pointer does not trigger it
const POLL_MS = 2500;
const UPLOADS_NEXT = "spanwise-uploads-next"; // the mission whose simulated UAVs this window has started
const BEFORE_FLIGHT = new Set(["approved", "dispatched", "active"]);

/** @type {Record<PreflightCheck["state"], { image: string, words: string }>} */
const STATES = {
  ok: { image: "circle-check", words: t("All right") },
  warning: { image: "triangle-alert", words: t("Look at this") },
  unknown: { image: "circle-dashed", words: t("Not known") },
  waiting: { image: "timer", words: t("Waits") },
  failed: { image: "octagon-alert", words: t("Blocks the start") },
};
/**
 * The rehearsal check of this plan: warns of one that failed or belongs to another plan.
 *
 * @param {Pick<Rehearsal, "state" | "level" | "is_outdated"> | null} rehearsal the newest
 * @returns {PreflightCheck}
 */
export function rehearsalCheck(rehearsal) {
  const rest = { code: "rehearsal", safe_height_m: null, detail: "" };
  if (!rehearsal || rehearsal.is_outdated)
    return { ...rest, state: "warning", message: t("This plan was not rehearsed") };
  if (rehearsal.level === "fail") return { ...rest, state: "warning", message: t("Its rehearsal failed") };
  if (rehearsal.level === "warnings") return { ...rest, state: "warning", message: t("Rehearsed, with warnings") };
  return rehearsal.level === "pass"
    ? { ...rest, state: "ok", message: t("Rehearsed: passed") }
    : { ...rest, state: "unknown", message: t("Its rehearsal has no result yet") };
}

/** @param {PreflightCheck} check @param {HTMLElement | null} [remedy] */
const checkRow = ({ code, state, message, detail }, remedy = null) =>
  h(
    "li",
    { class: `preflight-check ${state}`, "data-check": code, title: detail ? parametersText(detail) : null },
    icon(STATES[state].image, "small"),
    h("span", {}, h("span", { class: "unseen" }, `${STATES[state].words}: `), message, remedy),
  );

/** A button that sets a height without obstructions of the RTL path. @param {UavPreflight} row @param {PreflightCheck} check */
function heightButton({ uav, name }, { safe_height_m }) {
  if (safe_height_m === null) return null;
  /** @param {Event} event */
  const set = async ({ currentTarget }) => {
    const button = /** @type {HTMLButtonElement} */ (currentTarget);
    button.disabled = true;
    button.disabled = await setHeight({ uav, name, height_m: safe_height_m });
  };
  const words = t("Set return height to {height}", { height: heightText(safe_height_m) });
  return h("button", { type: "button", class: "button small", onclick: set }, icon("rotate-ccw", "small"), words);
}

/**
 * The panel's elements. draw: what was read; drawStep: the button alone.
 *
 * @param {HTMLElement} place
 * @param {{ act: (button: HTMLElement) => unknown, tick: (isDone: boolean) => void, simulateCopy: (() => unknown) | null }} on
 *   simulateCopy: null where no copy of it is flown in simulation, as its UAVs are simulated
 */
function createPanel(place, on) {
  let drawn = "";
  const list = h("div", { class: "preflight-checks" });
  /** @param {Event} event */
  const ticked = ({ currentTarget }) => on.tick(/** @type {HTMLInputElement} */ (currentTarget).checked);
  const tick = h(
    "label",
    { class: "preflight-tick", hidden: true },
    h("input", { type: "checkbox", id: "pilot-checked", onchange: ticked }),
    h("span", {}, PILOT_CHECK),
  );
  const heights = h("div", { class: "preflight-heights" });
  const button = h("button", { type: "button", class: "button primary wide", onclick: () => void on.act(button) });
  const simulate = h(
    "button",
    { type: "button", class: "button wide", hidden: on.simulateCopy === null, onclick: () => void on.simulateCopy?.() },
    icon("play", "small"),
    t("Fly in simulation"),
  );
  const why = h("p", { class: "caption", id: "preflight-why", role: "status" });
  button.setAttribute("aria-describedby", "preflight-why");
  const acts = h("div", { class: "preflight-acts" }, tick, heights, button, simulate, why);
  place.append(h("h2", {}, t("Before start")), list, acts);

  return {
    /** The values to set with the upload. */
    heights: () =>
      [...heights.querySelectorAll("input:checked")].flatMap((input) => {
        const { value, dataset } = /** @type {HTMLInputElement} */ (input);
        if (Date.now() - Number(dataset.since_ms) < SEEN_AFTER_MS) return [];
        return { uav: Number(value), name: dataset.name ?? "", height_m: Number(dataset.height) };
      }),
    /** @param {Preflight} preflight @param {PreflightCheck | null} rehearsal */
    draw(preflight, rehearsal) {
      const whole = [...preflight.checks, ...(rehearsal ? [rehearsal] : [])];
      const key = JSON.stringify([whole, preflight.uavs]);
      tick.hidden = preflight.next_act !== "start";
      if (key === drawn) return;
      drawn = key;
      drawHeights(heights, preflight);
      const parts = /** @type {HTMLElement[]} */ ([...list.querySelectorAll("details[open]")]);
      const open = new Set(parts.map(({ dataset }) => dataset.uav));
      const rows = preflight.uavs.map((row) => uavPart(row, open.has(`${row.uav}`)));
      list.replaceChildren(
        h(
          "ul",
          { class: "preflight-list" },
          whole.map((check) => checkRow(check)),
        ),
        ...rows,
      );
    },
    /** @param {NextStep} step @param {string} busy the running act; empty: none */
    drawStep({ act, words, image, why: reason, left }, busy) {
      button.disabled = busy !== "" || act === "connect" || act === "wait" || reason !== "";
      button.setAttribute("aria-busy", `${busy !== ""}`);
      button.dataset.act = act ?? "";
      simulate.disabled = busy !== "";
      if (button.dataset.words !== words) {
        button.dataset.words = words;
        button.replaceChildren(icon(image, "small"), words);
      }
      const summary = busy || [reason, left.length > 0 && `${left.join("; ")}.`].filter(Boolean).join(" ");
      why.hidden = summary === "";
      if (why.textContent !== summary) why.textContent = summary;
    },
  };
}

/** Heights that are set with the upload unless they are unticked. @param {HTMLElement} place @param {Preflight} preflight */
function drawHeights(place, preflight) {
  const unticked = new Set(
    [...place.querySelectorAll("input")].filter(({ checked }) => !checked).map(({ value }) => value),
  );
  const since_ms = new Map(
    [...place.querySelectorAll("input")].map(({ value, dataset }) => [`${value} ${dataset.height}`, dataset.since_ms]),
  );
  place.replaceChildren(
    ...heightsWanted(preflight).map(({ uav, name, height_m }) =>
      h(
        "label",
        { class: "preflight-tick" },
        h("input", {
          type: "checkbox",
          value: `${uav}`,
          checked: !unticked.has(`${uav}`),
          "data-name": name,
          "data-height": `${height_m}`,
          "data-since_ms": since_ms.get(`${uav} ${height_m}`) ?? `${Date.now()}`,
        }),
        h("span", {}, heightWords({ uav, name, height_m })),
      ),
    ),
  );
}

/** @param {UavPreflight} row @param {boolean} isOpen */
function uavPart(row, isOpen) {
  const worst = worstOf(row.checks);
  return h(
    "details",
    { "data-uav": `${row.uav}`, open: isOpen },
    h(
      "summary",
      { class: `preflight-check ${worst}` },
      icon(STATES[worst].image, "small"),
      h("strong", {}, row.name),
      h("span", { class: "check-summary" }, summaryOf(row)),
    ),
    h(
      "ul",
      { class: "preflight-list" },
      row.checks.map((check) => checkRow(check, heightButton(row, check))),
    ),
  );
}

/** @param {MonitorStore} store @param {MonitorPage} page @param {StandIns | null} standIns null where a UAV of the mission is real */
export function mountPreflight(store, page, standIns) {
  if (page.mission !== null && page.canFly) new BeforeStart(store, page, page.mission, standIns).open();
}

class BeforeStart {
  #store;
  #mission;
  #standIns;
  #place = byId("preflight");
  /** @type {Preflight | null} */
  #preflight = null;
  /** @type {PreflightCheck | null} */
  #rehearsal = null;
  #isPilotDone = false;
  #busy = ""; // the running act, until the checks are read again
  #uploadsNext; // to simulated UAVs that were just started, once all are connected
  #panel;

  /** @param {MonitorStore} store @param {MonitorPage} page @param {string} mission @param {StandIns | null} standIns */
  constructor(store, page, mission, standIns) {
    this.#store = store;
    this.#mission = mission;
    this.#standIns = standIns;
    this.#uploadsNext = sessionStorage.getItem(UPLOADS_NEXT) === mission;
    this.#panel = createPanel(this.#place, {
      act: (button) => this.#act(button),
      tick: (isDone) => {
        this.#isPilotDone = isDone;
        this.#draw();
      },
      simulateCopy: page.hasReal ? () => void this.#simulateCopy() : null,
    });
  }

  open() {
    this.#store.listen(["missions"], () => void (this.#preflight ? this.#draw() : this.#read()));
    void this.#readRehearsal();
    setInterval(() => this.#busy || this.#read(), POLL_MS);
  }

  get #state() {
    return this.#store.state.missions.find(({ id }) => id === this.#mission)?.state ?? "";
  }

  get #isBeforeFlight() {
    return BEFORE_FLIGHT.has(this.#state);
  }

  /** @returns {Stand} */
  get #stand() {
    if (!this.#standIns) return null;
    if (this.#uploadsNext) return "starting";
    if (this.#standIns.areThere()) return "running";
    return this.#state === "active" ? null : "off"; // a flight in progress is flown by other UAVs
  }

  #step() {
    if (!this.#isBeforeFlight) return null;
    if (this.#preflight && this.#standIns?.areThere() !== null)
      return nextStep(this.#preflight, this.#isPilotDone, this.#stand);
    return this.#state === "active" ? null : firstStep();
  }

  #draw() {
    const step = this.#step();
    this.#place.hidden = !step;
    if (!step) return;
    if (this.#preflight) this.#panel.draw(this.#preflight, this.#rehearsal);
    this.#panel.drawStep(step, this.#busy);
  }

  /** The page itself reports that the server is unavailable. @param {() => Promise<void>} reading */
  async #asFarAsItCan(reading) {
    try {
      await reading();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
    }
    this.#draw();
  }

  #read() {
    return this.#asFarAsItCan(async () => {
      if (document.hidden || !this.#isBeforeFlight) return;
      this.#preflight = /** @type {Answer<Preflight>} */ (await get(`/missions/${this.#mission}/preflight`)).data;
      if (!this.#uploadsNext || this.#busy) return;
      if (this.#standIns?.areThere() === false)
        this.#setUploadsNext(false); // it could not be started, or was ended
      else if (canUploadToAll(this.#preflight)) void this.#uploadNext();
    });
  }

  #readRehearsal() {
    return this.#asFarAsItCan(async () => {
      const answer = await get(`/missions/${this.#mission}/rehearsals`);
      const { data } = /** @type {Answer<{ results: Rehearsal[] }>} */ (answer);
      this.#rehearsal = rehearsalCheck(data.results[0] ?? null);
    });
  }

  /**
   * Show the running act until the checks are read again.
   * @param {string} words @param {() => Promise<void>} does @param {string} [failed]
   */
  async #doing(words, does, failed = "") {
    this.#busy = words;
    this.#draw();
    try {
      await does();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      toast(`${failed} ${error.message}`.trim());
    } finally {
      await this.#read();
      this.#busy = "";
      this.#draw();
    }
  }

  /** @param {boolean} isNext */
  #setUploadsNext(isNext) {
    this.#uploadsNext = isNext;
    if (isNext) sessionStorage.setItem(UPLOADS_NEXT, this.#mission);
    else sessionStorage.removeItem(UPLOADS_NEXT);
  }

  /** One click: simulated UAVs as planned, in real time, and the mission to them; the drawer of the simulation changes wind and speed. */
  #simulate() {
    return this.#doing(t("Simulated UAVs are being started."), async () => {
      await this.#standIns?.begin();
      this.#setUploadsNext(true);
      announce(t("Simulated UAVs are being started."));
    });
  }

  /** One click: to the page of a copy that simulated twins fly, which uploads it to them. */
  #simulateCopy() {
    return this.#doing(t("A simulated copy of the mission is being made."), async () => {
      const copy = await flyCopy(this.#mission);
      sessionStorage.setItem(UPLOADS_NEXT, copy);
      location.assign(`/missions/${copy}/fly`);
    });
  }

  #uploadNext() {
    this.#setUploadsNext(false);
    return this.#upload();
  }

  #upload() {
    const heights = this.#panel.heights();
    return this.#doing(t("The upload is being prepared."), () => upload(this.#mission, heights), t("Not sent."));
  }

  /** @param {HTMLElement} button */
  #act(button) {
    const step = this.#step();
    if (!step || this.#busy) return;
    if (step.act === "simulate") void this.#simulate();
    if (step.act === "upload") void this.#upload();
    if (step.act === "start")
      void this.#doing(
        t("The starts are being checked against UAVs in the air."),
        () => start(this.#mission, step, button),
        t("Not started."),
      );
  }
}
