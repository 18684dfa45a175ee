/** Heights of UAVs, converted to heights above sea level of the drawn terrain. Values in, values out. */

/** @import { GroundGrid } from "../../api_types.d.ts" */
/** @import { SourceKind } from "../types.d.ts" */

/** @typedef {"amsl" | "relative"} Trust which height is used */
/** @typedef {GroundGrid["kind"]} GroundKind */

const ON_GROUND_M = 0.12; // height of a UAV's middle above the surface on which it stands

/**
 * Return the height above sea level to draw at. Where there is a terrain model, AMSL heights of a plan or a simulation refer to the drawn
 * terrain ("amsl"). AMSL heights that a UAV reports are off by metres: its height above take-off is added to the drawn terrain instead
 * ("relative").
 *
 * @param {{ altitude_amsl_m?: number | null, altitude_relative_m?: number | null }} heights
 * @param {number} takeOff_amsl_m
 * @param {Trust} trust
 */
export function altitudeOf({ altitude_amsl_m = null, altitude_relative_m = null }, takeOff_amsl_m, trust) {
  if (trust === "amsl" && altitude_amsl_m !== null) return altitude_amsl_m;
  if (altitude_relative_m !== null) return takeOff_amsl_m + Math.max(altitude_relative_m, 0);
  return altitude_amsl_m ?? takeOff_amsl_m;
}

/**
 * Which height of a source to use over this terrain ("terrain", "partly", "flat"). Flat terrain is 0 everywhere, and so are AMSL heights
 * of a rehearsal over it.
 *
 * @param {SourceKind} sourceKind
 * @param {GroundKind} groundKind
 * @returns {Trust}
 */
export const trustIn = (sourceKind, groundKind) =>
  sourceKind === "rehearsal" || (sourceKind === "plan" && groundKind !== "flat") ? "amsl" : "relative";

/**
 * Planned heights: of the plan itself wherever it knows them and the ground is drawn.
 *
 * @param {GroundKind} groundKind
 * @returns {Trust}
 */
export const trustInPlan = (groundKind) => (groundKind === "flat" ? "relative" : "amsl");

/** The middle of a UAV is never drawn below what it stands on. @param {number} y @param {number} ground_y */
export const aboveGround = (y, ground_y) => Math.max(y, ground_y + ON_GROUND_M);
