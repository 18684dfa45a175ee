/** Whether this page is an offline copy: it then shows the state of one moment, and sends nothing. */

export const COPY_HEADER = "X-Offline-Copy"; // as in offline/service_worker.js

/** When the data shown were stored, ISO 8601; null on a page of the server. @type {string | null} */
export const copiedAt = globalThis.document?.documentElement.dataset.offlineCopy ?? null;
