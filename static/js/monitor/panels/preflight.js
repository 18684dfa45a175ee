/** Before start: the checks of each UAV, what only a pilot can see, and one button that names the next act. */

import { ApiError, freshKey, get, post } from "../../api.js";
import { byId, h, icon } from "../../dom.js";
import { KINDS } from "../../domain/flying.js";
import { nextStep, summaryOf, worstOf } from "../../domain/preflight_step.js";
import { beginStarts } from "../../page/planned_starts.js";
import { tellUav } from "../../page/tell_uav.js";
import { say, toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { heightText } from "../../units.js";

import { beginSimulation, flyCopy } from "./simulation.js";

/** @import { Answer } from "../../api.js" */
/** @import { Mission, MissionStarts, Preflight, PreflightCheck, Rehearsal, UavPreflight } from "../../api_types.d.ts" */
/** @import { NextStep } from "../../domain/preflight_step.js" */
/** @import { MonitorPage, MonitorStore } from "../types.d.ts" */

const SEEN_AFTER_MS = 1_000; // what appears under the pointer is not sent by the press that was on its way
const POLL_MS = 2500;
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
 * Of this very plan: one that failed or is of another plan is warned of.
 *
 * @param {Pick<Rehearsal, "state" | "level" | "is_outdated"> | null} rehearsal the newest
 * @returns {PreflightCheck}
 */
export function rehearsalCheck(rehearsal) {
  const [code, safe_height_m] = ["rehearsal", null];
  if (!rehearsal || rehearsal.is_outdated)
    return { code, safe_height_m, state: "warning", message: t("This plan was not rehearsed") };
  if (rehearsal.level === "fail") return { code, safe_height_m, state: "warning", message: t("Its rehearsal failed") };
  if (rehearsal.level === "warnings")
    return { code, safe_height_m, state: "warning", message: t("Rehearsed, with warnings") };
  return rehearsal.level === "pass"
    ? { code, safe_height_m, state: "ok", message: t("Rehearsed: passed") }
    : { code, safe_height_m, state: "unknown", message: t("Its rehearsal has no result yet") };
}

/** @param {PreflightCheck} check @param {HTMLElement | null} [remedy] */
const checkRow = ({ code, state, message }, remedy = null) =>
  h(
    "li",
    { class: `preflight-check ${state}`, "data-check": code },
    icon(STATES[state].image, "small"),
    h("span", {}, h("span", { class: "unseen" }, `${STATES[state].words}: `), message, remedy),
  );

/** Whether it is being told. @param {number} uav @param {string} name @param {number} height_m */
async function setHeight(uav, name, height_m) {
  try {
    return await tellUav(uav, name, "set-return-height", { height_m });
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(`${t("{act}: not sent to {name}.", { name, act: KINDS["set-return-height"] })} ${error.message}`);
    return false;
  }
}

/** One click to a height at which nothing is in the way home. @param {UavPreflight} row @param {PreflightCheck} check */
function heightButton({ uav, name }, { safe_height_m }) {
  if (safe_height_m === null) return null;
  /** @param {Event} event */
  const set = async ({ currentTarget }) => {
    const button = /** @type {HTMLButtonElement} */ (currentTarget);
    button.disabled = true;
    button.disabled = await setHeight(uav, name, safe_height_m);
  };
  const words = t("Set return height to {height}", { height: heightText(safe_height_m) });
  return h("button", { type: "button", class: "button small", onclick: set }, icon("rotate-ccw", "small"), words);
}

/**
 * The panel's elements. draw: what was read; drawStep: the button alone.
 *
 * @param {HTMLElement} place
 * @param {{ act: (button: HTMLElement) => unknown, tick: (isDone: boolean) => void, simulate: (() => unknown) | null, isCopied: boolean }} on
 *   simulate: null where it cannot be flown in simulation; isCopied: a copy of it is, as its UAVs are real
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
    h("span", {}, t("Looked at on site: propellers and battery, take-off place, airspace and weather, radio at hand")),
  );
  const heights = h("div", { class: "preflight-heights" });
  const button = h("button", { type: "button", class: "button primary wide", onclick: () => void on.act(button) });
  const simulate = h(
    "button",
    { type: "button", class: "button wide", hidden: true, onclick: () => void on.simulate?.() },
    icon("play", "small"),
    t("Fly in simulation"),
  );
  const why = h("p", { class: "caption", id: "preflight-why", role: "status" });
  button.setAttribute("aria-describedby", "preflight-why");
  place.append(h("h2", {}, t("Before start")), list, tick, heights, button, simulate, why);

  return {
    /** What is to be set with the upload. */
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
    /** @param {NextStep} step @param {boolean} isActing */
    drawStep({ act, words, image, why: reason, left }, isActing) {
      button.disabled = isActing || act === "connect" || act === "wait" || reason !== "";
      button.dataset.act = act ?? "";
      simulate.hidden = on.simulate === null || (act !== "connect" && !on.isCopied);
      simulate.disabled = isActing;
      if (button.dataset.words !== words) {
        button.dataset.words = words;
        button.replaceChildren(icon(image, "small"), words);
      }
      const said = [reason, left.length > 0 && `${left.join("; ")}.`].filter(Boolean).join(" ");
      why.hidden = said === "";
      if (why.textContent !== said) why.textContent = said;
    },
  };
}

