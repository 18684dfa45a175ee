/** Request bodies of a UAV, a type or a base. */

import { USUAL_RESERVE_PERCENT } from "../uav_figures.js";

/** @import { BaseBody, Body, FleetBase, FleetType, Row, Tab, TypeBody, Uav, UavBody } from "./types.d.ts" */

/** @param {UavBody & Pick<Uav, "from_type">} uav @returns {UavBody} */
function bodyOfUav(uav) {
  /**
   * Values inherited from the type are omitted.
   *
   * @param {"max_range_m" | "cruise_speed_mps" | "battery_wh" | "mass_kg" | "reserve_percent" | "max_airspeed_mps"} name
   */
  const own = (name) => (uav.from_type.includes(name) ? null : uav[name]);
  return {
    name: uav.name,
    type: uav.type,
    base: uav.base,
    position: uav.position,
    serial_number: uav.serial_number,
    mavlink_system_id: uav.mavlink_system_id,
    max_range_m: own("max_range_m"),
    cruise_speed_mps: own("cruise_speed_mps"),
    battery_wh: own("battery_wh"),
    mass_kg: own("mass_kg"),
    reserve_percent: own("reserve_percent"),
    max_airspeed_mps: own("max_airspeed_mps"),
    battery_percent: uav.battery_percent,
    sensor: uav.sensor,
    end_action: uav.end_action,
    link: uav.link,
    allows_unsigned: uav.allows_unsigned,
    is_simulated: uav.is_simulated,
  };
}

/** @param {TypeBody} type @returns {TypeBody} */
const bodyOfType = (type) => ({
  name: type.name,
  max_range_m: type.max_range_m,
  range_unlimited: type.range_unlimited,
  cruise_speed_mps: type.cruise_speed_mps,
  battery_wh: type.battery_wh,
  mass_kg: type.mass_kg,
  reserve_percent: type.reserve_percent,
  max_airspeed_mps: type.max_airspeed_mps,
  rotor_disk_m2: type.rotor_disk_m2,
  hover_power_w: type.hover_power_w,
  sensors: type.sensors,
  cameras: type.cameras,
});

/** @param {BaseBody} base @returns {BaseBody} */
const bodyOfBase = ({ name, position, note }) => ({ name, position, note });

/** The editable values of a row. @param {Tab} tab @param {Row} row @returns {Body} */
export function bodyOf(tab, row) {
  if (tab === "uavs") return bodyOfUav(/** @type {Uav} */ (row));
  return tab === "types" ? bodyOfType(/** @type {FleetType} */ (row)) : bodyOfBase(/** @type {FleetBase} */ (row));
}

/** What the form of a new row begins with. @param {Tab} tab @returns {Body} */
export function blankBody(tab) {
  if (tab === "uavs")
    return {
      name: "",
      type: null,
      base: null,
      position: null,
      serial_number: "",
      mavlink_system_id: null,
      max_range_m: null,
      cruise_speed_mps: null,
      battery_wh: null,
      mass_kg: null,
      reserve_percent: null,
      max_airspeed_mps: null,
      battery_percent: null,
      sensor: "",
      end_action: "return",
      link: "mavlink",
      allows_unsigned: false,
      is_simulated: false,
    };
  if (tab === "types")
    return {
      name: "",
      max_range_m: null,
      range_unlimited: false,
      cruise_speed_mps: 12,
      battery_wh: null,
      mass_kg: null,
      reserve_percent: USUAL_RESERVE_PERCENT,
      max_airspeed_mps: null,
      rotor_disk_m2: null,
      hover_power_w: null,
      sensors: [],
      cameras: [],
    };
  return { name: "", position: null, note: "" };
}
