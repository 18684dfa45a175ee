/** Simulated UAVs that stand in for a mission's: how each does, started, given wind and faults while they fly, ended. Only where the fleet says that they are simulated. */

import { ApiError, get, patch, post, remove } from "../../api.js";
import { byId, h, icon, keyedList, refill } from "../../dom.js";
import { routeLetter, routeNumber } from "../../domain/palette.js";
import { confirmAct } from "../../page/confirm.js";
import { say, toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { SPEED_UNIT } from "../../units.js";
import {
  AIRS,
  FAULTS,
  isFlown,
  isPresent,
  lastsWords,
  SPEEDS,
  stateWords,
  vehicleWords,
  WELL,
  windOf,
} from "../simulation_words.js";

const EVERY_MS = 2000;
const LASTS_S = 60; // of the clock on the wall, until somebody says otherwise
const [MOST_WIND_MPS, MOST_GUSTS_MPS] = [60, 10]; // simulation/rehearsing/sky.py
const AGAIN = () => crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;

const choice = (id, entries) =>
  h(
    "select",
    { class: "input", id },
    entries.map(([value, words]) => h("option", { value }, words)),
  );
const field = (label, input, unit = null) =>
  h(
    "div",
    { class: "field" },
    h("label", { for: input.id }, label),
    unit ? h("div", { class: "with-unit" }, input, h("span", { class: "unit" }, unit)) : input,
  );
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

export function mountSimulation(page) {
  if (!page.hasSimulated) return;
  const state = byId("simulation-state");
  let newest = null;

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

  // how each does

  const drawVehicles = keyedList(
    byId("simulation-uavs"),
    ({ id }) => id,
    () => h("li", {}),
    (row, vehicle) => {
      const { words, isBad } = vehicleWords(vehicle);
      const canEnd = page.canFly && isPresent(vehicle) && newest.vehicles.filter(isPresent).length > 1;
      row.className = `route-${routeNumber(vehicle.sequence)} ${isBad ? "bad" : ""}`;
      refill(row, JSON.stringify([vehicle.name, words, canEnd]), () => [
        h("span", { class: "letter" }, routeLetter(vehicle.sequence)),
        h("span", {}, h("strong", {}, vehicle.name), h("small", {}, words)),
        canEnd &&
          h(
            "button",
            {
              type: "button",
              class: "icon-button tight",
              "aria-label": t("End {name}", { name: vehicle.name }),
              title: t("End {name}", { name: vehicle.name }),
              onclick: ({ currentTarget }) => void endOne(vehicle, currentTarget),
            },
            icon("x", "small"),
          ),
      ]);
    },
  );

  async function endOne(vehicle, opener) {
    const asked = await confirmAct({
      title: t("End {name}?", { name: vehicle.name }),
      lines: [t("It is gone at once, wherever it is: if it is in the air, its link is lost. The others fly on.")],
      keep: t("Keep flying"),
      act: t("End {name}", { name: vehicle.name }),
      opener,
    });
    if (asked) await done(() => remove(`/simulated-vehicles/${vehicle.id}`));
  }

  // what is begun with

  const startSpeed = choice("simulation-start-speed", SPEEDS);
  const air = choice("simulation-air", AIRS);
  const start = h(
    "form",
    {
      class: "simulation-form",
      onsubmit: (event) => {
        event.preventDefault();
        void done(
          () =>
            post(
              `/missions/${page.mission}/simulated-flights`,
              { speed: Number(startSpeed.value), conditions: air.value },
              { headers: { "Idempotency-Key": AGAIN() } },
            ),
          t("Simulated UAVs are being started."),
        );
      },
    },
    h("div", { class: "simulation-pair" }, field(t("Pace"), startSpeed), field(t("Wind"), air)),
    h("button", { class: "button", type: "submit" }, icon("play", "small"), t("Fly in simulation")),
  );

  // what is changed in flight

  const speed = choice("simulation-speed", SPEEDS);
  speed.addEventListener(
    "change",
    () => void done(() => patch(`/simulations/${newest.id}`, { speed: Number(speed.value) })),
  );
  const whose = choice("simulation-whose", []);
  const address = () => (whose.value ? `/simulated-vehicles/${whose.value}` : `/simulations/${newest.id}`);
  const meant = () =>
    whose.value ? newest.vehicles.filter(({ id }) => id === whose.value) : newest.vehicles.filter(isPresent);

  const inUnits = (most_mps) => Math.floor(most_mps / SPEED_UNIT.mps);
  const wind = number("simulation-wind", Math.round(5 / SPEED_UNIT.mps), 0, inUnits(MOST_WIND_MPS));
  const from = number("simulation-from", 270, 0, 360);
  const gusts = number("simulation-gusts", 0, 0, inUnits(MOST_GUSTS_MPS));
  const setWind = h(
    "form",
    {
      class: "simulation-wind",
      onsubmit: (event) => {
        event.preventDefault();
        const [speed_mps, gusts_mps] = [wind, gusts].map(({ valueAsNumber }) => valueAsNumber * SPEED_UNIT.mps);
        void done(
          () => patch(address(), { conditions: windOf(speed_mps, from.valueAsNumber, gusts_mps) }),
          t("The wind has changed."),
        );
      },
    },
    h(
      "div",
      { class: "simulation-three" },
      field(t("Speed|wind"), wind, SPEED_UNIT.unit),
      field(t("From"), from, "°"),
      field(t("Gusts"), gusts, SPEED_UNIT.unit),
    ),
    h("button", { class: "button small", type: "submit" }, t("Set the wind")),
  );

  const seconds = number("simulation-seconds", LASTS_S, 1, 3600);
  const lasts = h("p", { class: "caption", id: "simulation-lasts" });
  seconds.setAttribute("aria-describedby", lasts.id);
  seconds.addEventListener("input", () => draw());
  const faults = [...FAULTS, WELL].map(({ name, image, words, lasts: isLasting, of }) =>
    h(
      "button",
      {
        class: "button small",
        type: "button",
        "data-fault": name,
        onclick: () => {
          if (isLasting && !seconds.reportValidity()) return;
          const flown_s = Math.min(seconds.valueAsNumber * newest.speed, 86_400);
          void done(
            () =>
              Promise.all(
                meant().map((vehicle) => patch(`/simulated-vehicles/${vehicle.id}`, { faults: of(vehicle, flown_s) })),
              ),
            t("{fault}: done.", { fault: words }),
          );
        },
      },
      icon(image, "small"),
      words,
    ),
  );
  const end = h(
    "button",
    {
      class: "button small",
      type: "button",
      onclick: async () => {
        const asked = await confirmAct({
          title: t("End the simulation?"),
          lines: [t("Its UAVs are gone at once, wherever they are: of those in the air the link is lost.")],
          keep: t("Keep flying"),
          act: t("End the simulation"),
          opener: end,
        });
        if (asked) await done(() => remove(`/simulations/${newest.id}`));
      },
    },
    icon("x", "small"),
    t("End the simulation"),
  );
  const group = (words, id, ...parts) =>
    h("div", { class: "simulation-group", role: "group", "aria-labelledby": id }, h("h3", { id }, words), parts);
  const fly = h(
    "div",
    { class: "simulation-form" },
    h("div", { class: "simulation-pair" }, field(t("Pace"), speed), field(t("Wind and faults of"), whose)),
    group(t("Wind"), "simulation-wind-title", setWind),
    group(
      t("Faults"),
      "simulation-faults",
      h("div", { class: "simulation-faults" }, faults),
      h("div", { class: "simulation-lasts" }, field(t("Link or GPS lost for"), seconds, "s"), lasts),
    ),
    end,
  );
  if (page.canFly) byId("simulation-acts").append(start, fly);

  function draw() {
    const { words, isBad } = stateWords(newest, page.canFly);
    if (state.textContent !== words) state.textContent = words;
    state.classList.toggle("bad", isBad);
    drawVehicles(isPresent(newest) ? newest.vehicles : []);
    start.hidden = isPresent(newest);
    fly.hidden = !isPresent(newest);
    if (!isPresent(newest)) return;
    if (document.activeElement !== speed) speed.value = `${newest.speed}`;
    lasts.textContent = lastsWords(seconds.valueAsNumber, newest.speed);
    const flown = newest.vehicles.filter(isFlown);
    const chosen = whose.value;
    refill(whose, flown.map(({ id, name }) => `${id} ${name}`).join(), () => [
      h("option", { value: "" }, t("All UAVs")),
      flown.map(({ id, name }) => h("option", { value: id }, name)),
    ]);
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

  void look();
  setInterval(() => document.hidden || void look(), EVERY_MS);
}
