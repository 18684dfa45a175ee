/** All that a mission's record is made of, from the API. */

import { get } from "../api.js";

/** @import { Answer } from "../api.js" */
/** @import { AlertPage, CommandPage, EstimateCollection, MissionRecord, RecordCollection } from "../api_types.d.ts" */

/** @typedef {Awaited<ReturnType<typeof loadMission>>} LoadedMission */

const MAX_RECORDS = 4_000; // over all UAVs; the server thins them out
const MAX_ESTIMATES = 4_000;
const MAX_ROWS = 2_000; // alerts and commands, each

/**
 * @template {{ next: string | null }} Page
 * @param {string} address of the first page
 * @param {(pages: Page[]) => boolean} [isEnough] whether the next page is not needed
 */
async function pagesAt(address, isEnough = () => false) {
  /** @type {Page[]} */
  const pages = [];
  for (let next = /** @type {string | null} */ (address); next && !isEnough(pages); ) {
    const { data } = /** @type {Answer<Page>} */ (await get(next));
    pages.push(data);
    next = data.next;
  }
  return pages;
}

/** @template Row @param {{ results: Row[] }[]} pages */
const rowsOf = (pages) => pages.flatMap(({ results }) => results);
/** @param {{ results: unknown[], next: string | null }[]} pages */
const areEnoughRows = (pages) => rowsOf(pages).length >= MAX_ROWS;

/** @template Feature @param {{ features: Feature[], every_s: number | null }[]} pages */
const featuresOf = (pages) => ({
  features: pages.flatMap(({ features }) => features),
  every_s: pages.map(({ every_s }) => every_s).find((every_s) => every_s !== null) ?? null,
});

/** @param {string} id @throws {ApiError} */
export async function loadMission(id) {
  const [{ data: record }, records, estimates, alerts, commands] = await Promise.all([
    /** @type {Promise<Answer<MissionRecord>>} */ (get(`/missions/${id}/record`)),
    /** @type {Promise<RecordCollection[]>} */ (pagesAt(`/telemetry?mission=${id}&most=${MAX_RECORDS}&limit=1000`)),
    /** @type {Promise<EstimateCollection[]>} */ (
      pagesAt(`/missions/${id}/estimates?replaced=false&most=${MAX_ESTIMATES}&limit=1000`)
    ),
    /** @type {Promise<AlertPage[]>} */ (pagesAt(`/alerts?mission=${id}&limit=200`, areEnoughRows)),
    /** @type {Promise<CommandPage[]>} */ (pagesAt(`/missions/${id}/commands?limit=200`, areEnoughRows)),
  ]);
  return {
    record,
    records: featuresOf(records),
    estimates: featuresOf(estimates),
    alerts: rowsOf(alerts),
    commands: rowsOf(commands),
  };
}
