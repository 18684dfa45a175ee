/** What the strips and charts draw, as tables for those who do not see them. */

import { h } from "../dom.js";
import { MEASURED, momentOf } from "../record/track.js";
import { t } from "../text.js";
import { exactClockText, heightText, percentText, speedText } from "../units.js";

/** @import { Moment } from "../record/track.js" */
/** @import { ReplayRoute } from "./types.d.ts" */

const ROWS = 12;

/**
 * A table of each UAV: its figures at evenly spaced moments of its flights.
 *
 * @param {readonly ReplayRoute[]} routes
 */
export function replayTables(routes) {
  return routes
    .filter(({ track }) => track.samples.length)
    .map(({ name, track }) => {
      const [from_ms, to_ms] = [track.samples[0].at_ms, track.samples[track.samples.length - 1].at_ms];
      const moments = Array.from({ length: ROWS }, (_, index) => from_ms + ((to_ms - from_ms) * index) / (ROWS - 1));
      const head = [t("Time"), t("Height above take-off"), t("Speed"), t("Battery")];
      return h(
        "table",
        {},
        h("caption", {}, t("{name}, by time", { name })),
        h(
          "thead",
          {},
          h(
            "tr",
            {},
            head.map((words) => h("th", { scope: "col" }, words)),
          ),
        ),
        h(
          "tbody",
          {},
          moments.map((at_ms) => row(at_ms, momentOf(track, at_ms))),
        ),
      );
    });
}

/** @param {number} at_ms @param {Moment} moment */
function row(at_ms, moment) {
  if (moment?.kind !== MEASURED)
    return h(
      "tr",
      {},
      h("th", { scope: "row" }, exactClockText(at_ms)),
      h("td", { colspan: 3 }, t("nothing measured")),
    );
  const { height_m, speed_mps, battery_percent } = moment.sample;
  /** @param {number | null} value @param {(value: number) => string} text */
  const summary = (value, text) => h("td", {}, value === null ? "—" : text(value));
  return h(
    "tr",
    {},
    h("th", { scope: "row" }, exactClockText(at_ms)),
    summary(height_m, heightText),
    summary(speed_mps, speedText),
    summary(battery_percent, percentText),
  );
}
