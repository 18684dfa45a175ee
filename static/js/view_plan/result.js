/** What a plan of photos has to say: figures, coverage by kind of component, zones met, and the photos. */

import { focalText, gsdText } from "../cameras/words.js";
import { h, icon, term } from "../dom.js";
import { t, tn } from "../text.js";
import { durationText, exactHeightText, lengthText, numberText } from "../units.js";
import { assumedText, byKind, COMPONENTS, nothingText, restText, shareText } from "./words.js";

/** @import { ViewPlan } from "../api_types.d.ts" */

const DEGREE = "°";

/** @param {string} kind @param {string} words @param {import("../dom.js").Child} [more] */
const notice = (kind, words, more) =>
  h("div", { class: `notice ${kind}` }, icon("triangle-alert"), h("p", {}, h("strong", {}, words), " ", more));

/** @param {ViewPlan} plan */
function zonesNotice({ zones }) {
  const names = zones.flatMap(({ id, name }, place) => [
    place ? ", " : "",
    h("a", { href: `/zones?id=${id}`, translate: "no" }, name),
  ]);
  return notice("warning", t("Not allowed while these zones are in force:"), names);
}

/** @param {ViewPlan} plan */
const figures = ({
  pattern,
  photos,
  photos_bound: bound,
  duration_s,
  length_m,
  clearance_m,
  focal_length_mm: focal_mm,
}) =>
  h(
    "dl",
    { class: "facts" },
    term(
      t("Photos"),
      h(
        "span",
        { title: pattern ? "" : t("At least {count} are needed.", { count: numberText(bound) }) },
        numberText(photos.length),
      ),
    ),
    term(t("Duration"), durationText(duration_s)),
    term(t("Flight length"), lengthText(length_m)),
    term(t("Clearance kept"), exactHeightText(clearance_m)),
    term(t("Focal length used"), focalText([focal_mm])),
  );

/** Of an overview without what cannot be shown: that counts closer photos too. @param {ViewPlan} plan */
const coverageTable = ({ pattern, coverage }) =>
  h(
    "table",
    { class: "coverage" },
    h("caption", {}, t("Coverage")),
    h(
      "thead",
      {},
      h(
        "tr",
        {},
        h("th", { scope: "col" }, t("Component")),
        h("th", { scope: "col", class: "number", title: t("Of what a photo can show.") }, t("Shown")),
        h("th", { scope: "col", class: "number", title: t("95 % of what is shown is as fine or finer.") }, t("GSD")),
        pattern !== "overview" && h("th", { scope: "col" }, t("Cannot be shown")),
      ),
    ),
    h(
      "tbody",
      {},
      byKind(coverage.components).map((row) =>
        h(
          "tr",
          {},
          h("th", { scope: "row" }, COMPONENTS[row.kind] ?? row.kind),
          h("td", { class: "number" }, row.ofReachable === null ? "—" : shareText(row.ofReachable)),
          h("td", { class: "number" }, row.gsd_mm === null ? "—" : gsdText(row.gsd_mm)),
          pattern !== "overview" && h("td", {}, restText(row)),
        ),
      ),
    ),
  );

/** @param {ViewPlan} plan @param {(number: number | null) => void} choose */
function photosList({ photos }, choose) {
  /** @type {HTMLElement | null} */
  let chosen = null;
  const rows = photos.map(({ height_agl_m, height_m, yaw_deg, pitch_deg }, number) => {
    const row = h(
      "button",
      { type: "button", class: "photo-row", "aria-pressed": "false" },
      h("strong", {}, t("Photo {number}", { number: number + 1 })),
      h(
        "span",
        { class: "caption" },
        t("{height} AGL · yaw {yaw} · pitch {pitch}", {
          height: exactHeightText(height_agl_m ?? height_m),
          yaw: `${numberText((Math.round(yaw_deg) + 360) % 360)}${DEGREE}`,
          pitch: `${numberText(Math.round(pitch_deg))}${DEGREE}`,
        }),
      ),
    );
    row.addEventListener("click", () => {
      const isNew = chosen !== row;
      chosen?.setAttribute("aria-pressed", "false");
      row.setAttribute("aria-pressed", `${isNew}`);
      chosen = isNew ? row : null;
      choose(isNew ? number : null);
    });
    return h("li", {}, row);
  });
  return h(
    "details",
    { class: "photo-list" },
    h("summary", {}, tn(photos.length, "{count} photo", "{count} photos")),
    h("ol", {}, rows),
  );
}

/**
 * @param {ViewPlan} plan
 * @param {(number: number | null) => void} choose a photo, null: none
 */
export function resultOf(plan, choose) {
  const flat = t("No terrain data: the ground counts as level.");
  const model = h("p", { class: "caption" }, plan.has_terrain ? assumedText(plan) : `${assumedText(plan)} ${flat}`);
  if (!plan.photos.length)
    return [notice("advisory", t("Nothing can be shown."), nothingText(plan)), model, coverageTable(plan)];
  return [
    plan.zones.length > 0 && zonesNotice(plan),
    figures(plan),
    model,
    coverageTable(plan),
    photosList(plan, choose),
  ];
}
