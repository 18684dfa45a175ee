/** What photos prove of a mission's towers and bridges: promised by the plan, rehearsed, achieved; by kind of component, with what is missing. */

import { get } from "../api.js";
import { gsdText } from "../cameras/words.js";
import { h, icon } from "../dom.js";
import { t, tn } from "../text.js";
import { exactHeightText, numberText } from "../units.js";
import { byKind, COMPONENTS, restText, shareText } from "./words.js";

/** @import { Answer } from "../api.js" */
/** @import { ComponentCoverage, Deviation, MissionCoverage, NotCounted, Shown, TargetCoverage } from "../api_types.d.ts" */

/** @typedef {Shown & { deviations?: Deviation[] }} Proof */
/** @typedef {{ words: string, title?: string, proof: Proof }} Column a proof, and what it is called */

const DEGREE = "°";
const MAX_NAMED = 5;

/** @type {Record<NotCounted["reason"], string>} */
const NOT_COUNTED = {
  failed: t("the camera reported a failure"),
  position: t("position unknown"),
  height: t("height unknown"),
  attitude: t("direction of the camera unknown"),
  tilted: t("camera tilted"),
  far: t("too far from the target"),
};

/**
 * Read what photos of a mission prove, page by page.
 *
 * @param {string} mission
 * @param {string} rehearsal whose photos count as rehearsed; "": the newest
 * @param {AbortSignal} [signal]
 */
export async function readCoverage(mission, rehearsal = "", signal) {
  /** @type {TargetCoverage[]} */
  const found = [];
  const query = rehearsal ? `?rehearsal=${rehearsal}` : "";
  for (let next = /** @type {string | null} */ (`/missions/${mission}/coverage${query}`); next; ) {
    const { data } = /** @type {Answer<MissionCoverage>} */ (await get(next, { signal }));
    found.push(...data.results);
    next = data.next;
  }
  return found;
}

/**
 * Of what the plan can show, by kind of component: what each proof shows, 0 to 1, and how fine.
 *
 * @param {Shown} promised
 * @param {readonly Proof[]} proofs
 */
export function proofsByKind(promised, proofs) {
  const kinds = proofs.map(({ coverage }) => new Map(byKind(coverage.components).map((row) => [row.kind, row])));
  return byKind(promised.coverage.components).map((row) => {
    const reachable_m2 = area_m2(promised.coverage.components, row.kind, ({ reachable }) => reachable);
    return {
      ...row,
      cells: proofs.map(({ coverage }, place) => ({
        share:
          reachable_m2 > 0
            ? Math.min(1, area_m2(coverage.components, row.kind, ({ shown }) => shown) / reachable_m2)
            : null,
        gsd_mm: kinds[place].get(row.kind)?.gsd_mm ?? null,
      })),
    };
  });
}

/** @param {readonly ComponentCoverage[]} rows @param {string} kind @param {(row: ComponentCoverage) => number} share */
const area_m2 = (rows, kind, share) =>
  rows.filter(({ component }) => component === kind).reduce((sum, row) => sum + row.area_m2 * share(row), 0);

/** Of what the plan can show of the whole target, 0 to 1. @param {Shown} promised @param {Proof} proof */
export const shownOf = (promised, proof) =>
  promised.coverage.reachable > 0 ? Math.min(1, proof.coverage.shown / promised.coverage.reachable) : 0;

/** @param {Shown} promised @param {readonly Column[]} columns */
export function proofTable(promised, columns) {
  const rows = proofsByKind(
    promised,
    columns.map(({ proof }) => proof),
  );
  return h(
    "table",
    { class: "coverage" },
    h("caption", { class: "unseen" }, t("Coverage")),
    h(
      "thead",
      {},
      h(
        "tr",
        {},
        h("th", { scope: "col" }, t("Component")),
        columns.map(({ words, title }) => h("th", { scope: "col", class: "number", title }, words)),
      ),
    ),
    h(
      "tbody",
      {},
      rows.map((row) =>
        h(
          "tr",
          {},
          h("th", { scope: "row" }, COMPONENTS[row.kind] ?? row.kind, h("small", {}, restText(row))),
          row.cells.map((cell) => proofCell(cell, row.cells[0].share)),
        ),
      ),
    ),
  );
}

const SHORT_SHARE = 0.02; // less than promised by more than this is marked

/** @param {{ share: number | null, gsd_mm: number | null }} cell @param {number | null} promised */
function proofCell({ share, gsd_mm }, promised) {
  const isShort = share !== null && promised !== null && share < promised - SHORT_SHARE;
  return h(
    "td",
    { class: isShort ? "number short" : "number" },
    share === null ? "—" : shareText(share),
    h("small", {}, gsd_mm === null ? "" : gsdText(gsd_mm)),
  );
}

/** What was not taken as planned, and what is not counted. @param {Proof} proof @param {string} notTaken */
export function proofFaults({ deviations = [], not_counted: notCounted }, notTaken) {
  const lines = [
    ...notCounted.map(({ reason, count }) =>
      tn(count, "{count} photo not counted: {reason}.", "{count} photos not counted: {reason}.", {
        reason: NOT_COUNTED[reason] ?? reason,
      }),
    ),
    ...[...deviations].sort(worstFirst).map((one) => deviationText(one, notTaken)),
  ];
  if (!lines.length) return null;
  const list = (/** @type {string[]} */ some) =>
    h(
      "ul",
      { class: "coverage-faults" },
      some.map((words) => h("li", {}, icon("triangle-alert", "small"), words)),
    );
  const more = lines.length - MAX_NAMED;
  return [
    list(lines.slice(0, MAX_NAMED)),
    more > 0 &&
      h(
        "details",
        { class: "coverage-more" },
        h("summary", {}, tn(more, "{count} more", "{count} more")),
        list(lines.slice(MAX_NAMED)),
      ),
  ];
}

/** @param {Deviation} a @param {Deviation} b */
const worstFirst = (a, b) => (b.off_deg ?? Infinity) - (a.off_deg ?? Infinity) || a.photo - b.photo;

/** @param {Deviation} one @param {string} notTaken */
const deviationText = ({ photo, off_m, off_deg, not_counted: reason }, notTaken) =>
  off_m === null || off_deg === null
    ? t("Photo {number}: {fault}.", { number: photo, fault: reason ? NOT_COUNTED[reason] : notTaken })
    : t("Photo {number}: {away} and {angle} off.", {
        number: photo,
        away: exactHeightText(off_m),
        angle: `${numberText(off_deg, off_deg < 10 ? 1 : 0)}${DEGREE}`,
      });

/** "Foundations (2 of 4), Number plate": components of which nothing is achieved. @param {TargetCoverage} target */
export function missingText({ missing, promised }) {
  const kinds = new Set(missing.map(({ component }) => component));
  return [...kinds]
    .map((kind) => {
      const [few, all] = [missing, promised?.coverage.components ?? []].map(
        (rows) => rows.filter(({ component }) => component === kind).length,
      );
      const component = COMPONENTS[kind] ?? kind;
      return few < all ? t("{component} ({count} of {all})", { component, count: few, all }) : component;
    })
    .join(", ");
}
