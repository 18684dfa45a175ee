/** The three kinds of rows of the fleet: source, columns of the table, name and full description. */

import { h, term } from "../dom.js";
import { simulatedMark } from "../simulated.js";
import { t, tn } from "../text.js";
import { coordinateText, percentText, powerText, speedText } from "../units.js";
import {
  ageText,
  batteryMark,
  endWords,
  fromType,
  kilograms,
  rangeText,
  squareMetres,
  stateChip,
  uavsText,
  wattHours,
} from "./words.js";

/** @import { Child } from "../dom.js" */
/** @import { FleetBase, FleetType, Kind, Tab, Uav } from "./types.d.ts" */

/** @param {string} words */
const caption = (words) => words && h("span", { class: "caption" }, words);

/**
 * The present charge and the capacity; only the capacity where the charge is unknown.
 *
 * @param {Uav} uav
 * @returns {Child}
 */
function batteryCell({ battery_percent, battery_wh }) {
  const holds = battery_wh !== null && caption(wattHours(battery_wh));
  return battery_percent === null && holds ? holds : [batteryMark(battery_percent), holds];
}

/** @type {Kind<Uav>} */
const UAVS = {
  tab: "uavs",
  icon: "uav",
  words: t("UAVs"),
  one: t("New UAV"),
  count: (count) => tn(count, "{count} UAV", "{count} UAVs"),
  hint: t("Name, base, type or serial number"),
  path: "/uavs",
  columns: [
    {
      words: t("Name"),
      cell: (uav) => [uav.is_simulated && simulatedMark(), caption(uav.type_name || t("no type"))],
    },
    { words: t("State"), cell: (uav) => stateChip(uav) },
    {
      words: t("Base"),
      class: "wide",
      cell: (uav) => [uav.base_name || "—", caption(t("position {age}", { age: ageText(uav) }))],
    },
    { words: t("Battery"), class: "number", cell: batteryCell },
    { words: t("Range"), class: "number wide", cell: (uav) => rangeText(uav.max_range_m) },
    { words: t("Missions"), class: "number missions", cell: (uav) => `${uav.mission_count || "—"}` },
  ],
  facts: (uav) => [
    term(t("Type"), uav.type_name || t("not stated")),
    term(t("Base"), uav.base_name || t("not stated")),
    term(t("Position"), `${coordinateText(uav.position)} · ${ageText(uav)}`),
    term(t("Battery charge"), batteryMark(uav.battery_percent)),
    term(t("Range"), fromType(uav, "max_range_m", rangeText(uav.max_range_m))),
    term(t("Speed"), fromType(uav, "cruise_speed_mps", speedText(uav.cruise_speed_mps))),
    term(
      t("Battery"),
      fromType(uav, "battery_wh", uav.battery_wh === null ? t("not stated") : wattHours(uav.battery_wh)),
    ),
    term(t("Mass"), fromType(uav, "mass_kg", uav.mass_kg === null ? t("not stated") : kilograms(uav.mass_kg))),
    term(
      t("Kept in reserve"),
      uav.reserve_percent === null ? null : fromType(uav, "reserve_percent", percentText(uav.reserve_percent)),
    ),
    term(
      t("Maximum airspeed"),
      fromType(
        uav,
        "max_airspeed_mps",
        uav.max_airspeed_mps === null ? t("cruise speed") : speedText(uav.max_airspeed_mps),
      ),
    ),
    term(t("Sensors"), uav.sensors.join(", ") || t("not stated")),
    term(t("End of mission"), endWords(uav.end_action)),
    term(t("Serial number"), uav.serial_number),
    term(t("MAVLink system id"), uav.mavlink_system_id && `${uav.mavlink_system_id}`),
    term(t("Simulated"), uav.is_simulated && t("yes")),
    term(t("MAVLink without a signature"), uav.allows_unsigned && t("is taken for its word")),
  ],
  deleted: (uav) => t("{name} is deleted.", { name: uav.name }),
  none: { title: t("No UAVs yet"), text: t("Add the first one, then plan a mission with it.") },
};

/** @type {Kind<FleetType>} */
const TYPES = {
  tab: "types",
  icon: "settings",
  words: t("Types"),
  one: t("New type"),
  count: (count) => tn(count, "{count} type", "{count} types"),
  hint: t("Name"),
  path: "/uav-types",
  columns: [
    { words: t("Name"), cell: (type) => caption(type.sensors.join(", ")) },
    { words: t("Range"), class: "number", cell: (type) => rangeText(type.max_range_m, type.range_unlimited) },
    { words: t("Speed"), class: "number wide", cell: (type) => speedText(type.cruise_speed_mps) },
    { words: t("Battery"), class: "number wide", cell: (type) => wattHours(type.battery_wh) },
    { words: t("Mass"), class: "number wide", cell: (type) => kilograms(type.mass_kg) },
    { words: t("UAVs"), class: "number", cell: (type) => `${type.uav_count || "—"}` },
  ],
  facts: (type) => [
    term(t("Range"), rangeText(type.max_range_m, type.range_unlimited)),
    term(t("Speed"), speedText(type.cruise_speed_mps)),
    term(t("Battery"), wattHours(type.battery_wh)),
    term(t("Mass"), kilograms(type.mass_kg)),
    term(t("Kept in reserve"), percentText(type.reserve_percent)),
    term(t("Maximum airspeed"), type.max_airspeed_mps ? speedText(type.max_airspeed_mps) : t("cruise speed")),
    term(t("Rotor area"), squareMetres(type.rotor_disk_m2)),
    term(t("Power in a hover"), type.hover_power_w ? powerText(type.hover_power_w) : t("worked out")),
    term(t("Sensors"), type.sensors.join(", ") || t("not stated")),
    term(t("UAVs"), type.uav_count ? uavsText(type.uav_count) : t("none")),
  ],
  deleted: (type) => t("The type {name} is deleted.", { name: type.name }),
  none: { title: t("No types yet"), text: t("A type gives its range, speed and sensors to all its UAVs.") },
};

/** @type {Kind<FleetBase>} */
const BASES = {
  tab: "bases",
  icon: "warehouse",
  words: t("Bases"),
  one: t("New base"),
  count: (count) => tn(count, "{count} base", "{count} bases"),
  hint: t("Name"),
  path: "/bases",
  columns: [
    { words: t("Name"), cell: (base) => caption(base.note) },
    { words: t("Place"), class: "wide", cell: (base) => coordinateText(base.position) },
    { words: t("UAVs"), class: "number", cell: (base) => `${base.uav_count || "—"}` },
  ],
  facts: (base) => [
    term(t("Place"), coordinateText(base.position)),
    term(t("Note"), base.note),
    term(t("UAVs"), base.uav_count ? uavsText(base.uav_count) : t("none")),
  ],
  deleted: (base) => t("The base {name} is deleted.", { name: base.name }),
  none: { title: t("No bases yet"), text: t("A base is where UAVs stand and take off.") },
};

/** @type {Record<Tab, Kind>} */
export const KINDS = { uavs: UAVS, types: TYPES, bases: BASES };
