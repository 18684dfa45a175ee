/** Whether this page is an offline copy: then it shows what was kept at one time, and sends nothing. */

export const COPY_HEADER = "X-Offline-Copy"; // as in offline/service_worker.js

/** When what is shown was kept, ISO 8601; null on a page of the server. @type {string | null} */
export const copiedAt = globalThis.document?.documentElement.dataset.offlineCopy ?? null;
