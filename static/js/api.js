/** The one module that fetches: CSRF, the error shape, and words for what went wrong. */

import { t } from "./text.js";

const ROOT = "/api/v1";

export class ApiError extends Error {
  constructor(message, { status = 0, code = "", details = null, retryAfter_s = null } = {}) {
    super(message);
    this.name = "ApiError";
    this.status = status;
    this.code = code;
    this.details = details;
    this.retryAfter_s = retryAfter_s; // where the server says when it may be asked again
  }

  get isAway() {
    return this.status === 0 || this.status === 502 || this.status === 504;
  }

  get isSignedOut() {
    return this.status === 401;
  }
}

const SIGNED_OUT = t("You are signed out. Your selection is kept in this browser.");

/** Also where the session ended and the page's CSRF token with it. */
export function isSignedOut(status, code, message) {
  return status === 401 || (status === 403 && (code === "not_authenticated" || (message ?? "").startsWith("CSRF")));
}

/** The door, and from there back to where the page is now. */
export function signInAddress({ pathname, search = "", hash = "" } = location) {
  return `/sign-in?next=${encodeURIComponent(pathname + search + hash)}`;
}

function cookie(name) {
  const entry = document.cookie.split("; ").find((part) => part.startsWith(`${name}=`));
  return entry ? decodeURIComponent(entry.slice(name.length + 1)) : "";
}

/** First message in DRF's nested details, with the place where it stands. */
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

async function problemOf(response) {
  const status = response.status;
  let error = {};
  try {
    error = (await response.json()).error ?? {};
  } catch {
    /* not our server's answer: the status says what can be said */
  }
  const detail = status === 400 ? firstDetail(error.details) : "";
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

/** request("POST", "/plans", { body }) → { data, status, etag }; 304 comes without data. Throws ApiError; an abort passes as AbortError. */
export async function request(method, path, { body, bytes, headers = {}, signal, keepalive = false } = {}) {
  const address = path.startsWith("http") || path.startsWith("/api/") ? path : ROOT + path;
  const send = {
    method,
    signal,
    keepalive,
    credentials: "same-origin",
    headers: { Accept: "application/json", ...headers },
  };
  if (method !== "GET") send.headers["X-CSRFToken"] = cookie("__Host-csrftoken") || cookie("csrftoken"); // the first over https
  if (body !== undefined) {
    send.headers["Content-Type"] = "application/json";
    send.body = JSON.stringify(body);
  }
  if (bytes !== undefined) {
    send.headers["Content-Type"] = "application/octet-stream";
    send.body = bytes;
  }
  let response;
  try {
    response = await fetch(address, send);
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new ApiError(t("The server cannot be reached."), { code: "server_away" });
  }
  if (response.status === 304) return { data: null, status: 304, etag: response.headers.get("ETag") };
  if (!response.ok) throw await problemOf(response);
  const text = await response.text();
  return { data: text ? JSON.parse(text) : null, status: response.status, etag: response.headers.get("ETag") };
}

export const get = (path, options) => request("GET", path, options);
export const post = (path, body, options) => request("POST", path, { ...options, body });
export const patch = (path, body, options) => request("PATCH", path, { ...options, body });
export const put = (path, body, options) => request("PUT", path, { ...options, body });
/** Raw bytes: a Blob. */
export const putBytes = (path, bytes, options) => request("PUT", path, { ...options, bytes });
export const remove = (path, options) => request("DELETE", path, options);

const pause = (ms, signal) =>
  new Promise((resolve, reject) => {
    const timer = setTimeout(resolve, ms);
    signal?.addEventListener("abort", () => (clearTimeout(timer), reject(new DOMException("stopped", "AbortError"))), {
      once: true,
    });
  });

/** Follows a job until it ends; `onProgress(job)` is told on the way. Returns the job; throws where it failed. */
export async function follow(jobId, { onProgress, signal, every_ms = 700 } = {}) {
  for (;;) {
    const { data: job } = await get(`/jobs/${jobId}`, { signal });
    if (job.state === "failed")
      throw new ApiError(job.error?.message ?? t("The job failed."), { status: 500, code: job.error?.code ?? "" });
    if (job.state === "done" || job.state === "cancelled") return job;
    onProgress?.(job);
    await pause(every_ms, signal);
  }
}
