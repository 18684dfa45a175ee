/** The page of a campaign: its days, missions and launch sites, and planning it again with other rules. */

import { ApiError, freshKey, get, isAbort, post, remove } from "../api.js";
import { byId, h, icon, setChildren } from "../dom.js";
import { boxAround } from "../domain/geodesy.js";
import { mountGroundPage } from "../ground/ground_page.js";
import { followLive } from "../live/jobs.js";
import { loadMapLibrary } from "../map/maplibre.js";
import { menuOf, toggleMenu } from "../page/chrome.js";
import { confirmAct } from "../page/confirm.js";
import { announce, toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { percentText } from "../units.js";
import * as layer from "./campaign_layer.js";
import { openRules } from "./rules_form.js";
import { dayCards, factsOf, tooLongCard, unassignedCard, unusedSitesCard } from "./schedule_view.js";

/** @import { Answer } from "../api.js" */
/** @import { Campaign, CampaignRoutes, CampaignRulesRequest, CampaignSchedule, Job } from "../api_types.d.ts" */
/** @import { Box } from "../map/types.d.ts" */
/** @import { GroundPage } from "../ground/types.d.ts" */

/** @type {Campaign | null} */
let campaign = null;
/** @type {CampaignRoutes | null} */
let routes = null;
/** Of the last job, or of loading. @type {{ words: string, canRetry: boolean } | null} */
let problem = null;
/** @type {Job | null} */
let job = null;

/** What a click on the map sets: the launch site at this place of the schedule; null: a further one. @type {{ site: number | null } | null} */
let placing = null;

await loadMapLibrary();
const {
  page: groundPage,
  map,
  layout,
  open,
} = mountGroundPage({
  click(_thing, position) {
    if (placing) void place(position);
  },
});
const page = /** @type {GroundPage & { campaign: string }} */ (groundPage);
const address = `/campaigns/${page.campaign}`;

/** Read campaign and routes, and draw them. Rejects with ApiError. */
async function load() {
  const { data } = /** @type {Answer<Campaign>} */ (await get(address));
  campaign = data;
  routes = data.schedule ? /** @type {Answer<CampaignRoutes>} */ (await get(`${address}/routes`)).data : null;
  draw();
}

/** Load again what could not be loaded, or say why not. */
async function reload() {
  try {
    problem = null;
    await load();
    fit({ animate: false });
    await followPlanning();
  } catch (error) {
    tell(error);
  }
}

/** @param {unknown} error */
function tell(error) {
  if (!(error instanceof ApiError)) throw error;
  problem = { words: error.isAway ? t("The server cannot be reached.") : error.message, canRetry: true };
  job = null;
  draw();
}

/** Follow the job that plans the campaign while one does, and show what it has planned. */
async function followPlanning() {
  if (!campaign?.job) return;
  const { data } = /** @type {Answer<Job>} */ (await get(`/jobs/${campaign.job}`));
  if (data.state === "failed" && !campaign.schedule) problem = { words: data.error?.message ?? "", canRetry: false };
  if (!["queued", "running"].includes(data.state)) {
    draw();
    return;
  }
  const had = campaign.schedule;
  try {
    const { state } = await followLive(data.id, {
      onProgress(next) {
        job = next;
        drawJob();
      },
    });
    if (state === "cancelled") problem = { words: t("Planning was stopped. Nothing was stored."), canRetry: false };
  } catch (error) {
    if (isAbort(error)) return;
    if (!(error instanceof ApiError) || error.isAway) throw error;
    problem = { words: error.message, canRetry: false };
  } finally {
    job = null;
    drawJob();
  }
  await load();
  if (!had && campaign.schedule) fit({ animate: true });
  if (campaign.schedule && !problem) announce(factsOf(campaign.schedule));
}

/** @param {{ animate?: boolean }} [options] */
function fit(options) {
  const box = boxOf(() => true);
  if (box) map.fit(box, options);
  else map.fitAll(options);
}

/** Around routes and sites of the missions that are wanted. @param {(number: number) => boolean} isWanted @returns {Box | null} */
function boxOf(isWanted) {
  const schedule = campaign?.schedule;
  if (!schedule) return null;
  const sites = schedule.missions
    .filter(({ number }) => isWanted(number))
    .map(({ site }) => schedule.sites[site].position);
  const lines = (routes?.features ?? []).filter(({ properties }) => isWanted(properties.number));
  const places = [...sites, ...lines.flatMap(({ geometry }) => geometry.coordinates)];
  return places.length ? /** @type {Box} */ (boxAround(places)) : null;
}

/** @type {import("./schedule_view.js").DayActs} */
const acts = {
  point: (number) => layer.light(map.map, number),
  show(number) {
    const box = boxOf((other) => other === number);
    if (box) map.fit(box);
    if (layout.isPhone()) layout.foldSide();
  },
  move: page.canPlan ? startPlacing : null,
  reach_m: () => campaign?.rules.reach_m ?? Number.POSITIVE_INFINITY,
};

/** @param {number | null} site */
function startPlacing(site) {
  placing = { site };
  const banner = byId("map-banner");
  setChildren(
    banner,
    h("span", {}, t("Click on the map where the crew can launch.")),
    h("button", { type: "button", class: "text-button", onclick: stopPlacing }, t("Cancel")),
  );
  banner.hidden = false;
  map.map.getCanvas().style.cursor = "crosshair";
  if (layout.isPhone()) layout.foldSide();
}

function stopPlacing() {
  placing = null;
  byId("map-banner").hidden = true;
  map.map.getCanvas().style.cursor = "";
}

/** Plan again with the launch sites of the present schedule, one of them moved or added. @param {number[]} position */
async function place(position) {
  const site = placing?.site ?? null;
  stopPlacing();
  if (!campaign?.schedule) return;
  const sites = campaign.schedule.sites.map((one, index) =>
    index === site ? { name: "", position, is_required: true } : one,
  );
  if (site === null) sites.push({ name: "", position, is_required: true });
  try {
    await plan({ ...campaign.rules, sites });
  } catch (error) {
    toast(/** @type {Error} */ (error).message);
  }
}

/** @param {CampaignRulesRequest} rules @param {string} [key] of all tries */
async function plan(rules, key = freshKey()) {
  const headers = { "Idempotency-Key": key };
  const { data } = /** @type {Answer<Campaign>} */ (await post(`${address}/plan`, { rules }, { headers }));
  campaign = data;
  problem = null;
  draw();
  followPlanning().catch(tell);
}

function draw() {
  if (!campaign) {
    setChildren(byId("campaign-days"), problemNotice());
    return;
  }
  const { name, schedule, target_count } = campaign;
  document.title = `${name} · Spanwise`;
  for (const id of ["campaign-name", "bar-title"]) byId(id).textContent = name;
  byId("page-facts").textContent = schedule ? factsOf(schedule) : tn(target_count, "{count} target", "{count} targets");
  layer.show(map.map, campaign, routes);
  const isEmpty = schedule && schedule.missions.length === 0;
  setChildren(
    byId("campaign-days"),
    problemNotice(),
    unusedSitesCard(campaign),
    unassignedCard(campaign),
    isEmpty &&
      h(
        "div",
        { class: "empty" },
        icon("calendar-clock"),
        h("strong", {}, t("No mission could be planned")),
        h("p", {}, t("Allow a greater distance from launch sites, or check the no-fly zones.")),
      ),
    ...(schedule ? dayCards(schedule, acts) : []),
    schedule && tooLongCard(schedule, acts),
    schedule && schedule.days.length > 0 && h("p", { class: "caption campaign-foot" }, footWords(schedule)),
  );
  drawJob();
}

/** @param {CampaignSchedule} schedule */
const footWords = ({ is_proven, sites }) =>
  [
    is_proven && t("Proven: no order of these missions takes fewer days or less driving."),
    sites.some(({ name }) => !name) &&
      t("Proposed launch sites lie 40 m beside towers: check each place and its access."),
    t("Times count from a start at 08:00; drives are estimated from the straight line."),
  ]
    .filter(Boolean)
    .join(" ");

function problemNotice() {
  if (!problem) return null;
  const again = h("button", { type: "button", class: "text-button", onclick: () => void reload() }, t("Load again"));
  return h(
    "div",
    { class: "notice critical", role: "alert" },
    icon("circle-alert"),
    h("p", {}, problem.words, " ", problem.canRetry && again),
  );
}

function drawJob() {
  const element = byId("campaign-job");
  element.hidden = job === null;
  for (const id of ["plan-campaign-again", "add-launch-site"]) byId(id, HTMLButtonElement).disabled = job !== null;
  if (!job) return;
  const share = job.progress ?? 0;
  byId("campaign-job-words").textContent = job.state === "queued" ? t("Waiting for a planner") : job.message;
  byId("campaign-job-share").textContent = percentText(share * 100);
  byId("campaign-job-bar").setAttribute("aria-valuenow", String(Math.round(share * 100)));
  /** @type {HTMLElement} */ (byId("campaign-job-bar").firstElementChild).style.width = `${share * 100}%`;
}

async function stop() {
  if (!campaign?.job) return;
  try {
    await post(`/jobs/${campaign.job}/cancel`);
  } catch (error) {
    toast(/** @type {Error} */ (error).message);
  }
}

async function planAgain() {
  if (!campaign) return;
  await openRules({
    title: t("Plan this campaign again"),
    act: t("Plan"),
    rules: campaign.rules,
    send: ({ rules, key }) => plan(rules, key),
    hint: t("The missions of this campaign are replaced, with all changes made to them."),
  });
}

/** @param {HTMLElement} opener */
async function removeCampaign(opener) {
  if (!campaign) return;
  const approved =
    campaign.schedule?.missions.filter(({ state }) => state && !["draft", "planned"].includes(state)).length ?? 0;
  const sure = await confirmAct({
    title: t("Delete {name}?", { name: campaign.name }),
    lines: [
      t("Its missions go with it. They can be brought back from the list of missions."),
      approved > 0 &&
        tn(
          approved,
          "{count} mission is approved or has flown: it stays.",
          "{count} missions are approved or have flown: they stay.",
        ),
    ],
    act: t("Delete"),
    isDanger: true,
    opener,
  });
  if (!sure) return;
  try {
    await remove(address);
    location.assign("/");
  } catch (error) {
    toast(/** @type {Error} */ (error).message);
  }
}

byId("campaign-menu").addEventListener("click", () =>
  toggleMenu(byId("campaign-menu"), () =>
    menuOf(t("This campaign"), [
      ...(campaign?.schedule
        ? [{ icon: "download", label: t("Days as CSV"), act: () => location.assign(`/api/v1${address}/days.csv`) }]
        : []),
      ...(page.canPlan
        ? [{ icon: "trash-2", label: t("Delete"), act: () => void removeCampaign(byId("campaign-menu")) }]
        : []),
      { icon: "clipboard-list", label: t("All missions"), act: () => location.assign("/") },
    ]),
  ),
);
byId("plan-campaign-again").addEventListener("click", () => void planAgain());
byId("add-launch-site").addEventListener("click", () => startPlacing(null));
byId("stop-campaign").addEventListener("click", () => void stop());

open({
  bindings: [
    {
      keys: ["escape"],
      act() {
        if (!placing) return false;
        stopPlacing();
        return true;
      },
    },
  ],
  async load() {
    layer.addTo(map.map, map.view.palette().fonts);
    map.onRecolour((palette) => layer.recolour(map.map, palette.fonts));
    void reload();
  },
});
