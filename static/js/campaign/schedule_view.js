/** The days of a campaign: who drives when to which site, and what is flown there. */

import { h, icon } from "../dom.js";
import { MISSION_STATES } from "../domain/planned_state.js";
import { t, tn } from "../text.js";
import { coordinateText, durationText, lengthText } from "../units.js";

/** @import { Campaign, CampaignDay, CampaignMission, CampaignSchedule } from "../api_types.d.ts" */

/**
 * @typedef {object} DayActs
 * @property {(number: number | null) => void} point at a mission by its number
 * @property {(number: number) => void} show a mission on the map
 * @property {((site: number) => void) | null} move a launch site by its place; null: the user cannot
 * @property {() => number} reach_m greatest distance of a target from its launch site
 */

const DAY_BEGINS_H = 8;
const COLOURS = 8; // of routes

/** The number of the colour of a day, from 1; 0 for none. @param {number} day from 1; 0: none */
export const colourOfDay = (day) => (day === 0 ? 0 : ((day - 1) % COLOURS) + 1);

/** "08:40": clock of a working day that begins at 8. @param {number} seconds */
export function dayClock(seconds) {
  const minutes = Math.round(seconds / 60) + DAY_BEGINS_H * 60;
  return `${String(Math.floor(minutes / 60) % 24).padStart(2, "0")}:${String(minutes % 60).padStart(2, "0")}`;
}

/** "3 days · 12 launch sites · 31 flights · 214 km" @param {CampaignSchedule} schedule */
export function factsOf(schedule) {
  const days = Math.max(0, ...schedule.days.map(({ day }) => day));
  const used = new Set(schedule.missions.map(({ site }) => site));
  /** @param {keyof CampaignMission} figure */
  const total = (figure) => schedule.missions.reduce((sum, mission) => sum + Number(mission[figure]), 0);
  return [
    tn(days, "{count} day", "{count} days"),
    tn(used.size, "{count} launch site", "{count} launch sites"),
    tn(total("flights"), "{count} flight", "{count} flights"),
    lengthText(total("length_m")),
  ].join(" · ");
}

/** @param {CampaignSchedule} schedule @param {number} site its place */
export const siteName = ({ sites }, site) => sites[site].name || t("Launch site {number}", { number: site + 1 });

/**
 * @param {CampaignSchedule} schedule
 * @param {DayActs} acts
 */
export function dayCards(schedule, acts) {
  const crews = Math.max(1, ...schedule.days.map(({ crew }) => crew));
  return schedule.days.map((day) => dayCard(schedule, day, acts, crews > 1));
}

/** @param {CampaignSchedule} schedule @param {CampaignDay} day @param {DayActs} acts @param {boolean} hasCrews */
function dayCard(schedule, day, acts, hasCrews) {
  const title = hasCrews
    ? t("Day {day} · crew {crew}", { day: day.day, crew: day.crew })
    : t("Day {day}", { day: day.day });
  const drive_m = day.visits.reduce((sum, { drive_m: own }) => sum + own, day.back_m);
  return h(
    "section",
    { class: `campaign-day route-${colourOfDay(day.day)}`, "aria-label": title },
    h(
      "header",
      {},
      h("h2", {}, h("i", { class: "day-mark", "aria-hidden": "true" }), title),
      h(
        "span",
        { class: "caption" },
        `${dayClock(0)}–${dayClock(day.ends_s)} · ${lengthText(drive_m)} ${t("by road")}`,
      ),
    ),
    h(
      "ol",
      {},
      day.visits.map((visit) => {
        const mission = schedule.missions[visit.mission - 1];
        return [
          driveLine(visit.arrives_s - visit.drive_s, visit.drive_m, visit.drive_s),
          missionLine(schedule, mission, acts, `${dayClock(visit.arrives_s)}–${dayClock(visit.leaves_s)}`),
        ];
      }),
      driveLine(day.ends_s - day.back_s, day.back_m, day.back_s, t("Drive back")),
    ),
  );
}

/** @param {number} at_s @param {number} drive_m @param {number} drive_s */
const driveLine = (at_s, drive_m, drive_s, words = t("Drive")) =>
  h(
    "li",
    { class: "campaign-drive" },
    h("time", {}, dayClock(at_s)),
    h("span", {}, `${words} ${lengthText(drive_m)}, ${durationText(drive_s)}`),
  );

