/** Which parts of a line or railway were inspected and when: a strip from its one end to the other, and the way to plan the rest. */

import { ApiError, freshKey, get } from "../api.js";
import { h, icon, term } from "../dom.js";
import { AGES, ageOf, tintOf } from "../domain/inspection_age.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { dateText, lengthText, numberText, percentText } from "../units.js";

/** @import { Answer } from "../api.js" */
/** @import { AssetDetailFeature, InspectedPart, InspectedParts, LinePartsOutput, TargetInputRequest } from "../api_types.d.ts" */

const MAX_LISTED = 12;

/** @param {InspectedPart} part */
const kmText = ({ from_m: from, to_m: to }) =>
  `km ${[from, to].map((metres) => numberText(metres / 1000, 1)).join("–")}`;
/** @param {InspectedPart} part */
const colourOf = ({ inspected_at: at }) => {
  if (!at) return null;
  const key = ageOf(Date.parse(at) / 1000);
  return tintOf(AGES.find((age) => age.key === key)?.accent ?? 0);
};

/**
 * Parts beside each other that one mission has inspected, as one part with its newest time.
 *
 * @param {InspectedPart[]} parts
 */
export function partsByMission(parts) {
  /** @type {InspectedPart[]} */
  const joined = [];
  for (const part of parts) {
    const last = joined[joined.length - 1];
    if (!last || last.to_m !== part.from_m || last.mission?.id !== part.mission?.id) joined.push({ ...part });
    else {
      last.to_m = part.to_m;
      last.inspected_at = [last.inspected_at, part.inspected_at].sort()[1];
    }
  }
  return joined;
}

/**
 * The strip, the share, the parts with their missions.
 *
 * @param {AssetDetailFeature} feature
 * @param {{ planRest: ((targets: TargetInputRequest[], key: string) => Promise<void>) | null }} act null: the reader may not plan
 * @returns {Promise<Node[]>}
 */
export async function inspectedPartsOf({ id }, { planRest }) {
  const { data } = /** @type {Answer<InspectedParts>} */ (await get(`/assets/${id}/inspected-parts`));
  const { parts, length_m: length, inspected_m: inspected } = data;
  const done = parts.filter((part) => part.inspected_at);
  const never = parts.filter((part) => !part.inspected_at && part.can_be_target);
  if (!done.length) return [h("p", { class: "caption" }, t("No part of it was inspected yet."))];
  const rows = partsByMission(done);
  const newest = done.map((part) => part.inspected_at ?? "").sort();
  const words = t("{done} of {all}, {share}", {
    done: lengthText(inspected),
    all: lengthText(length),
    share: percentText(Math.floor((inspected / length) * 100)),
  });
  return [
    strip(parts, length, words),
    h(
      "dl",
      { class: "facts" },
      term(t("Inspected"), words),
      term(t("Oldest inspection"), dateText(newest[0])),
      term(t("Last inspection"), dateText(newest[newest.length - 1])),
    ),
    h("ol", { class: "asset-missions" }, rows.slice(0, MAX_LISTED).map(partRow)),
    rows.length > MAX_LISTED &&
      h("p", { class: "caption" }, tn(rows.length - MAX_LISTED, "{count} more part", "{count} more parts")),
    planRest && never.length > 0 && restButton(id, never, planRest),
  ].filter((part) => part instanceof Node);
}

/** @param {InspectedPart[]} parts @param {number} length_m @param {string} words */
const strip = (parts, length_m, words) =>
  h(
    "div",
    { class: "inspected-strip", role: "img", "aria-label": t("Inspected: {words}", { words }) },
    parts.map((part) => {
      const colour = colourOf(part);
      return h("span", {
        style: `flex-grow: ${(part.to_m - part.from_m) / length_m}${colour ? `; background: ${colour}` : ""}`,
        title: `${kmText(part)}: ${part.inspected_at ? dateText(part.inspected_at) : t("never")}`,
      });
    }),
  );

/** @param {InspectedPart} part */
const partRow = (part) =>
  h(
    "li",
    {},
    part.mission && h("a", { href: `/missions/${part.mission.id}/report`, translate: "no" }, part.mission.name),
    h("span", { class: "caption" }, `${kmText(part)} · ${dateText(part.inspected_at ?? "")}`),
  );

/**
 * @param {number} line
 * @param {InspectedPart[]} never
 * @param {(targets: TargetInputRequest[], key: string) => Promise<void>} planRest
 */
function restButton(line, never, planRest) {
  const key = freshKey();
  const length_m = never.reduce((sum, part) => sum + part.to_m - part.from_m, 0);
  const words = t("Plan the {length} not inspected yet", { length: lengthText(length_m) });
  const button = h("button", { type: "button", class: "button" }, icon("list-plus", "small"), words);
  button.addEventListener("click", async () => {
    button.disabled = true;
    try {
      /** @type {TargetInputRequest[]} */
      const targets = [];
      for (const { stretch } of never) {
        const path = `/assets/${line}/parts?ends=${stretch.flat().join()}`;
        const { data } = /** @type {Answer<LinePartsOutput>} */ (await get(path));
        for (const part of data.parts)
          targets.push({ asset: line, stretch: /** @type {[number, number][]} */ (part.stretch) });
      }
      await planRest(targets, key);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      toast(error.message);
    } finally {
      button.disabled = false;
    }
  });
  return button;
}
