/** Targets of UAVs in flight by state: complete filled, failed red, skipped dashed, the rest open. */

import { h } from "../../dom.js";
import { colourClass } from "../../domain/palette.js";
import { maplibre } from "../../map/maplibre.js";
import { mergePills } from "../../map/pills.js";
import { t } from "../../text.js";
import { STATES } from "../board.js";

/** @import { Marker } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { TargetState } from "../../api_types.d.ts" */
/** @import { MapLibreMap } from "../../map/types.d.ts" */
/** @import { Pill } from "../../map/pills.js" */

/** @typedef {Omit<Pill, "x" | "y"> & { position: number[], state: TargetState, colour: number | null }} TargetPill */

const MAX_PILLS = 200;
/** @param {TargetPill[]} members @returns {TargetState} */
const stateOf = (members) => (members.every(({ state }) => state === members[0].state) ? members[0].state : "pending");

/** @param {MapLibreMap} map */
export function createTargetPills(map) {
  /** @type {TargetPill[]} */
  let pills = [];
  /** @type {Marker[]} */
  let markers = [];
  let drawn = "";

  function draw() {
    const placed = pills.slice(0, MAX_PILLS).map((pill) => {
      const [longitude, latitude] = pill.position;
      const { x, y } = map.project([longitude, latitude]);
      return { ...pill, x, y };
    });
    const groups = mergePills(placed);
    const now = JSON.stringify(
      groups.map(({ label, members }) => [label, members.map(({ key, state }) => [key, state])]),
    );
    if (now === drawn) return;
    drawn = now;
    for (const marker of markers) marker.remove();
    markers = groups.map(({ members, label }) => {
      const [first] = members;
      const [longitude, latitude] = first.position;
      const state = stateOf(members);
      const words = members.map(({ name, state: own }) => `${name}: ${STATES[own].words}`).join("; ");
      const element = h(
        "span",
        {
          class: `map-pill live-pill ${state} ${colourClass(first.colour) || "waiting"}`,
          role: "img",
          "aria-label": t("Target {label}: {names}", { label, names: words }),
          title: words,
        },
        h("span", { class: "pill" }, label),
      );
      return new maplibre.Marker({ element, subpixelPositioning: true }).setLngLat([longitude, latitude]).addTo(map);
    });
  }

  map.on("zoomend", draw);
  return {
    /** @param {TargetPill[]} next */
    update(next) {
      pills = next;
      draw();
    },
  };
}
