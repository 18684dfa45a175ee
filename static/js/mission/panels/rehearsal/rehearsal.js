/** The panel of rehearsals: conditions, progress, and the verdict by route and by target. Everything in it is simulated, and says so. */

import { byId, h, icon, refill } from "../../../dom.js";
import { routeLetter, routeNumber } from "../../../domain/palette.js";
import { t } from "../../../text.js";
import { exactHeightText, heightText, numberText, percentText, SPEED_UNIT, speedText, whenText } from "../../../units.js";
import { isPlanCurrent, isUnsaved } from "../../plan_view.js";
import {
  CONDITIONS,
  conditionWords,
  figuresOf,
  isRunning,
  LEVELS,
  levelWords,
  nearestOther,
  ownConditions,
  sentenceOf,
} from "../../rehearsal.js";
import { drawCharts } from "../../rehearsal_charts.js";

const [MOST_WIND_MPS, MOST_GUSTS_MPS] = [60, 10]; // simulation/rehearsing/sky.py

const level = (name) =>
  h(
    "span",
    { class: `rehearsal-level ${name || "open"}` },
    icon(LEVELS[name] ?? "circle-dashed", "small"),
    levelWords(name),
  );

/** Why the plan on the page cannot be rehearsed; empty where it can. */
export function whyNotRehearsed(state) {
  if (!state.mission) return t("Save the mission first: what is stored is rehearsed.");
  if (!state.plan) return t("Plan the mission first.");
  if (!state.mission.plan || !isPlanCurrent(state)) return t("It has changed since it was planned. Plan again first.");
  if (isUnsaved(state) || !state.planIsStored || state.saving) return t("It is not saved yet.");
  return "";
}