/** @param {CampaignSchedule} schedule @param {CampaignMission} mission @param {DayActs} acts @param {string} times */
function missionLine(schedule, mission, acts, times) {
  const { number, state } = mission;
  const name = siteName(schedule, mission.site);
  const figures = [
    tn(mission.targets, "{count} target", "{count} targets"),
    tn(mission.flights, "{count} flight", "{count} flights"),
    lengthText(mission.length_m),
    t("{duration} in the field", { duration: durationText(mission.work_s) }),
  ].join(" · ");
  return h(
    "li",
    {
      class: "campaign-visit",
      onpointerenter: () => acts.point(number),
      onpointerleave: () => acts.point(null),
    },
    times && h("time", {}, times),
    h(
      "div",
      { class: "what" },
      h(
        "div",
        { class: "name" },
        h("span", { class: "letter" }, String(number)),
        state === null
          ? h("strong", {}, name)
          : h(
              "a",
              {
                href: `/missions/${mission.mission}`,
                onfocus: () => acts.point(number),
                onblur: () => acts.point(null),
              },
              name,
            ),
        state !== "planned" &&
          h("span", { class: `chip ${state ?? "draft"}` }, state === null ? t("Deleted") : MISSION_STATES[state]),
      ),
      h("small", {}, figures),
      noteOf(mission, acts.reach_m()),
    ),
    acts.move && iconButton("move-3d", t("Move {name}", { name }), () => acts.move?.(mission.site)),
    iconButton("map-pin", t("Show {name} on the map", { name }), () => acts.show(number)),
  );
}

/** That routes lead beyond the reach, and that the plan warns. @param {CampaignMission} mission @param {number} reach_m */
function noteOf({ farthest_m, warnings }, reach_m) {
  const notes = [
    farthest_m > reach_m && t("Routes lead up to {distance} from the site.", { distance: lengthText(farthest_m) }),
    warnings > 0 && tn(warnings, "{count} warning in its plan.", "{count} warnings in its plan."),
  ].filter(Boolean);
  return notes.length > 0 && h("small", { class: "note" }, icon("triangle-alert", "small"), notes.join(" "));
}

/** @param {string} image @param {string} label @param {() => void} act */
const iconButton = (image, label, act) =>
  h(
    "button",
    { type: "button", class: "icon-button tight", "aria-label": label, title: label, onclick: act },
    icon(image, "small"),
  );

/** Missions that no working day holds. @param {CampaignSchedule} schedule @param {DayActs} acts */
export function tooLongCard(schedule, acts) {
  const missions = schedule.missions.filter(({ is_too_long }) => is_too_long);
  if (missions.length === 0) return null;
  return h(
    "section",
    { class: "campaign-day too-long" },
    h("header", {}, h("h2", {}, t("Longer than a working day"))),
    h("p", { class: "caption" }, t("With the drive there and back. Allow a longer day, more UAVs, or a nearer start.")),
    h(
      "ol",
      {},
      missions.map((mission) => missionLine(schedule, mission, acts, "")),
    ),
  );
}

/** Launch sites that were stated and are not used: inside zones, or set by the user where others are nearer. @param {Campaign} campaign */
export function unusedSitesCard({ schedule, rules }) {
  if (!schedule) return null;
  const { blocked_sites: blocked, sites } = schedule;
  /** @param {CampaignSchedule["sites"]} among @param {number[]} place */
  const has = (among, place) => among.some(({ position }) => position[0] === place[0] && position[1] === place[1]);
  const idle = (rules.sites ?? []).filter(
    ({ is_required, position }) => is_required && !has(sites, position) && !has(blocked, position),
  );
  const lines = [
    blocked.length > 0 &&
      tn(
        blocked.length,
        "{count} launch site is not used: it lies in a no-fly zone, or too near to one.",
        "{count} launch sites are not used: they lie in a no-fly zone, or too near to one.",
      ),
    idle.length > 0 &&
      tn(
        idle.length,
        "{count} launch site is not used: other sites are nearer to the targets in its reach.",
        "{count} launch sites are not used: other sites are nearer to the targets in their reach.",
      ),
  ].filter(Boolean);
  if (lines.length === 0) return null;
  const names = [...blocked, ...idle].map(({ name, position }) => name || coordinateText(position)).join("; ");
  return h("div", { class: "notice warning" }, icon("triangle-alert"), h("p", {}, lines.join(" "), ` ${names}`));
}

/** Targets that no mission visits, by cause. @param {Campaign} campaign */
export function unassignedCard({ schedule, target_count }) {
  const items = schedule?.unassigned ?? [];
  if (items.length === 0) return null;
  /** @type {Map<string, number>} */
  const causes = new Map();
  for (const { message } of items) causes.set(message, (causes.get(message) ?? 0) + 1);
  const missed = t("{missed} of {all} targets are in no mission.", { missed: items.length, all: target_count });
  return h(
    "div",
    { class: "notice warning" },
    icon("triangle-alert"),
    h(
      "div",
      {},
      h("p", {}, h("strong", {}, missed)),
      h(
        "ul",
        { class: "causes" },
        [...causes].map(([message, count]) => h("li", {}, count > 1 ? `${message} (${count})` : message)),
      ),
    ),
  );
}
