/** A route pulled straight, with its UAV on it: what is flown is thick, the 95 % interval a bracket. */

import { svg } from "../dom.js";
import { layOut, scaleOf } from "../mission/span_strip.js";

const HEIGHT_PX = 34;
const MIDDLE_PX = 18;
const DART = "M-8 -6.5L8 0L-8 6.5L-4.5 0Z";

/** profile: of profileOf; along_m: flown of it, null where that is not known; half_m: of the interval, 0 without. */
export function liveStrip({ profile, length_m, along_m, half_m, kind, width_px, label }) {
  const plan = layOut(profile, length_m, width_px);
  const { x } = scaleOf(length_m, width_px);
  const at = along_m === null ? null : x(Math.min(length_m, Math.max(0, along_m)));
  const flown = at === null ? plan.start : at;
  const clipped = (legs, from, to) => legs.filter((leg) => leg.x2 > from && leg.x1 < to).map((leg) => ({ ...leg, x1: Math.max(leg.x1, from), x2: Math.min(leg.x2, to) }));
  const line = (leg, name) => svg("line", { x1: leg.x1, x2: leg.x2, y1: MIDDLE_PX, y2: MIDDLE_PX, class: `strip-leg ${name}${leg.offNetwork ? " off" : ""}` });
  const base = (place) => svg("rect", { x: place - 4, y: MIDDLE_PX - 4, width: 8, height: 8, class: "strip-base" });
  const [low, high] = at === null || !half_m ? [0, 0] : [x(Math.max(0, along_m - half_m)), x(Math.min(length_m, along_m + half_m))];
  return svg(
    "svg",
    { class: "strip live-strip", role: "img", "aria-label": label, width: width_px, height: HEIGHT_PX, viewBox: `0 0 ${width_px} ${HEIGHT_PX}` },
    plan.ticks.map((tick) => svg("line", { x1: tick, x2: tick, y1: MIDDLE_PX - 6, y2: MIDDLE_PX - 1, class: "strip-tick" })),
    clipped(plan.legs, flown, plan.end).map((leg) => line(leg, "ahead")),
    clipped(plan.legs, plan.start, flown).map((leg) => line(leg, "flown")),
    base(plan.start),
    base(plan.end),
    plan.pills.map(({ x: place, width, label: number }) => svg("g", { class: `strip-target${place <= flown ? " passed" : ""}` }, svg("rect", { x: place - width / 2, y: MIDDLE_PX - 9, width, height: 18, rx: 9 }), svg("text", { x: place, y: MIDDLE_PX + 4 }, number))),
    high > low && svg("path", { class: "strip-interval", d: `M${low + 3} 4H${low}V32H${low + 3}M${high - 3} 4H${high}V32H${high - 3}` }),
    at !== null && svg("path", { class: `strip-uav ${kind}`, d: DART, transform: `translate(${at} ${MIDDLE_PX})` }),
  );
}
