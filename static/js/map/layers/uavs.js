/**
 * Markers of UAVs: a square with the letter for those of the mission, a dart with the name for the others. Squares can be dragged. Darts
 * that would overlap are one mark with their number; a click spreads them until the map is zoomed.
 */

import { h, svg } from "../../dom.js";
import { routeNumber } from "../../domain/palette.js";
import { t } from "../../text.js";
import { maplibre } from "../maplibre.js";
import { mergeDarts } from "../pills.js";

/** @import { Dart, Group } from "../pills.js" */
/** @import { MapLibreMap } from "../types.d.ts" */

/** @typedef {{ heading_deg?: number | null }} Heading */

const SQUARE_PX = 22;
const DART_MIDDLE_PX = 14; // from a dart's left edge; its name is to the right

/** @param {Heading} uav */
const headingWords = ({ heading_deg }) =>
  knows(heading_deg)
    ? t("heading {degrees}°", { degrees: String(Math.round(heading_deg) % 360).padStart(3, "0") })
    : "";
/** @param {number | null | undefined} heading_deg @returns {heading_deg is number} */
const knows = (heading_deg) => heading_deg !== null && heading_deg !== undefined;

/** A dart along its heading; without one a round mark that points nowhere. @param {Heading} uav */
function uavMark({ heading_deg }) {
  const turned = knows(heading_deg) ? { style: `rotate: ${heading_deg}deg` } : {};
  const shape = knows(heading_deg)
    ? svg("path", { d: "M12 2.5L19.5 21L12 16.8L4.5 21Z" })
    : svg("circle", { cx: 12, cy: 12, r: 7 });
  return svg("svg", { class: "icon", viewBox: "0 0 24 24", "aria-hidden": "true", ...turned }, shape);
}

/**
 * @typedef {object} MapUav
 * @property {number | string} id
 * @property {string} name
 * @property {[number, number]} position
 * @property {number | null} [heading_deg]
 * @property {number | null} sequence in the mission; null: not of the mission
 * @property {string} [letter]
 * @property {boolean} [canMove]
 */
/** @typedef {InstanceType<typeof maplibre.Marker>} Marker */
/**
 * @typedef {object} UavHandlers
 * @property {(sequence: number, position: [number, number]) => void} onMove
 * @property {(id: MapUav["id"]) => void} onPick
 * @property {(sequence: number | null) => void} onLook
 */

/** @param {MapLibreMap} map @param {UavHandlers} on */
export const createUavs = (map, on) => new Uavs(map, on);

class Uavs {
  #map;
  #on;
  /** @type {Marker[]} */
  #squares = [];
  /** @type {Marker[]} */
  #darts = [];
  /** UAVs that are not of the mission. @type {MapUav[]} */
  #others = [];
  /** Count of squares at a place. @type {Map<string, number>} */
  #standing = new Map();
  #spread = ""; // the group that is spread out, by its UAVs

  /** @param {MapLibreMap} map @param {UavHandlers} on */
  constructor(map, on) {
    this.#map = map;
    this.#on = on;
    map.on("zoomend", () => {
      this.#spread = "";
      this.#drawDarts();
    });
  }

  /** @param {MapUav[]} uavs */
  update(uavs) {
    for (const marker of this.#squares) marker.remove();
    this.#standing = new Map();
    this.#squares = uavs.flatMap((uav) => (uav.sequence === null ? [] : [this.#squareMarker(uav, uav.sequence)]));
    this.#others = uavs.filter((uav) => uav.sequence === null);
    this.#drawDarts();
  }

  /** @param {MapUav} uav @param {number} sequence */
  #squareMarker(uav, sequence) {
    const before = this.#standing.get(placeOf(uav)) ?? 0;
    this.#standing.set(placeOf(uav), before + 1);
    const element = this.#square(uav, sequence);
    const marker = new maplibre.Marker({ element, draggable: uav.canMove, offset: [before * SQUARE_PX, 0] });
    marker.on("dragend", () => {
      const { lng, lat } = marker.getLngLat();
      this.#on.onMove(sequence, [Number(lng.toFixed(6)), Number(lat.toFixed(6))]);
    });
    return marker.setLngLat(uav.position).addTo(this.#map);
  }

  /** @param {MapUav} uav @param {number} sequence */
  #square(uav, sequence) {
    return h(
      "button",
      {
        type: "button",
        tabindex: "-1",
        class: `map-base route-${routeNumber(sequence)}`,
        "aria-label": t("{name} starts here", { name: uav.name }),
        title: uav.canMove ? t("{name}. Drag to another start", { name: uav.name }) : uav.name,
        onpointerenter: () => this.#on.onLook(sequence),
        onpointerleave: () => this.#on.onLook(null),
        onclick: (event) => event.stopPropagation(),
      },
      h("span", { class: "letter" }, uav.letter),
    );
  }

  /** @param {MapUav} uav */
  #dart(uav) {
    const labels = [t("{name}, not in this mission", { name: uav.name }), headingWords(uav)];
    const title = [t("{name}. Click to take it along", { name: uav.name }), headingWords(uav)];
    return h(
      "button",
      {
        type: "button",
        tabindex: "-1",
        class: "map-dart",
        "aria-label": labels.filter(Boolean).join(", "),
        title: title.filter(Boolean).join(" · "),
        onclick: (event) => {
          event.stopPropagation();
          this.#on.onPick(uav.id);
        },
      },
      uavMark(uav),
      h("span", { class: "dart-name", "aria-hidden": "true" }, uav.name),
    );
  }

  /** @param {Group<MapUav & Dart>} group */
  #several({ members, label }) {
    const names = members.map((uav) => uav.name).join(", ");
    return h(
      "button",
      {
        type: "button",
        tabindex: "-1",
        class: "map-dart several",
        "aria-label": t("{uavs}, not in this mission: {names}", { uavs: label, names }),
        title: t("{names}. Click to see each", { names }),
        onclick: (event) => {
          event.stopPropagation();
          this.#spread = keyOf(members);
          this.#drawDarts();
        },
      },
      uavMark({}),
      h("span", { class: "dart-name", "aria-hidden": "true" }, label),
    );
  }

  #drawDarts() {
    for (const marker of this.#darts) marker.remove();
    const placed = this.#others.map((uav) => {
      const { x, y } = this.#map.project(uav.position);
      return { ...uav, x, y };
    });
    this.#darts = mergeDarts(placed).flatMap((group) => {
      const [first] = group.members;
      const below = this.#standing.has(placeOf(first)) ? 1 : 0;
      /** @param {HTMLElement} element @param {number} row */
      const at = (element, row) =>
        new maplibre.Marker({ element, anchor: "left", offset: [-DART_MIDDLE_PX, (below + row) * SQUARE_PX] })
          .setLngLat(first.position)
          .addTo(this.#map);
      if (group.members.length > 1 && this.#spread !== keyOf(group.members)) return [at(this.#several(group), 0)];
      return group.members.map((uav, row) => at(this.#dart(uav), row));
    });
  }
}

/** @param {{ position: number[] }} uav */
const placeOf = ({ position }) => position.map((degrees) => degrees.toFixed(5)).join();
/** @param {Pick<MapUav, "id">[]} members */
const keyOf = (members) => members.map(({ id }) => id).join();