/** Heights that are set with the upload unless they are unticked. @param {HTMLElement} place @param {Preflight} preflight */
function drawHeights(place, { next_act, uavs }) {
  const unticked = new Set(
    [...place.querySelectorAll("input")].filter(({ checked }) => !checked).map(({ value }) => value),
  );
  const since_ms = new Map(
    [...place.querySelectorAll("input")].map(({ value, dataset }) => [`${value} ${dataset.height}`, dataset.since_ms]),
  );
  const rows = next_act === "upload" ? uavs.filter(({ is_loaded }) => !is_loaded) : [];
  const wanted = rows.flatMap(({ uav, name, checks }) => {
    const height_m = checks.find(({ safe_height_m }) => safe_height_m !== null)?.safe_height_m ?? null;
    return height_m === null ? [] : [{ uav, name, height_m }];
  });
  place.replaceChildren(
    ...wanted.map(({ uav, name, height_m }) =>
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
        h(
          "span",
          {},
          t("Also set the return altitude of {name} to {height}: lower, its return path is obstructed", {
            name,
            height: heightText(height_m),
          }),
        ),
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

/** @param {MonitorStore} store @param {MonitorPage} page */
export function mountPreflight(store, page) {
  const { mission } = page;
  if (mission === null || !page.canFly) return;
  const place = byId("preflight");
  /** @type {Preflight | null} */
  let preflight = null;
  /** @type {PreflightCheck | null} */
  let rehearsal = null;
  let [isPilotDone, isActing] = [false, false];
  const panel = createPanel(place, {
    act,
    tick(isDone) {
      isPilotDone = isDone;
      draw();
    },
    simulate: page.hasReal ? simulateCopy : page.hasSimulated ? simulate : null,
    isCopied: page.hasReal === true,
  });
  const isBeforeFlight = () => BEFORE_FLIGHT.has(store.state.missions.find(({ id }) => id === mission)?.state ?? "");

  function draw() {
    const step = preflight && isBeforeFlight() ? nextStep(preflight, isPilotDone) : null;
    place.hidden = !step;
    if (!preflight || !step) return;
    panel.draw(preflight, rehearsal);
    panel.drawStep(step, isActing);
  }

  /** The page says itself that the server is away. @param {() => Promise<void>} reading */
  const asFarAsItCan = (reading) =>
    reading().then(draw, (error) => {
      if (!(error instanceof ApiError)) throw error;
    });
  const read = () =>
    asFarAsItCan(async () => {
      if (document.hidden || isActing || !isBeforeFlight()) return;
      preflight = /** @type {Answer<Preflight>} */ (await get(`/missions/${mission}/preflight`)).data;
    });
  const readRehearsal = () =>
    asFarAsItCan(async () => {
      const { data } = /** @type {Answer<{ results: Rehearsal[] }>} */ (await get(`/missions/${mission}/rehearsals`));
      rehearsal = rehearsalCheck(data.results[0] ?? null);
    });

  /** One click: as planned, in real time; the drawer of the simulation changes that. */
  async function simulate() {
    isActing = true;
    draw();
    try {
      await beginSimulation(mission);
      say(t("Simulated UAVs are being started."));
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      toast(error.message);
    } finally {
      isActing = false;
      void read();
    }
  }

  /** One click: to the page of a copy that simulated twins fly. */
  async function simulateCopy() {
    isActing = true;
    draw();
    try {
      location.assign(`/missions/${await flyCopy(mission)}/fly`);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      toast(error.message);
    } finally {
      isActing = false;
      draw();
    }
  }

  /** @param {HTMLElement} button */
  async function act(button) {
    const step = preflight && nextStep(preflight, isPilotDone);
    if (!step || isActing || mission === null) return;
    isActing = true;
    draw();
    try {
      const heights = panel.heights();
      if (step.act === "upload") {
        await upload(mission);
        for (const { uav, name, height_m } of heights) await setHeight(uav, name, height_m);
      }
      if (step.act === "start") await start(mission, step, button);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      toast(`${step.act === "upload" ? t("Not sent.") : t("Not started.")} ${error.message}`);
    } finally {
      isActing = false;
      void read();
    }
  }

  store.listen(["missions"], () => void (preflight ? draw() : read()));
  void readRehearsal();
  setInterval(read, POLL_MS);
}

/** To all that have nothing yet; of the revision that was just read. @param {string} mission */
async function upload(mission) {
  const { data } = /** @type {Answer<Mission>} */ (await get(`/missions/${mission}`));
  const headers = { "If-Match": `"${data.revision}"`, "Idempotency-Key": freshKey() };
  await post(`/missions/${mission}/dispatch`, {}, { headers });
}

/** Those that are ready, in planned order. @param {string} mission @param {NextStep} step @param {HTMLElement} opener */
async function start(mission, { uavs, left }, opener) {
  const { data } = /** @type {Answer<MissionStarts>} */ (await get(`/missions/${mission}/planned-starts`));
  const waiting = data.waiting.filter(({ uav }) => uavs.includes(uav));
  await beginStarts(mission, waiting, opener, { left });
}
