/** A UAV as the live page shows it at a moment: where, how sure, how old. Values in, values out. */

import { t } from "../text.js";
import { lengthText } from "../units.js";

export const MEASURED = "measured";
export const ESTIMATED = "estimated";
export const LOST = "lost"; // past what the estimator vouches for, or nobody estimates it and it is silent
export const UNKNOWN = "unknown"; // never heard

const FRESH_S = 2.5; // a report so young is shown as it is
export const LATE_S = 12; // a UAV reports at least every ten seconds

const secondsSince = (iso, now_ms) => (iso ? Math.max(0, (now_ms - Date.parse(iso)) / 1000) : null);
const level = (value) => (value === null || value === undefined ? null : value);

/**
 * uav: of the feed. → { kind, position, heading_deg, age_s, isLate, height_m, speed_mps, battery_percent, isGuess, ring, reportAt,
 * reportPosition, contactAt, endsAt, next, toGo_m, along_m, mode, isInAir }. isGuess: its figures are estimates; ring: { along_m, across_m,
 * bearing_deg } or null; next: { target, at } or null.
 */
export function viewOf(uav, now_ms) {
  const { measured, estimated, link } = uav;
  const age_s = secondsSince(measured?.received_at ?? link?.heard_at, now_ms);
  const isFresh = age_s !== null && age_s <= FRESH_S;
  const guess = estimated && !estimated.is_measured && !(isFresh && measured?.position) ? estimated : null;
  const position = guess?.position ?? measured?.position ?? null;
  const isSilent = !guess && age_s !== null && age_s > LATE_S;
  const kind = !position ? UNKNOWN : guess ? (guess.is_lost ? LOST : ESTIMATED) : isSilent ? LOST : MEASURED;
  const next = (estimated?.arrivals ?? []).find(({ target, at }) => target !== null && Date.parse(at) > now_ms) ?? null;
  return {
    kind,
    position,
    heading_deg: level(guess?.heading_deg ?? measured?.heading_deg),
    age_s,
    isLate: age_s !== null && age_s > LATE_S,
    height_m: level(guess ? guess.altitude_relative_m : measured?.altitude_relative_m),
    speed_mps: level(guess ? guess.speed_mps : measured?.speed_mps),
    battery_percent: level(measured?.battery_percent),
    isGuess: Boolean(guess),
    ring: guess ? guess.bound : null,
    reportAt: measured?.measured_at ?? null,
    reportPosition: measured?.position ?? null,
    contactAt: guess?.contact_expected_at ?? null,
    endsAt: estimated?.ends_at ?? null,
    next,
    toGo_m: level(estimated?.to_go_m),
    along_m: level(estimated?.along_route_m),
    mode: measured?.mode || link?.mode || "",
    isInAir: measured?.is_in_air ?? link?.is_in_air ?? null,
  };
}

/** "0.7 s ago", "12 s ago", "no report for 74 s", "never heard". */
export function ageWords({ age_s, isLate }) {
  if (age_s === null) return t("never heard");
  const shown = age_s < 9.95 ? age_s.toFixed(1) : `${Math.round(age_s)}`;
  if (age_s >= 3_600) return t("no report for {count} h", { count: Math.floor(age_s / 3_600) });
  if (age_s >= 120) return t("no report for {count} min", { count: Math.floor(age_s / 60) });
  return isLate ? t("no report for {count} s", { count: shown }) : t("{count} s ago", { count: shown });
}

/** The one fact on the map beside the name. */
export function factWords(view) {
  if (view.kind === ESTIMATED) return t("estimated, ±{bound}", { bound: lengthText(boundOf(view)) });
  if (view.kind === LOST) return t("lost");
  return view.isInAir === false ? t("on the ground") : "";
}

/** The greater half-axis of where it is, 95 times of 100. */
export const boundOf = ({ ring }) => (ring ? Math.max(ring.along_m, ring.across_m) : 0);

const RANK = { critical: 0, warning: 1, advisory: 2 };

/** The chosen one, then by the level of its worst open alert, then by landing time, then by name. */
export function inOrder(uavs, { chosen, alerts, viewFor }) {
  const worst = new Map();
  for (const alert of alerts) {
    if (alert.closed_at || alert.uav === null || alert.acknowledged_at) continue;
    worst.set(alert.uav, Math.min(worst.get(alert.uav) ?? 3, RANK[alert.level]));
  }
  const key = (uav) => [uav.id === chosen ? 0 : 1, worst.get(uav.id) ?? 3, viewFor(uav).endsAt ? Date.parse(viewFor(uav).endsAt) : Infinity, uav.name];
  return [...uavs].sort((a, b) => {
    const [left, right] = [key(a), key(b)];
    const at = left.findIndex((value, index) => value !== right[index]);
    return at < 0 ? 0 : left[at] < right[at] ? -1 : 1;
  });
}
