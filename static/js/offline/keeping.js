/** Passes the approved missions to the service worker, which stores them for times without a server. */

import { ApiError, get } from "../api.js";
import { isKept, placesOf, startsOf, tilesOf, wholeOf } from "./addresses.js";

/** @import { Answer } from "../api.js" */
/** @import { Mission, MissionPage } from "../api_types.d.ts" */

/** @typedef {{ userId: number, organisationId: number, mission?: string | null }} KeptPage what the server wrote into the page */

const WORKER = "/service-worker.js";
const COPIES = "spanwise-copy-"; // caches of the worker
const NOT_FOUND = 404;
const AFTER_LOAD_MS = 1_500; // the page itself comes first
const MAX_MISSIONS = 10;
const ALL_INTERVAL_MS = 600_000;

/** Keep an offline copy; on every page of a signed-in user. @param {KeptPage} page */
export function keepForOffline(page) {
  const workers = globalThis.navigator?.serviceWorker;
  if (!workers) return; // http to another host than this one, or a browser without it
  addEventListener("load", () => setTimeout(() => void keep(workers, page).catch(forgive), AFTER_LOAD_MS));
}

/** @param {unknown} error */
function forgive(error) {
  if (error instanceof ApiError || error instanceof TypeError || error instanceof DOMException) return; // server unavailable, storage closed
  throw error;
}

/** @param {ServiceWorkerContainer} workers @param {KeptPage} page */
async function keep(workers, page) {
  await workers.register(WORKER);
  const { active } = await workers.ready;
  const fleet = await fleetAddresses();
  for (const id of await missionsOf(page)) {
    const mission = await missionNow(id);
    active?.postMessage(
      mission && isKept(mission)
        ? {
            type: "keep",
            owner: `${page.userId}@${page.organisationId}`,
            whole: wholeOf(id, fleet),
            map: tilesOf(placesOf(mission)),
          }
        : { type: "drop", starts: startsOf(id) },
    );
  }
}

/** null: there is none any more. @param {string} id */
async function missionNow(id) {
  try {
    return /** @type {Answer<Mission>} */ (await get(`/missions/${id}`)).data;
  } catch (error) {
    if (error instanceof ApiError && error.status === NOT_FOUND) return null;
    throw error;
  }
}

/** Missions of which the worker keeps a page. */
async function heldMissions() {
  const names = (await caches.keys()).filter((name) => name.startsWith(COPIES));
  const requests = await Promise.all(names.map(async (name) => (await caches.open(name)).keys()));
  return requests.flat().flatMap(({ url }) => /^\/missions\/([0-9a-f-]{36})$/.exec(new URL(url).pathname)?.[1] ?? []);
}

/** The page's own mission; on other pages, now and then, the newest that are approved and those that are kept. @param {KeptPage} page */
async function missionsOf({ mission, userId }) {
  if (mission) return [mission];
  const key = `spanwise.offline-asked.${userId}`;
  if (Date.now() - Number(localStorage.getItem(key)) < ALL_INTERVAL_MS) return [];
  localStorage.setItem(key, `${Date.now()}`);
  const { data } = /** @type {Answer<MissionPage>} */ (
    await get(`/missions?state=approved,dispatched,active&limit=${MAX_MISSIONS}`)
  );
  return [...new Set([...data.results.map(({ id }) => id), ...(await heldMissions())])];
}

/** Addresses of UAVs, as the page of a mission requests them, page by page. */
async function fleetAddresses() {
  const addresses = ["/api/v1/uavs?limit=100"];
  for (;;) {
    const { data } = /** @type {Answer<{ next: string | null }>} */ (await get(addresses[addresses.length - 1]));
    if (!data.next) return addresses;
    const { pathname, search } = new URL(data.next, location.origin);
    addresses.push(pathname + search);
  }
}
