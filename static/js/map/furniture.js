/** What stands around the map: legend, scale, coordinates, attribution, tooltip, the layers menu. */

import { byId, h, icon, svg } from "../dom.js";
import { coordinateText, lengthText } from "../units.js";
import { GROUPS } from "./style.js";

const TIP_AFTER_MS = 300;
const WIDEST_SCALE_PX = 90;

const sample = (...drawing) => svg("svg", { width: 26, height: 12, viewBox: "0 0 26 12", "aria-hidden": "true" }, drawing);
const stroke = (token, width, rest = {}) => svg("path", { d: "M1 6H25", stroke: `var(${token})`, "stroke-width": width, fill: "none", ...rest });

const line = (token, width, rest) => () => sample(stroke(token, width, rest));

/** Rows of the legend: what counts as being in view, words, drawing. */
const LEGEND = [
  { layer: "lines", test: ({ voltage }) => voltage >= 380, words: "380 kV and over", draw: line("--volt-400", 3) },
  { layer: "lines", test: ({ voltage }) => voltage >= 200 && voltage < 380, words: "200 to 379 kV", draw: line("--volt-220", 2.2) },
  { layer: "lines", test: ({ voltage }) => voltage >= 100 && voltage < 200, words: "100 to 199 kV", draw: line("--volt-132", 1.6) },
  { layer: "lines", test: ({ voltage }) => voltage >= 50 && voltage < 100, words: "50 to 99 kV", draw: line("--volt-66", 1.1) },
  { layer: "lines", test: ({ voltage }) => voltage < 50, words: "under 50 kV", draw: line("--volt-20", 0.9) },
  { layer: "lines-unknown", test: () => true, words: "Voltage not stated", draw: line("--volt-unknown", 1.3, { "stroke-dasharray": "5 3" }) },
  { layer: "railways", test: () => true, words: "Railway", draw: () => sample(stroke("--railway", 2.6), stroke("--ground", 1.3, { "stroke-dasharray": "5 5" })) },
  { layer: "bridges", test: () => true, words: "Bridge", draw: () => sample(svg("path", { d: "M1 4H25M1 8H25", stroke: "var(--bridge)", "stroke-width": 1.5 })) },
  {
    layer: "zones-fill",
    test: () => true,
    words: "No-fly zone",
    draw: () =>
      sample(
        svg("rect", { x: 3, y: 1, width: 20, height: 10, fill: "var(--zone-fill)", stroke: "var(--zone)", "stroke-width": 1.3 }),
        svg("path", { d: "M5 10l8-8M11 10l8-8M17 10l5-5", stroke: "var(--zone)", "stroke-width": 0.9 }),
      ),
  },
];

/** UAVs stand on the map as HTML, not in a layer. */
const UAV_ROW = {
  words: "UAV",
  draw: () => sample(svg("path", { d: "M13 1L18.5 11L13 8.5L7.5 11Z", fill: "var(--map-casing)", stroke: "var(--ink-2)", "stroke-width": 1.3, "stroke-linejoin": "round" })),
};

const legendItems = (rows) => rows.map(({ words, draw }) => h("li", {}, draw(), words));

function isWithin(element, frame) {
  const [inner, outer] = [element.getBoundingClientRect(), frame.getBoundingClientRect()];
  return inner.right > outer.left && inner.left < outer.right && inner.bottom > outer.top && inner.top < outer.bottom;
}

/** A legend of what is in view. */
export function mountLegend(map) {
  const legend = byId("legend");
  let shown = "";
  map.on("idle", () => {
    const layers = [...new Set(LEGEND.map((row) => row.layer))].filter((id) => map.getLayer(id));
    const seen = map.queryRenderedFeatures({ layers });
    const rows = LEGEND.filter((row) => seen.some((feature) => feature.layer.id === row.layer && row.test(feature.properties)));
    if ([...map.getContainer().querySelectorAll(".map-dart")].some((dart) => isWithin(dart, map.getContainer()))) rows.push(UAV_ROW);
    const words = rows.map((row) => row.words).join();
    if (words === shown) return;
    shown = words;
    legend.hidden = rows.length === 0;
    legend.replaceChildren(...legendItems(rows));
  });
}

/** The longest round distance that is at most 90 px: { length_m, width_px }. */
export function scaleOf(metres_per_px) {
  const most = metres_per_px * WIDEST_SCALE_PX;
  const power = 10 ** Math.floor(Math.log10(most));
  const length_m = [5, 2, 1].map((factor) => factor * power).find((candidate) => candidate <= most);
  return { length_m, width_px: length_m / metres_per_px };
}

export function mountScale(map) {
  const scale = byId("scale");
  const draw = () => {
    const latitude = map.getCenter().lat;
    const metres_per_px = (40_075_016.686 * Math.cos((latitude * Math.PI) / 180)) / (512 * 2 ** map.getZoom());
    const { length_m, width_px } = scaleOf(metres_per_px);
    scale.querySelector("span").textContent = lengthText(length_m).replace(".0", "");
    scale.querySelector("i").style.width = `${width_px}px`;
  };
  map.on("move", draw);
  draw();
}

