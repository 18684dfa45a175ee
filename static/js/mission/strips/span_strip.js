/**
 * The span strip: a route pulled straight. Distance runs to the right, ticks are towers, circles are targets, pills
 * several of them.
 */

import { h, svg } from "../../dom.js";
import { profileOf } from "../../domain/route_profile.js";
import { staticAddress } from "../../static_address.js";
import { t } from "../../text.js";
import { LONG_UNIT, lengthText, numberText } from "../../units.js";
import { zoneWords } from "../options/zones_passed.js";

/** @import { Waypoint } from "../../api_types.d.ts" */
/** @import { PassedZone } from "../options/zones_passed.js" */
/** @import { PickedTarget } from "../types.d.ts" */

/** @typedef {ReturnType<typeof profileOf>} FlownProfile */
/** @typedef {FlownProfile["targets"]} FlownTargets */
/**
 * A target on a strip, `at` metres flown.
 *
 * @template Target
 * @typedef {{ target: Target, at: number, isLocked?: boolean, isMoved?: boolean }} Stop
 */
/**
 * @template Target
 * @typedef {Omit<FlownProfile, "targets"> & { targets: Stop<Target>[] }} StripProfile
 */
/**
 * A target of a pill, at x px.
 *
 * @template Target
 * @typedef {Omit<Stop<Target>, "at"> & { x: number, number: number }} Member
 */
/**
 * Neighbouring targets in one mark.
 *
 * @template Target
 * @typedef {object} Pill
 * @property {Member<Target>[]} members
 * @property {number} first number of its first target
 * @property {number} last
 * @property {Target[]} targets
 * @property {string} label
 * @property {number} true_x
 * @property {number} x
 * @property {number} width
 */
/** @typedef {(event: PointerEvent, keys: string[], label: string) => void} Grab a pill is pressed */
/** @typedef {{ onTarget?: (key: string | null) => void, grab?: Grab }} PillHandlers */
/** @typedef {{ kind: "base" | "charging", words: string }} Wait */
/**
 * @typedef {PillHandlers & {
 *   longest_m: number, width_px: number, label: string, zones?: PassedZone[],
 *   waypoints: readonly Waypoint[], length_m: number,
 *   waits?: (Wait & { index: number })[],
 *   stopsOf: (targets: FlownTargets) => Stop<string>[],
 *   onAlong?: (at_m: number | null) => void,
 * }} StripOptions
 */
/**
 * @typedef {PillHandlers & {
 *   profile: StripProfile<string>, longest_m: number, width_px: number, label: string, zones: PassedZone[], waits?: (Wait & { at: number })[],
 * }} DrawingOptions
 */
/** @typedef {ReturnType<typeof spanStrip>} Strip */

const TICK_SPACING_PX = 3.5;
const TARGET_SPACING_PX = 19;
const LETTER_PX = 7;
const MAX_PUSHED_PX = 14; // from the true place; more, and neighbours become one pill
const HEIGHT_PX = 34;
const MIDDLE_PX = 18;
const EDGE_PX = 10;

/**
 * The axis that strips and the profile share: distance flown [m] to px, and back.
 *
 * @param {number} longest_m
 * @param {number} width_px
 */
export function scaleOf(longest_m, width_px) {
  const room = width_px - 2 * EDGE_PX;
  return {
    /** @param {number} distance_m */
    x: (distance_m) => EDGE_PX + (longest_m > 0 ? (distance_m / longest_m) * room : 0),
    /** @param {number} x [px] */
    distanceAt: (x) => (room > 0 ? ((x - EDGE_PX) / room) * longest_m : 0),
  };
}

/**
 * Places in px: ticks thinned, targets pushed apart when they would touch, and merged into one pill where that would
 * push them far.
 *
 * @template Target
 * @param {StripProfile<Target>} profile
 * @param {number} longest_m
 * @param {number} width_px
 */
export function layOut(profile, longest_m, width_px) {
  const { x } = scaleOf(longest_m, width_px);
  /** @type {number[]} */
  const ticks = [];
  for (const distance of profile.ticks) {
    if (x(distance) - (ticks.at(-1) ?? -Infinity) >= TICK_SPACING_PX) ticks.push(x(distance));
  }
  const [start, end] = [x(0), x(profile.places.at(-1) ?? 0)];
  const pills = placePills(
    profile.targets.map(({ at, ...stop }) => ({ ...stop, x: x(at) })),
    start,
    end,
    width_px,
  );
  return { ticks, pills, legs: profile.legs.map((leg) => ({ ...leg, x1: x(leg.from), x2: x(leg.to) })), start, end };
}

