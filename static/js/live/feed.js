/** The feed of a live page: over a websocket, by polling every two seconds where there is none; it always reports which. */

import { get as ask } from "../api.js";
import { serverClock } from "./server_clock.js";
import { applyChanges, nothingShown, shownAfterSnapshot } from "./shown.js";

/** @import { Answer, ApiError } from "../api.js" */
/** @import { Live, LiveAnswer } from "../api_types.d.ts" */
/** @import { Changes, Touched } from "./shown.js" */

/** @typedef {"live" | "asked" | "crowded" | "connecting" | "signed-out" | "gone"} FeedState */

export const LIVE = "live"; // notified of each change at once
export const ASKED = "asked"; // by HTTP, every two seconds
export const CROWDED = "crowded"; // by HTTP, too: this user, or this network, has the maximum of open websockets
export const CONNECTING = "connecting"; // neither: the data on the page are as old as their times
export const SIGNED_OUT = "signed-out"; // for good
export const GONE = "gone"; // the mission is deleted: for good

export const FEED_LOST_MS = 5_000; // the server sends a heartbeat every 2 s: after that the page has no data
const AHEAD_MS = 2_500; // the time shown is at most this far ahead of the last message
const CONNECT_WITHIN_MS = 15_000; // until the first message of a websocket
const FIRST_MESSAGE_MS = 3_000; // after this the page polls, while it waits for the socket
const ASK_EVERY_MS = 2_000;
const ASK_WITHIN_MS = 8_000;
const FIRST_PAUSE_MS = 500;
const MAX_PAUSE_MS = 5_000;
const RESTARTS = 1012; // close code of a websocket whose server process is stopping
const TOO_MANY = 4429; // after a refusal because too many are open
const CROWDED_PAUSE_MS = 60_000; // then the page tries again: others may have been closed

/**
 * A message of the server: a snapshot, changes, or that it is still there.
 *
 * @typedef {{ type: string, sequence: number, server_time: string, live: Live } & Changes} Message
 */
/**
 * @typedef {object} FeedOptions
 * @property {string | null} [mission] without it the feed is the whole organisation's
 * @property {(touched: Touched | null) => void} [onChange] called after each message; null where everything may have changed
 * @property {(state: { state: FeedState, since_ms: number }) => void} [onState] how the page receives data from now on
 * @property {typeof WebSocket} [Socket]
 * @property {typeof ask} [get]
 * @property {ReturnType<typeof serverClock>} [clock]
 * @property {() => number} [random] 0 to 1
 */

/**
 * Pause before the nth retry in a row [ms]: longer each time, with jitter between pages.
 *
 * @param {number} failures
 * @param {() => number} [random]
 */
export function pauseBefore_ms(failures, random = Math.random) {
  return Math.min(FIRST_PAUSE_MS * 2 ** Math.min(failures, 10), MAX_PAUSE_MS) * (0.5 + random() / 2);
}

/** @param {string | null} mission */
function socketAddress(mission) {
  const { protocol, host } = globalThis.location;
  return `${protocol === "https:" ? "wss:" : "ws:"}//${host}/ws/${mission ? `missions/${mission}/` : ""}live`;
}

/**
 * The socket that early.js has opened to an address, once, and what has come over it; null where there is none, or where it was lost.
 *
 * @param {string} address
 * @returns {{ socket: WebSocket, messages: string[] } | null}
 */
function openedEarly(address) {
  /** @type {{ socket: WebSocket, take: () => string[] } | undefined} */
  const early = /** @type {any} */ (globalThis).earlySocket;
  if (early?.socket.url !== address) return null;
  delete (/** @type {any} */ (globalThis).earlySocket);
  const { socket } = early;
  const isThere = socket.readyState === socket.CONNECTING || socket.readyState === socket.OPEN;
  return isThere ? { socket, messages: early.take() } : null;
}

/**
 * Opens a feed: feed.shown.uavs is a Map by id, feed.now_ms() the server's time, feed.close() the end.
 *
 * @param {FeedOptions} [options]
 */
