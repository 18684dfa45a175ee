/** Order of UAVs and alerts. Values in, values out. */

/** @import { Alert, AlertLevel, LiveMission, LiveUav } from "../api_types.d.ts" */

/** @type {Record<AlertLevel, number>} */
const RANKS = { critical: 0, warning: 1, advisory: 2 };
const CALM = 3;

/** @param {Pick<Alert, "closed_at">} alert */
export const isOpenAlert = ({ closed_at }) => closed_at === null;
/**
 * Whether a critical alert has ended and is not acknowledged; it stays until then.
 * @param {Pick<Alert, "closed_at" | "acknowledged_at" | "level">} alert
 */
export const isEndedUnseen = (alert) =>
  !isOpenAlert(alert) && alert.acknowledged_at === null && alert.level === "critical";
/** @param {Pick<Alert, "closed_at" | "acknowledged_at" | "level">} alert */
export const isUnanswered = (alert) => alert.acknowledged_at === null && (isOpenAlert(alert) || isEndedUnseen(alert));

/**
 * Where a UAV is down away from its plan: [longitude, latitude], or null.
 * @param {Pick<Alert, "code" | "details">} alert @returns {[number, number] | null}
 */
export function downAt({ code, details }) {
  const { position } = /** @type {{ position?: unknown }} */ (details ?? {});
  const isPlace = Array.isArray(position) && position.length === 2 && position.every(Number.isFinite);
  return code === "down-off-plan" && isPlace ? /** @type {[number, number]} */ (position) : null;
}

/**
 * Alerts that a user must see: open ones, and unacknowledged critical ones that ended; only the newest of each cause.
 *
 * @template {Pick<Alert, "uav" | "code" | "subject" | "opened_at" | "closed_at" | "acknowledged_at" | "level">} Shown
 * @param {Shown[]} alerts
 */
export function pinnedAlerts(alerts) {
  /** @param {Shown} alert */
  const causeOf = ({ uav, code, subject }) => JSON.stringify([uav, code, subject]);
  /** @type {Map<string, Shown>} */
  const newest = new Map();
  const pinned = alerts.filter((alert) => isOpenAlert(alert) || isEndedUnseen(alert));
  for (const alert of pinned) {
    const other = newest.get(causeOf(alert));
    if (!other || Date.parse(alert.opened_at) > Date.parse(other.opened_at)) newest.set(causeOf(alert), alert);
  }
  return [...newest.values()];
}

/**
 * The worst level of a UAV's alerts that are pinned: open, or critical and not acknowledged; null.
 *
 * @param {number} uav
 * @param {Pick<Alert, "uav" | "level" | "closed_at" | "acknowledged_at">[]} alerts
 */
export function alarmOf(uav, alerts) {
  const own = alerts.filter((alert) => alert.uav === uav && (isOpenAlert(alert) || isEndedUnseen(alert)));
  const levels = own.map(({ level }) => level);
  return levels.sort((a, b) => RANKS[a] - RANKS[b])[0] ?? null;
}

/**
 * Mission by mission, in each by its letters; those of no mission last. Whatever happens to a UAV, it keeps its place.
 *
 * @param {LiveUav[]} uavs
 * @param {Pick<LiveMission, "id">[]} missions in the order of the page
 */
export function inOrder(uavs, missions) {
  const ranks = new Map(missions.map(({ id }, rank) => [id, rank]));
  return sorted(uavs, ({ id, mission, place }) => [
    mission === null ? Infinity : (ranks.get(mission) ?? missions.length),
    place ?? Infinity,
    id,
  ]);
}

/**
 * Alerts in order: open unacknowledged ones by level, newest first; critical ones that have ended; acknowledged ones; closed ones.
 *
 * @param {Alert[]} alerts
 */
export function alertsInOrder(alerts) {
  /** @param {Alert} alert */
  const keys = (alert) => [
    isOpenAlert(alert)
      ? alert.acknowledged_at === null
        ? RANKS[alert.level]
        : CALM
      : isEndedUnseen(alert)
        ? RANKS.critical + 0.5
        : CALM + 1,
    -Date.parse(alert.opened_at),
  ];
  return sorted(alerts, keys);
}

/** @template Item @param {Item[]} items @param {(item: Item) => number[]} keysOf */
function sorted(items, keysOf) {
  return items
    .map((item) => ({ keys: keysOf(item), item }))
    .sort(({ keys: a }, { keys: b }) => {
      const at = a.findIndex((key, index) => key !== b[index]);
      return at < 0 ? 0 : a[at] < b[at] ? -1 : 1;
    })
    .map(({ item }) => item);
}

/**
 * Alerts to notify since the last poll: each cause once, and again when its level has risen.
 *
 * @param {Alert[]} alerts
 * @param {Map<number, AlertLevel>} reported level by id
 */
export function newAlerts(alerts, reported) {
  /** @param {Alert} alert */
  const isNew = ({ id, level, closed_at, acknowledged_at }) =>
    closed_at === null && acknowledged_at === null && reported.get(id) !== level;
  return alerts.filter(isNew);
}
