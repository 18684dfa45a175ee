/**
 * The service worker: keeps pages and documents of approved missions, and answers with them where the server cannot be reached.
 *
 * A page from the copy is marked (`data-offline-copy` on its first element) and asks for documents of the copy by a header;
 * every other page gets only static files from it. The copy is one user's, and goes when that user signs out. The server puts
 * `globalThis.VERSION` before this text, which changes with the static files; a script that is not a module is what every browser takes.
 */

/**
 * @typedef {Event & { waitUntil: (work: Promise<unknown>) => void }} WorkerEvent
 * @typedef {WorkerEvent & { request: Request, respondWith: (answer: Promise<Response>) => void }} AskedEvent
 * @typedef {{ type: "keep", owner: string, whole: string[], map: string[] } | { type: "drop", starts: string[] }} Order
 */

const worker = /** @type {any} */ (globalThis);
/** @type {string} */
const version = worker.VERSION ?? "";

const [COPIES, SHELLS] = ["spanwise-copy-", "spanwise-shell-"]; // copies of a user; shells for all: static files, the page without data
const [COPY, SHELL] = [COPIES + version, SHELLS + version];
const OWNER = "/.offline/owner";
const NO_CONNECTION = "/offline";
const TILES = "/api/v1/tiles/";
const KEPT_AT = "X-Offline-Copy"; // header of a stored answer: when it was stored; of a request: it is for a page of the copy
const HASHED = /^\/static\/(?:.+\.[0-9a-f]{12}\.[a-z0-9]+|bundles\/.+)$/;
const STATIC_FILE = /(?:href|src|content)="(\/static\/[^"?#]+\.[a-z0-9]+)"/g;
const PAGE_DATA = /<script id="page" type="application\/json">(.*?)<\/script>/s;
const MAX_AGE_MS = 7 * 86_400_000;
const MAP_RENEWED_MS = 86_400_000;
const NETWORK_TIMEOUT_MS = 20_000; // for a page of which there is a copy: a slow server still answers with commands, a copy has none
const WIPE_TIMEOUT_MS = 5_000;
const AT_ONCE = 6;
const GATEWAY_FAULTS = new Set([502, 503, 504]);

let wipes = 0; // how often the copy was emptied: requests from before store nothing after

const signedOut = (/** @type {Response} */ answer) =>
  new URL(answer.url || location.href).pathname.startsWith("/sign-in");

async function wipe() {
  wipes += 1;
  for (const name of await caches.keys()) if (name.startsWith(COPIES)) await caches.delete(name);
}

/** `{ userId, organisationId }` as the server wrote it into a page, in one text; null for a page without a user. @param {string} html */
function ownerOf(html) {
  const found = PAGE_DATA.exec(html);
  if (!found) return null;
  const { userId, organisationId } = JSON.parse(found[1]);
  return userId === undefined ? null : `${userId}@${organisationId}`;
}

/** @param {Response} answer @param {string} keptAt ISO 8601 */
async function stored(answer, keptAt) {
  const headers = new Headers(answer.headers);
  for (const name of ["Content-Encoding", "Content-Length", "Set-Cookie"]) headers.delete(name);
  headers.set(KEPT_AT, keptAt);
  const body = answer.status === 204 ? null : await answer.arrayBuffer();
  return new Response(body, { status: answer.status, headers });
}

const find = async (/** @type {string} */ address, cache = COPY) =>
  (await caches.open(cache)).match(address, { ignoreVary: true });

/** @param {string[]} addresses @param {(address: string) => Promise<unknown>} act */
async function each(addresses, act) {
  const waiting = [...addresses];
  await Promise.all(
    Array.from({ length: AT_ONCE }, async () => {
      for (let next = waiting.shift(); next !== undefined; next = waiting.shift()) await act(next);
    }),
  );
}

/** @param {string} address */
async function fetched(address) {
  const answer = await fetch(address, {
    credentials: "same-origin",
    headers: { Accept: address.startsWith("/api/") ? "application/json" : "*/*" },
  });
  if (!answer.ok || signedOut(answer)) throw new Error(`${address}: ${answer.status}`);
  return answer;
}

