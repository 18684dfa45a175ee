/**
 * What the view shows of a mission, from the API: a rehearsal's run, its record, itself live, or its plan.
 *
 * A source: { kind, isSimulated, departs_ms, hasDate, span: { from_ms, to_ms } | null, routes: [{ place, uav, name, planned, pieces }], targets, events,
 * windAt(at_ms, height_m) → { speed_mps, from_deg } | null }; a live one besides take(), momentAt() and revision.
 */

import { get } from "../../api.js";
import { loadMission } from "../../record/load.js";
import { liveSource } from "./live_source.js";
import { planSource } from "./plan_source.js";
import { recordSource } from "./record_source.js";
import { rehearsalSource } from "./rehearsal_source.js";

const UNDER_WAY = ["dispatched", "active"];
const OVER = ["completed", "aborted", "failed"];
const MOST_RECORDS = 3_000; // of the line flown so far
const ORDER = ["fail", "warnings", "pass"];

/** What a mission is looked at by where nothing else is said. rehearsals: newest first. */
export function usualSource({ state }, rehearsals) {
  if (UNDER_WAY.includes(state)) return { kind: "live", rehearsal: null, run: null };
  if (OVER.includes(state)) return { kind: "record", rehearsal: null, run: null };
  return rehearsals.some(({ level }) => level)
    ? { kind: "rehearsal", rehearsal: null, run: null }
    : { kind: "plan", rehearsal: null, run: null };
}

/** The worst of a rehearsal's runs that was flown; null where none was. */
export function worstRun({ runs }) {
  const flown = runs
    .filter(({ level }) => level)
    .sort((a, b) => ORDER.indexOf(a.level) - ORDER.indexOf(b.level) || a.sequence - b.sequence);
  return flown[0]?.sequence ?? null;
}

async function readRehearsal(mission, { rehearsal, run }, rehearsals) {
  const id = rehearsal ?? rehearsals.find(({ level }) => level)?.id;
  if (!id) return null;
  const { data: detail } = await get(`/missions/${mission.id}/rehearsals/${id}`);
  const number = run !== null && detail.runs[run]?.level ? run : worstRun(detail);
  if (number === null) return null;
  const { data: track } = await get(`/missions/${mission.id}/rehearsals/${id}/track?run=${number}`);
  return {
    ...rehearsalSource({ detail, track, mission }),
    runs: detail.runs.filter(({ level }) => level).map(({ sequence, words }) => ({ sequence, words })),
  };
}

async function readLive(mission) {
  const { data } = await get(
    `/telemetry?mission=${mission.id}&most=${MOST_RECORDS}&limit=${MOST_RECORDS > 1_000 ? 1_000 : MOST_RECORDS}`,
  );
  const features = [...data.features];
  for (let { next } = data; next; ) {
    const { data: more } = await get(next);
    features.push(...more.features);
    next = more.next;
  }
  return liveSource({ detail: mission, features });
}

/** mission: GET /missions/{id}; wanted: of link.js, or null for what is usual. Throws ApiError. */
export async function readSource(mission, wanted = null) {
  const { data: listed } = await get(`/missions/${mission.id}/rehearsals`);
  const rehearsals = listed.results;
  const choice = wanted ?? usualSource(mission, rehearsals);
  const read = {
    rehearsal: () => readRehearsal(mission, choice, rehearsals),
    record: async () => recordSource(await loadMission(mission.id)),
    live: () => readLive(mission),
    plan: () => planSource(mission),
  };
  const source = (await read[choice.kind]()) ?? planSource(mission);
  return { source, choices: choicesOf(mission, rehearsals, source) };
}

/** What can be looked at besides: kinds of sources. */
function choicesOf({ state, plan }, rehearsals, { kind }) {
  const found = [];
  if (plan) found.push("plan");
  if (rehearsals.some(({ level }) => level)) found.push("rehearsal");
  if (UNDER_WAY.includes(state)) found.push("live");
  if (UNDER_WAY.includes(state) || OVER.includes(state)) found.push("record");
  return found.includes(kind) ? found : [...found, kind];
}