export function mountCoordinates() {
  const place = byId("coordinates");
  return (position) => (place.textContent = position ? coordinateText(position) : "");
}

/** Each source once; "© X" is left out beside "© X, licence". */
export function distinct(sources) {
  const all = [...new Set(sources)];
  return all.filter((source) => !all.some((other) => other !== source && other.startsWith(`${source},`)));
}

export function setAttribution(sources) {
  byId("attribution").textContent = distinct(sources.filter(Boolean)).join(" · ");
}

/** Shows words beside the pointer after 300 ms; null takes them away. */
export function createTip(frame) {
  const tip = byId("map-tip");
  let timer = 0;
  let current = null;
  const place = ({ x, y }) => {
    const [width, height] = [tip.offsetWidth, tip.offsetHeight];
    const left = x + 14 + width > frame.clientWidth ? x - width - 14 : x + 14;
    const top = y + 14 + height > frame.clientHeight ? y - height - 14 : y + 14;
    tip.style.transform = `translate(${Math.max(6, left)}px, ${Math.max(6, top)}px)`;
  };
  const hide = () => {
    clearTimeout(timer);
    tip.hidden = true;
    current = null;
  };
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && !tip.hidden) hide();
  });
  return (key, point, make) => {
    if (key === null) return hide();
    if (key === current) {
      if (!tip.hidden) place(point);
      return undefined;
    }
    hide();
    current = key;
    timer = setTimeout(() => {
      tip.replaceChildren(...make());
      tip.hidden = false;
      place(point);
    }, TIP_AFTER_MS);
    return undefined;
  };
}

const KIND_WORDS = { tower: "Power tower", line: "Power line", railway: "Railway", bridge: "Bridge", pole: "Pole", portal: "Portal", minor_line: "Minor power line", cable: "Cable" };

function limitWords(value, reference) {
  const references = { agl: "above ground", amsl: "above sea level", wgs84: "above the ellipsoid" };
  if (value === undefined || value === null) return "not stated";
  return `${Math.round(value)} m${references[String(reference).toLowerCase()] ? ` ${references[String(reference).toLowerCase()]}` : ""}`;
}

/** The words of a zone file's code: "AIR_TRAFFIC, NATURE" becomes "Air traffic, nature". Other texts stay as they are. */
export function plainWords(text) {
  if (!/^[A-Z][A-Z_]+(, ?[A-Z][A-Z_]+)*$/.test(text)) return text;
  const words = text.toLowerCase().replaceAll("_", " ");
  return words[0].toUpperCase() + words.slice(1);
}

/** The tooltip's content for an asset or a zone. */
export function tipOf({ kind, properties }) {
  if (kind === "zone") {
    const lower = limitWords(properties.lower_limit_m, properties.lower_reference);
    const upper = limitWords(properties.upper_limit_m, properties.upper_reference);
    const isStated = properties.lower_limit_m !== undefined || properties.upper_limit_m !== undefined;
    return [
      h("strong", {}, properties.name),
      h("span", { class: "zone-chip" }, icon("circle-alert", "small"), "No-fly zone"),
      h("div", {}, isStated ? `From ${lower} to ${upper}` : "Heights not stated"),
      properties.reason && h("div", {}, plainWords(properties.reason)),
      h("div", { class: "quiet-text" }, "Counts at all heights and times for now"),
    ].filter(Boolean);
  }
  return [
    h("strong", {}, properties.label),
    h("div", {}, KIND_WORDS[properties.subtype] ?? KIND_WORDS[kind]),
    properties.detail && h("div", { class: "quiet-text" }, properties.detail),
    properties.flyable === false && h("div", { class: "quiet-text" }, "Not part of the flying network"),
  ].filter(Boolean);
}

/** The layers menu. under: { choices: [{ value, words }], chosen, choose(value) } */
export function layersMenu({ under, isShown, show }) {
  const menu = h("div", { class: "menu float layers-menu", role: "group", "aria-label": "Layers" });
  if (under.choices.length > 1) {
    menu.append(
      h("h2", {}, "Base map"),
      ...under.choices.map(({ value, words }) =>
        h("label", {}, h("input", { type: "radio", name: "under", class: "radio", value, checked: under.chosen() === value, onchange: () => under.choose(value) }), words),
      ),
    );
  }
  menu.append(
    h("h2", {}, "Shown"),
    ...GROUPS.map((group) => h("label", {}, h("input", { type: "checkbox", class: "check", checked: isShown(group), onchange: (event) => show(group, event.target.checked) }), group.name)),
    h("h2", { class: "legend-head" }, "Legend"),
    h("ul", { class: "legend" }, legendItems([...LEGEND, UAV_ROW])),
  );
  return menu;
}
