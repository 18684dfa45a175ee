/** Following a job over its websocket; by polling where there is none. */

import { ApiError, follow } from "../api.js";
import { t } from "../text.js";

/** @import { Job } from "../api_types.d.ts" */

/** @typedef {{ onProgress?: (job: Job) => void, signal?: AbortSignal }} Following */

const SILENT_MS = 45_000; // the server sends keepalives

/** @param {string} jobId */
function socketAddress(jobId) {
  const { protocol, host } = globalThis.location;
  return `${protocol === "https:" ? "wss:" : "ws:"}//${host}/ws/jobs/${jobId}`;
}

/**
 * The job once it has ended; null where the socket closes before that or never opens.
 *
 * @param {string} jobId
 * @param {Following & { Socket: typeof WebSocket }} options
 * @returns {Promise<Job | null>}
 */
function listen(jobId, { onProgress, signal, Socket }) {
  return new Promise((resolve, reject) => {
    const socket = new Socket(socketAddress(jobId));
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    let timer;
    const hangUp = () => {
      clearTimeout(timer);
      if (socket.readyState === Socket.CONNECTING)
        socket.addEventListener("open", () => socket.close()); // closing one that is not open yet is a fault
      else socket.close();
    };
    /** @param {Job | null} job */
    const finish = (job) => {
      hangUp();
      resolve(job);
    };
    /** @param {Error} error */
    const fail = (error) => {
      hangUp();
      reject(error);
    };
    const wait = () => {
      clearTimeout(timer);
      timer = setTimeout(finish, SILENT_MS, null);
    };
    signal?.addEventListener("abort", () => fail(new DOMException("stopped", "AbortError")), { once: true });
    socket.addEventListener("message", ({ data }) => {
      wait();
      /** @type {{ type: string, job: Job }} */
      const { type, job } = JSON.parse(data);
      if (type !== "job") return;
      if (job.state === "failed")
        fail(new ApiError(job.error?.message ?? t("The job failed."), { status: 500, code: job.error?.code ?? "" }));
      else if (job.state === "done" || job.state === "cancelled") finish(job);
      else onProgress?.(job);
    });
    socket.addEventListener("close", () => finish(null));
    wait();
  });
}

/**
 * Follow a job until it ends, like follow in api.js; requests what the socket cannot deliver.
 *
 * @param {string} jobId
 * @param {Following & { Socket?: typeof WebSocket }} [options]
 */
export async function followLive(jobId, { onProgress, signal, Socket = globalThis.WebSocket } = {}) {
  if (signal?.aborted) throw new DOMException("stopped", "AbortError");
  const ended = Socket ? await listen(jobId, { onProgress, signal, Socket }) : null;
  return ended ?? follow(jobId, { onProgress, signal });
}
