/** Texts of the fleet's pages on UAVs, types and bases. */

import { h, icon } from "../dom.js";
import { t, tn } from "../text.js";
import { lengthText, numberText, percentText, whenText } from "../units.js";

/** @import { UavFeature, UavState } from "../api_types.d.ts" */
/** @import { FleetBase, FleetType, Position, RowAnswer, Uav } from "./types.d.ts" */

const LOW_PERCENT = 30;

/** @type {Record<UavState, { words: string, icon: string }>} */
export const STATES = {
  active: { words: t("In service"), icon: "check" },
  maintenance: { words: t("In maintenance"), icon: "wrench" },
  retired: { words: t("Retired"), icon: "archive" },
};

/** @type {[Uav["end_action"], string][]} */
export const ENDS = [
  ["hover", t("Hover over its last target")],
  ["return", t("Return to start")],
  ["land", t("Land at its last target")],
  ["base", t("Land at the nearest base")],
];

export const CREDENTIALS = { "link-token": t("Token of the HTTP link"), "mavlink-key": t("MAVLink signing key") };

export const LINKS = {
  mavlink: { words: "MAVLink", by: t("by MAVLink") },
  http: { words: t("a companion computer over HTTP"), by: t("over HTTP") },
};

/** @type {Record<Uav["missing"][number], string>} */
const MISSING = { type: t("Type"), range: t("Range, battery, or unlimited range chosen for its type") };

/** A UAV in service that lacks something is not planned. @param {Pick<Uav, "state" | "missing">} uav */
const isIncomplete = ({ state, missing }) => state === "active" && missing.length > 0;

/** @param {Pick<Uav, "state" | "missing">} uav */
export function stateChip(uav) {
  const { words, icon: image } = isIncomplete(uav)
    ? { words: t("Incomplete"), icon: "circle-alert" }
    : STATES[uav.state];
  return h("span", { class: `chip ${isIncomplete(uav) ? "incomplete" : uav.state}` }, icon(image, "small"), words);
}

/** What an incomplete UAV needs before it can be planned, as a checklist; null where it is complete. @param {Uav} uav */
export function missingList(uav) {
  if (!isIncomplete(uav)) return null;
  return h(
    "div",
    { class: "notice warning" },
    icon("circle-alert"),
    h(
      "div",
      {},
      h("p", {}, t("It cannot be planned, approved or started before this is stated:")),
      h(
        "ul",
        { class: "checklist" },
        Object.entries(MISSING).map(([name, words]) => {
          const isMissing = uav.missing.some((one) => one === name);
          return h("li", {}, icon(isMissing ? "circle" : "check", "small"), words, !isMissing && ` (${t("stated")})`);
        }),
      ),
    ),
  );
}

/** @param {string} end */
export function endWords(end) {
  return ENDS.find(([value]) => value === end)?.[1] ?? end;
}

/** "now", "today, 11:40": when the UAV was last known to be where it is. @param {Pick<Uav, "located_at">} uav */
export function ageText(uav) {
  return uav.located_at ? whenText(uav.located_at) : t("age not known");
}

/** @param {number | null} range_m @param {boolean} [isUnlimited] */
export const rangeText = (range_m, isUnlimited = false) => {
  if (range_m !== null) return lengthText(range_m);
  return isUnlimited ? t("unlimited") : t("not stated");
};

/** @param {Pick<Uav, "from_type">} uav @param {string} field @param {string} words */
export function fromType(uav, field, words) {
  return uav.from_type.includes(field) ? t("{figure}, as its type", { figure: words }) : words;
}

/** @param {number | null} percent */
export function batteryMark(percent) {
  if (percent === null) return h("span", { class: "quiet-text" }, "—");
  const bar = h("b", {});
  bar.style.width = `${percent}%`;
  return h(
    "span",
    { class: `battery${percent < LOW_PERCENT ? " low" : ""}` },
    h("i", { "aria-hidden": "true" }, bar),
    percentText(percent),
  );
}

/** @param {number | null} battery_wh */
export const wattHours = (battery_wh) =>
  battery_wh === null ? "—" : `${numberText(battery_wh, Number.isInteger(battery_wh) ? 0 : 1)}\u00a0Wh`;
/** @param {number | null} mass_kg */
export const kilograms = (mass_kg) =>
  mass_kg === null ? "—" : `${numberText(mass_kg, Number.isInteger(mass_kg) ? 0 : 1)}\u00a0kg`;
/** @param {number | null} area_m2 */
export const squareMetres = (area_m2) => (area_m2 === null ? t("not stated") : `${numberText(area_m2, 3)}\u00a0m²`);
/** @param {number} count */
export const uavsText = (count) => tn(count, "{count} UAV", "{count} UAVs");

/** A row of the API; a UAV as one object. @param {RowAnswer} answer */
export const readRow = (answer) =>
  answer && "properties" in answer ? flat(answer) : /** @type {FleetType | FleetBase} */ (answer);

/** A UAV of the API as one object. @param {UavFeature} feature */
export function flat({ id, geometry, properties }) {
  const position = /** @type {Position} */ (geometry.coordinates.slice(0, 2));
  return /** @type {Uav} */ ({ id, position, ...properties });
}