/** rehearsing: see rehearsal_actions.js; canRehearse: operators; isStage: the page is about it alone; seeInSpace(): opens the 3D view of what is shown. */
export function mountRehearsal(store, rehearsing, { canRehearse, isFrozen, isStage, seeInSpace }) {
  const section = byId("rehearsal");
  const place = (name) => byId(`rehearsal-${name}`);
  let chosenRoute = null;

  const form = canRehearse ? mountForm() : null;

  function mountForm() {
    const own = h("input", { type: "checkbox", name: "own" });
    const speeds = { wind_mps: MOST_WIND_MPS, gusts_mps: MOST_GUSTS_MPS };
    const most = (name) => Math.floor(speeds[name] / SPEED_UNIT.mps);
    const figure = (name, label, unit, min, max) =>
      h(
        "label",
        { class: "field" },
        h("span", { class: "field-label" }, label),
        h(
          "span",
          { class: "with-unit" },
          h("input", {
            class: "input",
            type: "number",
            name,
            step: "any",
            min,
            max,
            oninput: () => (own.checked = true),
          }),
          h("span", { class: "unit" }, unit),
        ),
      );
    const checks = CONDITIONS.map((code) =>
      h(
        "label",
        { class: "rehearsal-check" },
        h("input", { type: "checkbox", name: "condition", value: code, checked: code === "as-planned" }),
        h("span", {}, conditionWords(code)),
      ),
    );
    place("form").append(
      h(
        "fieldset",
        { class: "rehearsal-conditions" },
        h("legend", { class: "field-label" }, t("Conditions")),
        checks,
        h("label", { class: "rehearsal-check" }, own, h("span", {}, t("Own figures"))),
      ),
      h(
        "details",
        { class: "rehearsal-own" },
        h("summary", {}, t("Own figures")),
        h(
          "div",
          { class: "rehearsal-figures" },
          figure("wind_mps", t("Wind speed"), SPEED_UNIT.unit, 0, most("wind_mps")),
          figure("from_deg", t("Wind from"), "°", 0, 360),
          figure("gusts_mps", t("Gusts"), SPEED_UNIT.unit, 0, most("gusts_mps")),
          figure("battery_percent", t("Battery holds"), "%", 10, 100),
        ),
        h("p", { class: "caption" }, t("What is empty is as planned.")),
      ),
    );
    const read = () => {
      const conditions = [...place("form").querySelectorAll("input[name=condition]:checked")].map(({ value }) => value);
      const typed = (name) => place("form").querySelector(`[name=${name}]`).valueAsNumber;
      const figures = Object.fromEntries(
        ["wind_mps", "from_deg", "gusts_mps", "battery_percent"].map((name) => [
          name,
          typed(name) * (speeds[name] ? SPEED_UNIT.mps : 1),
        ]),
      );
      return own.checked ? [...conditions, ownConditions(figures)] : conditions;
    };
    place("form").addEventListener("submit", (event) => {
      event.preventDefault();
      start();
    });
    place("form").addEventListener("input", () => draw(store.state));
    place("cancel").addEventListener("click", () => void rehearsing.cancel());
    return { read };
  }

  function start() {
    if (!form || place("start").disabled || !place("form").reportValidity()) return false;
    const conditions = form.read();
    if (!conditions.length) return false;
    void rehearsing.start(conditions);
    return true;
  }

  function drawStart(state) {
    const { running } = state.rehearsal;
    const reason = whyNotRehearsed(state) || (form.read().length ? "" : t("Choose at least one of the conditions."));
    place("start").disabled = Boolean(reason) || running !== null;
    place("why-not").textContent = running ? "" : reason;
    place("start").hidden = running !== null;
    place("cancel").hidden = running === null;
    place("cancel").disabled = !running?.id;
  }

  function drawRunning({ running }) {
    place("job").hidden = running === null;
    if (!running) return;
    const share = running.progress ?? 0;
    place("what").textContent = running.message;
    place("how-far").textContent = running.progress === null ? "" : percentText(share * 100);
    place("progress").setAttribute("aria-valuenow", Math.round(share * 100));
    place("progress").firstElementChild.style.width = `${share * 100}%`;
  }

  function drawVerdict({ detail, run, track, list }, mission) {
    const isKnown = Boolean(detail?.runs);
    place("verdict").hidden = !isKnown;
    place("empty").hidden = isKnown || list === null || list.some(isRunning);
    drawEarlier(list ?? [], detail);
    if (!isKnown) return refill(place("verdict"), "", () => []);
    const key = JSON.stringify([
      detail.id,
      detail.state,
      detail.level,
      detail.is_outdated,
      detail.ground_changed,
      run,
      Boolean(track),
      chosenRoute,
      mission?.revision,
    ]);
    return refill(place("verdict"), key, () => verdict(detail, run, track));
  }

  /** Which of the rehearsals is looked at, where there are several. */
  function drawEarlier(list, detail) {
    place("earlier").hidden = list.length < 2;
    refill(
      place("list"),
      JSON.stringify(list.map(({ id, state, level: name, is_outdated }) => [id, state, name, is_outdated])),
      () =>
        list.map((one) =>
          h(
            "option",
            { value: one.id },
            [
              whenText(one.created_at),
              one.is_outdated ? t("out of date") : isRunning(one) ? t("under way") : levelWords(one.level),
              one.runs.map(({ words }) => words).join(", "),
            ].join(" · "),
          ),
        ),
    );
    if (detail && document.activeElement !== place("list")) place("list").value = detail.id;
  }
  place("list").addEventListener("change", ({ target }) => void rehearsing.show(target.value));

  function verdict(detail, number, track) {
    const run = detail.runs[number];
    return [
      h("h3", { class: "rehearsal-sentence", id: "rehearsal-sentence" }, sentenceOf(detail)),
      h(
        "p",
        { class: "caption" },
        t("Simulated {time}", { time: whenText(detail.created_at) }),
        detail.created_by && ` · ${detail.created_by}`,
      ),
      detail.is_outdated &&
        h(
          "p",
          { class: "notice warning", role: "status" },
          icon("triangle-alert"),
          h(
            "span",
            {},
            h("strong", {}, t("Out of date.")),
            " ",
            t("The plan is another one by now: this says nothing about it. Rehearse it again."),
          ),
        ),
      !detail.is_outdated &&
        detail.ground_changed &&
        h(
          "p",
          { class: "notice advisory" },
          icon("info"),
          h("span", {}, t("Zones, assets or terrain have changed somewhere since.")),
        ),
      detail.runs.length > 1 &&
        h(
          "div",
          { class: "rehearsal-runs", role: "group", "aria-label": t("Conditions") },
          detail.runs.map((one) =>
            h(
              "button",
              {
                type: "button",
                class: "button small",
                "aria-pressed": `${one.sequence === number}`,
                disabled: !one.level,
                onclick: () => void rehearsing.chooseRun(one.sequence),
              },
              icon(LEVELS[one.level] ?? "circle-dashed", "small"),
              one.words,
            ),
          ),
        ),
      run?.is_reused &&
        h(
          "p",
          { class: "caption rehearsal-reused" },
          t("Flown {time}: the same plan in the same air flies alike, and was not flown again.", {
            time: whenText(run.finished_at),
          }),
          canRehearse &&
            !detail.is_outdated && [
              " ",
              h(
                "button",
                {
                  type: "button",
                  class: "text-button",
                  disabled: store.state.rehearsal.running !== null,
                  onclick: () =>
                    void rehearsing.start(
                      detail.runs.map(({ conditions }) => askedAgain(conditions)),
                      { afresh: true },
                    ),
                },
                t("Fly it again"),
              ),
            ],
        ),
      run?.verdict ? runOf(detail, run, track) : [],
      h(
        "details",
        { class: "rehearsal-limits" },
        h("summary", {}, t("Limits and what flew")),
        detail.uavs.map(({ words }) => h("p", { class: "caption" }, words)),
        h(
          "dl",
          {},
          detail.limits.map(({ words, value, name, source }) => [
            h("dt", {}, words),
            h("dd", {}, limitText(name, value), h("small", {}, source)),
          ]),
        ),
      ),
    ];
  }

  function runOf(detail, run, track) {
    return [
      h("p", { class: "rehearsal-air" }, airWords(run.conditions)),
      h(
        "button",
        { type: "button", class: "button small", onclick: seeInSpace },
        icon("move-3d", "small"),
        t("See it in 3D"),
      ),
      run.verdict.routes.map((route) => {
        const isOpen = (chosenRoute ?? worstRoute(run.verdict)) === route.uav;
        const flown = track?.routes.find(({ uav }) => uav === route.uav);
        const other = nearestOther(run.verdict, route.uav);
        return h(
          "details",
          {
            class: `rehearsal-route route-${routeNumber(route.uav)}`,
            open: isOpen,
            ontoggle: ({ target }) => target.open && choose(route.uav),
          },
          h(
            "summary",
            {},
            h("span", { class: "letter" }, routeLetter(route.uav)),
            h("strong", {}, route.name),
            level(route.level),
            icon("chevron-down", "small"),
          ),
          route.reasons.length > 0 &&
            h(
              "ul",
              { class: "rehearsal-reasons" },
              route.reasons.map((words) => h("li", {}, words)),
            ),
          h(
            "table",
            { class: "rehearsal-table" },
            h("caption", { class: "unseen" }, t("Flown in simulation, and planned or allowed")),
            h(
              "tbody",
              {},
              figuresOf(route, detail.limits).map(({ words, flown: value, beside }) =>
                h("tr", {}, h("th", { scope: "row" }, words), h("td", { class: "number" }, value), h("td", {}, beside)),
              ),
              other &&
                h(
                  "tr",
                  {},
                  h("th", { scope: "row" }, t("From another UAV")),
                  h("td", { class: "number" }, heightText(other.away_m)),
                  h("td", {}, routeLetter(other.other)),
                ),
            ),
          ),
          flown && drawCharts(flown, route.reserve_percent),
          h("h4", {}, t("Targets")),
          h("ol", { class: "rehearsal-targets" }, route.targets.map(targetOf)),
        );
      }),
    ];
  }

  function choose(uav) {
    if (chosenRoute === uav) return;
    chosenRoute = uav;
    for (const details of place("verdict").querySelectorAll(".rehearsal-route"))
      if (!details.classList.contains(`route-${routeNumber(uav)}`)) details.open = false;
  }

  const targetOf = (target) =>
    h(
      "li",
      { class: target.level },
      icon(LEVELS[target.level], "small"),
      h(
        "div",
        {},
        h(
          "p",
          {},
          h("strong", {}, `${target.target + 1} ${target.label}`),
          h("span", { class: "unseen" }, ` ${levelWords(target.level)}`),
        ),
        h(
          "p",
          { class: "caption" },
          [
            target.closest_m === null
              ? t("not flown to")
              : target.is_reached
                ? t("reached, {away} off", { away: heightText(target.closest_m) })
                : t("not reached, {away} off", { away: heightText(target.closest_m) }),
            target.battery_percent !== null && t("battery {percent}", { percent: percentText(target.battery_percent) }),
          ]
            .filter(Boolean)
            .join(" · "),
        ),
        target.reasons.map((words) => h("p", { class: "rehearsal-why" }, words)),
      ),
    );

  function draw(state) {
    const { rehearsal, mission, plan } = state;
    section.hidden = !isStage && (!mission || (!plan && !isFrozen && !rehearsal.list?.length));
    if (section.hidden) return;
    if (form) drawStart(state);
    drawRunning(rehearsal);
    place("fault").hidden = !rehearsal.fault;
    place("fault").textContent = rehearsal.fault;
    drawVerdict(rehearsal, mission);
  }

  store.listen(
    ["rehearsal", "mission", "plan", "planIsStored", "selection", "name", "savedBasis", "saving", "planning"],
    draw,
  );
  if (!canRehearse) return [];
  const open = () => {
    if (section.hidden) return false;
    const scrolled = section.closest(".side-scroll"); // the page itself stays where it is
    scrolled.scrollTop += section.getBoundingClientRect().top - scrolled.getBoundingClientRect().top;
    place("form").querySelector("input").focus({ preventScroll: true });
    return true;
  };
  return [{ keys: ["r"], words: t("Rehearse: choose conditions"), act: open }];
}

