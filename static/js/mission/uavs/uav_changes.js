/** Changes of UAVs since a mission took over their figures, and figures that are the mission's own. Values in, values out. */

import { t } from "../../text.js";
import { OWN_FIGURES } from "../../uav_figures.js";
import { LONG_UNIT, numberText, SPEED_UNIT } from "../../units.js";
import { PERFORMANCE } from "../selection.js";

/** @import { UavChange, UavFigure } from "../../api_types.d.ts" */
/** @import { OwnFigure } from "../../uav_figures.js" */
/** @import { FleetUav, MissionSelection, PickedUav } from "../types.d.ts" */

/** @typedef {UavChange["figures"][number]["kept"]} FigureValue */

/** In the order in which the server writes them down. @type {UavFigure[]} */
const FIGURES = ["max_range_m", "cruise_speed_mps", ...PERFORMANCE, "sensors"];
const MAX_DIGITS = 6;
const SPACE = "\u00a0";

/** @param {unknown} a @param {unknown} b */
const isSame = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/**
 * Changes of a stored mission that the selection has not taken over: its UAVs still have the old figures.
 *
 * @param {MissionSelection} selection
 * @param {UavChange[] | null | undefined} changes
 */
export function openChanges(selection, changes) {
  return (changes ?? [])
    .map((change) => {
      const uav = selection.uavs.find(({ id }) => id === change.id);
      /** @param {UavFigure} name @param {FigureValue} value */
      const hasStill = (name, value) => uav && uav[name] !== undefined && isSame(uav[name], value);
      const said = (change.said ?? []).filter(
        (one) => uav?.own_figures?.includes(one.name) && hasStill(one.name, one.said),
      );
      return {
        ...change,
        isThere: Boolean(uav),
        figures: change.figures.filter(({ name, kept }) => hasStill(name, kept)),
        said,
      };
    })
    .filter(
      ({ isThere, figures, state, said }) => isThere && (figures.length > 0 || state !== null || said.length > 0),
    );
}

/**
 * The same selection with the figures that the fleet has now.
 *
 * @param {MissionSelection} selection
 * @param {Pick<UavChange, "id" | "figures">[]} changes
 * @returns {MissionSelection}
 */
export function withPresentFigures(selection, changes) {
  const taken = new Map(
    changes.map(({ id, figures }) => [id, Object.fromEntries(figures.map(({ name, now }) => [name, now]))]),
  );
  return {
    ...selection,
    uavs: selection.uavs.map((uav) => (taken.has(uav.id ?? -1) ? { ...uav, ...taken.get(uav.id ?? -1) } : uav)),
  };
}

/**
 * The selection with the fleet's figures in place of those set for the mission.
 *
 * @param {MissionSelection} selection
 * @param {Pick<UavChange, "id" | "said">[]} changes
 * @returns {MissionSelection}
 */
export function withFleetFigures(selection, changes) {
  const taken = new Map(changes.map(({ id, said }) => [id, said]));
  /** @param {PickedUav} uav @param {UavChange["said"]} said */
  const ofFleet = (uav, said) => ({
    ...uav,
    ...Object.fromEntries(said.map(({ name, now }) => [name, now])),
    own_figures: (uav.own_figures ?? []).filter((own) => !said.some(({ name }) => name === own)),
  });
  return {
    ...selection,
    uavs: selection.uavs.map((uav) => {
      const said = taken.get(uav.id ?? -1) ?? [];
      return said.length ? ofFleet(uav, said) : uav;
    }),
  };
}

/** @param {string} name @returns {name is OwnFigure} */
const isOwn = (name) => OWN_FIGURES.some((own) => own === name);

/**
 * Figures typed for a UAV in a mission. `known` is the UAV of the fleet: an empty field has its value, another value is the mission's
 * own.
 *
 * @param {PickedUav} uav
 * @param {Partial<PickedUav>} values
 * @param {FleetUav | undefined} known
 * @returns {Partial<PickedUav>}
 */
