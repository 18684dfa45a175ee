/** Inspections of an asset: its missions, of a line its towers and spans, photos, findings, and the way to a new mission. */

import { ApiError, freshKey, get, post } from "../api.js";
import { h, icon, setChildren, term } from "../dom.js";
import { MISSION_STATES } from "../domain/planned_state.js";
import { toast } from "../page/toast.js";
import { mountFindings } from "../photos/findings_list.js";
import { mountPhotos } from "../photos/section.js";
import { t, tn } from "../text.js";
import { dateText, lengthText, numberText } from "../units.js";
import { inspectedPartsOf } from "./inspected_parts.js";

/** @import { Answer } from "../api.js" */
/** @import { AssetCounts, AssetDetailFeature, AssetMission, AssetMissionPage, TargetInputRequest } from "../api_types.d.ts" */

const ENDED = ["completed", "aborted", "failed"];

/**
 * Opens a new mission with the asset as target.
 *
 * @param {number} asset
 * @param {string} label
 * @param {TargetInputRequest["task"]} [task]
 * @param {string} [key] idempotency key
 */
export const planInspection = (asset, label, task, key = freshKey()) =>
  openMission(label, [{ asset, ...(task ? { task } : {}) }], key);

/** @param {string} label @param {TargetInputRequest[]} targets @param {string} key idempotency key */
async function openMission(label, targets, key) {
  const body = { name: t("Inspection of {name}", { name: label }).slice(0, 200), targets };
  try {
    const { data } = /** @type {Answer<{ id: string }>} */ (
      await post("/missions", body, { headers: { "Idempotency-Key": key } })
    );
    location.assign(`/missions/${data.id}`);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  }
}

/** The button that opens a new mission with the asset as target. @param {AssetDetailFeature} feature */
export function planButton({ id, properties }) {
  const words = properties.kind === "line" ? t("Plan an inspection of this line") : t("Plan an inspection");
  const key = freshKey();
  const button = h("button", { type: "button", class: "button primary" }, icon("list-plus", "small"), words);
  button.addEventListener("click", async () => {
    button.disabled = true;
    await planInspection(id, properties.label, undefined, key);
    button.disabled = false;
  });
  return button;
}

/**
 * The missions of an asset, of a line or railway its inspected parts, and of a line its towers and spans. They are read once the part is
 * shown.
 *
 * @param {AssetDetailFeature} feature
 * @param {(id: number, label: string) => void} showSupports in the register
 * @param {{ canPlan: boolean }} page
 */
export function inspectionsPart(feature, showSupports, { canPlan }) {
  const { kind, label, is_flyable: isFlown } = feature.properties;
  const isLine = kind === "line";
  const isLong = (isLine || kind === "railway") && feature.geometry.type === "LineString";
  const parts = h("div", {}, h("div", { class: "skeleton" }));
  const supports = h("div", {}, h("div", { class: "skeleton" }));
  const missions = h("div", {}, h("div", { class: "skeleton" }));
  const part = h(
    "div",
    {},
    isLong && h("h3", {}, icon("line", "small"), t("Inspected parts")),
    isLong && parts,
    isLine && h("h3", {}, icon("tower", "small"), t("Towers and spans")),
    isLine && supports,
    h("h3", {}, icon("list-checks", "small"), t("Missions")),
    missions,
  );
  fill(missions, () => missionsOf(feature.id));
  /** @param {TargetInputRequest[]} targets @param {string} key */
  const planRest = (targets, key) => openMission(label, targets, key);
  if (isLong) fill(parts, () => inspectedPartsOf(feature, { planRest: canPlan && isFlown ? planRest : null }));
  if (isLine) fill(supports, () => supportsOf(feature, showSupports));
  return part;
}

/** @param {HTMLElement} element @param {() => Promise<Node[]>} make */
async function fill(element, make) {
  try {
    setChildren(element, await make());
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    setChildren(element, h("p", { class: "caption" }, error.message));
  }
}

/** @param {AssetDetailFeature} feature @param {(id: number, label: string) => void} showSupports */
async function supportsOf({ id, properties }, showSupports) {
  const [all, inspected] = await Promise.all(
    ["", "&inspected=true"].map(
      async (more) => /** @type {Answer<AssetCounts>} */ (await get(`/assets/summary?line=${id}${more}`)).data.total,
    ),
  );
  const spans = Math.max(all - 1, 0);
  const show = () => showSupports(id, properties.label);
  return [
    h(
      "dl",
      { class: "facts" },
      term(t("Towers and poles"), numberText(all)),
      term(t("Spans"), numberText(spans)),
      term(t("Average span"), spans && properties.length_m && lengthText(properties.length_m / spans)),
      term(t("Inspected"), all && t("{done} of {all}", { done: numberText(inspected), all: numberText(all) })),
    ),
    ...(all
      ? [h("button", { type: "button", class: "text-button", onclick: show }, t("Show the towers in the list"))]
      : []),
  ];
}

/** @param {number} id */
async function missionsOf(id) {
  const { data } = /** @type {Answer<AssetMissionPage>} */ (await get(`/assets/${id}/missions`));
  if (!data.results.length) return [h("p", { class: "caption" }, t("No mission inspects it yet."))];
  const more = data.next
    ? [h("p", { class: "caption" }, t("The newest {count} are shown.", { count: data.results.length }))]
    : [];
  return [h("ol", { class: "asset-missions" }, data.results.map(missionRow)), ...more];
}

/** @param {AssetMission} mission */
function missionRow(mission) {
  const {
    id,
    name,
    state,
    departs_at: departs,
    created_at: created,
    target_count: count,
    inspected_count: done,
  } = mission;
  const isEnded = ENDED.includes(state);
  const facts = [
    MISSION_STATES[state],
    dateText(departs ?? created),
    isEnded
      ? t("{done} of {all} inspected", { done: numberText(done), all: numberText(count) })
      : tn(count, "{count} target", "{count} targets", { count: numberText(count) }),
    mission.is_simulated && t("simulated"),
  ];
  return h(
    "li",
    {},
    h("a", { href: isEnded ? `/missions/${id}/report` : `/missions/${id}`, translate: "no" }, name),
    h("span", { class: "caption" }, facts.filter(Boolean).join(" · ")),
  );
}

/**
 * Photos of an asset through time, and findings.
 *
 * @param {AssetDetailFeature} feature @param {{ canPlan: boolean }} page
 */
export function resultsPart({ id }, { canPlan }) {
  const findings = h("div", {}, h("div", { class: "skeleton" }));
  const photos = h("div", {});
  mountFindings(findings, `asset=${id}`, { canPlan });
  mountPhotos(photos, { query: `asset=${id}`, stated: { asset: id }, canUpload: canPlan });
  return h(
    "div",
    {},
    h("h3", {}, icon("triangle-alert", "small"), t("Findings")),
    findings,
    h("h3", {}, icon("camera", "small"), t("Photos")),
    photos,
  );
}
