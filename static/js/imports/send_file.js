/** Upload of a file in parts; it resumes after an interrupted connection. */

import { ApiError, get, post, putBytes } from "../api.js";

/** @import { Answer } from "../api.js" */
/** @import { Upload } from "../api_types.d.ts" */
/** @import { SendHints } from "./types.d.ts" */

const MAX_WAIT_S = 15;
const WORTH_ANOTHER_TRY = new Set([0, 408, 429, 500, 502, 503, 504]);

/**
 * Send a file; returns the upload's id.
 *
 * @param {File} file
 * @param {SendHints & { uploadId?: string | null, onBegun?: (id: string) => void }} options uploadId: of an upload to resume
 * @throws {ApiError} for errors that a retry cannot solve; AbortError if `signal` is aborted
 */
export async function sendFile(file, { uploadId = null, notify, nudge = () => {}, onBegun = () => {}, signal }) {
  /** @type {Upload | null} */
  let upload = null;
  let wait_s = 1;
  for (;;) {
    try {
      /** @type {Upload} */
      const begun = upload ?? (await begin(file, uploadId, signal));
      upload = begun;
      onBegun(begun.id);
      const { id, received_bytes, part_bytes } = begun;
      notify({ received: received_bytes, waits_s: 0 });
      if (begun.is_complete) return id;
      const part = file.slice(received_bytes, Math.min(received_bytes + part_bytes, file.size));
      const address = `/uploads/${id}/bytes/${received_bytes}`;
      upload = /** @type {Answer<Upload>} */ (await putBytes(address, part, { signal })).data;
      wait_s = 1;
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      uploadId = upload?.id ?? uploadId;
      upload = null;
      if (error.code === "gap") continue; // the received size is requested again
      if (!WORTH_ANOTHER_TRY.has(error.status)) throw error;
      await pause(wait_s, { notify, nudge, signal });
      wait_s = Math.min(wait_s * 2, MAX_WAIT_S);
    }
  }
}

/**
 * Runs `act` until the server has answered.
 *
 * @template Result
 * @param {() => Promise<Result>} act
 * @param {SendHints} hints
 */
export async function untilAnswered(act, hints) {
  for (let wait_s = 1; ; wait_s = Math.min(wait_s * 2, MAX_WAIT_S)) {
    try {
      return await act();
    } catch (error) {
      if (!(error instanceof ApiError) || !WORTH_ANOTHER_TRY.has(error.status)) throw error;
      await pause(wait_s, hints);
    }
  }
}

/** @param {File} file @param {string | null} uploadId @param {AbortSignal} [signal] @returns {Promise<Upload>} */
async function begin(file, uploadId, signal) {
  if (uploadId) {
    try {
      const { data } = /** @type {Answer<Upload>} */ (await get(`/uploads/${uploadId}`, { signal }));
      if (data.size_bytes === file.size) return data;
    } catch (error) {
      if (!(error instanceof ApiError) || error.status !== 404) throw error; // 404: deleted after a day
    }
  }
  const body = { file_name: file.name, size_bytes: file.size };
  return /** @type {Answer<Upload>} */ (await post("/uploads", body, { signal })).data;
}

/** @param {number} wait_s @param {SendHints} hints @returns {Promise<void>} */
function pause(wait_s, { notify, nudge = () => {}, signal }) {
  return new Promise((resolve, reject) => {
    let left_s = wait_s;
    /** @param {() => void} act */
    const end = (act) => {
      clearInterval(timer);
      removeEventListener("online", go);
      signal?.removeEventListener("abort", stop);
      act();
    };
    const go = () => end(resolve);
    const stop = () => end(() => reject(new DOMException("stopped", "AbortError")));
    const timer = setInterval(() => {
      left_s -= 1;
      if (left_s <= 0) go();
      else notify({ waits_s: left_s });
    }, 1000);
    notify({ waits_s: left_s });
    nudge(go);
    addEventListener("online", go);
    signal?.addEventListener("abort", stop);
    if (signal?.aborted) stop();
  });
}
