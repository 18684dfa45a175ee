/** The head of the page: which mission, its state, the facts of now; and what is said when nothing comes in any more. */

import { signInAddress } from "../../api.js";
import { byId, h, icon } from "../../dom.js";
import { ASKED, LIVE } from "../../live/feed.js";
import { staleWords } from "../../live/stale.js";
import { t, tn } from "../../text.js";
import { exactClockText, speedText, zoneText } from "../../units.js";

const STATES = {
  draft: t("Draft"),
  planned: t("Planned"),
  approved: t("Approved"),
  dispatched: t("Dispatched"),
  active: t("Active"),
  completed: t("Completed"),
  aborted: t("Aborted"),
  failed: t("Failed"),
};
const IMAGES = {
  approved: "badge-check",
  dispatched: "send",
  active: "radio",
  completed: "check",
  aborted: "octagon-alert",
  failed: "circle-x",
};
const LEAST_WIND_MPS = 0.5; // below, it comes from nowhere

/** Wind as the newest report has it: "wind 5 m/s from 240°", or "". */
export function windWords(uavs) {
  const told = uavs.map(({ measured }) => measured).filter((measured) => typeof measured?.wind_speed_mps === "number");
  const [newest] = told.sort((a, b) => Date.parse(b.measured_at) - Date.parse(a.measured_at));
  if (!newest) return "";
  const from =
    typeof newest.wind_from_deg === "number" && newest.wind_speed_mps >= LEAST_WIND_MPS
      ? t("from {degrees}°", { degrees: Math.round(newest.wind_from_deg) })
      : "";
  return `${t("wind {speed}", { speed: speedText(newest.wind_speed_mps) })} ${from}`.trim();
}

export function mountHead(store, page) {
  const chip = byId("mission-state");
  const stale = byId("stale");
  store.listen(["missions", "uavs", "now_ms"], ({ missions, uavs, now_ms }) => {
    const mission = page.mission ? missions.find(({ id }) => id === page.mission) : null;
    const name = mission?.name ?? page.missionName ?? t("Live");
    if (byId("page-title").textContent !== name) {
      byId("page-title").textContent = name;
      byId("bar-title").textContent = name;
      document.title = `${name} · Spanwise`;
    }
    chip.hidden = !mission;
    if (mission && chip.dataset.state !== mission.state) {
      chip.dataset.state = mission.state;
      chip.className = `chip ${mission.state}`;
      chip.replaceChildren(
        ...(IMAGES[mission.state] ? [icon(IMAGES[mission.state], "small")] : []),
        STATES[mission.state],
      );
    }
    const counts = mission
      ? t("{done} of {all} complete", { done: mission.counts.complete, all: mission.counts.all })
      : [
          tn(uavs.length, "{count} UAV", "{count} UAVs"),
          tn(missions.length, "{count} mission", "{count} missions"),
        ].join(", ");
    const iso = new Date(now_ms).toISOString();
    const facts = byId("live-facts");
    facts.textContent = [exactClockText(iso), windWords(uavs), counts].filter(Boolean).join(" · ");
    facts.title = zoneText(iso);
  });
  store.listen(["link", "since_ms", "now_ms"], (state) => {
    const said = staleWords(state);
    document.documentElement.dataset.link = said
      ? "cut"
      : state.link === LIVE || state.link === ASKED
        ? "whole"
        : "opening";
    if (stale.dataset.words === (said?.words ?? "")) return;
    stale.dataset.words = said?.words ?? "";
    stale.hidden = !said;
    if (said)
      stale.replaceChildren(
        icon("cloud-off"),
        h(
          "span",
          {},
          h("strong", {}, said.words),
          said.rest && ` ${said.rest}`,
          said.needsDoor && [" ", h("a", { href: signInAddress() }, t("Sign in"))],
        ),
      );
  });
}
