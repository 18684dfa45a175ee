/** What the view shows of a mission, from the API: a rehearsal's run, its record, itself live, or its plan. */

import { get } from "../../api.js";
import { loadMission } from "../../record/load.js";
import { liveSource } from "./live_source.js";
import { planSource } from "./plan_source.js";
import { recordSource } from "./record_source.js";
import { rehearsalSource } from "./rehearsal_source.js";

/** @import { Answer } from "../../api.js" */
/** @import { Mission, RecordCollection, Rehearsal, RehearsalDetail, RehearsalPage, RehearsalTrack } from "../../api_types.d.ts" */
/** @import { FlightSource, SourceKind, WantedSource } from "../types.d.ts" */

const UNDER_WAY = ["dispatched", "active"];
const OVER = ["completed", "aborted", "failed"];
const MAX_RECORDS = 3_000; // of the line flown so far
const ORDER = ["fail", "warnings", "pass"];

/**
 * The default source of a mission.
 *
 * @param {Pick<Mission, "state">} mission
 * @param {readonly Pick<Rehearsal, "level">[]} rehearsals newest first
 * @returns {WantedSource}
 */
export function usualSource({ state }, rehearsals) {
  if (UNDER_WAY.includes(state)) return { kind: "live", rehearsal: null, run: null };
  if (OVER.includes(state)) return { kind: "record", rehearsal: null, run: null };
  return rehearsals.some(({ level }) => level)
    ? { kind: "rehearsal", rehearsal: null, run: null }
    : { kind: "plan", rehearsal: null, run: null };
}

/**
 * The worst of a rehearsal's runs that was flown; null where none was.
 *
 * @param {{ runs: Pick<RehearsalDetail["runs"][number], "level" | "sequence">[] }} rehearsal
 */
export function worstRun({ runs }) {
  const flown = runs
    .filter(({ level }) => level)
    .sort((a, b) => ORDER.indexOf(a.level) - ORDER.indexOf(b.level) || a.sequence - b.sequence);
  return flown[0]?.sequence ?? null;
}

/** @param {Mission} mission @param {WantedSource} wanted @param {readonly Rehearsal[]} rehearsals */
async function readRehearsal(mission, { rehearsal, run = null }, rehearsals) {
  const id = rehearsal ?? rehearsals.find(({ level }) => level)?.id;
  if (!id) return null;
  const { data: detail } = /** @type {Answer<RehearsalDetail>} */ (
    await get(`/missions/${mission.id}/rehearsals/${id}`)
  );
  const number = run !== null && detail.runs[run]?.level ? run : worstRun(detail);
  if (number === null) return null;
  const { data: track } = /** @type {Answer<RehearsalTrack>} */ (
    await get(`/missions/${mission.id}/rehearsals/${id}/track?run=${number}`)
  );
  return {
    ...rehearsalSource({ detail, track, mission }),
    runs: detail.runs.filter(({ level }) => level).map(({ sequence, words }) => ({ sequence, words })),
  };
}

/** @param {Mission} mission */
async function readLive(mission) {
  const features = [];
  let next = /** @type {string | null} */ (
    `/telemetry?mission=${mission.id}&most=${MAX_RECORDS}&limit=${Math.min(MAX_RECORDS, 1_000)}`
  );
  while (next) {
    const { data } = /** @type {Answer<RecordCollection>} */ (await get(next));
    features.push(...data.features);
    next = data.next;
  }
  return liveSource({ detail: mission, features });
}

/**
 * @param {Mission} mission
 * @param {WantedSource | null} [wanted] null: the default
 * @returns {Promise<{ source: FlightSource, choices: SourceKind[] }>}
 * @throws {ApiError}
 */
export async function readSource(mission, wanted = null) {
  const { data: listed } = /** @type {Answer<RehearsalPage>} */ (await get(`/missions/${mission.id}/rehearsals`));
  const rehearsals = listed.results;
  const choice = wanted ?? usualSource(mission, rehearsals);
  /** @type {Record<SourceKind, () => Promise<FlightSource | null>>} */
  const read = {
    rehearsal: () => readRehearsal(mission, choice, rehearsals),
    record: async () => recordSource(await loadMission(mission.id)),
    live: () => readLive(mission),
    plan: async () => planSource(mission),
  };
  const source = (await read[choice.kind]()) ?? planSource(mission);
  return { source, choices: choicesOf(mission, rehearsals, source) };
}

/**
 * The other sources to choose from.
 *
 * @param {Mission} mission
 * @param {readonly Rehearsal[]} rehearsals
 * @param {Pick<FlightSource, "kind">} source
 */
function choicesOf({ state, plan }, rehearsals, { kind }) {
  /** @type {SourceKind[]} */
  const found = [];
  if (plan) found.push("plan");
  if (rehearsals.some(({ level }) => level)) found.push("rehearsal");
  if (UNDER_WAY.includes(state)) found.push("live");
  if (UNDER_WAY.includes(state) || OVER.includes(state)) found.push("record");
  return found.includes(kind) ? found : [...found, kind];
}