export function figuresInMission(uav, values, known) {
  if (!known) return values;
  const said = { ...values };
  const own = new Set(uav.own_figures ?? []);
  for (const name of FIGURES.filter((figure) => figure in values)) {
    const ofFleet = isOwn(name) ? known.usual[name] : known[name];
    if (values[name] === null && isOwn(name)) {
      said[name] = undefined;
      own.delete(name);
    } else if (values[name] !== uav[name]) own[values[name] === ofFleet ? "delete" : "add"](name);
  }
  return { ...said, own_figures: FIGURES.filter((name) => own.has(name)) };
}

/**
 * @type {Record<Exclude<UavFigure, "sensors">, { words: string, unit: string, scale?: number, none?: string, digits?: number }>}
 */
const FIGURE_WORDS = {
  max_range_m: { words: t("range|figure"), unit: LONG_UNIT.unit, scale: LONG_UNIT.metres, none: t("not stated|range") },
  cruise_speed_mps: { words: t("speed|figure"), unit: SPEED_UNIT.unit, scale: SPEED_UNIT.mps },
  battery_wh: { words: t("battery|figure"), unit: "Wh", none: t("not counted") },
  mass_kg: { words: t("mass|figure"), unit: "kg", digits: 3 },
  reserve_percent: { words: t("reserve|figure"), unit: "%" },
  max_airspeed_mps: {
    words: t("highest airspeed|figure"),
    unit: SPEED_UNIT.unit,
    scale: SPEED_UNIT.mps,
    none: t("not stated|airspeed"),
  },
  rotor_disk_m2: { words: t("rotor area|figure"), unit: "m²", digits: 3 },
  hover_power_w: { words: t("power in the hover|figure"), unit: "W", none: t("worked out") },
};

/** @param {FigureValue} value */
const sensorNames = (value) => (Array.isArray(value) && value.join(", ")) || t("none|sensor");
/** @param {FigureValue} value @param {number} scale */
const scaled = (value, scale) => (typeof value === "number" ? value / scale : null);

/**
 * "battery 56.6 → 40 Wh"
 *
 * @param {Pick<UavChange["figures"][number], "name"> & { kept: FigureValue, now: FigureValue }} change
 */
function figureWords({ name, kept, now }) {
  if (name === "sensors") return t("sensors {kept} → {now}", { kept: sensorNames(kept), now: sensorNames(now) });
  const { words, unit, scale = 1, none = "", digits = 1 } = FIGURE_WORDS[name];
  const [before, after] = distinguished(scaled(kept, scale), scaled(now, scale), digits);
  return `${words} ${before ?? none} → ${after === null ? none : `${after}${SPACE}${unit}`}`;
}

/**
 * Two numbers with as many decimals as distinguish them.
 *
 * @param {number | null} kept
 * @param {number | null} now
 * @param {number} digits
 * @returns {(string | null)[]}
 */
function distinguished(kept, now, digits) {
  const [before, after] = [kept, now].map((value) => (value === null ? null : shortText(value, digits)));
  return before === after && before !== null && digits < MAX_DIGITS
    ? distinguished(kept, now, digits + 1)
    : [before, after];
}

/** @param {number} value @param {number} digits */
function shortText(value, digits) {
  const rounded = Number(value.toFixed(digits));
  return numberText(rounded, Number.isInteger(rounded) ? 0 : `${rounded}`.split(".")[1].length);
}

const STATE_WORDS = {
  active: t("flies again, and the plan leaves it on the ground"),
  maintenance: t("is in maintenance"),
  retired: t("is retired"),
};

/**
 * "Kite: battery 56.6 → 40 Wh, is in maintenance."
 *
 * @param {Pick<UavChange, "name" | "figures" | "state" | "message"> & { said?: UavChange["said"] }} change
 */
export function changeWords({ name, figures, state, message, said = [] }) {
  const ofFleet = said.map(({ name: figure, then, now }) =>
    t("{change} in the fleet, but not in this mission", { change: figureWords({ name: figure, kept: then, now }) }),
  );
  const reported = [...figures.map(figureWords), ...(state ? [STATE_WORDS[state]] : []), ...ofFleet];
  return reported.length ? `${name}: ${reported.join(", ")}.` : message;
}
