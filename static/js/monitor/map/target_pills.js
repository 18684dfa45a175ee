/** Targets of what flies, by their state: complete filled, failed red, skipped dashed, the rest open. */

import { h } from "../../dom.js";
import { routeNumber } from "../../domain/palette.js";
import { maplibre } from "../../map/maplibre.js";
import { mergePills } from "../../map/pills.js";
import { t } from "../../text.js";
import { STATES } from "../board.js";

/** @import { TargetState } from "../../api_types.d.ts" */
/** @import { MapLibreMap } from "../../map/types.d.ts" */
/** @import { Pill } from "../../map/pills.js" */

const MOST = 200;
const stateOf = (members) => (members.every(({ state }) => state === members[0].state) ? members[0].state : "pending");

export function createTargetPills(map) {
  let pills = [];
  let markers = [];
  let drawn = "";

  function draw() {
    const placed = pills.slice(0, MOST).map((pill) => ({ ...pill, ...map.project(pill.position) }));
    const groups = mergePills(placed);
    const now = JSON.stringify(
      groups.map(({ label, members }) => [label, members.map(({ key, state }) => [key, state])]),
    );
    if (now === drawn) return;
    drawn = now;
    markers.forEach((marker) => marker.remove());
    markers = groups.map(({ members, label }) => {
      const [first] = members;
      const state = stateOf(members);
      const words = members.map(({ name, state: own }) => `${name}: ${STATES[own].words}`).join("; ");
      const element = h(
        "span",
        {
          class: `map-pill live-pill ${state} ${first.sequence === null ? "waiting" : `route-${routeNumber(first.sequence)}`}`,
          role: "img",
          "aria-label": t("Target {label}: {names}", { label, names: words }),
          title: words,
        },
        h("span", { class: "pill" }, label),
      );
      return new maplibre.Marker({ element, subpixelPositioning: true }).setLngLat(first.position).addTo(map);
    });
  }

  map.on("zoomend", draw);
  return {
    /** pills: [{ key, position, sequence or null, letter, number, name, state, isMissed: false }] */
    update(next) {
      pills = next;
      draw();
    },
  };
}
