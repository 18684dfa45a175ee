/** Target pills: HTML up to 200, a layer beyond. Pills of one route that would overlap are merged: "C3–4". */

import { h } from "../../dom.js";
import { maplibre } from "../maplibre.js";
import { routeNumber } from "../palette.js";
import { mergedLabel, mergePills } from "../pills.js";

const MOST_MARKERS = 200;
const MOST_NAMES = 6;

export function createTargets(map, { onPick, onHover }) {
  let pills = [];
  let markers = [];
  let lookedAt = null;
  let chosen = "";

  function elementOf(group) {
    const [first] = group.members;
    const label = mergedLabel(first.letter, group.members.map((pill) => pill.number));
    const names = group.members.slice(0, MOST_NAMES).map((pill) => pill.name).join("; ");
    const element = h(
      "button",
      {
        type: "button",
        class: `map-pill ${first.sequence === null ? "" : `route-${routeNumber(first.sequence)}`}`,
        "aria-label": `Target ${label}: ${names}`,
        title: names,
        tabindex: "-1",
        onclick: (event) => (event.stopPropagation(), onPick(first.key)),
        onpointerenter: () => onHover(first.key),
        onpointerleave: () => onHover(null),
      },
      h("span", { class: "pill" }, label),
    );
    element.classList.toggle("far", lookedAt !== null && first.sequence !== lookedAt);
    element.classList.toggle("chosen", group.members.some((pill) => pill.key === chosen));
    return element;
  }

  function draw() {
    markers.forEach((marker) => marker.remove());
    markers = [];
    if (pills.length > MOST_MARKERS) return;
    const placed = pills.map((pill) => ({ ...pill, ...map.project(pill.position) }));
    for (const group of mergePills(placed)) {
      const marker = new maplibre.Marker({ element: elementOf(group), subpixelPositioning: true });
      markers.push(marker.setLngLat(group.members[0].position).addTo(map));
    }
  }

  map.on("zoomend", draw);
  return {
    /** pills: [{ key, position, sequence or null, letter, number, name }] */
    update(next) {
      pills = next;
      const isMany = pills.length > MOST_MARKERS;
      map.getSource("many-targets").setData({
        type: "FeatureCollection",
        features: isMany
          ? pills.map((pill) => ({
              type: "Feature",
              properties: { route: pill.sequence === null ? 0 : routeNumber(pill.sequence), label: `${pill.letter}${pill.number}` },
              geometry: { type: "Point", coordinates: pill.position },
            }))
          : [],
      });
      draw();
    },
    lookAt(sequence) {
      lookedAt = sequence;
      draw();
    },
    choose(key) {
      chosen = key ?? "";
      draw();
    },
  };
}
