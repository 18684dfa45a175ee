/** Options of a flight: departure and conditions, charging, and lost-link action. Values in, values out. */

import { t } from "../../text.js";
import { clockText, compassText, dayText, heightText, sinceText, speedText, temperatureText } from "../../units.js";
import { lostLinkOf } from "./lost_link.js";

/** @import { Conditions, FlightOptions, LostLink } from "../types.d.ts" */

/** Any time, calm, no charging; without a link UAVs go on. @type {Readonly<FlightOptions>} */
export const UNSAID = Object.freeze({ departs_at: null, conditions: null, charging_w: null, lost_link: null });
export const MILD_C = 15; // ISA at sea level, the default
export const MAX_LAYERS = 10; // missions/serializers/limits.py

/** @param {Conditions["wind"][number]} layer */
const layerOf = ({ altitude_agl_m, speed_mps, from_deg }) => ({ altitude_agl_m, speed_mps, from_deg });

/**
 * One form for equal conditions: lowest layer first, and null for calm and mild.
 *
 * @param {Partial<Conditions> | null | undefined} conditions
 * @returns {Conditions | null}
 */
export function conditionsOf(conditions) {
  if (!conditions) return null;
  const temperature_c = conditions.temperature_c ?? MILD_C;
  const wind = (conditions.wind ?? []).map(layerOf).sort((a, b) => a.altitude_agl_m - b.altitude_agl_m);
  const blows = wind.some(({ speed_mps }) => speed_mps > 0);
  return blows || temperature_c !== MILD_C ? { wind: blows ? wind : [], temperature_c } : null;
}

/** The same moment written in one way. @param {string | null | undefined} departs_at */
export const momentOf = (departs_at) => (departs_at ? new Date(departs_at).toISOString() : null);

/**
 * The four of a stored mission or a draft.
 *
 * @param {{ departs_at?: string | null, conditions?: Partial<Conditions> | null, charging_w?: number | null, lost_link?: Partial<LostLink> | null }} stored
 * @returns {FlightOptions}
 */
export const flightOptionsOf = ({ departs_at, conditions, charging_w, lost_link }) => ({
  departs_at: momentOf(departs_at),
  conditions: conditionsOf(conditions),
  charging_w: charging_w ?? null,
  lost_link: lostLinkOf(lost_link),
});

/** The stated options in the form of the API. @param {FlightOptions} selection @returns {Partial<FlightOptions>} */
export function flightOptionsAsked(selection) {
  return Object.fromEntries(Object.entries(flightOptionsOf(selection)).filter(([, value]) => value !== null));
}

/**
 * "Calm, 15 °C", "8 m/s from the west at 100 m above ground, 5 °C".
 *
 * @param {Partial<Conditions> | null | undefined} conditions
 */
export function conditionsText(conditions) {
  const { wind, temperature_c } = conditionsOf(conditions) ?? { wind: [], temperature_c: MILD_C };
  const layers = wind.map(({ altitude_agl_m, speed_mps, from_deg }) =>
    t("{speed} from the {side} at {height}", {
      speed: speedText(speed_mps),
      side: compassText(from_deg),
      height: heightText(altitude_agl_m),
    }),
  );
  return [layers.length ? layers.join("; ") : t("Calm"), temperatureText(temperature_c)].join(", ");
}

/** "21 Nov, 19:30" by the reader's clock. @param {string} departs_at */
export const departureText = (departs_at) => `${dayText(departs_at)}, ${clockText(departs_at)}`;

/**
 * The time so many seconds after the departure: by the clock where there is one, else "+12:05".
 *
 * @param {string | null | undefined} departs_at
 * @param {number | null | undefined} after_s
 */
export function timeAt(departs_at, after_s) {
  if (after_s === null || after_s === undefined) return "—";
  if (!departs_at) return sinceText(after_s);
  const moment = new Date(Date.parse(departs_at) + after_s * 1000).toISOString();
  return dayText(moment) === dayText(departs_at) ? clockText(moment) : departureText(moment);
}

/** The next full minute: "now" as a departure. @param {number} now_ms */
export const nextMinute = (now_ms) => new Date(Math.ceil(now_ms / 60_000) * 60_000).toISOString();
