/** The selection as plain values: targets, UAVs, options; and its form in requests. */

import { t } from "../text.js";
import { lengthText } from "../units.js";
import { flightOptionsAsked, flightOptionsOf, UNSAID } from "./options/flight_options.js";
import { isUsualTask, taskOf } from "./tasks.js";

/** @import { FleetUav, MissionSelection, PickableAsset, PickedTarget, PickedUav, Wishes } from "./types.d.ts" */
/** @import { Mission, MissionTarget, PickedAsset, PlanInputRequest, SelectionTarget, TargetInputRequest, UavInputRequest } from "../api_types.d.ts" */

/**
 * Targets may be more or less urgent, tied to one UAV by its name, or need a sensor; locks: see locks.js, the last
 * three: flight_options.js.
 *
 * @type {Readonly<MissionSelection>}
 */
export const EMPTY = Object.freeze({
  targets: [],
  uavs: [],
  objective: "makespan",
  return_to_start: true,
  locks: [],
  ...UNSAID,
});

export const MAX_TARGETS = 500; // of a mission: planning/rules.py

/**
 * Two picks of the same place are one target: the asset whole, or one point of it.
 *
 * @param {Partial<Pick<PickedTarget, "asset" | "position" | "stretch">>} place
 */
export function keyOf({ asset, position, stretch }) {
  const places = stretch ?? (position ? [position] : []);
  return [asset ?? "place", ...places.map((place) => place.map((degrees) => degrees.toFixed(5)).join(","))].join(" ");
}

/**
 * A target from an asset feature of the API or a tile. `position` makes it one point of a line or railway.
 *
 * @param {PickableAsset} asset
 * @returns {PickedTarget}
 */
export function targetOf({ id, kind, properties, centre = null, position = null, stretch = null, task = null }) {
  const target = {
    asset: id,
    kind,
    label: properties.label || kind,
    detail: detailOf(kind, properties, position, stretch),
    line: properties.line ?? null,
    length_m: properties.length_m ?? null,
    position,
    stretch,
    centre: position ?? centre,
    task,
  };
  return { key: keyOf(target), ...target };
}

/** A free place as a target; its label is as the server makes it. @param {readonly number[]} place @returns {PickedTarget} */
export function placeTarget([longitude, latitude]) {
  const position = [longitude, latitude].map((degrees) => Number(degrees.toFixed(6)));
  const label = `${latitude.toFixed(5)}, ${longitude.toFixed(5)}`;
  const target = {
    asset: null,
    kind: "place",
    label,
    detail: "",
    position,
    stretch: null,
    centre: position,
    task: null,
  };
  return { key: keyOf(target), ...target };
}

/** A target from a short row of the API: a list, an area, a stretch. @param {PickedAsset} row */
export function targetOfRow({ id, kind, centre, ...properties }) {
  return targetOf({ id, kind, properties, centre });
}

/**
 * The extent picked of a line or railway. OpenStreetMap splits railways into sections: one of them is not the whole track.
 *
 * @param {string | null} kind
 * @param {number | null} [length_m]
 * @param {number[] | null} [position]
 * @param {number[][] | null} [stretch]
 */
export function extentOf(kind, length_m, position = null, stretch = null) {
  const whole = kind === "line" ? t("whole line") : kind === "railway" ? t("section") : undefined;
  if (!whole || position) return whole && t("one point");
  const words = !stretch ? whole : kind === "line" ? t("tower to tower") : t("part");
  return length_m ? `${words}, ${lengthText(length_m)}` : words;
}

/**
 * The second fact of a row, in secondary ink: how much of a line or railway is picked, then the server's detail of the asset.
 *
 * @param {string | null} kind
 * @param {{ detail?: string, length_m?: number | null }} properties
 * @param {number[] | null} [position]
 * @param {number[][] | null} [stretch]
 */
export function detailOf(kind, { detail, length_m }, position = null, stretch = null) {
  return [extentOf(kind, length_m, position, stretch), detail].filter(Boolean).join(" · ");
}

/**
 * Label and second fact in one, of a target or of an asset's properties.
 *
 * @param {{ label: string, detail?: string }} thing
 */
export function nameOf({ label, detail }) {
  return detail ? `${label}, ${detail}` : label;
}

/** @param {MissionSelection} selection @param {PickedTarget[]} targets @returns {MissionSelection} */
export function withTargets(selection, targets) {
  const known = new Set(selection.targets.map((target) => target.key));
  const fresh = targets.filter((target) => !known.has(target.key) && known.add(target.key));
  return fresh.length ? { ...selection, targets: [...selection.targets, ...fresh] } : selection;
}

