/** What stands above what: UAVs and alerts. Values in, values out. */

const RANKS = { critical: 0, warning: 1, advisory: 2 };
const CALM = 3;

export const isOpenAlert = ({ closed_at }) => closed_at === null;
export const isUnanswered = (alert) => isOpenAlert(alert) && alert.acknowledged_at === null;

/** The worst open alert of each UAV: Map of uav → rank, 0 for critical. */
function worstOf(alerts) {
  const worst = new Map();
  for (const { uav, level } of alerts.filter(isOpenAlert))
    worst.set(uav, Math.min(worst.get(uav) ?? CALM, RANKS[level]));
  return worst;
}

/** The chosen one, then by alert level, then by landing time, then by place. */
export function inOrder(uavs, alerts, chosen) {
  const worst = worstOf(alerts);
  const keys = (uav) => [
    uav.id === chosen ? 0 : 1,
    worst.get(uav.id) ?? CALM,
    Date.parse(uav.estimated?.ends_at ?? "") || Infinity,
    uav.mission === null ? 1 : 0,
    uav.place ?? 0,
  ];
  return sorted(uavs, keys);
}

/** Unanswered ones of the highest level first, the newest first; then those somebody knows of, then what is over. */
export function alertsInOrder(alerts) {
  const keys = (alert) => [
    isOpenAlert(alert) ? (alert.acknowledged_at === null ? RANKS[alert.level] : CALM) : CALM + 1,
    -Date.parse(alert.opened_at),
  ];
  return sorted(alerts, keys);
}

function sorted(items, keysOf) {
  return items
    .map((item) => [keysOf(item), item])
    .sort(([a], [b]) => {
      const at = a.findIndex((key, index) => key !== b[index]);
      return at < 0 ? 0 : a[at] < b[at] ? -1 : 1;
    })
    .map(([, item]) => item);
}
