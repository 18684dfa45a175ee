/** The one module that fetches: CSRF, the shape of errors, and their texts. */

import { COPY_HEADER, copiedAt } from "./offline_copy.js";
import { t } from "./text.js";

/** @import { Job } from "./api_types.d.ts" */

/**
 * An answer of the server. The caller states the shape of its data by an annotation `Answer<Mission>`.
 *
 * @template [Data=unknown]
 * @typedef {{ data: Data, status: number, etag: string | null }} Answer
 */
/** @typedef {{ body?: unknown, bytes?: Blob, headers?: Record<string, string>, signal?: AbortSignal, keepalive?: boolean }} Options */

const ROOT = "/api/v1";

export class ApiError extends Error {
  /**
   * @param {string} message for the reader
   * @param {{ status?: number, code?: string, details?: any, retryAfter_s?: number | null }} [answer]
   */
  constructor(message, { status = 0, code = "", details = null, retryAfter_s = null } = {}) {
    super(message);
    this.name = "ApiError";
    this.status = status;
    this.code = code;
    this.details = details;
    this.retryAfter_s = retryAfter_s; // if the server sends Retry-After
  }

  get isAway() {
    return this.status === 0 || this.status === 502 || this.status === 504;
  }

  get isSignedOut() {
    return this.status === 401;
  }
}

