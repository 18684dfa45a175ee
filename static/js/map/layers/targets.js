/** Target pills: HTML up to 200, a layer beyond. Pills of one UAV that would overlap are merged: "C3–4". */

import { h } from "../../dom.js";
import { routeNumber } from "../../domain/palette.js";
import { t, tn } from "../../text.js";
import { maplibre } from "../maplibre.js";
import { mergePills } from "../pills.js";

const MOST_MARKERS = 200;
const MOST_NAMES = 6;
const REACH_PX = 4;
const MISSED = -1; // instead of a route's number

const lookOf = (pill) =>
  pill.isMissed ? "missed" : pill.sequence === null ? "waiting" : `route-${routeNumber(pill.sequence)}`;

function namesOf(members) {
  const names = members.slice(0, MOST_NAMES).map((pill) => pill.name);
  const rest = members.length - names.length;
  const more = rest > 0 ? ` ${tn(rest, "and {count} more", "and {count} more")}` : "";
  return `${names.join("; ")}${more}${members[0].isMissed ? `: ${t("not reached")}` : ""}`;
}

export function createTargets(map, { onPick, onHover }) {
  let pills = [];
  let markers = new Map(); // what a group says → { marker, members, element }
  let lookedAt = null;
  let chosen = "";
  let hovered = null; // the element under the pointer: it may be taken away without the pointer leaving it

  function elementOf({ members, label }) {
    const [first] = members;
    const names = namesOf(members);
    const element = h(
      "button",
      {
        type: "button",
        class: `map-pill ${lookOf(first)}`,
        "aria-label": t("Target {label}: {names}", { label, names }),
        title: names,
        tabindex: "-1",
        onclick: (event) => (event.stopPropagation(), onPick(first.key)),
        onpointerenter: () => {
          hovered = element;
          onHover(first.key);
        },
        onpointerleave: () => {
          hovered = null;
          onHover(null);
        },
      },
      h("span", { class: "pill" }, label),
    );
    return element;
  }

  /** Markers that say the same as before stay, so that the pointer and the focus stay with them. */
  function draw() {
    const next = new Map();
    const placed = pills.length > MOST_MARKERS ? [] : pills.map((pill) => ({ ...pill, ...map.project(pill.position) }));
    for (const group of mergePills(placed)) {
      const [first] = group.members;
      const key = JSON.stringify([group.label, lookOf(first), first.position, group.members.map((pill) => pill.key)]);
      const kept = markers.get(key);
      const element = kept?.element ?? elementOf(group);
      const marker =
        kept?.marker ??
        new maplibre.Marker({ element, subpixelPositioning: true }).setLngLat(first.position).addTo(map);
      next.set(key, { marker, element, members: group.members });
    }
    for (const [key, { marker, element }] of markers) {
      if (next.has(key)) continue;
      marker.remove();
      if (element === hovered) {
        hovered = null;
        onHover(null);
      }
    }
    markers = next;
    mark();
  }

  function mark() {
    for (const { element, members } of markers.values()) {
      element.classList.toggle("far", lookedAt !== null && members[0].sequence !== lookedAt);
      element.classList.toggle(
        "chosen",
        members.some((pill) => pill.key === chosen),
      );
    }
  }

  map.on("zoomend", draw);
  return {
    /** pills: [{ key, position, sequence or null, letter, number, name, isMissed }] */
    update(next) {
      pills = next;
      const isMany = pills.length > MOST_MARKERS;
      map.getSource("many-targets").setData({
        type: "FeatureCollection",
        features: isMany
          ? pills.map((pill) => ({
              type: "Feature",
              properties: {
                key: pill.key,
                route: pill.isMissed ? MISSED : pill.sequence === null ? 0 : routeNumber(pill.sequence),
                label: pill.isMissed ? "×" : `${pill.letter}${pill.number}`,
              },
              geometry: { type: "Point", coordinates: pill.position },
            }))
          : [],
      });
      draw();
    },
    /** The target of the layer at a place on the screen, where there are too many for markers: its key, or null. */
    at({ x, y }) {
      if (pills.length <= MOST_MARKERS) return null;
      const box = [
        [x - REACH_PX, y - REACH_PX],
        [x + REACH_PX, y + REACH_PX],
      ];
      return map.queryRenderedFeatures(box, { layers: ["many-targets"] })[0]?.properties.key ?? null;
    },
    lookAt(sequence) {
      lookedAt = sequence;
      mark();
    },
    choose(key) {
      chosen = key ?? "";
      mark();
    },
  };
}
