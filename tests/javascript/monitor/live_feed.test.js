import assert from "node:assert/strict";
import test from "node:test";

import { certaintyOf, isLate } from "../../../static/js/domain/certainty.js";
import { openFeed, pauseBefore_ms } from "../../../static/js/live/feed.js";
import { serverClock } from "../../../static/js/live/server_clock.js";
import { staleWords } from "../../../static/js/live/stale.js";

globalThis.location = { protocol: "https:", host: "spanwise.example", origin: "https://spanwise.example" };

const TIME = "2026-11-22T12:00:00.000+00:00";
const EMPTY = { uavs: [], missions: [], alerts: [], commands: [], offers: [] };

/** A socket that a test speaks through. What a listener throws comes back to the test. */
class Socket {
  static CONNECTING = 0;
  static OPEN = 1;
  static all = [];

  constructor(address) {
    this.address = address;
    this.readyState = Socket.OPEN;
    this.sent = [];
    this.listeners = {};
    Socket.all.push(this);
  }

  static get last() {
    return Socket.all.at(-1);
  }

  addEventListener(name, listener) {
    this.listeners[name] = listener;
  }

  receives(message) {
    this.listeners.message({ data: JSON.stringify({ server_time: TIME, ...message }) });
  }

  send(text) {
    this.sent.push(JSON.parse(text));
  }

  close() {
    this.readyState = 3;
  }

  isLost(code = 1006) {
    this.readyState = 3;
    this.listeners.close({ code });
  }
}

const snapshot = (sequence, live) => ({ type: "snapshot", sequence, live: { ...EMPTY, ...live } });
const changes = (sequence, some, removed = {}) => ({
  type: "changes",
  sequence,
  ...EMPTY,
  ...some,
  removed: { ...EMPTY, ...removed },
});
const settle = () => new Promise((resolve) => setImmediate(resolve));

/** A page with timers of the test's own; `answers` are what the server says when it is asked, the last one again and again. */
function page(context, { answers = [new Error("away")], ...options } = {}) {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  Socket.all = [];
  const asked = [];
  const states = [];
  const reported = [];
  const get = async (address, { headers }) => {
    asked.push({ address, ...headers });
    const answer = answers.length > 1 ? answers.shift() : answers[0];
    if (answer instanceof Error) throw answer;
    return answer;
  };
  const feed = openFeed({
    Socket,
    get,
    random: () => 1,
    onState: ({ state }) => states.push(state),
    onChange: (touched) => reported.push(touched),
    ...options,
  });
  const pass = async (ms) => {
    context.mock.timers.tick(ms);
    await settle();
  };
  return { feed, asked, states, reported, pass };
}

const answer = (live, etag = '"1"') => ({
  status: 200,
  etag,
  data: { server_time: TIME, live: { ...EMPTY, ...live } },
});

test("a page shows everything, then what changes, and confirms each word", (context) => {
  const { feed, states, reported } = page(context);
  assert.equal(Socket.last.address, "wss://spanwise.example/ws/live");
  Socket.last.receives(
    snapshot(1, {
      uavs: [
        { id: 1, name: "Tern" },
        { id: 2, name: "Gull" },
      ],
    }),
  );
  assert.equal(reported.at(-1), null);
  Socket.last.receives(changes(2, { uavs: [{ id: 1, name: "Arctic tern" }] }, { uavs: [2] }));
  assert.deepEqual([...feed.shown.uavs.values()], [{ id: 1, name: "Arctic tern" }]);
  assert.deepEqual([...reported.at(-1).uavs], [1, 2]);
  assert.deepEqual(Socket.last.sent, [
    { type: "ack", sequence: 1 },
    { type: "ack", sequence: 2 },
  ]);
  assert.deepEqual(states, ["connecting", "live"]);
  feed.close();
});

test("a page of one mission listens to that mission", (context) => {
  page(context, { mission: "m1" }).feed.close();
  assert.equal(Socket.last.address, "wss://spanwise.example/ws/missions/m1/live");
});

test("after a gap the page asks once for everything and takes nothing before that", (context) => {
  const { feed, reported } = page(context);
  Socket.last.receives(snapshot(1, { uavs: [{ id: 1, at: "a" }] }));
  Socket.last.receives(changes(3, { uavs: [{ id: 1, at: "c" }] }));
  Socket.last.receives(changes(4, { uavs: [{ id: 1, at: "d" }] }));
  assert.equal(feed.shown.uavs.get(1).at, "a");
  assert.deepEqual(
    Socket.last.sent.map(({ type }) => type),
    ["ack", "resync", "ack", "ack"],
  );
  Socket.last.receives(snapshot(5, { uavs: [{ id: 1, at: "e" }] }));
  Socket.last.receives(changes(6, { uavs: [{ id: 1, at: "f" }] }));
  assert.equal(feed.shown.uavs.get(1).at, "f");
  assert.equal(reported.length, 3);
  feed.close();
});

