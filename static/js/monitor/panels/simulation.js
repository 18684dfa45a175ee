/**
 * Simulated UAVs in place of a mission's: their state, start, wind and faults in flight, and end. Only where the fleet marks the UAVs as
 * simulated.
 */

import { ApiError, freshKey, get, patch, post, remove } from "../../api.js";
import { byId, h, icon, keyedList, refill } from "../../dom.js";
import { colourClass, routeLetter, routeNumber } from "../../domain/palette.js";
import { confirmAct } from "../../page/confirm.js";
import { announce, toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { SPEED_UNIT } from "../../units.js";
import {
  AIRS,
  ALL,
  FAULTS,
  isFlown,
  isPresent,
  lastsWords,
  meantFor,
  SPEEDS,
  stateWords,
  vehicleWords,
  WELL,
  windOf,
} from "../text/simulation_text.js";

/** @import { Answer } from "../../api.js" */
/** @import { SimulatedVehicle, Simulation, SimulationPage } from "../../api_types.d.ts" */
/** @import { Fault } from "../text/simulation_text.js" */
/** @import { MonitorPage, MonitorStore } from "../types.d.ts" */

/** Sends something, announces it, and reads the state again. @typedef {(act: () => Promise<unknown>, words?: string) => Promise<void>} Do */

const EVERY_MS = 2000;
const LASTS_S = 60; // wall clock time, unless the user chooses otherwise
const MAX_FAULT_S = 86_400;
const [MAX_WIND_MPS, MAX_GUSTS_MPS] = [60, 10]; // simulation/rehearsing/weather_scenario.py

/** @param {string} id @param {(readonly [number | string, string])[]} entries value and words of each */
const choice = (id, entries) =>
  h(
    "select",
    { class: "input", id },
    entries.map(([value, words]) => h("option", { value }, words)),
  );

/** @param {string} label @param {HTMLElement} input @param {string | null} [unit] */
const field = (label, input, unit = null) =>
  h(
    "div",
    { class: "field" },
    h("label", { for: input.id }, label),
    unit ? h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)) : input,
  );

/** @param {string} id @param {number} value @param {number} min @param {number} max */
const number = (id, value, min, max) =>
  h("input", {
    class: "input",
    type: "number",
    inputmode: "decimal",
    id,
    value,
    min,
    max,
    step: "any",
    required: true,
  });

/** @param {string} words @param {string} id of its title @param {...(Node | Node[])} parts */
const group = (words, id, ...parts) =>
  h("div", { class: "simulation-group", role: "group", "aria-labelledby": id }, h("h3", { id }, words), parts);

/**
 * The simulation of a mission: whether simulated UAVs replace its own, and how they are started.
 *
 * @typedef {object} StandIns
 * @property {() => boolean | null} areThere null: not read yet
 * @property {() => Promise<void>} begin rejects with ApiError
 */

/** Returns null where a UAV of the mission is real. @param {MonitorStore} store @param {MonitorPage} page @returns {StandIns | null} */
export function mountSimulation(store, page) {
  if (!page.hasSimulated || page.hasReal) return null;
  const panel = new SimulationPanel(store, page);
  panel.open();
  return { areThere: () => panel.isRunning, begin: () => panel.begin() };
}