/** An Idempotency-Key: the same act sent again has the same one. */
export const freshKey = () => crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`;

/** Whether a request was stopped by its signal. @param {unknown} error */
export const isAbort = (error) => error instanceof Error && error.name === "AbortError";

const SIGNED_OUT = t("You are signed out. Your selection is kept in this browser.");

/**
 * Also where the session ended and the page's CSRF token with it.
 *
 * @param {number} status
 * @param {string} [code]
 * @param {string} [message]
 */
export function isSignedOut(status, code, message) {
  return status === 401 || (status === 403 && (code === "not_authenticated" || (message ?? "").startsWith("CSRF")));
}

/**
 * The address of the login page, which leads back to the present page.
 * @param {{ pathname: string, search?: string, hash?: string }} [place]
 */
export function signInAddress({ pathname, search = "", hash = "" } = location) {
  return `/sign-in?next=${encodeURIComponent(pathname + search + hash)}`;
}

/** @param {string} name */
function cookie(name) {
  const entry = document.cookie.split("; ").find((part) => part.startsWith(`${name}=`));
  return entry ? decodeURIComponent(entry.slice(name.length + 1)) : "";
}

/**
 * First message in DRF's nested details, with the path of its field.
 *
 * @param {unknown} details
 * @param {string} [place]
 * @returns {string}
 */
export function firstDetail(details, place = "") {
  if (typeof details === "string") return place ? `${place}: ${details}` : details;
  if (Array.isArray(details)) {
    return details.map((detail) => firstDetail(detail, place)).find(Boolean) ?? "";
  }
  if (details && typeof details === "object") {
    for (const [key, value] of Object.entries(details)) {
      const name = key === "non_field_errors" ? place : [place, key].filter(Boolean).join(" ");
      const found = firstDetail(value, name);
      if (found) return found;
    }
  }
  return "";
}

/** @param {Response} response */
async function problemOf(response) {
  const status = response.status;
  /** @type {{ code?: string, message?: string, details?: unknown }} */
  let error = {};
  try {
    error = (await response.json()).error ?? {};
  } catch {
    /* not our server's answer: only the status is known */
  }
  const detail = status === 400 ? firstDetail(error.details) : "";
  /** @type {Record<number, string>} */
  const words = {
    413: t("That is too much for one request."),
    429: t("Too many requests. Wait a moment, then try again."),
    502: t("The server cannot be reached."),
    504: t("The server did not answer in time."),
  };
  if (isSignedOut(status, error.code, error.message))
    return new ApiError(SIGNED_OUT, { status: 401, code: "not_authenticated" });
  const message = detail || error.message || words[status] || t("The server answered with {status}.", { status });
  const wait = response.headers.get("Retry-After");
  return new ApiError(message, {
    status,
    code: error.code ?? "",
    details: error.details ?? null,
    retryAfter_s: /^\d+$/.test(wait ?? "") ? Number(wait) : null,
  });
}

/** Answers that the server has written into the page, by address: each is taken once. @type {Record<string, unknown>} */
const embedded = JSON.parse(
  (copiedAt === null && globalThis.document?.getElementById?.("answers")?.textContent) || "{}",
);

/**
 * The answer in the page, or to a request that early.js began, once; null where there is none, or where it failed.
 *
 * @param {string} address
 * @returns {Promise<Response | null> | null}
 */
function begunEarly(address) {
  if (address in embedded) {
    const text = JSON.stringify(embedded[address]);
    delete embedded[address];
    return Promise.resolve(new Response(text));
  }
  /** @type {Map<string, Promise<Response>> | undefined} */
  const begun = /** @type {any} */ (globalThis).earlyRequests;
  const answer = begun?.get(address);
  begun?.delete(address);
  return answer?.catch(() => null) ?? null;
}

/**
 * request("POST", "/plans", { body }) → { data, status, etag }; 304 comes without data.
 *
 * @param {string} method
 * @param {string} path below the API's root, or an address that the API has given
 * @param {Options} [options]
 * @returns {Promise<Answer>}
 * @throws {ApiError} an abort passes as AbortError; of an offline copy all but GET are refused here
 */
export async function request(method, path, { body, bytes, headers = {}, signal, keepalive = false } = {}) {
  const address = path.startsWith("http") || path.startsWith("/api/") ? path : ROOT + path;
  if (copiedAt !== null && method !== "GET")
    throw new ApiError(t("This is an offline copy: nothing can be sent."), { code: "offline_copy" });
  /** @type {RequestInit & { headers: Record<string, string> }} */
  const send = {
    method,
    signal,
    keepalive,
    credentials: "same-origin",
    headers: { Accept: "application/json", ...(copiedAt === null ? {} : { [COPY_HEADER]: copiedAt }), ...headers },
  };
  if (method !== "GET") send.headers["X-CSRFToken"] = cookie("__Host-csrftoken") || cookie("csrftoken"); // the first over https
  if (body !== undefined) {
    send.headers["Content-Type"] = "application/json";
    send.body = JSON.stringify(body);
  }
  if (bytes !== undefined) {
    send.headers["Content-Type"] ??= "application/octet-stream";
    send.body = bytes;
  }
  let response;
  try {
    const isPlain = method === "GET" && copiedAt === null && !signal && Object.keys(headers).length === 0;
    response = (isPlain && (await begunEarly(address))) || (await fetch(address, send));
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    throw new ApiError(t("The server cannot be reached."), { code: "server_away" });
  }
  if (response.status === 304) return { data: null, status: 304, etag: response.headers.get("ETag") };
  if (!response.ok) throw await problemOf(response);
  const text = await response.text();
  return { data: text ? JSON.parse(text) : null, status: response.status, etag: response.headers.get("ETag") };
}

/** @param {string} path @param {Options} [options] */
export const get = (path, options) => request("GET", path, options);
/** @param {string} path @param {unknown} [body] @param {Options} [options] */
export const post = (path, body, options) => request("POST", path, { ...options, body });
/** @param {string} path @param {unknown} body @param {Options} [options] */
export const patch = (path, body, options) => request("PATCH", path, { ...options, body });
/** @param {string} path @param {unknown} body @param {Options} [options] */
export const put = (path, body, options) => request("PUT", path, { ...options, body });
/** @param {string} path @param {Blob} bytes @param {Options} [options] */
export const putBytes = (path, bytes, options) => request("PUT", path, { ...options, bytes });
/** @param {string} path @param {Options} [options] */
export const remove = (path, options) => request("DELETE", path, options);

/** @param {number} ms @param {AbortSignal} [signal] @returns {Promise<void>} */
const pause = (ms, signal) =>
  new Promise((resolve, reject) => {
    const timer = setTimeout(resolve, ms);
    const stop = () => {
      clearTimeout(timer);
      reject(new DOMException("stopped", "AbortError"));
    };
    signal?.addEventListener("abort", stop, { once: true });
  });

/**
 * Follows a job until it ends, and returns it. `onProgress(job)` is called on the way.
 *
 * @param {string} jobId
 * @param {{ onProgress?: (job: Job) => void, signal?: AbortSignal, every_ms?: number }} [options]
 * @returns {Promise<Job>}
 * @throws {ApiError} if it failed
 */
export async function follow(jobId, { onProgress, signal, every_ms = 700 } = {}) {
  for (;;) {
    const { data: job } = /** @type {Answer<Job>} */ (await get(`/jobs/${jobId}`, { signal }));
    if (job.state === "failed")
      throw new ApiError(job.error?.message ?? t("The job failed."), { status: 500, code: job.error?.code ?? "" });
    if (job.state === "done" || job.state === "cancelled") return job;
    onProgress?.(job);
    await pause(every_ms, signal);
  }
}
