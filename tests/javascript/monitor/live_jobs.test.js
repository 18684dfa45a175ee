import assert from "node:assert/strict";
import test from "node:test";

import { followLive } from "../../../static/js/live/jobs.js";

globalThis.location = { protocol: "https:", host: "spanwise.example", origin: "https://spanwise.example" };

/** A socket that a test speaks through. */
class Socket extends EventTarget {
  static CONNECTING = 0;
  static last = null;

  constructor(address) {
    super();
    this.address = address;
    this.readyState = 1;
    this.isClosed = false;
    Socket.last = this;
  }

  says(job) {
    this.dispatchEvent(new MessageEvent("message", { data: JSON.stringify({ type: "job", job }) }));
  }

  close() {
    this.isClosed = true;
  }
}

test("a job is told over its socket until it has ended", async () => {
  const received = [];
  const ended = followLive("j1", { Socket, onProgress: (job) => received.push(job.progress) });
  assert.equal(Socket.last.address, "wss://spanwise.example/ws/jobs/j1");
  Socket.last.says({ state: "running", progress: 0.5 });
  Socket.last.dispatchEvent(new MessageEvent("message", { data: '{"type":"keepalive"}' }));
  Socket.last.says({ state: "done", result: { routes: [] } });
  assert.deepEqual((await ended).result, { routes: [] });
  assert.deepEqual(received, [0.5]);
  assert.ok(Socket.last.isClosed);
});

test("a failed job is told in its own words", async () => {
  const ended = followLive("j1", { Socket });
  Socket.last.says({ state: "failed", error: { message: "No ground.", code: "no_graph" } });
  await assert.rejects(ended, { message: "No ground.", code: "no_graph" });
});

test("where the socket closes the job is asked for", async (context) => {
  context.mock.method(
    globalThis,
    "fetch",
    async () => new Response(JSON.stringify({ state: "cancelled", result: null })),
  );
  const ended = followLive("j1", { Socket });
  Socket.last.dispatchEvent(new Event("close"));
  assert.equal((await ended).state, "cancelled");
});

test("nobody follows any more once that is stopped", async () => {
  const stopping = new AbortController();
  const ended = followLive("j1", { Socket, signal: stopping.signal });
  stopping.abort();
  await assert.rejects(ended, { name: "AbortError" });
  assert.ok(Socket.last.isClosed);
});