class SimulationPanel {
  #page;
  #store;
  #state = byId("simulation-state");
  /** @type {Simulation | null} */
  #newest = null;
  #isRead = false;
  #start;
  #changes;
  #drawVehicles = keyedList(
    byId("simulation-uavs"),
    (/** @type {SimulatedVehicle} */ { id }) => id,
    () => h("li", {}),
    (row, vehicle) => this.#drawVehicle(row, vehicle),
  );

  /** @param {MonitorStore} store @param {MonitorPage} page */
  constructor(store, page) {
    this.#page = page;
    this.#store = store;
    /** @type {Do} */
    const act = (send, words) => this.#done(send, words);
    this.#start = startForm(page, act);
    this.#changes = new ChangesInFlight(act);
    if (page.canFly) byId("simulation-acts").append(this.#start, this.#changes.element);
    store.listen(["chosen"], ({ chosen }) => this.#changes.select(chosen));
  }

  get isRunning() {
    return this.#isRead ? isPresent(this.#newest) : null;
  }

  /** As planned, in real time. Rejects with ApiError. */
  async begin() {
    await beginSimulation(this.#page.mission);
    await this.#look();
  }

  open() {
    void this.#look();
    setInterval(() => {
      if (!document.hidden) void this.#look();
    }, EVERY_MS);
  }

  /** @param {() => Promise<unknown>} send @param {string} [words] */
  async #done(send, words) {
    try {
      await send();
      if (words) announce(words);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      toast(error.message);
    }
    await this.#look();
  }

  async #look() {
    try {
      const answer = await get(`/missions/${this.#page.mission}/simulated-flights?state=all&limit=1`);
      this.#newest = /** @type {Answer<SimulationPage>} */ (answer).data.results[0] ?? null;
      this.#isRead = true;
      this.#draw();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error; // the page's head reports the lost connection
    }
  }

  get #colours() {
    return this.#store.state.missions.find(({ id }) => id === this.#page.mission)?.colours;
  }

  #draw() {
    const newest = this.#newest;
    const { words, isBad } = stateWords(newest, this.#page.canFly);
    if (this.#state.textContent !== words) this.#state.textContent = words;
    this.#state.classList.toggle("bad", isBad);
    const present = isPresent(newest) ? newest : null;
    this.#drawVehicles(present?.vehicles ?? []);
    this.#start.hidden = present !== null;
    this.#changes.show(present);
  }

  /** @param {HTMLElement} row @param {SimulatedVehicle} vehicle */
  #drawVehicle(row, vehicle) {
    const { words, isBad } = vehicleWords(vehicle);
    const others = (this.#newest?.vehicles ?? []).filter(isPresent).length - 1;
    const canEnd = this.#page.canFly && isPresent(vehicle) && others > 0;
    row.className = `${colourClass(routeNumber(vehicle.sequence, this.#colours))} ${isBad ? "bad" : ""}`;
    refill(row, JSON.stringify([vehicle.name, words, canEnd]), () => [
      h("span", { class: "letter" }, routeLetter(vehicle.sequence)),
      h("span", {}, h("strong", {}, vehicle.name), h("small", {}, words)),
      canEnd && this.#endButton(vehicle),
    ]);
  }

  /** @param {SimulatedVehicle} vehicle */
  #endButton(vehicle) {
    const words = t("End {name}", { name: vehicle.name });
    /** @param {Event} event */
    const onclick = async ({ currentTarget }) => {
      const asked = await confirmAct({
        title: t("End {name}?", { name: vehicle.name }),
        lines: [t("The simulated UAV stops at once; in flight it shows as link lost. The others fly on.")],
        keep: t("Keep flying"),
        act: words,
        opener: /** @type {HTMLElement} */ (currentTarget),
      });
      if (asked) await this.#done(() => remove(`/simulated-vehicles/${vehicle.id}`));
    };
    const properties = { type: "button", class: "icon-button tight", "aria-label": words, title: words, onclick };
    return h("button", properties, icon("x", "small"));
  }
}

/**
 * Start simulated flights for the simulated UAVs of a mission. Rejects with ApiError.
 *
 * @param {string | null} mission
 * @param {number} [speed] times real time
 * @param {string} [conditions] wind
 */
const beginSimulation = (mission, speed = 1, conditions = AIRS[0][0]) =>
  post(`/missions/${mission}/simulated-flights`, { speed, conditions }, { headers: { "Idempotency-Key": freshKey() } });

/**
 * Simulated twins fly a copy of a mission of real UAVs, which stays as it is. Rejects with ApiError.
 *
 * @param {string | null} mission
 * @returns {Promise<string>} the copy
 */