/** Conditions as a request names them: those of a run once more. */
const askedAgain = ({ code, name, wind, temperature_c, gusts_mps, turbulence_mps_at_20ft, battery_percent }) =>
  code === "own" ? { name, wind, temperature_c, gusts_mps, turbulence_mps_at_20ft, battery_percent } : code;

const worstRoute = ({ routes }) =>
  (
    routes.find(({ level: name }) => name === "fail") ??
    routes.find(({ level: name }) => name === "warnings") ??
    routes[0]
  )?.uav;

const limitText = (name, value) =>
  name.endsWith("_percent")
    ? percentText(value)
    : name.endsWith("_s")
      ? `${numberText(value)}\u00a0s`
      : exactHeightText(value);

function airWords({ wind, gusts_mps, battery_percent }) {
  const [first] = wind;
  const words = [
    first && first.speed_mps > 0
      ? t("wind {speed} from {from}° at {height}", {
          speed: speedText(first.speed_mps),
          from: Math.round(first.from_deg),
          height: heightText(first.altitude_agl_m),
        })
      : t("no wind"),
  ];
  if (gusts_mps > 0) words.push(t("gusts {speed}", { speed: speedText(gusts_mps) }));
  if (battery_percent < 100) words.push(t("battery holds {percent}", { percent: percentText(battery_percent) }));
  return words.join(", ");
}
