/** The address of a moment and a camera: ?source=…&t=…&uav=…&camera=…&view=…, written and read. */

import { CAMERAS } from "./cameras/rig.js";

/** @import { CameraMode } from "./cameras/rig.js" */
/** @import { SourceKind, Vector, WantedSource } from "./types.d.ts" */

/**
 * A camera as a link says it: view: bearing, elevation [deg] and distance [m]; place: lon, lat, height above sea level of a free one.
 *
 * @typedef {{ mode: CameraMode, view: Vector | null, place: Vector | null, offset: Vector | null }} LinkedCamera
 */
/** @typedef {ReturnType<typeof readLink>} SceneLink */

/** @type {SourceKind[]} */
const SOURCES = ["record", "live", "rehearsal", "plan"];
const KEY = /^[0-9a-f-]{1,36}$/i;

/**
 * "rehearsal:{id}:{run}" → { kind, rehearsal, run }; what is missing is null: the newest one, the worst of its runs.
 *
 * @param {string | null} text
 * @returns {WantedSource | null}
 */
export function readSource(text) {
  const [said, rehearsal = "", run = ""] = (text ?? "").split(":");
  const kind = SOURCES.find((one) => one === said);
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

/** Three figures, or null where the text is something else. @param {string | null} text @returns {Vector | null} */
const figures = (text) => {
  const found = (text ?? "").split(",").map(Number);
  return text && found.length === 3 && found.every(Number.isFinite) ? [found[0], found[1], found[2]] : null;
};
/** @param {number} value @param {number} digits */
const round = (value, digits) => `${Number(value.toFixed(digits))}`;

/**
 * at_ms of a moment in UTC, since_s after departure; each is null where the address does not say it.
 *
 * @param {string} search
 */
export function readLink(search) {
  const said = new URLSearchParams(search);
  const t = said.get("t") ?? "";
  const isSeconds = /^-?\d+(\.\d+)?$/.test(t);
  const moment = isSeconds ? NaN : Date.parse(t);
  /** @param {string} name */
  const number = (name) => (/^\d{1,4}$/.test(said.get(name) ?? "") ? Number(said.get(name)) : null);
  const mode = CAMERAS.find((one) => one === said.get("camera"));
  /** @type {LinkedCamera | null} */
  const camera = mode
    ? {
        mode,
        view: figures(said.get("view")),
        place: figures(said.get("from")),
        offset: figures(said.get("offset")),
      }
    : null;
  return {
    source: readSource(said.get("source")),
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
  const said = new URLSearchParams();
  said.set("source", sourceText(source));
  if (since_s !== null) said.set("t", round(since_s, 1));
  else if (at_ms !== null) said.set("t", new Date(at_ms).toISOString());
  if (uav !== null) said.set("uav", `${uav}`);
  if (target !== null) said.set("target", `${target}`);
  if (camera) {
    said.set("camera", camera.mode);
    said.set(
      "view",
      [round(camera.bearing_deg, 1), round(camera.elevation_deg, 1), round(camera.distance_m, 1)].join(","),
    );
    if (camera.place)
      said.set("from", [round(camera.place[0], 6), round(camera.place[1], 6), round(camera.place[2], 1)].join(","));
    if (camera.offset?.some((metres) => Math.abs(metres) > 0.05))
      said.set("offset", camera.offset.map((metres) => round(metres, 1)).join(","));
  }
  return `?${`${said}`.replaceAll("%2C", ",").replaceAll("%3A", ":")}`;
}