export async function flyCopy(mission) {
  const headers = { "Idempotency-Key": freshKey() };
  const { data } = /** @type {Answer<Simulation>} */ (
    await post(`/missions/${mission}/simulated-copy`, { speed: 1, conditions: AIRS[0][0] }, { headers })
  );
  return data.mission ?? "";
}

/** The form that starts a simulation. @param {MonitorPage} page @param {Do} act */
function startForm(page, act) {
  const speed = choice("simulation-start-speed", SPEEDS);
  const air = choice("simulation-air", AIRS);
  const begin = () => beginSimulation(page.mission, Number(speed.value), air.value);
  /** @param {Event} event */
  const onsubmit = (event) => {
    event.preventDefault();
    void act(begin, t("Simulated UAVs are being started."));
  };
  return h(
    "form",
    { class: "simulation-form", onsubmit },
    h("div", { class: "simulation-pair" }, field(t("Speed"), speed), field(t("Wind"), air)),
    h("button", { class: "button", type: "submit" }, icon("play", "small"), t("Fly in simulation")),
  );
}

/** Clock rate, wind, faults and end of the running simulation. */
class ChangesInFlight {
  #act;
  /** @type {Simulation | null} */
  #flown = null;
  #speed = choice("simulation-speed", SPEEDS);
  #whose = choice("simulation-whose", []);
  #wished = ""; // who was chosen in the panel; see meantFor
  /** @type {number | null} */
  #selected = null; // UAV of the page
  #whom = h("p", { class: "caption", id: "simulation-whom" }); // keeps its place, so that the elements below it do
  /** @type {HTMLButtonElement[]} */
  #ofSome = []; // buttons that need a vehicle
  #seconds = number("simulation-seconds", LASTS_S, 1, 3600);
  #lasts = h("p", { class: "caption", id: "simulation-lasts" });

