/** Differences from the last plan: the sentence, then each UAV, then the targets that moved to another UAV. */

import { h } from "../../../dom.js";
import { routeLetter, routeNumber } from "../../../domain/palette.js";
import { t, tn } from "../../../text.js";
import { durationText, lengthText } from "../../../units.js";
import { counterpart, endsBetween, moreOrLess, movesBetween, summaryOfPlan } from "../../plan/compare.js";

/** @import { ShortPlan, ShortRoute, ShownPlan } from "../../types.d.ts" */

/** @typedef {ReturnType<typeof movesBetween>} Moves */

const MAX_MOVES = 30;

/** @param {ShownPlan} plan @param {ShortPlan} last */
export function comparison(plan, last) {
  const now = summaryOfPlan(plan);
  const moves = movesBetween(last, now);
  return [
    h("p", { class: "why-sentence" }, sentenceOf(last, now, moves)),
    table(now, last),
    gone(now, last),
    moved(moves, now),
  ];
}

/** @param {ShortPlan} last @param {ShortPlan} now @param {Moves} moves */
function sentenceOf(last, now, moves) {
  const [time, length] = [now.duration_s - last.duration_s, now.total_length_m - last.total_length_m];
  const parts = [];
  if (Math.abs(time) >= 30)
    parts.push(
      time < 0 ? t("{time} sooner", { time: durationText(-time) }) : t("{time} later", { time: durationText(time) }),
    );
  if (Math.abs(length) >= 50)
    parts.push(
      length < 0
        ? t("{length} less in total", { length: lengthText(-length) })
        : t("{length} more in total", { length: lengthText(length) }),
    );
  const changes = moves.length
    ? tn(moves.length, "{count} target has changed.", "{count} targets have changed.")
    : t("Every target stays with its UAV.");
  return `${parts.length ? `${parts.join(", ")}.` : t("As long and as late as before.")} ${changes}`;
}

/** @param {ShortPlan} now @param {ShortPlan} last */
function table(now, last) {
  const heads = [t("UAV"), t("before"), t("now"), t("difference")];
  const rows = now.routes.map((route, sequence) => {
    const old = counterpart(route, last);
    /** @param {ShortRoute | null} of */
    const figures = (of) =>
      of && of.length_m > 0 ? `${lengthText(of.length_m)}, ${durationText(of.duration_s)}` : "—";
    const differences = [
      moreOrLess(route.length_m - (old?.length_m ?? 0), 50, lengthText),
      moreOrLess(route.duration_s - (old?.duration_s ?? 0), 30, durationText),
    ].filter((words) => words !== "=");
    differences.push(...endWords(endsBetween(old, route)));
    const difference = differences.join(", ") || t("the same");
    return h(
      "tr",
      {},
      h(
        "th",
        { scope: "row", class: `route-${routeNumber(sequence)}` },
        h("span", { class: "why-uav" }, h("span", { class: "letter" }, routeLetter(sequence)), route.uav),
      ),
      h("td", {}, figures(old)),
      h("td", {}, figures(route)),
      h("td", {}, difference),
    );
  });
  return h(
    "table",
    { class: "why-table" },
    h(
      "thead",
      {},
      h(
        "tr",
        {},
        heads.map((words) => h("th", { scope: "col" }, words)),
      ),
    ),
    h("tbody", {}, rows),
  );
}

const END_WORDS = {
  hover: t("hovering at its last target"),
  return: t("at its start"),
  land: t("on the ground at its last target"),
  base: t("at the nearest base"),
};

/**
 * "starts 1.2 km from before", "ends at its start instead of hovering at its last target".
 *
 * @param {ReturnType<typeof endsBetween>} ends
 */
function endWords({ moved_m, from, to }) {
  /** @param {Pick<ShortRoute, "end_action" | "base">} end */
  const place = ({ end_action, base }) => base ?? (end_action ? END_WORDS[end_action] : "");
  return [
    ...(moved_m > 0 ? [t("starts {distance} from before", { distance: lengthText(moved_m) })] : []),
    ...(from && to ? [t("ends {now} instead of {before}", { now: place(to), before: place(from) })] : []),
  ];
}

/** @param {ShortPlan} now @param {ShortPlan} last */
function gone(now, last) {
  const names = last.routes.filter((route) => route.length_m > 0 && !counterpart(route, now)).map(({ uav }) => uav);
  return names.length ? h("p", {}, t("No longer in the mission: {names}.", { names: names.join(", ") })) : null;
}

/** @param {Moves} moves @param {ShortPlan} now */
function moved(moves, now) {
  if (!moves.length) return null;
  /** @param {ShortRoute | null | undefined} route */
  const place = (route) => {
    if (route === undefined) return t("not in the mission");
    if (route === null) return t("not reached");
    const sequence = now.routes.findIndex(
      (other) => other === route || (other.uav === route.uav && other.uav_id === route.uav_id),
    );
    return sequence < 0 ? route.uav : `${routeLetter(sequence)} ${route.uav}`;
  };
  const rest = moves.length - MAX_MOVES;
  return h(
    "ul",
    { class: "why-moves", "aria-label": t("Targets that have changed") },
    moves
      .slice(0, MAX_MOVES)
      .map(({ label, from, to }) => h("li", {}, h("span", {}, label), h("small", {}, `${place(from)} → ${place(to)}`))),
    rest > 0 && h("li", {}, tn(rest, "and {count} more", "and {count} more")),
  );
}
