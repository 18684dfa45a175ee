/** The strips of the routes: as planned, and once a wish is not planned yet, where targets would be; on request those of the plan before. */

import { h } from "../../../dom.js";
import { profileOf } from "../../../domain/route_profile.js";
import { t } from "../../../text.js";
import { durationText, lengthText } from "../../../units.js";
import { passedZones } from "../../options/zones_passed.js";
import { profileOfSummary } from "../../plan/compare.js";
import { routesOf, stripLabel } from "../../plan/plan_view.js";
import { staysOf, stayText } from "../../plan/route_times.js";
import { paleStrip, spanStrip, stripTable } from "../../strips/span_strip.js";
import { createPillDrag } from "../../strips/strip_drag.js";
import { lockOf, ordersOf, stopsWished, wishedOrders } from "../../targets/locks.js";
import { uavsByName } from "../../uavs/mission_uavs.js";

/** @import { Waypoint } from "../../../api_types.d.ts" */
/** @import { Child } from "../../../dom.js" */
/** @import { createGrounds } from "../../strips/profile.js" */
/** @import { MissionActions, MissionPageState, MissionStore, ShortRoute, ShownPlan, ShownRoute } from "../../types.d.ts" */

/** @typedef {ReturnType<typeof createGrounds>} Grounds */
/** @typedef {ReturnType<typeof spanStrip>} Strip */
/** @typedef {{ plan: ShownPlan, longest_m: number, width_px: number }} Drawn what all strips have in common */

const MAX_LOOKED_AT = 12; // count of routes whose zones are requested at once

/**
 * Locked keys by the place of each route; locks to a UAV without a route are not drawn.
 *
 * @param {MissionPageState} state
 * @param {ShownPlan} plan
 */
function wishesOf({ selection }, plan) {
  const known = new Set([...selection.targets, ...plan.targets].map(({ key }) => key));
  const wished = wishedOrders(ordersOf(plan), selection.locks ?? []);
  return plan.result.routes.map((_, sequence) => wished[sequence].targets.filter((key) => known.has(key)));
}

/** A strip of the plan before. @param {ShortRoute} old @param {Drawn} drawn */
function oldStrip(old, { longest_m, width_px }) {
  const label = t("In the last plan {name} flew {length} in {time}.", {
    name: old.uav,
    length: lengthText(old.length_m),
    time: durationText(old.duration_s),
  });
  return paleStrip({ profile: profileOfSummary(old), longest_m, width_px, label });
}

/**
 * @param {HTMLElement} list of the routes
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {{ canPlan: boolean, grounds: Grounds }} how
 */
export function createStrips(list, store, actions, { canPlan, grounds }) {
  /** @type {Map<number, Strip>} */
  const strips = new Map(); // by the place of the route
  /** @type {WeakMap<Waypoint[], ReturnType<typeof passedZones>>} */
  const zonesOf = new WeakMap(); // stretches beside zones
  /** @type {string[][]} */
  let wishes = []; // the order of each route with its locks
  const grab = createPillDrag(list, {
    strips,
    drop(keys, { sequence, index }) {
      const route = store.state.plan?.result.routes[sequence];
      store.update({ litTarget: null }); // a finger does not leave
      if (route) actions.placeTargets(keys, { uav: route.uav, index });
    },
  });

  /**
   * What keys mean on this page: targets of the plan, and those picked since.
   *
   * @param {MissionPageState} state
   * @param {string} key
   */
  const targetOf = ({ plan, selection }, key) =>
    [...(plan?.targets ?? []), ...selection.targets].find((target) => target.key === key);

  /**
   * The pills of a route.
   *
   * @param {ShownRoute} route
   * @param {MissionPageState} state
   * @param {ShownPlan} plan
   * @param {{ target: number | null, at: number }[]} planned
   */
  function stopsOf(route, { selection }, plan, planned) {
    const stops = planned.map(({ target, at }) => ({ target: plan.targets[target ?? -1]?.key ?? `${target}`, at }));
    const wished = wishes[route.sequence];
    const isAsPlanned = wished.join() === ordersOf(plan)[route.sequence].targets.join();
    const shown = isAsPlanned ? stops : stopsWished(stops, wished, route.length_m || plan.result.longest_route_m);
    return shown.map((stop) => ({ ...stop, isLocked: lockOf(selection, stop.target) !== null }));
  }

  /** @param {ShownRoute} route @param {MissionPageState} state @param {Drawn} drawn @returns {Child} */
  function stripOf(route, state, { plan, longest_m, width_px }) {
    const { waypoints, length_m, sequence, name } = route;
    const strip = spanStrip({
      waypoints,
      length_m,
      longest_m,
      width_px,
      label: stripLabel(
        route,
        wishes[sequence].map((key) => ({
          label: targetOf(state, key)?.label,
          isLocked: lockOf(state.selection, key) !== null,
        })),
      ),
      stopsOf: (planned) => stopsOf(route, state, plan, planned),
      zones: zonesOf.get(waypoints) ?? [],
      waits: staysOf(route).map((stay) => ({ ...stay, words: stayText(stay) })),
      onAlong: (at_m) => store.update({ along: at_m === null ? null : { sequence, at_m, isWished: false } }),
      onTarget: (key) => store.update({ litTarget: key }),
      grab: canPlan && uavsByName(state.selection).some((uav) => uav.name === name) ? grab : undefined,
    });
    strips.set(sequence, strip);
    return [strip.element, h("div", {}, stripTable({ waypoints, length_m, targets: plan.targets, name }))];
  }

  return {
    /** To be called before the routes are drawn. @param {MissionPageState} state @param {ShownPlan} plan */
    begin(state, plan) {
      strips.clear();
      wishes = wishesOf(state, plan);
    },
    /**
     * @param {ShownRoute} route
     * @param {ShortRoute | null} before
     * @param {MissionPageState} state
     * @param {Drawn} drawn
     * @returns {Child}
     */
    draw(route, before, state, drawn) {
      const isShown = Boolean(route.geometry) || wishes[route.sequence].length > 0;
      return [isShown && stripOf(route, state, drawn), before && before.length_m > 0 && oldStrip(before, drawn)];
    },
    /** Whether targets would be moved by what is not planned yet. @param {number} sequence of the route */
    isChanged: (sequence) =>
      (wishes[sequence] ?? []).join() !== (ordersOf(store.state.plan)[sequence]?.targets ?? []).join(),
    /** @param {string | null} target */
    light(target) {
      for (const strip of strips.values()) strip.light(target);
    },
    /** @param {MissionPageState["along"]} along */
    point(along) {
      for (const [sequence, strip] of strips)
        strip.point(along?.sequence === sequence && !along.isWished ? along.at_m : null);
    },
    /**
     * Request where routes go round zones; onFound() once the server has answered.
     *
     * @param {ShownPlan} plan
     * @param {() => void} onFound
     */
    lookForZones(plan, onFound) {
      const flown = routesOf(plan).filter(({ geometry }) => geometry);
      for (const route of flown.slice(0, MAX_LOOKED_AT)) {
        if (zonesOf.has(route.waypoints)) continue;
        grounds(route).then(
          (ground) => {
            const { places } = profileOf(route.waypoints, route.length_m);
            zonesOf.set(route.waypoints, passedZones(ground, route, places, plan.result.departs_at ?? null));
            if (ground.zones.length && store.state.plan === plan) onFound();
          },
          () => {}, // the strip works without them; the profile shows the failure
        );
      }
    },
  };
}
