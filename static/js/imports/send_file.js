/** Sends a file part by part; a cut connection goes on where it was. */

import { ApiError, get, post, putBytes } from "../api.js";

const LONGEST_WAIT_S = 15;
const WORTH_ANOTHER_TRY = new Set([0, 408, 429, 500, 502, 503, 504]);

/**
 * file: a File. uploadId: one that was begun before, or null. tell({ received, waits_s }) hears how far it is, and that it waits for the
 * connection. nudge(wake) is given a function that ends such a wait. Returns the upload's id; throws ApiError for what another try does
 * not mend, AbortError where `signal` says so.
 */
export async function sendFile(file, { uploadId = null, tell, nudge = () => {}, onBegun = () => {}, signal }) {
  let upload = null;
  let wait_s = 1;
  for (;;) {
    try {
      upload ??= await begin(file, uploadId, signal);
      onBegun(upload.id);
      tell({ received: upload.received_bytes, waits_s: 0 });
      if (upload.is_complete) return upload.id;
      const end = Math.min(upload.received_bytes + upload.part_bytes, file.size);
      const part = file.slice(upload.received_bytes, end);
      ({ data: upload } = await putBytes(`/uploads/${upload.id}/bytes/${upload.received_bytes}`, part, { signal }));
      wait_s = 1;
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      uploadId = upload?.id ?? uploadId;
      upload = null;
      if (error.code === "gap") continue; // asked again how much is there
      if (!WORTH_ANOTHER_TRY.has(error.status)) throw error;
      await pause(wait_s, { tell, nudge, signal });
      wait_s = Math.min(wait_s * 2, LONGEST_WAIT_S);
    }
  }
}

/** Runs `act` until the server has answered; the same hints as above. */
export async function untilAnswered(act, hints) {
  for (let wait_s = 1; ; wait_s = Math.min(wait_s * 2, LONGEST_WAIT_S)) {
    try {
      return await act();
    } catch (error) {
      if (!(error instanceof ApiError) || !WORTH_ANOTHER_TRY.has(error.status)) throw error;
      await pause(wait_s, hints);
    }
  }
}

async function begin(file, uploadId, signal) {
  if (uploadId) {
    try {
      const { data } = await get(`/uploads/${uploadId}`, { signal });
      if (data.size_bytes === file.size) return data;
    } catch (error) {
      if (!(error instanceof ApiError) || error.status !== 404) throw error; // 404: it was forgotten after a day
    }
  }
  return (await post("/uploads", { file_name: file.name, size_bytes: file.size }, { signal })).data;
}

function pause(wait_s, { tell, nudge = () => {}, signal }) {
  return new Promise((resolve, reject) => {
    let left_s = wait_s;
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
      else tell({ waits_s: left_s });
    }, 1000);
    tell({ waits_s: left_s });
    nudge(go);
    addEventListener("online", go);
    signal?.addEventListener("abort", stop);
    if (signal?.aborted) stop();
  });
}
