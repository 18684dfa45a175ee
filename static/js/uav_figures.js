/** Performance of UAVs: bounds of its figures, and defaults. As in planning/energy/performance.py. */

export const USUAL_RESERVE_PERCENT = 20;
/** The PX4 Iris. */
export const IRIS = Object.freeze({ mass_kg: 1.545, rotor_disk_m2: 0.2059 });
/** { min, max } in the units of the names. */
export const BOUNDS = Object.freeze({
  battery_wh: { min: 1, max: 100_000 },
  mass_kg: { min: 0.05, max: 1000 },
  reserve_percent: { min: 0, max: 90 },
  max_airspeed_mps: { min: 1, max: 100 },
  rotor_disk_m2: { min: 0.001, max: 1000 },
  hover_power_w: { min: 1, max: 1_000_000 },
});
/** @typedef {"battery_wh" | "mass_kg" | "reserve_percent" | "max_airspeed_mps"} OwnFigure */

/** Figures that a UAV may override. @type {OwnFigure[]} */
export const OWN_FIGURES = ["battery_wh", "mass_kg", "reserve_percent", "max_airspeed_mps"];

/**
 * The values in effect for a UAV of this type, or of none, without its own figures. A battery of its own requires a stated mass.
 *
 * @param {Partial<Record<OwnFigure, number | null>> | null | undefined} type
 * @returns {Record<OwnFigure, number | null>}
 */
export const usualOf = (type) => ({
  battery_wh: type?.battery_wh ?? null,
  mass_kg: type?.mass_kg ?? (type?.battery_wh ? IRIS.mass_kg : null),
  reserve_percent: type?.reserve_percent ?? USUAL_RESERVE_PERCENT,
  max_airspeed_mps: type?.max_airspeed_mps ?? null,
});

/**
 * The bounds in another unit, of `unit` stored ones, rounded inwards to a tenth.
 *
 * @param {keyof typeof BOUNDS} name
 * @param {number} unit
 */
export function boundsIn(name, unit) {
  const { min, max } = BOUNDS[name];
  return unit === 1
    ? BOUNDS[name]
    : { min: Math.ceil((min / unit) * 10) / 10, max: Math.floor((max / unit) * 10) / 10 };
}
