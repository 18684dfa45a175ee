/** Where UAVs stand: a square with the letter for those of the mission, a dart with the name for the others. Squares can be dragged. */

import { h, icon } from "../../dom.js";
import { maplibre } from "../maplibre.js";
import { routeNumber } from "../palette.js";

const SQUARE_PX = 22;
const DART_MIDDLE_PX = 14; // from a dart's left edge; its name stands to the right

export function createUavs(map, { onMove, onPick, onLook }) {
  let markers = [];

  function square(uav) {
    return h(
      "button",
      {
        type: "button",
        tabindex: "-1",
        class: `map-base route-${routeNumber(uav.sequence)}`,
        "aria-label": `${uav.name} starts here`,
        title: uav.canMove ? `${uav.name}. Drag to another start` : uav.name,
        onpointerenter: () => onLook(uav.sequence),
        onpointerleave: () => onLook(null),
        onclick: (event) => event.stopPropagation(),
      },
      h("span", { class: "letter" }, uav.letter),
    );
  }

  function dart(uav) {
    return h(
      "button",
      {
        type: "button",
        tabindex: "-1",
        class: "map-dart",
        "aria-label": `${uav.name}, not in this mission`,
        title: `${uav.name}. Click to take it along`,
        onclick: (event) => (event.stopPropagation(), onPick(uav.id)),
      },
      icon("uav"),
      h("span", { class: "dart-name", "aria-hidden": "true" }, uav.name),
    );
  }

  return {
    /** uavs: [{ id, name, position, sequence or null, letter, canMove }] */
    update(uavs) {
      markers.forEach((marker) => marker.remove());
      const standing = new Map(); // place → how many squares and darts stand there already
      markers = uavs.map((uav) => {
        const isChosen = uav.sequence !== null;
        const place = uav.position.map((degrees) => degrees.toFixed(5)).join();
        const before = standing.get(place) ?? { squares: 0, darts: 0 };
        standing.set(place, before);
        const marker = isChosen
          ? new maplibre.Marker({ element: square(uav), draggable: uav.canMove, offset: [before.squares++ * SQUARE_PX, 0] })
          : new maplibre.Marker({ element: dart(uav), anchor: "left", offset: [-DART_MIDDLE_PX, ((before.squares > 0 ? 1 : 0) + before.darts++) * SQUARE_PX] });
        marker.on("dragend", () => {
          const { lng, lat } = marker.getLngLat();
          onMove(uav.sequence, [Number(lng.toFixed(6)), Number(lat.toFixed(6))]);
        });
        return marker.setLngLat(uav.position).addTo(map);
      });
    },
  };
}
