/** Text of a page before all requests have arrived: that it is loading, never that there is none. Values in, values out. */

/** @import { MonitorState } from "./types.d.ts" */

/** Only then a list without entries is empty. @param {Pick<MonitorState, "isWhole">} state @param {readonly unknown[]} list */
export const isNone = ({ isWhole }, list) => isWhole && list.length === 0;

/** Whether UAVs and missions have arrived, and the routes of each mission. @param {Pick<MonitorState, "isWhole" | "missions" | "details">} state */
export const hasArrived = ({ isWhole, missions, details }) => isWhole && missions.every(({ id }) => details.has(id));
