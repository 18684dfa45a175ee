/** State of an approved mission: its commands, the connections of its UAVs and their RTL paths. Read while the page is visible. */

import { ApiError, get } from "../../api.js";
import { flyersOf, isFlown, isOnItsWay, isOpen, KINDS } from "../../domain/flying.js";
import { announce, toast } from "../../page/toast.js";
import { t } from "../../text.js";

/** @import { Answer } from "../../api.js" */
/** @import { Command, CommandPage, Mission, Preflight, ReturnChecks, UavConnection } from "../../api_types.d.ts" */
/** @import { MissionPageData, MissionStore } from "../types.d.ts" */

const POLL_MS = 2000;
const CONNECTIONS_EVERY_MS = 20_000;
const PREFLIGHT_EVERY_MS = 6000;
const RETURNS_EVERY_MS = 60_000; // slower for the server, and seldom changed

/** @param {MissionStore} store @param {Pick<MissionPageData, "isFrozen">} page */
export function createFlightReading(store, page) {
  let isAsking = false;
  let connectionsAt = 0;
  let returnsAt = 0;
  let preflightAt = 0;

  /**
   * By UAV, its connection and onboard list; null while that could not be read.
   *
   * @param {Mission} mission
   */
  async function readConnections(mission) {
    connectionsAt = Date.now();
    const uavs = flyersOf(mission).flatMap(({ uav }) => uav ?? []);
    const read = await Promise.all(
      uavs.map((uav) =>
        get(`/uavs/${uav}/connection`).then(
          ({ data }) => /** @type {[number, UavConnection]} */ ([uav, data]),
          () => /** @type {[number, null]} */ ([uav, null]),
        ),
      ),
    );
    store.update({ connections: new Map(read) });
  }

  /** Obstructions of the RTL paths as last read; null before. */
  async function readReturns() {
    const { mission } = store.state;
    if (!mission) return;
    returnsAt = Date.now();
    try {
      const { data } = /** @type {Answer<ReturnChecks>} */ (await get(`/missions/${mission.id}/returns`));
      store.update({ returns: data.results });
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      store.update({ returns: null });
    }
  }

  /** Which act comes next on the page Fly; null while that could not be read. */
  async function readPreflight() {
    const { mission } = store.state;
    if (!mission) return;
    preflightAt = Date.now();
    try {
      const { data } = /** @type {Answer<Preflight>} */ (await get(`/missions/${mission.id}/preflight`));
      store.update({ preflight: data });
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      store.update({ preflight: null });
    }
  }

  async function readCommands() {
    const { mission } = store.state;
    if (isAsking || !mission) return;
    isAsking = true;
    try {
      const { data } = /** @type {Answer<CommandPage>} */ (await get(`/missions/${mission.id}/commands?limit=200`));
      if (showChanges(store.state.commands, data.results)) void readConnections(mission);
      store.update({ commands: data.results });
    } catch (error) {
      if (!(error instanceof ApiError)) throw error; // else watchMission reports that the server is unavailable
    } finally {
      isAsking = false;
    }
  }

  /** Poll, more often while an act is in progress. */
  function poll() {
    const { mission, commands } = store.state;
    if (document.hidden || !mission) return;
    if (isFlown(mission) && Date.now() - preflightAt >= PREFLIGHT_EVERY_MS) void readPreflight();
    if (!(isOnItsWay(mission) || commands?.some(isOpen))) return;
    void readCommands();
    if (Date.now() - connectionsAt >= CONNECTIONS_EVERY_MS) void readConnections(mission);
    if (Date.now() - returnsAt >= RETURNS_EVERY_MS) void readReturns();
  }

  return {
    readCommands,
    readReturns,
    readPreflight,
    /** Run while the page is visible. */
    watch() {
      if (!page.isFrozen) return;
      setInterval(poll, POLL_MS);
      store.listen(["mission"], ({ mission }) => {
        if (!mission || store.state.commands !== null) return;
        void readCommands();
        void readConnections(mission);
        void readReturns();
        if (isFlown(mission)) void readPreflight();
      });
      document.addEventListener("visibilitychange", () => {
        if (!document.hidden) void readCommands();
      });
    },
  };
}

/**
 * Announce once what was carried out and what was not. Returns whether something was.
 *
 * @param {Command[] | null} before
 * @param {Command[]} now
 */
function showChanges(before, now) {
  if (!before) return false;
  const states = new Map(before.map(({ id, state }) => [id, state]));
  const ended = now.filter(({ id, state }) => !isOpen({ state }) && states.has(id) && states.get(id) !== state);
  for (const { uav, kind, state, outcome } of ended) {
    const words = { name: uav.name, act: KINDS[kind], outcome };
    if (state === "applied") announce(t("{act}: done by {name}.", words));
    else if (state === "failed") toast(t("{act}: not done by {name}. {outcome}", words));
  }
  return ended.length > 0;
}
