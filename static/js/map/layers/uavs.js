/**
 * Where UAVs stand: a square with the letter for those of the mission, a dart with the name for the others. Squares can be dragged.
 * Darts that would cover each other are one mark with their number; a click spreads them out until the map is zoomed.
 */

import { h, svg } from "../../dom.js";
import { routeNumber } from "../../domain/palette.js";
import { t } from "../../text.js";
import { maplibre } from "../maplibre.js";
import { mergeDarts } from "../pills.js";

const SQUARE_PX = 22;
const DART_MIDDLE_PX = 14; // from a dart's left edge; its name stands to the right

const headingWords = ({ heading_deg }) =>
  knows(heading_deg)
    ? t("heading {degrees}°", { degrees: String(Math.round(heading_deg) % 360).padStart(3, "0") })
    : "";
const knows = (heading_deg) => heading_deg !== null && heading_deg !== undefined;

/** A dart along its heading; without one a round mark that points nowhere. */
function uavMark({ heading_deg }) {
  const turned = knows(heading_deg) ? { style: `rotate: ${heading_deg}deg` } : {};
  const shape = knows(heading_deg)
    ? svg("path", { d: "M12 2.5L19.5 21L12 16.8L4.5 21Z" })
    : svg("circle", { cx: 12, cy: 12, r: 7 });
  return svg("svg", { class: "icon", viewBox: "0 0 24 24", "aria-hidden": "true", ...turned }, shape);
}

export function createUavs(map, { onMove, onPick, onLook }) {
  let squares = [];
  let darts = [];
  let others = []; // UAVs that are not of the mission
  let standing = new Map(); // place → how many squares stand there
  let spread = ""; // the group that is spread out, by its UAVs

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
        "aria-label": [t("{name}, not in this mission", { name: uav.name }), headingWords(uav)]
          .filter(Boolean)
          .join(", "),
        title: [t("{name}. Click to take it along", { name: uav.name }), headingWords(uav)].filter(Boolean).join(" · "),
        onclick: (event) => (event.stopPropagation(), onPick(uav.id)),
      },
      uavMark(uav),
      h("span", { class: "dart-name", "aria-hidden": "true" }, uav.name),
    );
  }

  function several({ members, label }) {
    const names = members.map((uav) => uav.name).join(", ");
    return h(
      "button",
      {
        type: "button",
        tabindex: "-1",
        class: "map-dart several",
        "aria-label": t("{uavs}, not in this mission: {names}", { uavs: label, names }),
        title: t("{names}. Click to see each", { names }),
        onclick: (event) => (event.stopPropagation(), (spread = keyOf(members)), drawDarts()),
      },
      uavMark({}),
      h("span", { class: "dart-name", "aria-hidden": "true" }, label),
    );
  }

  function drawDarts() {
    darts.forEach((marker) => marker.remove());
    const placed = others.map((uav) => ({ ...uav, ...map.project(uav.position) }));
    darts = mergeDarts(placed).flatMap((group) => {
      const [first] = group.members;
      const below = standing.has(placeOf(first)) ? 1 : 0;
      const at = (element, row) =>
        new maplibre.Marker({ element, anchor: "left", offset: [-DART_MIDDLE_PX, (below + row) * SQUARE_PX] })
          .setLngLat(first.position)
          .addTo(map);
      if (group.members.length > 1 && spread !== keyOf(group.members)) return [at(several(group), 0)];
      return group.members.map((uav, row) => at(dart(uav), row));
    });
  }

  map.on("zoomend", () => {
    spread = "";
    drawDarts();
  });

  return {
    /** uavs: [{ id, name, position, heading_deg, sequence or null, letter, canMove }] */
    update(uavs) {
      squares.forEach((marker) => marker.remove());
      standing = new Map();
      squares = uavs
        .filter((uav) => uav.sequence !== null)
        .map((uav) => {
          const before = standing.get(placeOf(uav)) ?? 0;
          standing.set(placeOf(uav), before + 1);
          const marker = new maplibre.Marker({
            element: square(uav),
            draggable: uav.canMove,
            offset: [before * SQUARE_PX, 0],
          });
          marker.on("dragend", () => {
            const { lng, lat } = marker.getLngLat();
            onMove(uav.sequence, [Number(lng.toFixed(6)), Number(lat.toFixed(6))]);
          });
          return marker.setLngLat(uav.position).addTo(map);
        });
      others = uavs.filter((uav) => uav.sequence === null);
      drawDarts();
    },
  };
}

const placeOf = ({ position }) => position.map((degrees) => degrees.toFixed(5)).join();
const keyOf = (members) => members.map(({ id }) => id).join();