test("a word that was lost last of all is found missing by the next sign of life", (context) => {
  const { feed } = page(context);
  Socket.last.receives(snapshot(1));
  Socket.last.receives({ type: "keepalive", sequence: 1 });
  assert.equal(Socket.last.sent.length, 1);
  Socket.last.receives({ type: "keepalive", sequence: 2 });
  assert.deepEqual(Socket.last.sent.at(-1), { type: "resync" });
  feed.close();
});

test("a page that fails to draw confirms all the same, so that it is told the next", (context) => {
  const { feed } = page(context, { onChange: () => assert.fail("not drawn") });
  assert.throws(() => Socket.last.receives(snapshot(1)), /not drawn/);
  assert.deepEqual(Socket.last.sent, [{ type: "ack", sequence: 1 }]);
  feed.close();
});

test("without a socket the page asks every two seconds and says so; the socket comes back by itself", async (context) => {
  const { feed, asked, states, pass } = page(context, {
    answers: [answer({ uavs: [{ id: 1 }] }), { status: 304, etag: '"1"' }],
  });
  Socket.last.receives(snapshot(1));
  Socket.last.isLost();
  await pass(0);
  assert.deepEqual(states, ["connecting", "live", "connecting", "asked"]);
  assert.deepEqual([...feed.shown.uavs.keys()], [1]);
  await pass(500);
  assert.equal(Socket.all.length, 2);
  Socket.last.isLost();
  await pass(1_500);
  assert.deepEqual(asked, [{ address: "/live" }, { address: "/live", "If-None-Match": '"1"' }]);
  assert.equal(Socket.all.length, 3);
  Socket.last.receives(snapshot(1, { uavs: [{ id: 7 }] }));
  await pass(4_000);
  assert.equal(asked.length, 2);
  assert.deepEqual([...feed.shown.uavs.keys()], [7]);
  assert.deepEqual(states.slice(3), ["asked", "live"]);
  feed.close();
});

test("while nothing answers the page says that it is connecting, and keeps trying", async (context) => {
  const { feed, states, asked, pass } = page(context);
  Socket.last.isLost();
  for (let second = 0; second < 60; second += 1) {
    await pass(1_000);
    if (Socket.last.readyState === Socket.OPEN) Socket.last.isLost();
  }
  assert.deepEqual(states, ["connecting"]);
  assert.ok(asked.length >= 28, `${asked.length} questions in a minute`);
  assert.ok(Socket.all.length >= 12, `${Socket.all.length} sockets in a minute`);
  feed.close();
});

test("a socket that opens and says nothing is not waited for", async (context) => {
  const { feed, states, pass } = page(context, { answers: [answer({})] });
  await pass(3_000);
  assert.deepEqual(states, ["connecting", "asked"]);
  await pass(12_000);
  await pass(500);
  assert.equal(Socket.all.length, 2);
  feed.close();
});

test("a page whose program is being stopped goes to the next one at once, and stays live", async (context) => {
  const { asked, states, feed, pass } = page(context);
  Socket.last.receives(snapshot(1, { uavs: [{ id: 1, name: "Tern" }] }));
  Socket.last.isLost(1012);
  assert.equal(Socket.all.length, 2);
  Socket.last.receives(snapshot(1, { uavs: [{ id: 1, name: "Gull" }] }));
  assert.equal(feed.shown.uavs.get(1).name, "Gull");
  assert.deepEqual([states, asked], [["connecting", "live"], []]);
  Socket.last.isLost(1012);
  Socket.last.isLost(); // nobody is there
  await pass(0);
  assert.deepEqual([states.at(-1), asked.length], ["connecting", 1]);
});

test("a live socket that falls silent is replaced after 5 s: the server sends a heartbeat each 2 s", async (context) => {
  const { feed, states, pass } = page(context);
  Socket.last.receives(snapshot(1));
  await pass(4_000);
  Socket.last.receives({ type: "keepalive", sequence: 1 });
  await pass(4_000);
  assert.deepEqual(states, ["connecting", "live"]);
  await pass(1_000);
  await pass(500);
  assert.equal(Socket.all.length, 2);
  assert.deepEqual(states, ["connecting", "live", "connecting"]);
  feed.close();
});

for (const [status, state] of [
  [401, "signed-out"],
  [404, "gone"],
]) {
  test(`after ${status} the page is ${state} for good`, async (context) => {
    const { feed, states, asked, pass } = page(context, { answers: [Object.assign(new Error("no"), { status })] });
    Socket.last.receives(snapshot(1));
    Socket.last.isLost();
    await pass(0);
    await pass(60_000);
    assert.equal(states.at(-1), state);
    assert.equal(asked.length, 1);
    assert.equal(Socket.all.length, 1);
    feed.close();
  });
}

/** A clock of the test's own, by the server's time. */
function testClock() {
  let now_ms = Date.parse(TIME);
  return { received() {}, now_ms: () => now_ms, pass: (ms) => (now_ms += ms) };
}

