/** Simulated UAVs that stand in for a mission's: started, given wind and faults while they fly, ended. Only where the fleet says that they are. */

import { ApiError, get, patch, post, remove } from "../../api.js";
import { byId, h, icon, refill } from "../../dom.js";
import { confirmAct } from "../../mission/panels/confirm.js";
import { say, toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { AIRS, FAULTS, isPresent, SPEEDS, stateWords, windOf } from "../simulation_words.js";

const EVERY_MS = 2000;
const LASTS_S = 30;
const AGAIN = () => crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;

export function mountSimulation(page) {
  if (!page.hasSimulated) return;
  const state = byId("simulation-state");
  let newest = null;

  const choice = (id, entries) => h("select", { class: "input", id }, entries.map(([value, words]) => h("option", { value }, words)));
  const field = (label, input, unit = null) => h("div", { class: "field" }, h("label", { for: input.id }, label), unit ? h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)) : input);
  const number = (id, value, min, max) => h("input", { class: "input", type: "number", id, value, min, max, step: "any", required: true });

  async function done(act, words) {
    try {
      await act();
      if (words) say(words);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      toast(error.message);
    }
    await look();
  }

  const startSpeed = choice("simulation-start-speed", SPEEDS);
  const air = choice("simulation-air", AIRS);
  const start = h("form", { class: "simulation-form", onsubmit: (event) => {
    event.preventDefault();
    void done(() => post(`/missions/${page.mission}/simulated-flights`, { speed: Number(startSpeed.value), conditions: air.value }, { headers: { "Idempotency-Key": AGAIN() } }), t("Simulated UAVs are being started."));
  } }, h("div", { class: "simulation-pair" }, field(t("Speed"), startSpeed), field(t("Air"), air)), h("button", { class: "button primary", type: "submit" }, icon("play", "small"), t("Start simulated UAVs")));

  const speed = choice("simulation-speed", SPEEDS);
  speed.addEventListener("change", () => void done(() => patch(`/simulations/${newest.id}`, { speed: Number(speed.value) })));
  const whose = choice("simulation-whose", []);
  const wind = number("simulation-wind", 5, 0, 30), from = number("simulation-from", 270, 0, 360), seconds = number("simulation-seconds", LASTS_S, 1, 3600);
  const address = () => (whose.value ? `/simulated-vehicles/${whose.value}` : `/simulations/${newest.id}`);
  const setWind = h("form", { class: "simulation-row", onsubmit: (event) => {
    event.preventDefault();
    void done(() => patch(address(), { conditions: windOf(wind.valueAsNumber, from.valueAsNumber) }), t("The wind has changed."));
  } }, field(t("Wind"), wind, "m/s"), field(t("From"), from, "°"), h("button", { class: "button", type: "submit" }, t("Set")));
  const faults = FAULTS.map(({ name, image, words, lasts, of }) => h("button", { class: "button small", type: "button", "data-fault": name, onclick: () => {
    if (lasts && !seconds.reportValidity()) return;
    const meant = whose.value ? newest.vehicles.filter(({ id }) => id === whose.value) : newest.vehicles.filter(isPresent);
    void done(() => Promise.all(meant.map((vehicle) => patch(`/simulated-vehicles/${vehicle.id}`, { faults: of(vehicle, seconds.valueAsNumber) }))), t("{fault}: done.", { fault: words }));
  } }, icon(image, "small"), words));
  const end = h("button", { class: "button", type: "button", onclick: async () => {
    const asked = await confirmAct({ title: t("End the simulation?"), lines: [t("Its UAVs are gone at once, wherever they are: of those in the air the link is lost.")], keep: t("Keep flying"), act: t("End the simulation"), opener: end });
    if (asked) await done(() => remove(`/simulations/${newest.id}`));
  } }, icon("x", "small"), t("End the simulation"));
  const fly = h("div", { class: "simulation-form" },
    h("div", { class: "simulation-pair" }, field(t("Speed"), speed), field(t("For"), whose)), setWind,
    h("div", { class: "field" }, h("span", { class: "field-label", id: "simulation-faults" }, t("Faults")), h("div", { class: "simulation-faults", role: "group", "aria-labelledby": "simulation-faults" }, faults)),
    h("div", { class: "simulation-row" }, field(t("Link or GPS lost for"), seconds, "s"), end));
  if (page.canFly) byId("simulation-acts").append(start, fly);

  function draw() {
    const { words, isBad } = stateWords(newest);
    if (state.textContent !== words) state.textContent = words;
    state.classList.toggle("bad", isBad);
    start.hidden = isPresent(newest);
    fly.hidden = !isPresent(newest);
    if (!isPresent(newest)) return;
    if (document.activeElement !== speed) speed.value = `${newest.speed}`;
    const flown = newest.vehicles.filter(isPresent);
    const chosen = whose.value;
    refill(whose, flown.map(({ id, name }) => `${id} ${name}`).join(), () => [h("option", { value: "" }, t("All UAVs")), flown.map(({ id, name }) => h("option", { value: id }, name))]);
    whose.value = flown.some(({ id }) => id === chosen) ? chosen : "";
  }

  async function look() {
    try {
      const { data } = await get(`/missions/${page.mission}/simulated-flights?state=all&limit=1`);
      newest = data.results[0] ?? null;
      draw();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error; // the head of the page says that nothing comes in
    }
  }

  draw();
  void look();
  setInterval(() => document.hidden || void look(), EVERY_MS);
}