/** @param {string} label */
const widthOf = (label) => Math.max(TARGET_SPACING_PX - 1, label.length * LETTER_PX + 10);

/**
 * Pills of neighbouring targets, "3" or "3–9", that stay on the strip: [{ first, last, targets, label, x, width }], in
 * order.
 *
 * @template Target
 * @param {(Omit<Stop<Target>, "at"> & { x: number })[]} targets
 * @param {number} start_px
 * @param {number} end_px
 * @param {number} width_px
 * @returns {Pill<Target>[]}
 */
export function placePills(targets, start_px, end_px, width_px) {
  let pills = targets.map((stop, index) => pillOf([{ ...stop, number: index + 1 }]));
  for (;;) {
    keepApart(pills, start_px, end_px, width_px);
    if (
      pills.length < 2 ||
      pills.every((pill) => Math.abs(pill.x - pill.true_x) <= MAX_PUSHED_PX && isOnStrip(pill, start_px, end_px))
    )
      return pills;
    const gaps = pills
      .slice(1)
      .map((pill, index) => pill.true_x - pills[index].true_x - (pill.width + pills[index].width) / 2);
    const at = gaps.indexOf(Math.min(...gaps));
    pills = [...pills.slice(0, at), pillOf([...pills[at].members, ...pills[at + 1].members]), ...pills.slice(at + 2)];
  }
}

/** @template Target @param {Member<Target>[]} members @returns {Pill<Target>} */
function pillOf(members) {
  const [begin, end] = [members[0], members[members.length - 1]];
  const [first, last] = [begin.number, end.number];
  const label = first === last ? `${first}` : `${first}–${last}`;
  const true_x = (begin.x + end.x) / 2;
  return {
    members,
    first,
    last,
    targets: members.map(({ target }) => target),
    label,
    true_x,
    x: true_x,
    width: widthOf(label),
  };
}

/** @param {{ x: number }} pill @param {number} start_px @param {number} end_px */
const isOnStrip = (pill, start_px, end_px) => pill.x >= start_px - 1 && pill.x <= end_px + 1;

/**
 * Move pills to the right so that they do not overlap, and those beyond the strip's end back to the left; all stay in the drawing.
 *
 * @param {{ x: number, true_x: number, width: number }[]} pills
 * @param {number} start_px
 * @param {number} end_px
 * @param {number} width_px
 */
function keepApart(pills, start_px, end_px, width_px) {
  /** @param {{ width: number }} a @param {{ width: number }} b */
  const spacing = (a, b) => (a.width + b.width) / 2 + 1;
  for (const pill of pills) pill.x = pill.true_x;
  for (let index = 0; index < pills.length; index += 1) {
    const least = index ? pills[index - 1].x + spacing(pills[index - 1], pills[index]) : pills[0].width / 2;
    pills[index].x = Math.max(pills[index].x, least);
  }
  for (let index = pills.length - 1; index >= 0; index -= 1) {
    const after = pills[index + 1];
    const most = after
      ? after.x - spacing(pills[index], after)
      : Math.min(Math.max(end_px, start_px + pills[index].width / 2), width_px - pills[index].width / 2);
    pills[index].x = Math.min(pills[index].x, most);
  }
}

/**
 * Round figures for the axis, in the reader's long unit (km): at most six.
 *
 * @param {number} longest_m
 * @param {number} [unit_m]
 */
export function axisTicks(longest_m, unit_m = LONG_UNIT.metres) {
  const longest = longest_m / unit_m;
  if (!(longest > 0)) return [0];
  const rough = longest / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((candidate) => candidate >= rough) ?? 10 * power;
  return Array.from({ length: Math.floor(longest / step + 1e-9) + 1 }, (_, index) =>
    Number((index * step).toPrecision(6)),
  );
}

/**
 * Draws the strip. onAlong(metres flown or null). `zones` are stretches beside zones: [{ from_m, to_m, name, kind }],
 * `waits`
 * stops at bases and on towers: [{ index of the waypoint, kind, words }].
 *
 * stopsOf(targets of the profile) are what is drawn as pills: [{ target, at, isLocked?, isMoved? }]; grab(event,
 * targets, label): a pill is
 * pressed. Returns { element, point(metres or null), light(target or null), indexAt(clientX, without), showGap(index or
 * null, without) }.
 *
 * @param {StripOptions} options
 */
