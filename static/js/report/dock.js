/** The dock: strips and charts on one time axis, one cursor through all of them, figures at the cursor beside them. */

import { byId, h, svg } from "../dom.js";
import { routeLetter, routeNumber } from "../domain/palette.js";
import { hasLanded, plannedHeights, scaleOf, ticksOf } from "../record/timeline.js";
import { ESTIMATED, linesOf, MEASURED, momentOf, SILENT } from "../record/track.js";
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

const MOST_READINGS = 6; // beside a chart; of more UAVs only the chosen one is read
const MINUTE_MS = 60_000;
const SHORT_S = 90;

const CHARTS = [
  {
    name: "height_m",
    words: t("Height"),
    said: t("Height above take-off by time"),
    unit: SHORT_UNIT.metres,
    height_px: 64,
    text: heightText,
    hasPlan: true,
  },
  {
    name: "speed_mps",
    words: t("Speed"),
    said: t("Speed over ground by time"),
    unit: SPEED_UNIT.mps,
    height_px: 44,
    text: speedText,
  },
  {
    name: "battery_percent",
    words: t("Battery"),
    said: t("Battery by time"),
    unit: 1,
    highest: 100,
    height_px: 44,
    text: percentText,
  },
];

const letter = (place, size = "") =>
  h("span", { class: `letter route-${routeNumber(place)} ${size}` }, routeLetter(place));
const waitText = (ms) =>
  ms < SHORT_S * 1_000 ? t("{count} s", { count: Math.round(ms / 1_000) }) : durationText(ms / 1_000);

/** What comes next for a UAV after a moment. */
function nextWords({ track, targets, isOver }, at_ms) {
  const [first] = track.flights;
  if (!first) return t("not flown");
  if (at_ms < first.from_ms) return t("takes off in {time}", { time: waitText(first.from_ms - at_ms) });
  const next = targets.find((target) => target.at_ms > at_ms);
  if (next) return t("{target} in {time}", { target: next.label, time: waitText(next.at_ms - at_ms) });
  const index = track.flights.findIndex(({ to_ms }) => to_ms > at_ms);
  if (index >= 0 && hasLanded(track, index, isOver))
    return t("lands in {time}", { time: waitText(track.flights[index].to_ms - at_ms) });
  return hasLanded(track, track.flights.length - 1, isOver)
    ? t("landed")
    : t("last heard {time}", { time: clockText(track.samples.at(-1).at_ms) });
}

function unsureWords(moment) {
  if (moment?.kind === ESTIMATED) return t("estimated, ±{bound}", { bound: heightText(moment.sample.bound_m) });
  return moment?.kind === SILENT ? t("no report") : "";
}