/** The static files that a page names. @param {string} html */
async function keepFiles(html) {
  const cache = await caches.open(SHELL);
  const files = new Set([...html.matchAll(STATIC_FILE)].map(([, address]) => address));
  await each([...files], async (address) => {
    if (!HASHED.test(address) || !(await cache.match(address))) await cache.put(address, await fetched(address));
  });
}

async function keepNoConnectionPage() {
  const cache = await caches.open(SHELL);
  const answer = await fetched(NO_CONNECTION);
  await keepFiles(await answer.clone().text());
  await cache.put(NO_CONNECTION, await stored(answer, new Date().toISOString()));
}

// --- keeping

/**
 * Store pages and documents of one moment, all or none: a page of today never appears with a route of yesterday.
 *
 * @param {string} owner @param {string[]} addresses
 */
async function keepWhole(owner, addresses) {
  const before = wipes;
  const keptAt = new Date().toISOString();
  const cache = await caches.open(COPY);
  /** @type {[string, Response][]} */
  const answers = [];
  for (const address of addresses) {
    const answer = await fetched(address);
    if (answer.headers.get("Content-Type")?.startsWith("text/html")) {
      const html = await answer.clone().text();
      if (ownerOf(html) !== owner) return wipe();
      await keepFiles(html);
    }
    answers.push([address, await stored(answer, keptAt)]);
  }
  if (before !== wipes) return;
  await cache.put(OWNER, new Response(owner));
  for (const [address, answer] of answers) await cache.put(address, answer);
}

/** Tiles of the map: those that are missing or a day old. @param {string[]} addresses */
async function keepMap(addresses) {
  const before = wipes;
  const cache = await caches.open(COPY);
  await each(addresses, async (address) => {
    const known = await cache.match(address);
    if (known && age_ms(known) < MAP_RENEWED_MS) return;
    const answer = await stored(await fetched(address), new Date().toISOString());
    if (before === wipes) await cache.put(address, answer);
  });
}

/** @param {Response} answer */
const age_ms = (answer) => Date.now() - Date.parse(answer.headers.get(KEPT_AT) ?? "");

async function forgetOld() {
  const cache = await caches.open(COPY);
  for (const request of await cache.keys()) {
    const answer = await cache.match(request);
    if (answer?.headers.has(KEPT_AT) && age_ms(answer) > MAX_AGE_MS) await cache.delete(request);
  }
}

/** @param {Order} order */
async function obey(order) {
  await forgetOld();
  if (order.type === "drop") {
    const cache = await caches.open(COPY);
    for (const { url } of await cache.keys())
      if (order.starts.some((start) => new URL(url).pathname.startsWith(start))) await cache.delete(url);
    return;
  }
  const known = await (await find(OWNER))?.text();
  if (known !== undefined && known !== order.owner) await wipe();
  await keepWhole(order.owner, order.whole);
  await keepMap(order.map);
}

// --- answering

/** @param {Response} answer of the copy @returns {Promise<Response>} the page, marked as a copy */
async function marked(answer) {
  const html = await answer.text();
  const keptAt = answer.headers.get(KEPT_AT) ?? "";
  return new Response(html.replace("<html ", `<html data-offline-copy="${keptAt}" `), { headers: answer.headers });
}

/** The stored copy of a page, unless it is too old; else null. @param {Request} request */
async function keptPage(request) {
  const answer = await find(new URL(request.url).pathname);
  return answer && age_ms(answer) <= MAX_AGE_MS ? answer : null;
}

/** @param {AskedEvent} event @returns {Promise<Response>} */
async function page(event) {
  const { request } = event;
  const kept = await keptPage(request);
  const stop = new AbortController();
  const timer = kept ? setTimeout(() => stop.abort(), NETWORK_TIMEOUT_MS) : 0;
  try {
    const answer = await (kept ? fetch(request, { signal: stop.signal }) : fetch(request));
    if (GATEWAY_FAULTS.has(answer.status) && kept) return marked(kept);
    event.waitUntil(checkOwner(answer.clone()));
    return answer;
  } catch {
    if (kept) return marked(kept);
    return (await find(NO_CONNECTION, SHELL)) ?? Response.error();
  } finally {
    clearTimeout(timer);
  }
}

