/** The dock: strips and charts on one time axis, one cursor through all of them, figures at the cursor beside them. */

import { byId, h, svg } from "../dom.js";
import { colourClass, routeLetter } from "../domain/palette.js";
import { hasLanded, plannedHeights, scaleOf, ticksOf } from "../record/timeline.js";
import { ESTIMATED, flownLinesOf, MEASURED, momentOf, SILENT } from "../record/track.js";
import { t } from "../text.js";
import {
  clockText,
  dateText,
  durationText,
  exactClockText,
  heightText,
  minutesAheadOfUtc,
  percentText,
  SHORT_UNIT,
  SPEED_UNIT,
  speedText,
  zoneText,
} from "../units.js";
import { drawChart } from "./charts.js";
import { drawStrip } from "./strip.js";

/** @import { TimeSpan } from "../record/player.js" */
/** @import { Scale } from "../record/timeline.js" */
/** @import { Moment, TimedValue } from "../record/track.js" */
/** @import { ReachedTarget, ReplayRoute } from "./types.d.ts" */

/**
 * @typedef {object} Chart
 * @property {"height_m" | "speed_mps" | "battery_percent"} name
 * @property {string} words
 * @property {string} summary for screen readers
 * @property {number} unit
 * @property {number} height_px
 * @property {number} [highest]
 * @property {(value: number) => string} text
 * @property {boolean} [hasPlan]
 */
/** @typedef {{ routes: ReplayRoute[], span: TimeSpan }} Shown */
/** @typedef {{ x: Scale["x"], width_px: number }} Axis */

const MAX_READINGS = 6; // beside a chart; with more UAVs only the chosen one has a figure
const MINUTE_MS = 60_000;
const SHORT_S = 90;

/** @type {Chart[]} */
const CHARTS = [
  {
    name: "height_m",
    words: t("Height"),
    summary: t("Height above take-off by time"),
    unit: SHORT_UNIT.metres,
    height_px: 64,
    text: heightText,
    hasPlan: true,
  },
  {
    name: "speed_mps",
    words: t("Speed"),
    summary: t("Speed over ground by time"),
    unit: SPEED_UNIT.mps,
    height_px: 44,
    text: speedText,
  },
  {
    name: "battery_percent",
    words: t("Battery"),
    summary: t("Battery by time"),
    unit: 1,
    highest: 100,
    height_px: 44,
    text: percentText,
  },
];

/** @param {Pick<ReplayRoute, "place" | "colour">} route @param {string} [size] */
const letter = ({ place, colour }, size = "") =>
  h("span", { class: `letter ${colourClass(colour)} ${size}` }, routeLetter(place));
/** @param {number} ms */
const waitText = (ms) =>
  ms < SHORT_S * 1_000 ? t("{count} s", { count: Math.round(ms / 1_000) }) : durationText(ms / 1_000);

/** @param {ReplayRoute} route */
const reachedTargets = ({ targets }) =>
  targets.filter(/** @returns {target is ReachedTarget} */ (target) => target.at_ms !== null);

/** What comes next for a UAV after a moment. @param {ReplayRoute} route @param {number} at_ms */
function nextWords(route, at_ms) {
  const { track, isOver } = route;
  const [first] = track.flights;
  if (!first) return t("not flown");
  if (at_ms < first.from_ms) return t("takes off in {time}", { time: waitText(first.from_ms - at_ms) });
  const next = reachedTargets(route).find((target) => target.at_ms > at_ms);
  if (next) return t("{target} in {time}", { target: next.label, time: waitText(next.at_ms - at_ms) });
  const index = track.flights.findIndex(({ to_ms }) => to_ms > at_ms);
  if (index >= 0 && hasLanded(track, index, isOver))
    return t("lands in {time}", { time: waitText(track.flights[index].to_ms - at_ms) });
  return hasLanded(track, track.flights.length - 1, isOver)
    ? t("landed")
    : t("last contact {time}", { time: clockText(track.samples[track.samples.length - 1].at_ms) });
}

/** @param {Moment | undefined} moment */
function unsureWords(moment) {
  if (moment?.kind === ESTIMATED) return t("estimated, ±{bound}", { bound: heightText(moment.sample.bound_m) });
  return moment?.kind === SILENT ? t("no telemetry") : "";
}

/** @typedef {ReturnType<typeof stripRow>} StripRow */
/** @param {ReplayRoute} route @param {Axis} axis @param {(place: number) => void} onChoose */
function stripRow(route, { x, width_px }, onChoose) {
  const targets = reachedTargets(route);
  const label = t("{name}: {targets} targets reached, {alerts} alerts", {
    name: route.name,
    targets: targets.length,
    alerts: route.alerts.length,
  });
  const strip = drawStrip({ ...route, targets, x, width_px, label });
  const reading = h("span", { class: "replay-reading" });
  const name = h(
    "button",
    { type: "button", class: "replay-name", "aria-pressed": "false", onclick: () => onChoose(route.place) },
    letter(route),
    h("strong", {}, route.name),
  );
  return {
    route,
    name,
    reading,
    row: h("div", { class: "replay-row", "data-place": route.place }, name, strip, reading),
  };
}

/** Returns nothing where no UAV reported the value. @param {Chart} chart @param {Shown} shown @param {Axis} axis */
function chartRow(chart, { routes, span }, { x, width_px }) {
  const series = routes.map((route) => ({
    place: route.place,
    colour: route.colour,
    lines: flownLinesOf(route.track, chart.name),
    planned: chart.hasPlan ? plannedHeights(route).filter(({ at_ms }) => at_ms <= span.to_ms) : [],
  }));
  if (!series.some(({ lines }) => lines.length)) return [];
  const drawing = drawChart({ ...chart, series, x, width_px, ruleText: chart.text, label: chart.summary });
  const readings = h("span", { class: "replay-reading replay-figures" });
  const row = h(
    "div",
    { class: "replay-row replay-chart-row" },
    h("span", { class: "replay-what" }, chart.words),
    drawing.element,
    readings,
  );
  return [{ chart, drawing, readings, row }];
}