/** @param {MissionSelection} selection @param {string[]} keys @returns {MissionSelection} */
export function withoutTargets(selection, keys) {
  const gone = new Set(keys);
  return { ...selection, targets: selection.targets.filter((target) => !gone.has(target.key)) };
}

/** The wishes of a target by default. @type {Readonly<Wishes>} */
const NO_WISH = { priority: "normal", uav: null, sensor: "" };

/**
 * How urgent a target is, which UAV alone may fly it and which sensor it needs: { priority, uav, sensor }.
 *
 * @param {{ priority?: Wishes["priority"] | null, uav?: string | null, sensor?: string | null }} target
 * @returns {Wishes}
 */
export function wishesOf({ priority, uav, sensor }) {
  return { priority: priority || NO_WISH.priority, uav: uav ?? NO_WISH.uav, sensor: sensor ?? NO_WISH.sensor };
}

/**
 * The same targets with another priority, UAV or sensor at some of them.
 *
 * @param {MissionSelection} selection
 * @param {string[]} keys
 * @param {Partial<Wishes>} wishes
 * @returns {MissionSelection}
 */
export function withWishes(selection, keys, wishes) {
  const wanted = new Set(keys);
  return {
    ...selection,
    targets: selection.targets.map((target) =>
      wanted.has(target.key) ? { ...target, ...wishesOf({ ...target, ...wishes }) } : target,
    ),
  };
}

/**
 * All sensors to choose from: those of the UAVs, and those that targets require already. Case is ignored.
 *
 * @param {MissionSelection} selection
 * @param {FleetUav[]} fleet
 */
export function sensorsKnown(selection, fleet) {
  const names = [...fleet, ...selection.uavs]
    .flatMap(({ sensors }) => sensors ?? [])
    .concat(selection.targets.map((target) => wishesOf(target).sensor));
  const bySound = new Map(names.filter(Boolean).map((name) => [name.trim().toLowerCase(), name.trim()]));
  return [...bySound.values()].sort((a, b) => a.localeCompare(b));
}

/**
 * Values of a UAV's performance: planning/energy/performance.py.
 *
 * @type {("battery_wh" | "mass_kg" | "reserve_percent" | "max_airspeed_mps" | "rotor_disk_m2" | "hover_power_w")[]}
 */
export const PERFORMANCE = [
  "battery_wh",
  "mass_kg",
  "reserve_percent",
  "max_airspeed_mps",
  "rotor_disk_m2",
  "hover_power_w",
];
/** Values of a UAV that a mission may override; the default is the UAV's own value, then its type's. */
const UAV_VALUES = /** @type {const} */ ([
  "max_range_m",
  "cruise_speed_mps",
  "end_action",
  "most_targets",
  ...PERFORMANCE,
]);

/**
 * Locks with indices into the targets, in the form of the API; empty without locks.
 *
 * @param {MissionSelection} selection
 * @returns {Pick<PlanInputRequest, "locks">}
 */
function locksAsked({ targets, locks }) {
  if (!locks?.length) return {};
  const index = new Map(targets.map((target, at) => [target.key, at]));
  return {
    locks: locks.map((lock) => ({
      ...lock,
      targets: lock.targets.map((key) => /** @type {number} */ (index.get(key))),
    })),
  };
}

/** The selection without locks. @param {MissionSelection} selection @returns {MissionSelection} */
export const withoutLocks = (selection) => ({ ...selection, locks: [] });

/**
 * The selection without locks and wishes of targets: changes of these keep a plan's targets and UAVs.
 *
 * @param {MissionSelection} selection
 * @returns {MissionSelection}
 */
export function withoutWishes(selection) {
  return { ...withoutLocks(selection), targets: selection.targets.map((target) => ({ ...target, ...NO_WISH })) };
}

const MAY_BE_NONE = /** @type {const} */ (["battery_wh", "max_airspeed_mps", "hover_power_w"]);

/**
 * What a mission keeps of a UAV even if the fleet has changed since: figures that the UAV itself does not have, sensors, and which are
 * its own.
 *
 * @param {PickedUav} uav
 * @returns {Partial<UavInputRequest>}
 */
function asKept(uav) {
  const none = Object.fromEntries(MAY_BE_NONE.filter((name) => uav[name] === null).map((name) => [name, null]));
  return { ...none, ...(uav.sensors ? { sensors: uav.sensors } : {}), own_figures: uav.own_figures ?? [] };
}

