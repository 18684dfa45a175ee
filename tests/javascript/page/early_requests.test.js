import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import vm from "node:vm";

const EARLY = readFileSync(new URL("../../../static/js/early.js", import.meta.url), "utf8");

/** What early.js requests in a page that names documents. */
function requested({ documents = "", dataset = {} }) {
  const asked = [];
  const context = {
    document: {
      documentElement: { dataset },
      querySelector: (wanted) => (wanted === 'meta[name="documents"]' && documents ? { content: documents } : null),
    },
    localStorage: { getItem: () => null },
    fetch: (address, options) => {
      asked.push({ address, accept: options.headers.Accept });
      return Promise.resolve(address);
    },
  };
  vm.runInNewContext(EARLY, context);
  return { asked, kept: [...context.earlyRequests.keys()] };
}

test("documents that a page names are requested before its scripts are there", () => {
  const { asked, kept } = requested({ documents: "/api/v1/ground /api/v1/uavs?limit=100" });
  assert.deepEqual(kept, ["/api/v1/ground", "/api/v1/uavs?limit=100"]);
  assert.deepEqual(
    asked.map(({ accept }) => accept),
    ["application/json", "application/json"],
  );
});

test("a page without documents, and an offline copy, request none", () => {
  assert.deepEqual(requested({}).asked, []);
  assert.deepEqual(requested({ documents: "/api/v1/ground", dataset: { offlineCopy: "2026-11-29" } }).asked, []);
});

globalThis.document = { cookie: "", querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
const { get } = await import("../../../static/js/api.js");
const answer = (data) => new Response(JSON.stringify(data), { headers: { ETag: '"1"' } });

test("an early answer is taken once, then the server is asked", async (t) => {
  t.mock.method(globalThis, "fetch", async () => answer("later"));
  globalThis.earlyRequests = new Map([["/api/v1/ground", Promise.resolve(answer("early"))]]);
  assert.deepEqual((await get("/ground")).data, "early");
  assert.deepEqual((await get("/ground")).data, "later");
});

test("where the early request failed, or a request names more than its address, the server is asked", async (t) => {
  t.mock.method(globalThis, "fetch", async () => answer("later"));
  globalThis.earlyRequests = new Map([["/api/v1/ground", Promise.reject(new TypeError("no network"))]]);
  assert.deepEqual((await get("/ground")).data, "later");
  globalThis.earlyRequests = new Map([["/api/v1/ground", Promise.resolve(answer("early"))]]);
  assert.deepEqual((await get("/ground", { headers: { "If-None-Match": '"1"' } })).data, "later");
});