export const openFeed = (options) => new Feed(options);

class Feed {
  #mission;
  #onChange;
  #onState;
  #Socket;
  #get;
  #clock;
  #random;
  /** @type {WebSocket | null} */
  #socket = null;
  #sequence = 0; // of the last message; 0: everything is waited for
  #failures = 0;
  /** @type {string | null} */
  #etag = null;
  /** @type {AbortController | null} */
  #asking = null;
  #isOver = false;
  #isCrowded = false; // the last websocket was refused because too many are open
  /** @type {Partial<Record<"silence" | "first" | "connect" | "ask", ReturnType<typeof setTimeout>>>} */
  #timers = {};

  shown = nothingShown();
  /** @type {FeedState | null} */
  state = null;
  /** When the last message arrived, by the server's clock; null before the first. @type {number | null} */
  received_ms = null;
  since_ms = 0; // by the server's clock

  /** @param {FeedOptions} [options] */
  constructor({
    mission = null,
    onChange = () => {},
    onState = () => {},
    Socket = globalThis.WebSocket,
    get = ask,
    clock = serverClock(),
    random = Math.random,
  } = {}) {
    this.#mission = mission;
    this.#onChange = onChange;
    this.#onState = onState;
    this.#Socket = Socket;
    this.#get = get;
    this.#clock = clock;
    this.#random = random;
    this.now_ms = clock.now_ms;
    this.#become(CONNECTING);
    this.#connect();
    if (!Socket) this.#startAsking();
  }

  /** Time since the last message [ms]; 0 before the first: no data are shown yet. */
  silent_ms() {
    return this.received_ms === null ? 0 : Math.max(0, this.#clock.now_ms() - this.received_ms);
  }

  /** The time of the data shown: without a connection, that of the last message. */
  shown_ms() {
    const now_ms = this.#clock.now_ms();
    if (this.received_ms === null) return now_ms;
    return this.silent_ms() >= FEED_LOST_MS ? this.received_ms : Math.min(now_ms, this.received_ms + AHEAD_MS);
  }

  #noteReceived() {
    this.received_ms = this.#clock.now_ms();
  }

  close() {
    this.#isOver = true;
    this.#hangUp();
    this.#stopAsking();
  }

