/** Uploads of photos: hashed, announced, sent in parts, two at once. A cut connection is waited for, and the upload continues. */

import { ApiError, post, request } from "../api.js";

/** @import { Answer } from "../api.js" */
/** @import { MediaUpload } from "../api_types.d.ts" */

export const PARALLEL = 2;
const RETRY_MS = [1_000, 2_000, 5_000, 10_000, 20_000, 30_000]; // pauses before the next try; the last one is repeated
const MAX_TRIES = 30; // without a byte in between, some 13 min
const MAX_HASHED_BYTES = 512 * 2 ** 20; // larger files are not hashed in the browser's memory; the server hashes them
const PART_TYPE = "application/offset+octet-stream";

/** @typedef {"waiting" | "sending" | "paused" | "done" | "known" | "failed"} Phase */
/** @typedef {{ file: File, phase: Phase, sent: number, problem: string }} PhotoUpload */
/** @typedef {{ count: number, done: number, known: number, failed: number, share: number, isBusy: boolean, isPaused: boolean, left_s: number | null }} UploadSummary */

/** @param {number} ms @returns {Promise<void>} */
const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** The hash of a file in hexadecimal; empty where the browser cannot compute it. @param {File} file */
export async function sha256Of(file) {
  if (!globalThis.crypto?.subtle || file.size > MAX_HASHED_BYTES) return "";
  const digest = await crypto.subtle.digest("SHA-256", await file.arrayBuffer());
  return [...new Uint8Array(digest)].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** Whether trying again may help. @param {unknown} error */
const isPassing = (error) => error instanceof ApiError && (error.isAway || [429, 503, 507].includes(error.status));

export class UploadQueue {
  /** @type {PhotoUpload[]} */
  items = [];
  #stated;
  #notify;
  #pause;
  #now;
  #running = 0;
  #began_ms = 0;
  #sentBefore = 0; // bytes that were not sent by this page since it began

  /**
   * @param {{ stated: Record<string, unknown>, notify: () => void, pause?: (ms: number) => Promise<void>, now?: () => number }} options
   *   stated: what the photos show, as the API takes it
   */
  constructor({ stated, notify, pause = wait, now = Date.now }) {
    this.#stated = stated;
    this.#notify = notify;
    this.#pause = pause;
    this.#now = now;
  }

  /** Add files, each once. @param {File[]} files @returns {Promise<void>} when all have ended */
  async add(files) {
    const known = new Set(this.items.filter(({ phase }) => phase !== "failed").map(({ file }) => markOf(file)));
    for (const file of files) {
      if (known.has(markOf(file))) continue;
      known.add(markOf(file));
      this.items = this.items.filter((item) => markOf(item.file) !== markOf(file));
      this.items.push({ file, phase: "waiting", sent: 0, problem: "" });
    }
    await this.#run();
  }

  /** Try the failed ones again. */
  async retry() {
    for (const item of this.items) if (item.phase === "failed") Object.assign(item, { phase: "waiting", problem: "" });
    await this.#run();
  }

  /** @returns {UploadSummary} */
  summary() {
    const count = (/** @type {Phase} */ phase) => this.items.filter((item) => item.phase === phase).length;
    const open = this.items.filter(({ phase }) => phase !== "failed");
    const all = open.reduce((sum, { file }) => sum + file.size, 0);
    const sent = open.reduce((sum, item) => sum + item.sent, 0);
    const elapsed_s = (this.#now() - this.#began_ms) / 1000;
    const isBusy = this.#running > 0;
    const rate = (sent - this.#sentBefore) / elapsed_s;
    return {
      count: this.items.length,
      done: count("done"),
      known: count("known"),
      failed: count("failed"),
      share: all ? sent / all : 1,
      isBusy,
      isPaused: isBusy && count("paused") > 0 && count("sending") === 0,
      left_s: isBusy && elapsed_s > 2 && rate > 0 ? (all - sent) / rate : null,
    };
  }

  async #run() {
    if (this.#running === 0) {
      this.#began_ms = this.#now();
      this.#sentBefore = this.items.reduce((sum, item) => sum + item.sent, 0);
    }
    this.#notify();
    /** @type {Promise<void>[]} */
    const workers = [];
    while (this.#running < PARALLEL && workers.length < PARALLEL) {
      this.#running += 1;
      workers.push(
        this.#work().finally(() => {
          this.#running -= 1;
          this.#notify();
        }),
      );
    }
    await Promise.all(workers);
  }

  async #work() {
    for (;;) {
      const item = this.items.find(({ phase }) => phase === "waiting");
      if (!item) return;
      item.phase = "sending";
      this.#notify();
      try {
        await this.#send(item);
      } catch (error) {
        const words = error instanceof Error ? error.message : String(error); // also a file that is no longer there
        Object.assign(item, { phase: "failed", problem: words, sent: 0 });
      }
      this.#notify();
    }
  }

  /** @param {PhotoUpload} item */
  async #send(item) {
    const { file } = item;
    const body = { ...this.#stated, file_name: file.name, size_bytes: file.size, sha256: await sha256Of(file) };
    const answer = await this.#untilAnswered(item, () => post("/media-uploads", body));
    const upload = /** @type {Answer<MediaUpload>} */ (answer).data;
    if (upload.is_known) {
      Object.assign(item, { phase: "known", sent: file.size });
      this.#sentBefore += file.size;
      return;
    }
    item.sent = upload.received_bytes;
    this.#sentBefore += upload.received_bytes;
    await this.#sendParts(item, upload);
    item.phase = "done";
  }

  /** @param {PhotoUpload} item @param {MediaUpload} upload */
  async #sendParts(item, upload) {
    const path = `/media-uploads/${upload.id}`;
    while (item.sent < item.file.size) {
      const bytes = item.file.slice(item.sent, item.sent + upload.part_bytes);
      const headers = { "Content-Type": PART_TYPE, "Upload-Offset": String(item.sent) };
      const end = item.sent + bytes.size;
      await this.#untilAnswered(item, async () => {
        try {
          await request("PATCH", path, { bytes, headers });
          item.sent = end;
        } catch (error) {
          // The part arrived and its answer was lost, or the server has lost a part.
          const received = error instanceof ApiError && error.code === "offset" ? error.details?.received_bytes : null;
          if (typeof received !== "number" || received === item.sent) throw error;
          item.sent = received;
        }
      });
      this.#notify();
    }
  }

  /**
   * @template Result
   * @param {PhotoUpload} item
   * @param {() => Promise<Result>} ask
   * @returns {Promise<Result>}
   */
  async #untilAnswered(item, ask) {
    for (let tries = 0; ; tries += 1) {
      try {
        const answer = await ask();
        item.phase = "sending";
        return answer;
      } catch (error) {
        if (!isPassing(error) || tries >= MAX_TRIES) throw error;
        item.phase = "paused";
        this.#notify();
        const asked_s = /** @type {ApiError} */ (error).retryAfter_s;
        await this.#pause(asked_s ? asked_s * 1000 : RETRY_MS[Math.min(tries, RETRY_MS.length - 1)]);
      }
    }
  }
}

/** A file that is chosen twice is the same one. @param {File} file */
const markOf = ({ name, size, lastModified }) => `${name} ${size} ${lastModified}`;
