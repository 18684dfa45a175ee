/** All that a mission's record is made of, from the API. */

import { get } from "../api.js";

const MOST_RECORDS = 4_000; // over all UAVs; the server thins them out
const MOST_ESTIMATES = 4_000;
const MOST_ROWS = 2_000; // alerts and commands, each

async function featuresAt(address) {
  const features = [];
  let every_s = null;
  for (let page = (await get(address)).data; page; page = page.next ? (await get(page.next)).data : null) {
    features.push(...page.features);
    every_s ??= page.every_s ?? null;
  }
  return { features, every_s };
}

async function rowsAt(address) {
  const rows = [];
  for (
    let page = (await get(address)).data;
    page;
    page = page.next && rows.length < MOST_ROWS ? (await get(page.next)).data : null
  )
    rows.push(...page.results);
  return rows;
}

/** → { record, records: { features, every_s }, estimates: the same, alerts, commands }. Throws ApiError. */
export async function loadMission(id) {
  const [record, records, estimates, alerts, commands] = await Promise.all([
    get(`/missions/${id}/record`).then(({ data }) => data),
    featuresAt(`/telemetry?mission=${id}&most=${MOST_RECORDS}&limit=1000`),
    featuresAt(`/missions/${id}/estimates?replaced=false&most=${MOST_ESTIMATES}&limit=1000`),
    rowsAt(`/alerts?mission=${id}&limit=200`),
    rowsAt(`/missions/${id}/commands?limit=200`),
  ]);
  return { record, records, estimates, alerts, commands };
}