  /** @param {FeedState} state */
  #become(state) {
    if (this.state === state) return;
    this.state = state;
    this.since_ms = this.#clock.now_ms();
    this.#onState({ state, since_ms: this.since_ms });
  }

  /** @param {FeedState} state */
  #end(state) {
    this.close();
    this.#become(state);
  }

  /** @param {Live} live */
  #showEverything(live) {
    this.shown = shownAfterSnapshot(live);
    this.#onChange(null);
  }

  // --- the websocket

  #connect() {
    if (!this.#Socket || this.#isOver) return;
    this.#sequence = 0;
    const address = socketAddress(this.#mission);
    const early = openedEarly(address);
    const opened = early?.socket ?? new this.#Socket(address);
    this.#socket = opened;
    const isCurrent = () => this.#socket === opened && !this.#isOver;
    opened.addEventListener("message", ({ data }) => {
      if (isCurrent()) this.#receive(JSON.parse(data));
    });
    opened.addEventListener("close", (event) => {
      if (!isCurrent()) return;
      this.#isCrowded = event?.code === TOO_MANY;
      if (event?.code === RESTARTS && this.state === LIVE) this.#reconnect();
      else this.#lose();
    });
    this.#expectMessage(CONNECT_WITHIN_MS);
    this.#timers.first = setTimeout(() => this.#startAsking(), FIRST_MESSAGE_MS);
    queueMicrotask(() => {
      for (const data of early?.messages ?? []) if (isCurrent()) this.#receive(JSON.parse(data));
    });
  }

  #expectMessage(within_ms = FEED_LOST_MS) {
    clearTimeout(this.#timers.silence);
    this.#timers.silence = setTimeout(() => this.#lose(), within_ms);
  }

  /** @param {Message} message */
  #receive(message) {
    this.#expectMessage();
    this.#clock.received(message.server_time);
    this.#noteReceived();
    try {
      if (message.type === "snapshot") this.#begin(message);
      else if (message.sequence !== this.#sequence + (message.type === "changes" ? 1 : 0)) this.#askAgain(message);
      else if (message.type === "changes") {
        this.#sequence = message.sequence;
        this.#onChange(applyChanges(this.shown, message));
      }
    } finally {
      // the next but one comes after it
      if (message.type !== "keepalive") this.#send({ type: "ack", sequence: message.sequence });
    }
  }

  /** @param {Message} snapshot */
  #begin(snapshot) {
    this.#sequence = snapshot.sequence;
    this.#failures = 0;
    this.#isCrowded = false;
    this.#stopAsking();
    this.#become(LIVE);
    this.#showEverything(snapshot.live);
  }

  /** Request everything once: messages before the answer are dropped. @param {Message} message */
  #askAgain(message) {
    if (this.#sequence || message.type === "keepalive") this.#send({ type: "resync" });
    this.#sequence = 0;
  }

  /** @param {object} message */
  #send(message) {
    if (this.#socket?.readyState === this.#Socket.OPEN) this.#socket.send(JSON.stringify(message));
  }

  #lose() {
    this.#hangUp();
    if (this.state !== ASKED && this.state !== CROWDED) this.#become(CONNECTING);
    const pause_ms = this.#isCrowded
      ? CROWDED_PAUSE_MS * (0.5 + this.#random() / 2)
      : pauseBefore_ms(this.#failures, this.#random);
    this.#failures += 1;
    this.#timers.connect = setTimeout(() => this.#connect(), pause_ms);
    this.#startAsking();
  }

  /** The server process is stopping and notifies its pages one by one; another process is available. */
  #reconnect() {
    this.#hangUp();
    this.#connect();
  }

  #hangUp() {
    const lost = this.#socket;
    this.#socket = null;
    clearTimeout(this.#timers.silence);
    clearTimeout(this.#timers.first);
    clearTimeout(this.#timers.connect);
    if (!lost) return;
    if (lost.readyState === this.#Socket.CONNECTING)
      lost.addEventListener("open", () => lost.close()); // closing one that is not open yet is a fault
    else lost.close();
  }

  // --- asking by HTTP

  #startAsking() {
    if (!this.#asking) this.#askOnce();
  }

  #stopAsking() {
    clearTimeout(this.#timers.first);
    clearTimeout(this.#timers.ask);
    this.#asking?.abort();
    this.#asking = null;
    this.#etag = null;
  }

  async #askOnce() {
    const own = new AbortController();
    this.#asking = own;
    const late = setTimeout(() => own.abort(), ASK_WITHIN_MS);
    const address = `/live${this.#mission ? `?mission=${this.#mission}` : ""}`;
    const headers = this.#etag ? { "If-None-Match": this.#etag } : undefined;
    try {
      const answer = /** @type {Answer<LiveAnswer>} */ (await this.#get(address, { signal: own.signal, headers }));
      if (own !== this.#asking) return;
      this.#etag = answer.etag;
      if (answer.status !== 304) this.#clock.received(answer.data.server_time);
      this.#noteReceived();
      if (answer.status !== 304) this.#showEverything(answer.data.live);
      this.#become(this.#isCrowded ? CROWDED : ASKED);
    } catch (error) {
      if (own !== this.#asking) return;
      const { status } = /** @type {Partial<ApiError>} */ (error);
      if (status === 401 || status === 403) {
        this.#end(SIGNED_OUT);
        return;
      }
      if (status === 404) {
        this.#end(GONE);
        return;
      }
      this.#become(CONNECTING);
    } finally {
      clearTimeout(late);
    }
    this.#timers.ask = setTimeout(() => this.#askOnce(), ASK_EVERY_MS);
  }
}
