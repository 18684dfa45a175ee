/** A list of findings: the worst first, each with its state and the way to its photo. */

import { ApiError, freshKey, get, post } from "../api.js";
import { h, icon, setChildren } from "../dom.js";
import { t, tn } from "../text.js";
import { dayText } from "../units.js";
import { FINDING_STATES, SEVERITIES } from "./words.js";

/** @import { Answer } from "../api.js" */
/** @import { InspectionFinding, InspectionFindingPage, Mission } from "../api_types.d.ts" */

const SHOWN = 50;
/** @type {Set<InspectionFinding["state"]>} */
const UNSETTLED = new Set(["open", "work_ordered", "done"]);

/**
 * Fill an element with findings, their files, and the way to look at them again.
 *
 * @param {HTMLElement} element
 * @param {string} query of the findings and of their photos
 * @param {{ canPlan: boolean }} reader
 */
export async function mountFindings(element, query, { canPlan }) {
  try {
    const { data } = /** @type {Answer<InspectionFindingPage>} */ (await get(`/findings?${query}&limit=${SHOWN}`));
    setChildren(
      element,
      data.results.length
        ? h(
            "ul",
            { class: "finding-list" },
            data.results.map((finding) => h("li", {}, findingRow(finding, query))),
          )
        : h("p", { class: "caption" }, t("No findings yet.")),
      data.next && h("p", { class: "caption" }, t("The first {count} are shown.", { count: SHOWN })),
      canPlan && lookAgain(data.results),
      data.results.length > 0 &&
        h(
          "p",
          { class: "finding-files caption" },
          t("Export:"),
          " ",
          exportLink("csv", "CSV", query),
          " ",
          exportLink("geojson", "GeoJSON", query),
        ),
    );
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    setChildren(element, h("p", { class: "caption" }, error.message));
  }
}

/**
 * A button that drafts a mission which takes the photos of then again, and what came of it; nothing where no finding is left to settle.
 *
 * @param {InspectionFinding[]} findings
 */
export function lookAgain(findings) {
  const wanted = findings.filter(({ state }) => UNSETTLED.has(state));
  if (!wanted.length) return null;
  const summary = h("p", { class: "caption", role: "status" });
  const key = freshKey(); // the same until it is answered, so that there is one draft
  const button = h(
    "button",
    { type: "button", class: "button", title: t("A mission with the same photos of what they are on"), onclick: ask },
    icon("rotate-ccw", "small"),
    tn(wanted.length, "Look again at {count} finding", "Look again at {count} findings"),
  );
  return h("div", { class: "finding-again" }, button, summary);

  async function ask() {
    button.disabled = true;
    summary.textContent = "";
    try {
      const body = { findings: wanted.map(({ id }) => id) };
      const { data } = /** @type {Answer<Mission>} */ (
        await post("/findings/look-again", body, { headers: { "Idempotency-Key": key } })
      );
      location.href = `/missions/${data.id}`;
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      summary.textContent = `${t("No mission was made.")} ${error.message}`;
      button.disabled = false;
    }
  }
}

/** @param {string} kind @param {string} words @param {string} query */
export const exportLink = (kind, words, query) =>
  h("a", { href: `/api/v1/findings.${kind}?${query}`, download: true }, words);

/** @param {InspectionFinding} finding @param {string} query */
function findingRow(finding, query) {
  const photo = finding.evidence[0]?.medium;
  const facts = [
    FINDING_STATES[finding.state],
    finding.asset_label,
    finding.due_on && finding.state === "open" && t("due {day}", { day: dayText(finding.due_on) }),
  ];
  return [
    severityMark(finding.severity),
    h(
      "span",
      {},
      photo
        ? h("a", { href: `/review?${query}&medium=${photo}` }, finding.category_name)
        : h("strong", {}, finding.category_name),
      h("small", {}, facts.filter(Boolean).join(" · ")),
      finding.note && h("small", {}, finding.note),
    ),
  ];
}

/** @param {number} severity */
export const severityMark = (severity) =>
  h(
    "span",
    { class: `severity severity-${severity}`, title: SEVERITIES[severity] },
    severity <= 2 && icon("triangle-alert", "small"),
    String(severity),
    h("span", { class: "unseen" }, SEVERITIES[severity]),
  );