export function spanStrip({
  waypoints,
  length_m,
  longest_m,
  width_px,
  label,
  zones = [],
  waits = [],
  stopsOf,
  onAlong,
  onTarget,
  grab,
}) {
  const flown = profileOf(waypoints, length_m);
  const profile = { ...flown, targets: stopsOf(flown.targets) };
  const places = waits.map(({ index, ...wait }) => ({ ...wait, at: flown.places[index] }));
  const { element, plan, x, pills } = drawing({
    profile,
    longest_m,
    width_px,
    label,
    zones,
    waits: places,
    onTarget,
    grab,
  });
  const { distanceAt } = scaleOf(longest_m, width_px);
  const cursor = svg("line", { y1: 0, y2: HEIGHT_PX, class: "strip-cursor", visibility: "hidden" });
  const gap = svg("line", { y1: 3, y2: HEIGHT_PX - 3, class: "strip-gap", visibility: "hidden" });
  element.append(cursor, gap);
  /** @param {string[]} without */
  const others = (without) =>
    plan.pills.flatMap((pill) => pill.members.filter(({ target }) => !without.includes(target)).map(() => pill.x));
  element.addEventListener("pointermove", (event) => {
    const at = Math.min(plan.end, Math.max(plan.start, event.clientX - element.getBoundingClientRect().left));
    onAlong?.(Math.min(length_m, Math.max(0, distanceAt(at))));
  });
  element.addEventListener("pointerleave", () => onAlong?.(null));
  return {
    element,
    /** @param {number | null} at_m */
    point(at_m) {
      cursor.setAttribute("visibility", at_m === null ? "hidden" : "visible");
      if (at_m === null) return;
      cursor.setAttribute("x1", `${x(at_m)}`);
      cursor.setAttribute("x2", `${x(at_m)}`);
    },
    /** @param {string | null} target */
    light(target) {
      for (const { element: pill, targets } of pills)
        pill.classList.toggle("lit", target !== null && targets.includes(target));
    },
    /** Index of the pointer among the other targets. @param {number} clientX @param {string[]} without */
    indexAt(clientX, without) {
      const at = clientX - element.getBoundingClientRect().left;
      return others(without).filter((place) => place < at).length;
    },
    /** @param {number | null} index @param {string[]} without */
    showGap(index, without) {
      gap.setAttribute("visibility", index === null ? "hidden" : "visible");
      if (index === null) return;
      const places = others(without);
      const [before, after] = [places[index - 1] ?? plan.start, places[index] ?? plan.end];
      const at = `${places.length && index === places.length ? Math.min(before + TARGET_SPACING_PX, width_px - 2) : (before + after) / 2}`;
      gap.setAttribute("x1", at);
      gap.setAttribute("x2", at);
    },
  };
}

/**
 * A strip of a plan in short, without a pointer: the same drawing, pale.
 *
 * @param {{ profile: StripProfile<string>, longest_m: number, width_px: number, label: string }} options
 */
export function paleStrip({ profile, longest_m, width_px, label }) {
  const { element } = drawing({ profile, longest_m, width_px, label, zones: [] });
  element.classList.add("pale");
  return element;
}

const LOCK_PX = 11;

/**
 * One pill: a number, or several; with a lock on its shoulder.
 *
 * @param {Pill<string>} pill
 * @param {PillHandlers} handlers
 */
function drawPill({ x: at, width, label, targets, members }, { onTarget, grab }) {
  const isLocked = members.some((member) => member.isLocked);
  const shoulder = at + width / 2 - 1;
  const element = svg(
    "g",
    { class: `strip-target${members.some(({ isMoved }) => isMoved) ? " moved" : ""}${grab ? " movable" : ""}` },
    svg("rect", { x: at - width / 2, y: MIDDLE_PX - 9, width, height: 18, rx: 9 }),
    svg("text", { x: at, y: MIDDLE_PX + 4 }, label),
    isLocked && svg("circle", { class: "strip-lock-ground", cx: shoulder, cy: 8, r: 7 }),
    isLocked &&
      svg("use", {
        class: "strip-lock",
        href: `${staticAddress("lib/icons.svg")}#lock`,
        x: shoulder - LOCK_PX / 2,
        y: 8 - LOCK_PX / 2,
        width: LOCK_PX,
        height: LOCK_PX,
      }),
  );
  if (onTarget) {
    element.addEventListener("pointerenter", () => onTarget(targets[0]));
    element.addEventListener("pointerleave", () => onTarget(null));
  }
  if (grab) {
    element.addEventListener("pointerdown", (event) => grab(event, targets, label));
    element.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false }); // the finger moves the pill, not the page
  }
  return { element, targets };
}

