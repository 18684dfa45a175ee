/** The address of a moment and a camera: ?source=…&t=…&uav=…&camera=…&view=…, written and read. */

import { CAMERAS } from "./cameras/rig.js";

/** @import { CameraMode } from "./cameras/rig.js" */
/** @import { SourceKind, Vector, WantedSource } from "./types.d.ts" */

/**
 * The camera of a link. view: bearing, elevation [deg] and distance [m]; place: lon, lat, height above sea level of a free camera.
 *
 * @typedef {{ mode: CameraMode, view: Vector | null, place: Vector | null, offset: Vector | null }} LinkedCamera
 */
/** @typedef {ReturnType<typeof readLink>} SceneLink */

/** @type {SourceKind[]} */
const SOURCES = ["record", "live", "rehearsal", "plan"];
const KEY = /^[0-9a-f-]{1,36}$/i;

/**
 * "rehearsal:{id}:{run}" → { kind, rehearsal, run }; a missing part is null: the newest rehearsal, the worst of its runs.
 *
 * @param {string | null} text
 * @returns {WantedSource | null}
 */
export function readSource(text) {
  const [summary, rehearsal = "", run = ""] = (text ?? "").split(":");
  const kind = SOURCES.find((one) => one === summary);
  if (!kind) return null;
  if (kind !== "rehearsal") return { kind, rehearsal: null, run: null };
  return { kind, rehearsal: KEY.test(rehearsal) ? rehearsal : null, run: /^\d{1,3}$/.test(run) ? Number(run) : null };
}

/** @param {WantedSource} source */
export const sourceText = ({ kind, rehearsal, run }) =>
  [
    kind,
    ...(kind === "rehearsal" && rehearsal ? [rehearsal, ...(run === null || run === undefined ? [] : [run])] : []),
  ].join(":");

/** Three figures, or null for any other text. @param {string | null} text @returns {Vector | null} */
const figures = (text) => {
  const found = (text ?? "").split(",").map(Number);
  return text && found.length === 3 && found.every(Number.isFinite) ? [found[0], found[1], found[2]] : null;
};
/** @param {number} value @param {number} digits */
const round = (value, digits) => `${Number(value.toFixed(digits))}`;

/**
 * The state in a link. at_ms of a moment in UTC, since_s after departure; each is null where the address does not state it.
 *
 * @param {string} search
 */
export function readLink(search) {
  const summary = new URLSearchParams(search);
  const t = summary.get("t") ?? "";
  const isSeconds = /^-?\d+(\.\d+)?$/.test(t);
  const moment = isSeconds ? NaN : Date.parse(t);
  /** @param {string} name */
  const number = (name) => (/^\d{1,4}$/.test(summary.get(name) ?? "") ? Number(summary.get(name)) : null);
  const mode = CAMERAS.find((one) => one === summary.get("camera"));
  /** @type {LinkedCamera | null} */
  const camera = mode
    ? {
        mode,
        view: figures(summary.get("view")),
        place: figures(summary.get("from")),
        offset: figures(summary.get("offset")),
      }
    : null;
  return {
    source: readSource(summary.get("source")),
    at_ms: Number.isNaN(moment) ? null : moment,
    since_s: isSeconds ? Number(t) : null,
    uav: number("uav"),
    target: number("target"),
    camera,
  };
}

/**
 * The search part of an address; offset and place only where they are not as usual.
 *
 * @param {object} moment
 * @param {WantedSource} moment.source
 * @param {number | null} [moment.at_ms]
 * @param {number | null} [moment.since_s]
 * @param {number | null} [moment.uav]
 * @param {number | null} [moment.target]
 * @param {{ mode: CameraMode, bearing_deg: number, elevation_deg: number, distance_m: number, place?: Vector | null, offset?: Vector } | null} [moment.camera]
 */
export function linkText({ source, at_ms = null, since_s = null, uav = null, target = null, camera = null }) {
  const summary = new URLSearchParams();
  summary.set("source", sourceText(source));
  if (since_s !== null) summary.set("t", round(since_s, 1));
  else if (at_ms !== null) summary.set("t", new Date(at_ms).toISOString());
  if (uav !== null) summary.set("uav", `${uav}`);
  if (target !== null) summary.set("target", `${target}`);
  if (camera) {
    summary.set("camera", camera.mode);
    summary.set(
      "view",
      [round(camera.bearing_deg, 1), round(camera.elevation_deg, 1), round(camera.distance_m, 1)].join(","),
    );
    if (camera.place)
      summary.set("from", [round(camera.place[0], 6), round(camera.place[1], 6), round(camera.place[2], 1)].join(","));
    if (camera.offset?.some((metres) => Math.abs(metres) > 0.05))
      summary.set("offset", camera.offset.map((metres) => round(metres, 1)).join(","));
  }
  return `?${`${summary}`.replaceAll("%2C", ",").replaceAll("%3A", ":")}`;
}
