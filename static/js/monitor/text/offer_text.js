/** Texts of an offer of another plan: why, and the change for each UAV and target. Values in, text out. */

import { routeLetter } from "../../domain/palette.js";
import { FEED_LOST_MS } from "../../live/feed.js";
import { t, tn } from "../../text.js";
import { clockText, countdownText, lengthText, percentText } from "../../units.js";

/** @import { LiveOffer, OfferState } from "../../api_types.d.ts" */
/** @import { OfferCause, OfferDifference, OfferFigures } from "../types.d.ts" */

/** @type {Record<string, string>} */
const CAUSES = {
  "uav-out": t("A UAV has dropped out"),
  "zone-active": t("A no-fly zone has come into force"),
  "battery-short": t("Battery not sufficient"),
  "asked-for": t("Requested"),
};
/** @type {Record<string, string>} */
const CHANGES = {
  untouched: t("continues as approved"),
  changed: t("gets another route"),
  recalled: t("returns"),
  out: t("has dropped out"),
};

/** @type {Partial<Record<OfferState, string>>} */
const OUTCOMES = {
  accepted: t("Re-plan accepted."),
  declined: t("Re-plan declined: the approved plan continues."),
  outdated: t("Re-plan expired."),
  impossible: t("No re-plan possible."),
};

/** The changes of another plan; empty while it is computed. @param {Pick<LiveOffer, "difference">} offer */
export const differenceOf = ({ difference }) => /** @type {OfferDifference} */ (difference ?? {});

/** @param {Pick<LiveOffer, "cause">} offer */
const causeOf = ({ cause }) => /** @type {OfferCause} */ (cause ?? {});

const MAX_NAMED = 4;

/** "E402-2 stays open: plan a follow-up."; "" without known open targets. @param {readonly string[]} open labels of targets */
function openWords(open) {
  const more = open.length - MAX_NAMED;
  const named = open.slice(0, MAX_NAMED).join(", ");
  const names = more > 0 ? t("{names} and {count} more", { names: named, count: more }) : named;
  return open.length
    ? tn(open.length, "{names} stays open: plan a follow-up.", "{names} stay open: plan a follow-up.", { names })
    : "";
}

/**
 * Texts of a closed offer: { strong, rest }.
 *
 * @param {Pick<LiveOffer, "state" | "outcome" | "decided_by" | "decided_at">} offer
 * @param {readonly string[]} [open] labels of targets that no plan reaches
 */
export const overWords = ({ state, outcome, decided_by, decided_at }, open = []) => ({
  strong: OUTCOMES[state] ?? "",
  rest: decided_by
    ? t("Decided by {who}, {time}.", { who: decided_by, time: decided_at ? clockText(decided_at) : "" })
    : [outcome, state === "impossible" && openWords(open)].filter(Boolean).join(" "),
});

/** @param {Pick<LiveOffer, "state">} offer */
export const isUndecided = ({ state }) => state === "computing" || state === "open";
/**
 * The cause of an offer: for a zone its name, and between which targets it lies across whose route.
 *
 * @param {Pick<LiveOffer, "code" | "cause">} offer
 */
export function causeWords({ code, cause }) {
  const { leg, zone_name = "", uav_name = "" } = causeOf({ cause });
  return leg
    ? t("{zone} lies across the route of {uav}, {way}", {
        zone: zone_name,
        uav: uav_name,
        way: wayWords(leg),
      })
    : (CAUSES[code] ?? code);
}

/** @param {[string | null, string | null]} leg */
function wayWords([start, end]) {
  if (start && end) return t("{start} to {end}|way", { start, end });
  return start ? t("after {start}", { start }) : end ? t("start to {end}|way", { end }) : t("on its way");
}

/**
 * The sentence first: "2 UAVs get another route, 3 targets change hands, 1 stays undone."
 *
 * @param {Pick<LiveOffer, "difference">} offer
 */
export function sentenceOf(offer) {
  const { uavs = [], targets = [], unreached = 0 } = differenceOf(offer);
  const changed = uavs.filter(({ change }) => change === "changed").length;
  const handed = targets.filter(({ to }) => to !== null).length;
  return [
    changed > 0 && tn(changed, "{count} UAV gets another route", "{count} UAVs get another route"),
    handed > 0 && tn(handed, "{count} target is reassigned", "{count} targets are reassigned"),
    unreached > 0 && tn(unreached, "{count} target stays open", "{count} targets stay open"),
  ]
    .filter(Boolean)
    .join(", ");
}

/** @param {OfferFigures} figures */
const figureWords = (figures) =>
  [
    lengthText(figures.length_m),
    figures.ends_at && t("lands {time}", { time: clockText(figures.ends_at) }),
    typeof figures.battery_percent === "number" && t("with {figure}", { figure: percentText(figures.battery_percent) }),
  ]
    .filter(Boolean)
    .join(", ");

/**
 * Lines by UAV: [{ place, letter, name, what, before, after, why }]. The reason of a UAV that is out names it and suffices.
 *
 * @param {Pick<LiveOffer, "difference">} offer
 */
export const uavLines = (offer) =>
  (differenceOf(offer).uavs ?? []).map(({ place, name, change, before, after, why, gained, lost }) => {
    const saysAll = change === "out" && Boolean(why);
    const counts = [gained.length > 0 && `+${gained.length}`, lost.length > 0 && `−${lost.length}`];
    return {
      place,
      letter: routeLetter(place),
      name: saysAll ? why : name,
      what: [!saysAll && (CHANGES[change] ?? change), ...counts].filter(Boolean).join(" "),
      before: change === "changed" && before ? figureWords(before) : "",
      after: after ? figureWords(after) : "",
      why: saysAll ? "" : why,
    };
  });

/** Per target that is moved to another UAV or dropped: ["Tower 31: B → C", …] @param {Pick<LiveOffer, "difference">} offer */
export const targetLines = (offer) =>
  (differenceOf(offer).targets ?? []).map(
    ({ label, from, to, message }) =>
      `${label}: ${from === null ? "—" : routeLetter(from)} → ${to === null ? message || t("not reached") : routeLetter(to)}`,
  );

/** The time left to accept it. @param {string} until @param {number} now_ms */
export const validWords = (until, now_ms) =>
  t("Valid for {time}. Dashed on the map.", {
    time: countdownText(Date.parse(until) - now_ms),
  });

/**
 * Why an offer can no longer be decided, though the server has not reported it yet; "" where it can.
 *
 * @param {LiveOffer} offer
 * @param {{ now_ms: number, silent_ms: number }} times
 */
export function whyNotDecided(offer, { now_ms, silent_ms }) {
  const { valid_until } = differenceOf(offer);
  if (valid_until && Date.parse(valid_until) <= now_ms + (silent_ms >= FEED_LOST_MS ? silent_ms : 0))
    return t("Expired {time}.", { time: clockText(valid_until) });
  return silent_ms >= FEED_LOST_MS ? t("No data on this device: it may have expired.") : "";
}

/**
 * The offer whose routes are on the map: only while it can be decided, as long as its card counts down.
 *
 * @param {LiveOffer[]} offers
 * @param {{ now_ms: number, silent_ms: number }} times
 */
export const drawnOffer = (offers, times) =>
  offers.find((offer) => offer.state === "open" && whyNotDecided(offer, times) === "");
