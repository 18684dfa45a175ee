/** The head of the page: the mission, its state, present facts; and a notice when updates stop. */

import { signInAddress } from "../../api.js";
import { byId, h, icon, setChildren } from "../../dom.js";
import { MISSION_STATES } from "../../domain/planned_state.js";
import { ASKED, CROWDED, LIVE } from "../../live/feed.js";
import { staleWords } from "../../live/stale.js";
import { announce } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import { exactClockText, zoneText } from "../../units.js";

/** @import { LiveMission, LiveUav, MissionState } from "../../api_types.d.ts" */
/** @import { MonitorPage, MonitorState, MonitorStore } from "../types.d.ts" */

/** @type {Partial<Record<MissionState, string>>} */
const IMAGES = {
  approved: "badge-check",
  dispatched: "send",
  active: "radio",
  completed: "check",
  aborted: "octagon-alert",
  failed: "circle-x",
};

/** @param {LiveUav[]} uavs @param {LiveMission[]} missions @param {LiveMission | null} mission the page's only one */
function countWords(uavs, missions, mission) {
  if (mission) return t("{done} of {all} complete", { done: mission.counts.complete, all: mission.counts.all });
  return [
    tn(uavs.length, "{count} UAV", "{count} UAVs"),
    tn(missions.length, "{count} mission", "{count} missions"),
  ].join(", ");
}

/** @param {string} name */
function drawTitle(name) {
  if (byId("page-title").textContent === name) return;
  byId("page-title").textContent = name;
  byId("bar-title").textContent = name;
  document.title = `${name} · Spanwise`;
}

/** @param {HTMLElement} chip @param {LiveMission | null} mission */
function drawState(chip, mission) {
  chip.hidden = !mission;
  if (!mission || chip.dataset.state === mission.state) return;
  const image = IMAGES[mission.state];
  chip.dataset.state = mission.state;
  chip.className = `chip ${mission.state}`;
  setChildren(chip, image && icon(image, "small"), MISSION_STATES[mission.state]);
}

/** @param {Readonly<MonitorState>} state */
function drawStale(state) {
  const stale = byId("stale");
  const summary = staleWords(state);
  const isWhole = state.link === LIVE || state.link === ASKED || state.link === CROWDED;
  document.documentElement.dataset.link = summary?.isBad ? "cut" : isWhole ? "whole" : "opening";
  if (stale.dataset.words === (summary?.words ?? "")) return;
  const wasHidden = stale.hidden;
  stale.dataset.words = summary?.words ?? "";
  stale.hidden = !summary;
  if (summary && wasHidden) announce(`${summary.words} ${summary.rest ?? ""}`); // once: the seconds that follow are for the eye
  if (!summary) return;
  const endpoint = summary.needsDoor && [" ", h("a", { href: signInAddress() }, t("Sign in"))];
  setChildren(
    stale,
    icon("cloud-off"),
    h("span", {}, h("strong", {}, summary.words), summary.rest && ` ${summary.rest}`, endpoint),
  );
}

/** @param {MonitorStore} store @param {MonitorPage} page */
export function mountHead(store, page) {
  const chip = byId("mission-state");
  store.listen(["missions", "uavs", "now_ms", "isWhole"], ({ missions, uavs, now_ms, isWhole }) => {
    const mission = missions.find(({ id }) => id === page.mission) ?? null;
    drawTitle(mission?.name ?? page.missionName ?? t("Live"));
    drawState(chip, mission);
    const iso = new Date(now_ms).toISOString(); // stops while the device receives no data
    const facts = byId("live-facts");
    const summary = [exactClockText(iso), isWhole && countWords(uavs, missions, mission)];
    facts.textContent = summary.filter(Boolean).join(" · ");
    facts.title = zoneText(iso);
  });
  store.listen(["link", "since_ms", "now_ms", "silent_ms"], drawStale);
}
