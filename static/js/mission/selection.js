/** What is to be flown, as plain values: targets, UAVs, options; and its shape on the wire. */

import { t } from "../text.js";
import { lengthText } from "../units.js";

export const EMPTY = Object.freeze({ targets: [], uavs: [], objective: "makespan", return_to_start: true });

/** Two picks of the same place are one target: the asset whole, or one point of it. */
export function keyOf({ asset, position, stretch }) {
  const places = stretch ?? (position ? [position] : []);
  return [asset ?? "place", ...places.map((place) => place.map((degrees) => degrees.toFixed(5)).join(","))].join(" ");
}

/** A target from an asset feature of the API or a tile. `position` makes it one point of a line or railway. */
export function targetOf({ id, kind, properties, centre = null, position = null, stretch = null, task = null }) {
  const target = { asset: id, kind, label: properties.label || kind, detail: detailOf(kind, properties, position, stretch), position, stretch, centre: position ?? centre, task };
  return { key: keyOf(target), ...target };
}

/** A target from a short row of the API: a list, an area, a stretch. */
export function targetOfRow({ id, kind, centre, ...properties }) {
  return targetOf({ id, kind, properties, centre });
}

/** How much of a line or railway is picked. OpenStreetMap cuts railways into sections: one of them is not the whole track. */
export function extentOf(kind, length_m, position = null, stretch = null) {
  const whole = { line: t("whole line"), railway: t("section") }[kind];
  if (!whole || position) return whole && t("one point");
  const words = stretch ? t("stretch") : whole;
  return length_m ? `${words}, ${lengthText(length_m)}` : words;
}

/** The second fact of a row, in secondary ink: how much of a line or railway is picked, then what the server says of the asset. */
export function detailOf(kind, { detail, length_m }, position = null, stretch = null) {
  return [extentOf(kind, length_m, position, stretch), detail].filter(Boolean).join(" · ");
}

/** Label and second fact in one, of a target or of an asset's properties. */
export function nameOf({ label, detail }) {
  return detail ? `${label}, ${detail}` : label;
}

export function isWhole(target) {
  return (target.kind === "line" || target.kind === "railway") && !target.position;
}

export function withTargets(selection, targets) {
  const known = new Set(selection.targets.map((target) => target.key));
  const fresh = targets.filter((target) => !known.has(target.key) && known.add(target.key));
  return fresh.length ? { ...selection, targets: [...selection.targets, ...fresh] } : selection;
}

export function withoutTargets(selection, keys) {
  const gone = new Set(keys);
  return { ...selection, targets: selection.targets.filter((target) => !gone.has(target.key)) };
}

/** Seconds at a target where nobody names them, as in missions/routing/problem.py. */
export const HOLD_S = { look: 5, photo: 10, hold: 30 };
export const LONGEST_HOLD_S = 3600;

/** What is done at a target for which nobody says it: details of towers and bridges are photographed, lines filmed in passing. */
export function usualTask(target) {
  if (target.asset === null) return { kind: "hold", hold_s: 10 };
  if (isWhole(target)) return { kind: "look", hold_s: 0 };
  return target.kind === "tower" || target.kind === "bridge" ? { kind: "photo", hold_s: HOLD_S.photo } : { kind: "look", hold_s: HOLD_S.look };
}

export function taskOf(target) {
  return target.task ? { kind: target.task.kind, hold_s: target.task.hold_s ?? HOLD_S[target.task.kind] } : usualTask(target);
}

const isSameTask = (a, b) => a.kind === b.kind && a.hold_s === b.hold_s;

export function isUsualTask(target) {
  return isSameTask(taskOf(target), usualTask(target));
}

/** The same targets with another task at some of them; without seconds each keeps its own where the kind stays. */
export function withTask(selection, keys, { kind, hold_s = null }) {
  const wanted = new Set(keys);
  const tasked = (target) => {
    const now = taskOf(target);
    const next = { kind, hold_s: hold_s ?? (now.kind === kind ? now.hold_s : HOLD_S[kind]) };
    return isSameTask(now, next) ? target : { ...target, task: isSameTask(next, usualTask(target)) ? null : next };
  };
  return { ...selection, targets: selection.targets.map((target) => (wanted.has(target.key) ? tasked(target) : target)) };
}

export function uavOf(feature) {
  const { name, base, base_name, max_range_m, cruise_speed_mps, end_action, state, type_name, sensors, battery_percent, heading_deg } = feature.properties;
  return {
    id: feature.id, name, base: base ?? null, base_name: base_name ?? "", position: feature.geometry.coordinates.slice(0, 2), max_range_m, cruise_speed_mps, end_action,
    state: state ?? "active", type_name: type_name ?? "", sensors: sensors ?? [], battery_percent: battery_percent ?? null, heading_deg: heading_deg ?? null,
  };
}

export function withUav(selection, uav) {
  return selection.uavs.some((chosen) => chosen.id === uav.id) ? selection : { ...selection, uavs: [...selection.uavs, uav] };
}

export function withoutUavAt(selection, sequence) {
  return { ...selection, uavs: selection.uavs.filter((_, index) => index !== sequence) };
}

export function withUavAt(selection, sequence, position) {
  return { ...selection, uavs: selection.uavs.map((uav, index) => (index === sequence ? { ...uav, position } : uav)) };
}

/** The same UAV with other values, in this mission. */
export function withUavAs(selection, sequence, values) {
  return { ...selection, uavs: selection.uavs.map((uav, index) => (index === sequence ? { ...uav, ...values } : uav)) };
}

/** The body of /plans and of a mission. */
export function requestOf(selection) {
  return {
    uavs: selection.uavs.map((uav) => {
      const body = { name: uav.name, position: uav.position };
      if (uav.id !== null && uav.id !== undefined) body.id = uav.id;
      if (body.id !== undefined && uav.max_range_m === null) body.max_range_m = null; // said so: the fleet's own range is not meant
      for (const name of ["max_range_m", "cruise_speed_mps", "end_action"]) if (uav[name] !== null && uav[name] !== undefined) body[name] = uav[name];
      return body;
    }),
    targets: selection.targets.map((target) => {
      const body = {};
      if (target.asset !== null) body.asset = target.asset;
      if (target.position) body.position = target.position;
      if (target.stretch) body.stretch = target.stretch;
      if (!isUsualTask(target)) body.task = taskOf(target);
      return body;
    }),
    objective: selection.objective,
    return_to_start: selection.return_to_start,
  };
}

/** Equal selections ask for equal plans. */
export function basisOf(selection) {
  return JSON.stringify(requestOf(selection));
}

/** A target as the server has stored it. */
export function storedTarget(target) {
  const position = target.is_point || target.asset === null ? target.position : null;
  const stretch = target.stretch ?? null;
  const detail = detailOf(target.kind, stretch ? { ...target, length_m: null } : target, position, stretch);
  const made = { asset: target.asset, kind: target.kind ?? "place", label: target.label, detail, position, stretch, centre: target.position, task: target.task ?? null };
  return { key: keyOf(made), ...made };
}

/** The selection of a stored mission. */
export function selectionOf(mission, fleet = []) {
  return {
    targets: mission.targets.map(storedTarget),
    uavs: mission.uavs.map((uav) => ({ ...uav, base_name: fleet.find((known) => known.id === uav.id)?.base_name ?? "" })),
    objective: mission.objective,
    return_to_start: mission.return_to_start,
  };
}