/**
 * What other systems keep with a target; the page leaves it as it is.
 *
 * @param {Pick<TargetInputRequest, "external_id" | "attributes">} target
 */
function givenOf({ external_id, attributes }) {
  return {
    ...(external_id ? { external_id } : {}),
    ...(Object.keys(attributes ?? {}).length ? { attributes } : {}),
  };
}

/** The body of /plans and of a mission. @param {MissionSelection} selection @returns {PlanInputRequest} */
export function requestOf(selection) {
  return {
    uavs: selection.uavs.map((uav) => {
      /** @type {UavInputRequest} */
      const body = { name: uav.name, position: uav.position };
      if (uav.id !== null && uav.id !== undefined) body.id = uav.id;
      if (body.id !== undefined && uav.max_range_m === null) body.max_range_m = null; // explicit: the range of the fleet does not apply
      for (const name of UAV_VALUES)
        if (uav[name] !== null && uav[name] !== undefined) Object.assign(body, { [name]: uav[name] });
      if ((uav.sorties ?? 1) > 1) body.sorties = uav.sorties;
      if (body.id === undefined && uav.sensors?.length) body.sensors = uav.sensors;
      return body.id === undefined ? body : { ...body, ...asKept(uav) };
    }),
    targets: selection.targets.map((target) => {
      /** @type {TargetInputRequest} */
      const body = {};
      if (target.asset !== null) body.asset = target.asset;
      if (target.position) body.position = target.position;
      if (target.stretch) body.stretch = target.stretch;
      if (!isUsualTask(target)) body.task = taskOf(target);
      const { priority, uav, sensor } = wishesOf(target);
      if (priority !== NO_WISH.priority) body.priority = priority;
      if (uav !== null) body.uav = uav;
      if (sensor) body.sensor = sensor;
      return { ...body, ...givenOf(target) };
    }),
    objective: selection.objective,
    return_to_start: selection.return_to_start,
    ...flightOptionsAsked(selection),
    ...locksAsked(selection),
  };
}

/**
 * Key of a selection: equal keys give equal routes. Lost-link actions do not count, nor the source of a UAV's figures.
 *
 * @param {MissionSelection} selection
 */
export function basisOf(selection) {
  return storedBasisOf({
    ...selection,
    lost_link: null,
    uavs: selection.uavs.map((uav) => ({ ...uav, own_figures: [] })),
  });
}

/** Equal selections are stored as the same mission. @param {MissionSelection} selection */
export function storedBasisOf(selection) {
  return JSON.stringify(requestOf(selection));
}

/**
 * A target as the server has stored it, in a mission or in a selection.
 *
 * @param {MissionTarget | SelectionTarget} target
 * @returns {PickedTarget}
 */
export function storedTarget(target) {
  const position = target.is_point || target.asset === null ? target.position : null;
  const stretch = target.stretch ?? null;
  const detail = detailOf(target.kind, stretch ? { ...target, length_m: null } : target, position, stretch);
  const made = {
    asset: target.asset,
    kind: target.kind ?? "place",
    label: target.label,
    detail,
    line: target.line ?? null,
    position,
    stretch,
    centre: target.position,
    task: target.task ?? null,
  };
  return { key: keyOf(made), ...made, ...wishesOf(target), ...("external_id" in target ? givenOf(target) : {}) };
}

/**
 * The targets with unique keys: a program may request one place several times.
 *
 * @param {PickedTarget[]} targets
 */
function distinguished(targets) {
  const count = new Map();
  return targets.map((target) => {
    const number = (count.get(target.key) ?? 0) + 1;
    count.set(target.key, number);
    return number === 1 ? target : { ...target, key: `${target.key} (${number})` };
  });
}

/**
 * The selection of a stored mission.
 *
 * @param {Mission} mission
 * @param {FleetUav[]} [fleet]
 * @returns {MissionSelection}
 */
export function selectionOf(mission, fleet = []) {
  const targets = distinguished(mission.targets.map(storedTarget));
  return {
    targets,
    uavs: mission.uavs.map((uav) => ({
      ...uav,
      base_name: fleet.find((known) => known.id === uav.id)?.base_name ?? "",
    })),
    objective: mission.objective,
    return_to_start: mission.return_to_start,
    ...flightOptionsOf(mission),
    locks: (mission.locks ?? []).map(({ uav, targets: places, at_start, at_end }) => ({
      uav,
      targets: places.map((place) => targets[place].key),
      at_start: Boolean(at_start),
      at_end: Boolean(at_end),
    })),
  };
}
