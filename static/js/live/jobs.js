/** Following a job as the server tells it, over its websocket; by asking again and again where there is none. */

import { ApiError, follow } from "../api.js";
import { t } from "../text.js";

const SILENT_MS = 45_000; // the server says now and then that it is still there

function socketAddress(jobId) {
  const { protocol, host } = globalThis.location;
  return `${protocol === "https:" ? "wss:" : "ws:"}//${host}/ws/jobs/${jobId}`;
}

/** The job once it has ended; null where the socket closes before that or never opens. */
function listen(jobId, { onProgress, signal, Socket }) {
  return new Promise((resolve, reject) => {
    const socket = new Socket(socketAddress(jobId));
    let timer = 0;
    const hangUp = () => {
      clearTimeout(timer);
      if (socket.readyState === Socket.CONNECTING)
        socket.addEventListener("open", () => socket.close()); // closing one that is not open yet is a fault
      else socket.close();
    };
    const finish = (settle, value) => (hangUp(), settle(value));
    const wait = () => {
      clearTimeout(timer);
      timer = setTimeout(finish, SILENT_MS, resolve, null);
    };
    signal?.addEventListener("abort", () => finish(reject, new DOMException("stopped", "AbortError")), { once: true });
    socket.addEventListener("message", ({ data }) => {
      wait();
      const { type, job } = JSON.parse(data);
      if (type !== "job") return;
      if (job.state === "failed")
        finish(
          reject,
          new ApiError(job.error?.message ?? t("The job failed."), { status: 500, code: job.error?.code ?? "" }),
        );
      else if (job.state === "done" || job.state === "cancelled") finish(resolve, job);
      else onProgress?.(job);
    });
    socket.addEventListener("close", () => finish(resolve, null));
    wait();
  });
}

/** Follows a job until it ends, like follow in api.js; what the socket cannot tell is asked for. */
export async function followLive(jobId, { onProgress, signal, Socket = globalThis.WebSocket } = {}) {
  if (signal?.aborted) throw new DOMException("stopped", "AbortError");
  const ended = Socket ? await listen(jobId, { onProgress, signal, Socket }) : null;
  return ended ?? follow(jobId, { onProgress, signal });
}