/** @param {TimeSpan} span @param {Axis} axis */
function drawAxis(span, { x, width_px }) {
  const { step_ms, moments } = ticksOf(span, width_px, minutesAheadOfUtc(span.from_ms));
  const text = step_ms < MINUTE_MS ? exactClockText : clockText;
  /** @param {number} at */
  const tick = (at) => [
    svg("line", { x1: x(at), x2: x(at), y1: 0, y2: 4 }),
    svg(
      "text",
      { x: x(at), y: 15, "text-anchor": x(at) < 20 ? "start" : x(at) > width_px - 20 ? "end" : "middle" },
      text(at),
    ),
  ];
  byId("replay-axis").replaceChildren(
    svg(
      "svg",
      { class: "replay-axis", width: width_px, height: 18, viewBox: `0 0 ${width_px} 18`, "aria-hidden": "true" },
      svg("line", { x1: 0, x2: width_px, y1: 0.5, y2: 0.5 }),
      moments.map(tick),
    ),
  );
}

/** @param {{ onChoose: (place: number) => void }} options onChoose: a UAV's name was clicked */
export function createDock({ onChoose }) {
  const body = byId("replay-body");
  const cursor = byId("replay-cursor");
  const slider = byId("replay-slider");
  /** @type {Shown | null} */
  let shown = null;
  /** @type {{ scale: Scale, strips: StripRow[], charts: ReturnType<typeof chartRow> } | null} */
  let drawn = null;
  let width_px = 0;
  /** @type {[at_ms: number, looked: number | null, eventWords: string] | null} */
  let last = null;

  const columnWidth = () => Math.floor(slider.getBoundingClientRect().width);

  /** @param {Shown} next */
  function draw(next) {
    shown = next;
    width_px = Math.max(120, columnWidth());
    const scale = scaleOf(next.span, width_px);
    const axis = { x: scale.x, width_px };
    const strips = next.routes.map((route) => stripRow(route, axis, onChoose));
    const charts = CHARTS.flatMap((chart) => chartRow(chart, next, axis));
    drawn = { scale, strips, charts };
    byId("replay-strips").replaceChildren(...strips.map(({ row }) => row));
    byId("replay-charts").replaceChildren(...charts.map(({ row }) => row));
    drawAxis(next.span, axis);
  }

  new ResizeObserver(() => {
    if (!shown || columnWidth() === width_px) return;
    draw(shown);
    if (last) point(...last);
  }).observe(body);

  /** @param {number} at_ms @param {number | null} looked @param {string} eventWords */
  function point(at_ms, looked, eventWords) {
    if (!shown || !drawn) return;
    const { routes, span } = shown;
    last = [at_ms, looked, eventWords];
    cursor.style.left = `${drawn.scale.x(at_ms)}px`;
    byId("replay-clock").textContent = exactClockText(at_ms);
    byId("replay-day").textContent = `${dateText(at_ms)}, ${zoneText(new Date(at_ms).toISOString())}`;
    byId("replay-event").textContent = eventWords;
    slider.setAttribute("aria-valuemax", `${Math.round((span.to_ms - span.from_ms) / 1_000)}`);
    slider.setAttribute("aria-valuenow", `${Math.round((at_ms - span.from_ms) / 1_000)}`);
    slider.setAttribute("aria-valuetext", [exactClockText(at_ms), eventWords].filter(Boolean).join(", "));
    const moments = new Map(routes.map(({ place, track }) => [place, momentOf(track, at_ms)]));
    for (const { route, name, reading, row } of drawn.strips) {
      reading.textContent = unsureWords(moments.get(route.place)) || nextWords(route, at_ms);
      name.setAttribute("aria-pressed", String(looked === route.place));
      row.classList.toggle("looked", looked === route.place);
    }
    byId("dock").classList.toggle("with-looked", looked !== null);
    for (const element of /** @type {NodeListOf<SVGElement>} */ (body.querySelectorAll("svg [data-place]")))
      element.classList.toggle("looked", Number(element.dataset.place) === looked);
    const read = routes.filter(({ place }) => (looked === null ? routes.length <= MAX_READINGS : place === looked));
    for (const { chart, drawing, readings } of drawn.charts) {
      const values = readingsOf(chart, moments);
      drawing.point(values);
      readings.replaceChildren(
        ...read.flatMap((route) => {
          const value = values.get(route.place)?.value;
          return value === undefined ? [] : [h("span", {}, letter(route, "small"), chart.text(value))];
        }),
      );
    }
  }

  return {
    draw,
    point,
    /** The moment at a place of the screen. @param {number} client_x */
    momentAt: (client_x) => drawn?.scale.at_ms(client_x - slider.getBoundingClientRect().left) ?? null,
  };
}

/**
 * The measurements at a moment, by the UAV's place; none in a silence.
 *
 * @param {Chart} chart
 * @param {Map<number, Moment>} moments
 */
function readingsOf({ name }, moments) {
  /** @type {Map<number, TimedValue>} */
  const values = new Map();
  for (const [place, moment] of moments) {
    const value = moment?.kind === MEASURED ? moment.sample[name] : null;
    if (moment && value !== null) values.set(place, { at_ms: moment.sample.at_ms, value });
  }
  return values;
}