/**
 * The mark of a zone: a block if it obstructs the route, a bracket if it is passed by or lies at another height. Zones out of force are
 * left out.
 *
 * @param {PassedZone} zone
 * @param {(distance_m: number) => number} x
 */
function zoneMark(zone, x) {
  const [left, right] = [x(zone.from_m), Math.max(x(zone.to_m), x(zone.from_m) + 3)];
  const title = svg("title", {}, zoneWords(zone));
  if (zone.kind === "met")
    return svg("rect", { class: "strip-zone", x: left, y: MIDDLE_PX - 10, width: right - left, height: 20 }, title);
  return svg(
    "path",
    { class: "strip-zone-beside", d: `M${left} ${HEIGHT_PX - 5}V${HEIGHT_PX - 1}H${right}V${HEIGHT_PX - 5}` },
    title,
  );
}

/** @param {DrawingOptions} options */
function drawing({ profile, longest_m, width_px, label, zones, waits = [], onTarget, grab }) {
  const plan = layOut(profile, longest_m, width_px);
  const { x } = scaleOf(longest_m, width_px);
  const pills = plan.pills.map((pill) => drawPill(pill, { onTarget, grab }));
  /** @param {number} at [px] */
  const mark = (at) => svg("rect", { x: at - 4, y: MIDDLE_PX - 4, width: 8, height: 8, class: "strip-base" });
  const element = svg(
    "svg",
    {
      class: "strip",
      role: "img",
      "aria-label": label,
      width: width_px,
      height: HEIGHT_PX,
      viewBox: `0 0 ${width_px} ${HEIGHT_PX}`,
    },
    zones.filter(({ kind }) => kind !== "asleep").map((zone) => zoneMark(zone, x)),
    plan.ticks.map((at) => svg("line", { x1: at, x2: at, y1: MIDDLE_PX - 6, y2: MIDDLE_PX - 1, class: "strip-tick" })),
    plan.legs.map((leg) =>
      svg("line", {
        x1: leg.x1,
        x2: leg.x2,
        y1: MIDDLE_PX,
        y2: MIDDLE_PX,
        class: leg.offNetwork ? "strip-leg off" : "strip-leg",
      }),
    ),
    mark(plan.start),
    mark(plan.end),
    waits.map(({ at, kind, words }) =>
      svg(
        "g",
        { class: "strip-wait" },
        svg("title", {}, words),
        kind === "base"
          ? mark(x(at))
          : svg("path", { d: `M${x(at) + 1} 2L${x(at) - 4} 9H${x(at)}L${x(at) - 1} 15L${x(at) + 4} 7.5H${x(at)}Z` }),
      ),
    ),
    pills.map((pill) => pill.element),
  );
  return { element, plan, x, pills };
}

/** The axis under a list of strips. @param {number} longest_m @param {number} width_px */
export function stripAxis(longest_m, width_px) {
  const { x } = scaleOf(longest_m, width_px);
  const ticks = axisTicks(longest_m);
  const digits = Math.max(0, ...ticks.map((tick) => (`${tick}`.split(".")[1] ?? "").length));
  return svg(
    "svg",
    { class: "strip-axis", width: width_px, height: 22, "aria-hidden": "true" },
    ticks.map((tick, index) => {
      const at = x(tick * LONG_UNIT.metres);
      const figure = numberText(tick, Number.isInteger(tick) ? 0 : digits);
      return [
        svg("line", { x1: at, x2: at, y1: 0, y2: 4 }),
        svg("text", { x: at, y: 16 }, index === ticks.length - 1 ? `${figure}\u00a0${LONG_UNIT.unit}` : figure),
      ];
    }),
  );
}

/**
 * The strip's table for those who do not see it: targets in order with the distance flown to each.
 *
 * @param {{ waypoints: readonly Waypoint[], length_m: number, targets: (PickedTarget | undefined)[], name: string }} route
 */
export function stripTable({ waypoints, length_m, targets, name }) {
  const profile = profileOf(waypoints, length_m);
  return h(
    "table",
    { class: "unseen" },
    h("caption", {}, t("Route of {name}", { name })),
    h("thead", {}, h("tr", {}, h("th", { scope: "col" }, t("Target")), h("th", { scope: "col" }, t("Distance flown")))),
    h(
      "tbody",
      {},
      profile.targets.map(({ target, at }) =>
        h("tr", {}, h("td", {}, targets[target ?? -1]?.label ?? t("Target")), h("td", {}, lengthText(at))),
      ),
    ),
  );
}
