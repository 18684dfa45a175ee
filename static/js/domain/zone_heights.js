/** Height limits of a zone: words, a small drawing of the band, and the fields that edit them. */

import { h, svg } from "../dom.js";
import { t } from "../text.js";
import { heightText } from "../units.js";

/** @import { Limit } from "../api_types.d.ts" */

/** @typedef {{ lower_limit: Limit | null, upper_limit: Limit | null }} Limits */

/** @type {[string, string][]} */
export const REFERENCES = [
  ["AGL", t("above ground")],
  ["AMSL", t("above sea level")],
  ["STD", t("flight level")],
  ["WGS84", t("above the ellipsoid")],
];
const WORDS = Object.fromEntries(REFERENCES);
const FOOT_M = 0.3048;
const FLIGHT_LEVEL_M = 100 * FOOT_M;

/** @param {Limit | null} limit @param {"lower" | "upper"} side */
export function limitText(limit, side) {
  if (!limit) return side === "lower" ? t("lower limit not stated") : t("upper limit not stated");
  if (limit.reference === "STD") return `FL\u00a0${Math.round(limit.value_m / FLIGHT_LEVEL_M)}`;
  if (limit.value_m === 0 && limit.reference === "AGL") return t("ground");
  return `${heightText(limit.value_m)} ${WORDS[limit.reference] ?? ""}`.trim();
}

/** Both limits in one sentence. @param {Limits} zone */
export function heightsText({ lower_limit: lower, upper_limit: upper }) {
  if (lower && upper)
    return t("From {low} to {high}", { low: limitText(lower, "lower"), high: limitText(upper, "upper") });
  if (upper) return t("Up to {high}, lower limit not stated", { high: limitText(upper, "upper") });
  return lower ? t("From {low}, upper limit not stated", { low: limitText(lower, "lower") }) : t("Heights not stated");
}

/** A column of air with the band in it; an unstated limit is open, drawn as a dashed end. @param {Limits} zone */
export function bandDrawing({ lower_limit: lower, upper_limit: upper }) {
  const [width, height, ground] = [34, 64, 58];
  const top = upper ? 16 : 4;
  const bottom = lower && lower.value_m > 0 ? 40 : ground;
  return svg(
    "svg",
    { width, height, viewBox: `0 0 ${width} ${height}`, "aria-hidden": "true" },
    svg("rect", { x: 8, y: top, width: 18, height: bottom - top, fill: "var(--zone-fill)", stroke: "none" }),
    ...[0, 6, 12, 18].map((step) =>
      svg("path", {
        d: `M8 ${Math.min(bottom, top + step + 12)}L26 ${Math.max(top, top + step - 2)}`,
        stroke: "var(--zone)",
        "stroke-width": 0.8,
        "clip-path": "none",
        opacity: 0.6,
      }),
    ),
    svg("path", {
      d: `M6 ${top}H28`,
      stroke: "var(--zone)",
      "stroke-width": 1.75,
      "stroke-dasharray": upper ? "none" : "3 3",
    }),
    svg("path", {
      d: `M6 ${bottom}H28`,
      stroke: "var(--zone)",
      "stroke-width": 1.75,
      "stroke-dasharray": lower ? "none" : "3 3",
    }),
    svg("path", { d: `M2 ${ground}H32`, stroke: "var(--ink-2)", "stroke-width": 1.5 }),
  );
}

/** What planning makes of a limit that is not stated. */
const OPEN = {
  lower: t("Not stated: plans count the zone from the ground."),
  upper: t("Not stated: plans count the zone without an upper end."),
};

/**
 * { element, set(), read() } for one limit; read gives { value_m, reference } or null for "not stated".
 *
 * @param {"lower" | "upper"} side
 * @param {string} words
 * @param {Limit | null} limit
 */
export function limitField(side, words, limit) {
  const isLevel = limit?.reference === "STD";
  const value = h("input", {
    class: "input",
    id: `${side}-value`,
    type: "number",
    step: "any",
    min: -1000,
    max: 100_000,
    value: limit ? String(Math.round((isLevel ? limit.value_m / FLIGHT_LEVEL_M : limit.value_m) * 10) / 10) : "",
    "aria-label": t("{limit}, value", { limit: words }),
  });
  const unit = h(
    "select",
    { class: "input", "aria-label": t("{limit}, unit", { limit: words }) },
    [
      ["m", "m"],
      ["ft", "ft"],
    ].map(([key, text]) => h("option", { value: key }, text)),
  );
  const reference = h(
    "select",
    { class: "input", "aria-label": t("{limit}, counted from", { limit: words }) },
    [["", t("not stated")], ...REFERENCES].map(([key, text]) =>
      h("option", { value: key, selected: key === (limit?.reference ?? "") }, text),
    ),
  );
  const metres = h("p", { class: "caption", hidden: true });
  const open = h("p", { class: "caption" }, OPEN[side]);
  const factor = () => (reference.value === "STD" ? FLIGHT_LEVEL_M : unit.value === "ft" ? FOOT_M : 1);
  const adapt = () => {
    value.disabled = reference.value === "";
    value.required = reference.value !== "";
    unit.disabled = reference.value === "" || reference.value === "STD";
    open.hidden = reference.value !== "";
    metres.hidden = value.disabled || value.value === "" || factor() === 1;
    metres.textContent = `${value.value}\u00a0${reference.value === "STD" ? t("hundred feet of pressure altitude") : "ft"} = ${heightText(Number(value.value) * factor())}`;
  };
  for (const part of [value, unit, reference]) part.addEventListener("input", adapt);
  adapt();
  return {
    element: h(
      "fieldset",
      {},
      h("legend", {}, words),
      h("div", { class: "limit-row" }, value, unit, reference),
      metres,
      open,
    ),
    /** @param {Limit | null} to */
    set(to) {
      reference.value = to?.reference ?? "";
      unit.value = "m";
      value.value = to ? `${to.value_m}` : "";
      adapt();
      value.dispatchEvent(new Event("input", { bubbles: true }));
    },
    read() {
      if (!reference.value || value.value === "") return null;
      return { value_m: Math.round(Number(value.value) * factor() * 100) / 100, reference: reference.value };
    },
  };
}
