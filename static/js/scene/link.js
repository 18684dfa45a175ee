/** The address of a moment and a camera: ?source=…&t=…&uav=…&camera=…&view=…, written and read. */

import { CAMERAS } from "./cameras/rig.js";

const SOURCES = ["record", "live", "rehearsal", "plan"];
const KEY = /^[0-9a-f-]{1,36}$/i;

/** "rehearsal:{id}:{run}" → { kind, rehearsal, run }; what is missing is null: the newest one, the worst of its runs. */
export function readSource(text) {
  const [kind, rehearsal = "", run = ""] = (text ?? "").split(":");
  if (!SOURCES.includes(kind)) return null;
  if (kind !== "rehearsal") return { kind, rehearsal: null, run: null };
  return { kind, rehearsal: KEY.test(rehearsal) ? rehearsal : null, run: /^\d{1,3}$/.test(run) ? Number(run) : null };
}

export const sourceText = ({ kind, rehearsal, run }) =>
  [
    kind,
    ...(kind === "rehearsal" && rehearsal ? [rehearsal, ...(run === null || run === undefined ? [] : [run])] : []),
  ].join(":");

const figures = (text, count) => {
  const found = (text ?? "").split(",").map(Number);
  return text && found.length === count && found.every(Number.isFinite) ? found : null;
};
const round = (value, digits) => `${Number(value.toFixed(digits))}`;

/**
 * → { source, at_ms, since_s, uav, target, camera }: at_ms of a moment in UTC, since_s after departure, each null where the address does not
 * say it; camera: { mode, bearing_deg, elevation_deg, distance_m, place: [lon, lat, altitude_amsl_m] | null, offset } or null.
 */
export function readLink(search) {
  const said = new URLSearchParams(search);
  const t = said.get("t") ?? "";
  const isSeconds = /^-?\d+(\.\d+)?$/.test(t);
  const moment = isSeconds ? NaN : Date.parse(t);
  const number = (name) => (/^\d{1,4}$/.test(said.get(name) ?? "") ? Number(said.get(name)) : null);
  const mode = CAMERAS.includes(said.get("camera")) ? said.get("camera") : null;
  const view = figures(said.get("view"), 3);
  return {
    source: readSource(said.get("source")),
    at_ms: Number.isNaN(moment) ? null : moment,
    since_s: isSeconds ? Number(t) : null,
    uav: number("uav"),
    target: number("target"),
    camera: mode && { mode, view, place: figures(said.get("from"), 3), offset: figures(said.get("offset"), 3) },
  };
}

/** The search part of an address; offset and place only where they are not as usual. */
export function linkText({ source, at_ms = null, since_s = null, uav = null, target = null, camera = null }) {
  const said = new URLSearchParams();
  said.set("source", sourceText(source));
  if (since_s !== null) said.set("t", round(since_s, 1));
  else if (at_ms !== null) said.set("t", new Date(at_ms).toISOString());
  if (uav !== null) said.set("uav", uav);
  if (target !== null) said.set("target", target);
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