/** Check the user in a page from the server: no user, or another than the copy's, deletes the copy. @param {Response} answer */
async function checkOwner(answer) {
  if (answer.type === "opaqueredirect" || !answer.headers.get("Content-Type")?.startsWith("text/html")) return;
  const known = await (await find(OWNER))?.text();
  if (known === undefined) return;
  if (signedOut(answer)) return wipe();
  const owner = ownerOf(await answer.text());
  if (owner !== null && owner !== known) await wipe();
}

/** @param {Request} request */
async function staticFile(request) {
  const { pathname } = new URL(request.url);
  if (HASHED.test(pathname)) return (await find(pathname, SHELL)) ?? fetch(request);
  return fetch(request).catch(async () => (await find(pathname, SHELL)) ?? Response.error());
}

/** @param {Request} request of a page of the copy */
async function fromCopy(request) {
  const answer = await find(request.url);
  return answer && age_ms(answer) <= MAX_AGE_MS ? answer : Response.error();
}

/** Delete the copy first, even if the request does not reach the server. @param {Request} request */
async function signOut(request) {
  const emptied = wipe().catch(() => {});
  try {
    await Promise.race([emptied, new Promise((resolve) => setTimeout(resolve, WIPE_TIMEOUT_MS))]);
    return await fetch(request);
  } catch {
    return (await find(NO_CONNECTION, SHELL)) ?? Response.error();
  }
}

worker.addEventListener("fetch", (/** @type {AskedEvent} */ event) => {
  const { request } = event;
  const { origin, pathname } = new URL(request.url);
  if (origin !== location.origin) return;
  if (request.mode === "navigate") {
    if (request.method === "POST" && pathname === "/sign-out") event.respondWith(signOut(request));
    else if (request.method === "GET" && !/^\/(?:api|admin|static)\//.test(pathname)) event.respondWith(page(event));
  } else if (request.method !== "GET") return;
  else if (request.headers.has(KEPT_AT)) event.respondWith(fromCopy(request));
  else if (pathname.startsWith("/static/")) event.respondWith(staticFile(request));
});

worker.addEventListener("message", (/** @type {WorkerEvent & { data: Order }} */ event) => {
  event.waitUntil(obey(event.data).catch((error) => console.info(`offline copy: ${error.message}`)));
});

// --- a new version

/** Addresses of each mission, with those that all of them share. @param {string[]} addresses */
function byMission(addresses) {
  const missionOf = (/** @type {string} */ address) => /^(?:\/api\/v1)?\/missions\/([^/?]+)/.exec(address)?.[1];
  const shared = addresses.filter((address) => missionOf(address) === undefined);
  const missions = new Set(addresses.flatMap((address) => missionOf(address) ?? []));
  return [...missions].map((mission) => [...addresses.filter((address) => missionOf(address) === mission), ...shared]);
}

/** Drop stored documents that the server no longer serves; without a network all are kept. @param {Promise<unknown>} work */
async function unlessGone(work) {
  try {
    await work;
  } catch (error) {
    if (error instanceof TypeError) throw error; // of fetch: no network
  }
}

/** Fetch what the previous version kept before that is deleted: the copy always has its files. */
async function takeOver() {
  await keepNoConnectionPage();
  for (const name of (await caches.keys()).filter((one) => one.startsWith(COPIES) && one !== COPY)) {
    const before = await caches.open(name);
    const owner = await (await before.match(OWNER))?.text();
    const kept = (await before.keys()).map(({ url }) => new URL(url)).map(({ pathname, search }) => pathname + search);
    if (!owner) continue;
    const whole = kept.filter((address) => address !== OWNER && !address.startsWith(TILES));
    for (const addresses of byMission(whole)) await unlessGone(keepWhole(owner, addresses));
    await unlessGone(keepMap(kept.filter((address) => address.startsWith(TILES))));
  }
}

worker.addEventListener("install", (/** @type {WorkerEvent} */ event) => {
  event.waitUntil(takeOver().then(() => worker.skipWaiting()));
});
worker.addEventListener("activate", (/** @type {WorkerEvent} */ event) => {
  const others = async () => {
    const ours = (await caches.keys()).filter((name) => name.startsWith(COPIES) || name.startsWith(SHELLS));
    for (const name of ours) if (name !== COPY && name !== SHELL) await caches.delete(name);
    await worker.clients.claim();
  };
  event.waitUntil(others());
});
