/** A live page's end of the wire: told over a websocket, asking every two seconds where there is none, and never silent about which. */

import { get as ask } from "../api.js";
import { serverClock } from "./server_clock.js";
import { applyChanges, nothingShown, shownAfterSnapshot } from "./shown.js";

export const LIVE = "live"; // told of each change at once
export const ASKED = "asked"; // by HTTP, every two seconds
export const CONNECTING = "connecting"; // neither: what is shown is as old as its times say
export const SIGNED_OUT = "signed-out"; // for good
export const GONE = "gone"; // the mission is deleted: for good

const SILENT_MS = 45_000; // the server says every 20 s that it is still there
const FIRST_WORD_MS = 3_000; // after which the page asks, while it goes on waiting
const ASK_EVERY_MS = 2_000;
const ASK_WITHIN_MS = 8_000;
const FIRST_PAUSE_MS = 500;
const LONGEST_PAUSE_MS = 5_000;
const RESTARTS = 1012; // the code of a websocket whose program is being stopped

/** How long to wait before the nth try in a row: longer each time, and not all pages at once. */
export function pauseBefore_ms(failures, random = Math.random) {
  return Math.min(FIRST_PAUSE_MS * 2 ** Math.min(failures, 10), LONGEST_PAUSE_MS) * (0.5 + random() / 2);
}

function socketAddress(mission) {
  const { protocol, host } = globalThis.location;
  return `${protocol === "https:" ? "wss:" : "ws:"}//${host}/ws/${mission ? `missions/${mission}/` : ""}live`;
}

/**
 * const feed = openFeed({ mission, onChange, onState }); feed.shown.uavs is a Map by id, feed.now_ms() the server's time, feed.close() the end.
 *
 * onChange(touched) after each word: touched is { uavs: Set of ids, … }, or null where everything may be another. onState({ state, since_ms })
 * says how the page is told from now on, since_ms by the server's clock. Without `mission` it is the whole organisation's.
 */
export function openFeed({
  mission = null,
  onChange = () => {},
  onState = () => {},
  Socket = globalThis.WebSocket,
  get = ask,
  clock = serverClock(),
  random = Math.random,
} = {}) {
  const feed = { shown: nothingShown(), state: null, since_ms: 0, now_ms: clock.now_ms, close };
  const address = `/live${mission ? `?mission=${mission}` : ""}`;
  let socket = null;
  let sequence = 0; // of the last word; 0: everything is waited for
  let failures = 0;
  let etag = null;
  let asking = null;
  let isOver = false;
  const timers = { silence: 0, first: 0, connect: 0, ask: 0 };

  function become(state) {
    if (feed.state === state) return;
    feed.state = state;
    feed.since_ms = clock.now_ms();
    onState({ state, since_ms: feed.since_ms });
  }

  function showEverything(live) {
    feed.shown = shownAfterSnapshot(live);
    onChange(null);
  }

  // The websocket

  function connect() {
    if (!Socket || isOver) return;
    sequence = 0;
    const opened = (socket = new Socket(socketAddress(mission)));
    const isCurrent = () => socket === opened && !isOver;
    opened.addEventListener("message", ({ data }) => isCurrent() && hear(JSON.parse(data)));
    opened.addEventListener(
      "close",
      (event) => isCurrent() && (event?.code === RESTARTS && feed.state === LIVE ? comeBack() : lose()),
    );
    expectWord();
    timers.first = setTimeout(startAsking, FIRST_WORD_MS);
  }

  function expectWord() {
    clearTimeout(timers.silence);
    timers.silence = setTimeout(lose, SILENT_MS);
  }

  function hear(word) {
    expectWord();
    clock.heard(word.server_time);
    try {
      if (word.type === "snapshot") begin(word);
      else if (word.sequence !== sequence + (word.type === "changes")) askAgain(word);
      else if (word.type === "changes") {
        sequence = word.sequence;
        onChange(applyChanges(feed.shown, word));
      }
    } finally {
      if (word.type !== "still-there") say({ type: "have", sequence: word.sequence }); // the next but one comes after it
    }
  }

  function begin(word) {
    sequence = word.sequence;
    failures = 0;
    stopAsking();
    become(LIVE);
    showEverything(word.live);
  }

  function askAgain(word) {
    if (sequence || word.type === "still-there") say({ type: "again" }); // once; words between here and the answer are of no use
    sequence = 0;
  }

  function say(word) {
    if (socket?.readyState === Socket.OPEN) socket.send(JSON.stringify(word));
  }

  function lose() {
    hangUp();
    if (feed.state !== ASKED) become(CONNECTING);
    timers.connect = setTimeout(connect, pauseBefore_ms(failures++, random));
    startAsking();
  }

  /** Its program is being stopped, and has told its pages one by one: another one is there. */
  function comeBack() {
    hangUp();
    connect();
  }

  function hangUp() {
    const lost = socket;
    socket = null;
    for (const name of ["silence", "first", "connect"]) clearTimeout(timers[name]);
    if (!lost) return;
    if (lost.readyState === Socket.CONNECTING)
      lost.addEventListener("open", () => lost.close()); // closing one that is not open yet is a fault
    else lost.close();
  }

  // Asking

  function startAsking() {
    if (!asking) askOnce();
  }

  function stopAsking() {
    clearTimeout(timers.first);
    clearTimeout(timers.ask);
    asking?.abort();
    asking = etag = null;
  }

  async function askOnce() {
    const own = (asking = new AbortController());
    const late = setTimeout(() => own.abort(), ASK_WITHIN_MS);
    try {
      const answer = await get(address, { signal: own.signal, headers: etag ? { "If-None-Match": etag } : {} });
      if (own !== asking) return;
      etag = answer.etag;
      if (answer.status !== 304) {
        clock.heard(answer.data.server_time);
        showEverything(answer.data.live);
      }
      become(ASKED);
    } catch (error) {
      if (own !== asking) return;
      if (error.status === 401 || error.status === 403) return end(SIGNED_OUT);
      if (error.status === 404) return end(GONE);
      become(CONNECTING);
    } finally {
      clearTimeout(late);
    }
    timers.ask = setTimeout(askOnce, ASK_EVERY_MS);
  }

  // The end

  function end(state) {
    close();
    become(state);
  }

  function close() {
    isOver = true;
    hangUp();
    stopAsking();
  }

  become(CONNECTING);
  connect();
  if (!Socket) startAsking();
  return feed;
}