  /** @param {Do} act */
  constructor(act) {
    this.#act = act;
    this.#speed.addEventListener("change", () => {
      const speed = Number(this.#speed.value);
      void this.#act(() => patch(this.#ofAll(), { speed }));
    });
    this.#whose.addEventListener("change", () => {
      this.#wished = this.#whose.value;
      this.#drawMeant();
    });
    this.#whose.setAttribute("aria-describedby", this.#whom.id);
    this.#seconds.setAttribute("aria-describedby", this.#lasts.id);
    this.#seconds.addEventListener("input", () => this.#drawLasts());
    const faults = [...FAULTS, WELL].map((fault) => this.#faultButton(fault));
    this.element = h(
      "div",
      { class: "simulation-form" },
      h(
        "div",
        { class: "simulation-pair" },
        field(t("Speed"), this.#speed),
        field(t("Wind and faults of"), this.#whose),
      ),
      this.#whom,
      group(t("Wind"), "simulation-wind-title", this.#windForm()),
      group(
        t("Faults"),
        "simulation-faults",
        h("div", { class: "simulation-faults" }, faults),
        h("div", { class: "simulation-lasts" }, field(t("Link or GPS lost for"), this.#seconds, "s"), this.#lasts),
      ),
      this.#endButton(),
    );
  }

  /** @param {Simulation | null} flown null: no simulation runs */
  show(flown) {
    this.#flown = flown;
    this.element.hidden = flown === null;
    if (!flown) return;
    if (document.activeElement !== this.#speed) this.#speed.value = `${flown.speed}`;
    this.#drawLasts();
    this.#drawMeant();
  }

  /** Apply wind and faults to the UAV that is selected on the page, in place of the earlier choice. @param {number | null} uav */
  select(uav) {
    this.#selected = uav;
    this.#wished = "";
    this.#drawMeant();
  }

  #drawMeant() {
    const vehicles = (this.#flown?.vehicles ?? []).filter(isFlown);
    refill(this.#whose, vehicles.map(({ id, name }) => `${id} ${name}`).join(), () => [
      h("option", { value: "" }, t("Choose a UAV")),
      vehicles.map(({ id, name }) => h("option", { value: id }, name)),
      h("option", { value: ALL }, t("All UAVs of this mission")),
    ]);
    this.#whose.value = meantFor(this.#wished, this.#selected, vehicles);
    const isNobody = this.#whose.value === "";
    const names = this.#meant().map(({ name }) => name);
    this.#whom.textContent = isNobody
      ? t("Choose first which UAV it is for.")
      : t("For {names}.", { names: names.join(", ") });
    for (const button of this.#ofSome) {
      button.disabled = isNobody;
      button.title = isNobody ? this.#whom.textContent : "";
    }
  }

  #drawLasts() {
    if (this.#flown) this.#lasts.textContent = lastsWords(this.#seconds.valueAsNumber, this.#flown.speed);
  }

  #ofAll() {
    return `/simulations/${this.#flown?.id}`;
  }

  /** UAVs that a fault applies to. */
  #meant() {
    const vehicles = this.#flown?.vehicles ?? [];
    return this.#whose.value === ALL
      ? vehicles.filter(isPresent)
      : vehicles.filter(({ id }) => id === this.#whose.value);
  }

  #windForm() {
    /** @param {number} most_mps */
    const inUnits = (most_mps) => Math.floor(most_mps / SPEED_UNIT.mps);
    const wind = number("simulation-wind", Math.round(5 / SPEED_UNIT.mps), 0, inUnits(MAX_WIND_MPS));
    const from = number("simulation-from", 270, 0, 360);
    const gusts = number("simulation-gusts", 0, 0, inUnits(MAX_GUSTS_MPS));
    /** @param {Event} event */
    const onsubmit = (event) => {
      event.preventDefault();
      const address = this.#whose.value === ALL ? this.#ofAll() : `/simulated-vehicles/${this.#whose.value}`;
      const [speed_mps, gusts_mps] = [wind, gusts].map(({ valueAsNumber }) => valueAsNumber * SPEED_UNIT.mps);
      const conditions = windOf(speed_mps, from.valueAsNumber, gusts_mps);
      void this.#act(() => patch(address, { conditions }), t("The wind has changed."));
    };
    const set = h("button", { class: "button small", type: "submit" }, t("Set the wind"));
    this.#ofSome.push(set);
    return h(
      "form",
      { class: "simulation-wind", onsubmit },
      h(
        "div",
        { class: "simulation-three" },
        field(t("Wind speed|panel"), wind, SPEED_UNIT.unit),
        field(t("From"), from, "°"),
        field(t("Gusts"), gusts, SPEED_UNIT.unit),
      ),
      set,
    );
  }

  /** @param {Fault} fault */
  #faultButton({ name, image, words, lasts, of }) {
    const onclick = () => {
      if (lasts && !this.#seconds.reportValidity()) return;
      const flown_s = Math.min(this.#seconds.valueAsNumber * (this.#flown?.speed ?? 1), MAX_FAULT_S);
      const send = () =>
        Promise.all(
          this.#meant().map((vehicle) => patch(`/simulated-vehicles/${vehicle.id}`, { faults: of(vehicle, flown_s) })),
        );
      void this.#act(send, t("{fault}: done.", { fault: words }));
    };
    const properties = { class: "button small", type: "button", "data-fault": name, onclick };
    const button = h("button", properties, icon(image, "small"), words);
    this.#ofSome.push(button);
    return button;
  }

  #endButton() {
    /** @param {Event} event */
    const onclick = async ({ currentTarget }) => {
      const asked = await confirmAct({
        title: t("End the simulation?"),
        lines: [t("Simulated UAVs stop at once; those in flight show as link lost.")],
        keep: t("Keep flying"),
        act: t("End the simulation"),
        opener: /** @type {HTMLElement} */ (currentTarget),
      });
      if (asked) await this.#act(() => remove(this.#ofAll()));
    };
    return h("button", { class: "button small", type: "button", onclick }, icon("x", "small"), t("End the simulation"));
  }
}
