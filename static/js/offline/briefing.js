/** What a pilot without a network needs of an approved mission: UAVs with start and route, rally points, fences, contacts. */

import { ApiError, get } from "../api.js";
import { h } from "../dom.js";
import { rallyName, routeLetter, routeNumber } from "../domain/palette.js";
import { t, tn } from "../text.js";
import { coordinateText, durationText, exactText, lengthText } from "../units.js";

/** @import { Answer } from "../api.js" */
/** @import { Mission } from "../api_types.d.ts" */

/** A fence or a zone of the approval, as its document has it. @typedef {{ name: string }} ApprovedZone */
/** @typedef {{ uav: string | null, place: number, flights: { items: { fence?: (number | null)[][] } | null }[] }} ApprovedRoute */
/** @typedef {{ document: { zones: ApprovedZone[], routes: ApprovedRoute[] } }} Approval */

const SCALE = 1e7; // MAVLink's integers of latitude and longitude
const [LONGITUDE, LATITUDE, CORNERS] = [6, 7, 2]; // of an item: [command, frame, p1, …, longitude_e7, latitude_e7, …]

/**
 * Rings of the uploaded fences, lon lat, closed; each once.
 *
 * @param {Approval | null} approval
 * @returns {number[][][]}
 */
export function fencesOf(approval) {
  /** @type {Map<string, number[][]>} */
  const rings = new Map();
  for (const { flights } of approval?.document.routes ?? []) {
    for (const { items } of flights) {
      const corners = (items?.fence ?? []).map((item) => item.map(Number));
      for (let start = 0; start < corners.length; start += Math.max(1, corners[start][CORNERS])) {
        const part = corners.slice(start, start + Math.max(1, corners[start][CORNERS]));
        const ring = part.map((item) => [item[LONGITUDE] / SCALE, item[LATITUDE] / SCALE]);
        if (ring.length > 2) rings.set(JSON.stringify(ring), [...ring, ring[0]]);
      }
    }
  }
  return [...rings.values()];
}

/** Where a UAV may come down by itself: rally points, unless UAVs fly on without a link. @param {Mission} mission */
export const rallyPointsOf = ({ lost_link }) => (lost_link.behaviour === "go_on" ? [] : lost_link.rally_points);

/** @type {Record<string, string>} */
const WITHOUT_LINK = {
  go_on: t("Without a link each UAV flies its route to the end."),
  hold: t("Without a link each UAV holds, then flies to the nearest of its start and the rally points."),
  return: t("Without a link each UAV flies to the nearest of its start and the rally points."),
};

/** @param {string} title @param {(Node | string)[]} rows @param {string} [none] */
function section(title, rows, none = "") {
  if (rows.length === 0 && !none) return null;
  const list = h(
    "ul",
    {},
    rows.map((row) => h("li", {}, row)),
  );
  return h("section", {}, h("h3", {}, title), rows.length ? list : h("p", { class: "caption" }, none));
}

/** @param {Mission} mission @param {(position: number[]) => void} show brings a place into view */
function uavRows({ uavs, plan, colours }, show) {
  return uavs.map(({ name, position }, place) => {
    const route = plan?.routes[place];
    const targets = route?.targets.length ?? 0;
    const facts = route
      ? [lengthText(route.length_m), durationText(route.duration_s), tn(targets, "{count} target", "{count} targets")]
      : [];
    return h(
      "div",
      { class: `briefing-uav route-${routeNumber(place, colours)}` },
      h("span", { class: "letter" }, routeLetter(place)),
      h("span", {}, h("strong", {}, name), h("small", {}, facts.join(" · "))),
      placeButton(t("Start and landing"), position, show),
    );
  });
}

/** @param {string} words @param {number[]} position @param {(position: number[]) => void} show */
const placeButton = (words, position, show) =>
  h(
    "button",
    { type: "button", class: "text-button", onclick: () => show(position) },
    `${words} ${coordinateText(position)}`,
  );

/** @param {Mission} mission */
function contactRows({ author, approval, attributes }) {
  const by = approval?.approved_by;
  return [
    author && t("Planned by {name}", { name: author }),
    by && t("Approved by {name}, {time}", { name: by, time: exactText(approval.approved_at) }),
    ...Object.entries(attributes).map(([name, value]) => `${name}: ${value}`),
  ].filter((row) => typeof row === "string");
}

/**
 * Reads a mission and its approval out of the copy: { mission, approval, element }.
 *
 * @param {string} id
 * @param {(position: number[]) => void} show brings a place into view
 * @throws {ApiError} if the mission was not kept
 */
export async function readBriefing(id, show) {
  const { data: mission } = /** @type {Answer<Mission>} */ (await get(`/missions/${id}`));
  const approval = await get(`/missions/${id}/approval`).then(
    ({ data }) => /** @type {Approval} */ (data),
    (error) => {
      if (!(error instanceof ApiError)) throw error;
      return null;
    },
  );
  return { mission, approval, element: briefing(mission, approval, show) };
}

/**
 * @param {Mission} mission
 * @param {Approval | null} approval null where it was not kept
 * @param {(position: number[]) => void} show
 */
function briefing(mission, approval, show) {
  const rally = rallyPointsOf(mission).map((position, place) =>
    placeButton(t("Rally point {name}", { name: rallyName(place) }), position, show),
  );
  const zones = approval?.document.zones.map(({ name }) => name) ?? [];
  const fences = fencesOf(approval).length;
  const fenced = fences ? tn(fences, "{count} area that UAVs keep out of", "{count} areas that UAVs keep out of") : "";
  return h(
    "section",
    { class: "briefing", id: "briefing", "aria-label": t("Approved mission") },
    section(t("UAVs"), uavRows(mission, show)),
    section(t("Rally points"), rally, t("No rally points. UAVs land at their starts.")),
    h("p", { class: "caption" }, WITHOUT_LINK[mission.lost_link.behaviour] ?? ""),
    section(t("Fence"), [fenced, ...zones].filter(Boolean), t("No zone is near the routes.")),
    section(t("Contacts"), contactRows(mission), t("No contacts are stored.")),
  );
}