test("a page that hears nothing says so after 5 s, with the time of the last message, and what it shows stands still", (context) => {
  const clock = testClock();
  const { feed } = page(context, { clock });
  const sent = () =>
    staleWords({
      link: feed.state,
      since_ms: feed.since_ms,
      now_ms: feed.now_ms(),
      silent_ms: feed.silent_ms(),
      received_ms: feed.received_ms,
    });
  const received_ms = clock.now_ms();
  Socket.last.receives(snapshot(1));
  clock.pass(4_900);
  assert.equal(sent(), null);
  assert.equal(feed.shown_ms(), received_ms + 2_500, "no age grows by the device's own loss");
  clock.pass(600);
  assert.deepEqual([sent().words, sent().isBad], ["No data on this device for 5 s.", true]);
  assert.match(sent().rest, /^Last message \d\d:00:00: everything here is as of then\./);
  clock.pass(40_000);
  assert.equal(feed.shown_ms(), received_ms);
  Socket.last.receives({ type: "keepalive", sequence: 1 });
  assert.deepEqual([sent(), feed.silent_ms()], [null, 0]);
  feed.close();
});

test("no UAV is lost by the device's own loss", (context) => {
  const clock = testClock();
  const { feed } = page(context, { clock });
  Socket.last.receives(snapshot(1));
  const uav = {
    measured: { measured_at: TIME, position: [10, 50], is_in_air: true },
    estimated: null,
    link: { is_in_air: true },
    rhythm: { interval_s: 1, late_after_s: 5, silent_after_s: 10 },
  };
  for (let second = 0; second < 60; second += 1) {
    clock.pass(1_000);
    assert.equal(certaintyOf(uav, feed.shown_ms()), "measured");
    assert.equal(isLate(uav, feed.shown_ms()), false);
  }
  feed.close();
});

test("what is answered after the socket is back changes nothing", async (context) => {
  let answerNow;
  const { feed, pass } = page(context, { get: () => new Promise((resolve) => (answerNow = resolve)) });
  Socket.last.isLost();
  await pass(500);
  Socket.last.receives(snapshot(1, { uavs: [{ id: 7 }] }));
  answerNow(answer({ uavs: [{ id: 1 }] }));
  await pass(4_000);
  assert.deepEqual([...feed.shown.uavs.keys()], [7]);
  assert.equal(feed.state, "live");
  feed.close();
});

test("a closed page neither hears nor asks", async (context) => {
  const { feed, asked, reported, pass } = page(context);
  const socket = Socket.last;
  feed.close();
  socket.receives(snapshot(1));
  socket.isLost();
  await pass(60_000);
  assert.deepEqual([asked.length, reported.length, Socket.all.length, socket.readyState], [0, 0, 1, 3]);
});

test("pages do not all come back at once, and wait 5 s at most", () => {
  assert.deepEqual(
    [0, 1, 2, 3, 4, 50].map((failures) => pauseBefore_ms(failures, () => 1)),
    [500, 1_000, 2_000, 4_000, 5_000, 5_000],
  );
  assert.deepEqual(
    [0, 50].map((failures) => pauseBefore_ms(failures, () => 0)),
    [250, 2_500],
  );
});

test("the server's time is known although the page's clock is wrong and words come late", () => {
  let ticks_ms = 1_000;
  const server_ms = Date.parse(TIME);
  const at = (ms) => new Date(server_ms + ms).toISOString();
  const clock = serverClock(() => ticks_ms, 0);
  clock.received(at(0 - 300)); // it took 300 ms
  assert.equal(clock.now_ms(), server_ms - 300);
  ticks_ms += 1_000;
  clock.received(at(1_000 - 20));
  ticks_ms += 1_000;
  clock.received(at(2_000 - 900));
  assert.equal(clock.now_ms(), server_ms + 2_000 - 20);
  ticks_ms += 100_000; // the page slept, and what it knew is too old
  clock.received(at(90_000));
  assert.equal(clock.now_ms(), server_ms + 90_000);
});

test("a page whose websocket is refused because too many are open asks, says so, and tries again a minute later", async (context) => {
  const { feed, states, pass } = page(context, { answers: [answer({ uavs: [{ id: 1 }] })] });
  Socket.last.isLost(4429);
  await settle();
  assert.deepEqual(states, ["connecting", "crowded"]);
  const sent = staleWords({ link: feed.state, since_ms: feed.since_ms, now_ms: feed.now_ms() });
  assert.deepEqual([sent.words, sent.isBad], ["Too many live pages are open.", false]);
  await pass(59_000);
  assert.equal(Socket.all.length, 1);
  await pass(1_001);
  assert.equal(Socket.all.length, 2);
  Socket.last.receives(snapshot(1, {}));
  assert.equal(feed.state, "live");
  feed.close();
});

test("a socket that early.js has opened is taken over with the messages that have come", async (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  Socket.all = [];
  const early = Object.assign(new Socket("early"), { url: "wss://spanwise.example/ws/live", OPEN: 1, CONNECTING: 0 });
  const first = JSON.stringify({ server_time: TIME, ...snapshot(4, { uavs: [{ id: 7 }] }) });
  globalThis.earlySocket = { socket: early, take: () => [first] };
  const feed = openFeed({ Socket });
  await settle();
  assert.deepEqual(Socket.all, [early]);
  assert.deepEqual([...feed.shown.uavs.keys()], [7]);
  assert.deepEqual(early.sent, [{ type: "ack", sequence: 4 }]);
  feed.close();
});