/** onChoose(place): a UAV's name was clicked. draw(shown, span); point(at_ms, chosen). */
export function createDock({ onChoose }) {
  const body = byId("replay-body");
  const cursor = byId("replay-cursor");
  const slider = byId("replay-slider");
  let shown = null; // { routes, span }
  let scale = null;
  const parts = { strips: [], charts: [] };
  let width_px = 0;

  const columnWidth = () => Math.floor(slider.getBoundingClientRect().width);

  function draw() {
    if (!shown) return;
    width_px = Math.max(120, columnWidth());
    scale = scaleOf(shown.span, width_px);
    const { x } = scale;
    parts.strips = shown.routes.map((route) => stripRow(route, x));
    byId("replay-strips").replaceChildren(...parts.strips.map(({ row }) => row));
    parts.charts = CHARTS.map((chart) => chartRow(chart, x)).filter(Boolean);
    byId("replay-charts").replaceChildren(...parts.charts.map(({ row }) => row));
    drawAxis(x);
  }

  function stripRow(route, x) {
    const flown = route.targets.filter(({ at_ms }) => at_ms !== null);
    const label = t("{name}: {targets} targets reached, {alerts} alerts", {
      name: route.name,
      targets: flown.length,
      alerts: route.alerts.length,
    });
    const strip = drawStrip({ ...route, targets: flown, x, width_px, label });
    const reading = h("span", { class: "replay-reading" });
    const name = h(
      "button",
      { type: "button", class: "replay-name", "aria-pressed": "false", onclick: () => onChoose(route.place) },
      letter(route.place),
      h("strong", {}, route.name),
    );
    return {
      route,
      name,
      reading,
      row: h("div", { class: "replay-row", "data-place": route.place }, name, strip, reading),
    };
  }

  function chartRow(chart, x) {
    const series = shown.routes.map((route) => ({
      place: route.place,
      lines: linesOf(route.track.samples, chart.name, route.track.silence_ms),
      planned: chart.hasPlan ? plannedHeights(route).filter(({ at_ms }) => at_ms <= shown.span.to_ms) : [],
    }));
    if (!series.some(({ lines }) => lines.length)) return null;
    const drawing = drawChart({ ...chart, series, x, width_px, ruleText: chart.text, label: chart.said });
    const readings = h("span", { class: "replay-reading replay-figures" });
    return {
      chart,
      drawing,
      readings,
      row: h(
        "div",
        { class: "replay-row replay-chart-row" },
        h("span", { class: "replay-what" }, chart.words),
        drawing.element,
        readings,
      ),
    };
  }

  function drawAxis(x) {
    const { step_ms, moments } = ticksOf(shown.span, width_px, minutesAheadOfUtc(shown.span.from_ms));
    const text = step_ms < MINUTE_MS ? exactClockText : clockText;
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

  new ResizeObserver(() => {
    if (!shown || columnWidth() === width_px) return;
    draw();
    if (last) point(...last);
  }).observe(body);

  let last = null;
  function point(at_ms, looked, eventWords) {
    if (!shown) return;
    last = [at_ms, looked, eventWords];
    cursor.style.left = `${scale.x(at_ms)}px`;
    byId("replay-clock").textContent = exactClockText(at_ms);
    byId("replay-day").textContent = `${dateText(at_ms)}, ${zoneText(new Date(at_ms).toISOString())}`;
    byId("replay-event").textContent = eventWords;
    slider.setAttribute("aria-valuemax", Math.round((shown.span.to_ms - shown.span.from_ms) / 1_000));
    slider.setAttribute("aria-valuenow", Math.round((at_ms - shown.span.from_ms) / 1_000));
    slider.setAttribute("aria-valuetext", [exactClockText(at_ms), eventWords].filter(Boolean).join(", "));
    const moments = new Map(shown.routes.map(({ place, track }) => [place, momentOf(track, at_ms)]));
    for (const { route, name, reading, row } of parts.strips) {
      const moment = moments.get(route.place);
      reading.textContent = unsureWords(moment) || nextWords(route, at_ms);
      name.setAttribute("aria-pressed", String(looked === route.place));
      row.classList.toggle("looked", looked === route.place);
    }
    byId("dock").classList.toggle("with-looked", looked !== null);
    for (const element of body.querySelectorAll("svg [data-place]"))
      element.classList.toggle("looked", Number(element.dataset.place) === looked);
    for (const part of parts.charts) {
      const values = readingsOf(part.chart, moments);
      part.drawing.point(values);
      const said = shown.routes.filter(
        ({ place }) => values.has(place) && (looked === null ? shown.routes.length <= MOST_READINGS : place === looked),
      );
      part.readings.replaceChildren(
        ...said.map(({ place }) => h("span", {}, letter(place, "small"), part.chart.text(values.get(place).value))),
      );
    }
  }

  return {
    draw(next) {
      shown = next;
      draw();
    },
    point,
    /** The moment at a place of the screen. */
    momentAt: (client_x) => scale?.at_ms(client_x - slider.getBoundingClientRect().left) ?? null,
  };
}

/** Map of place → { at_ms, value }: what was measured then; nothing in a silence. */
function readingsOf({ name }, moments) {
  const values = new Map();
  for (const [place, moment] of moments) {
    if (moment?.kind !== MEASURED || moment.sample[name] === null) continue;
    values.set(place, { at_ms: moment.sample.at_ms, value: moment.sample[name] });
  }
  return values;
}
