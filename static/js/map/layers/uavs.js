/** Where UAVs stand: a square with the letter for those of the mission, a dart with the name for the others. Squares can be dragged. */

import { h, svg } from "../../dom.js";
import { maplibre } from "../maplibre.js";
import { t } from "../../text.js";
import { routeNumber } from "../palette.js";

const SQUARE_PX = 22;
const DART_MIDDLE_PX = 14; // from a dart's left edge; its name stands to the right

const headingWords = ({ heading_deg }) => (knows(heading_deg) ? t("heading {degrees}°", { degrees: String(Math.round(heading_deg) % 360).padStart(3, "0") }) : "");
const knows = (heading_deg) => heading_deg !== null && heading_deg !== undefined;

/** A dart along its heading; without one a round mark that points nowhere. */
function uavMark({ heading_deg }) {
  const turned = knows(heading_deg) ? { style: `rotate: ${heading_deg}deg` } : {};
  const shape = knows(heading_deg) ? svg("path", { d: "M12 2.5L19.5 21L12 16.8L4.5 21Z" }) : svg("circle", { cx: 12, cy: 12, r: 7 });
  return svg("svg", { class: "icon", viewBox: "0 0 24 24", "aria-hidden": "true", ...turned }, shape);
}

export function createUavs(map, { onMove, onPick, onLook }) {
  let markers = [];

  function square(uav) {
    return h(
      "button",
      {
        type: "button",
        tabindex: "-1",
        class: `map-base route-${routeNumber(uav.sequence)}`,
        "aria-label": t("{name} starts here", { name: uav.name }),
        title: uav.canMove ? t("{name}. Drag to another start", { name: uav.name }) : uav.name,
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
        "aria-label": [t("{name}, not in this mission", { name: uav.name }), headingWords(uav)].filter(Boolean).join(", "),
        title: [t("{name}. Click to take it along", { name: uav.name }), headingWords(uav)].filter(Boolean).join(" · "),
        onclick: (event) => (event.stopPropagation(), onPick(uav.id)),
      },
      uavMark(uav),
      h("span", { class: "dart-name", "aria-hidden": "true" }, uav.name),
    );
  }

  return {
    /** uavs: [{ id, name, position, heading_deg, sequence or null, letter, canMove }] */
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
