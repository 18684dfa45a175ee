/** Target pills: HTML up to 200, a layer beyond. Pills of one UAV that would overlap are merged: "C3–4". */

import { h } from "../../dom.js";
import { routeNumber } from "../../domain/palette.js";
import { t, tn } from "../../text.js";
import { setFeatures } from "../look/style.js";
import { maplibre } from "../maplibre.js";
import { mergePills } from "../pills.js";

/** @import { Group, Pill } from "../pills.js" */
/** @import { MapLibreMap, ScreenPoint } from "../types.d.ts" */

const MAX_MARKERS = 200;
const MAX_NAMES = 6;
const REACH_PX = 4;
const MISSED = -1; // instead of a route's number

/** @param {Pick<Pill, "isMissed" | "sequence">} pill */
const lookOf = (pill) =>
  pill.isMissed ? "missed" : pill.sequence === null ? "waiting" : `route-${routeNumber(pill.sequence)}`;

/** @param {Pick<Pill, "name" | "isMissed">[]} members */
function namesOf(members) {
  const names = members.slice(0, MAX_NAMES).map((pill) => pill.name);
  const rest = members.length - names.length;
  const more = rest > 0 ? ` ${tn(rest, "and {count} more", "and {count} more")}` : "";
  return `${names.join("; ")}${more}${members[0].isMissed ? `: ${t("not reached")}` : ""}`;
}

/** @typedef {Omit<Pill, "x" | "y"> & { position: [number, number] }} TargetPill */
/** @typedef {TargetPill & { x: number, y: number }} PlacedPill */
/** @typedef {{ marker: InstanceType<typeof maplibre.Marker>, members: PlacedPill[], element: HTMLElement }} Drawn */
/** @typedef {{ onPick: (key: string) => void, onHover: (key: string | null) => void }} TargetHandlers */

/** @param {MapLibreMap} map @param {TargetHandlers} on */
export const createTargets = (map, on) => new Targets(map, on);

class Targets {
  #map;
  #on;
  /** @type {TargetPill[]} */
  #pills = [];
  /** By key of the group. @type {Map<string, Drawn>} */
  #drawn = new Map();
  /** @type {number | null} */
  #lookedAt = null;
  #chosen = "";
  /** The element under the pointer: it may be removed without a leave event. @type {HTMLElement | null} */
  #hovered = null;

  /** @param {MapLibreMap} map @param {TargetHandlers} on */
  constructor(map, on) {
    this.#map = map;
    this.#on = on;
    map.on("zoomend", () => this.#draw());
  }

  /** @param {TargetPill[]} pills */
  update(pills) {
    this.#pills = pills;
    const features = pills.length > MAX_MARKERS ? pills.map(featureOf) : [];
    setFeatures(this.#map, "many-targets", features);
    this.#draw();
  }

  /**
   * The target of the layer at a place on the screen, where there are too many for markers: its key, or null.
   *
   * @param {ScreenPoint} place
   * @returns {string | null}
   */
  at({ x, y }) {
    if (this.#pills.length <= MAX_MARKERS) return null;
    /** @type {[[number, number], [number, number]]} */
    const box = [
      [x - REACH_PX, y - REACH_PX],
      [x + REACH_PX, y + REACH_PX],
    ];
    return this.#map.queryRenderedFeatures(box, { layers: ["many-targets"] })[0]?.properties.key ?? null;
  }

  /** @param {number | null} sequence */
  lookAt(sequence) {
    this.#lookedAt = sequence;
    this.#mark();
  }

  /** @param {string | null} key */
  choose(key) {
    this.#chosen = key ?? "";
    this.#mark();
  }

  /** @param {Group<PlacedPill>} group */
  #elementOf({ members, label }) {
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
        onclick: (event) => {
          event.stopPropagation();
          this.#on.onPick(first.key);
        },
        onpointerenter: () => {
          this.#hovered = element;
          this.#on.onHover(first.key);
        },
        onpointerleave: () => {
          this.#hovered = null;
          this.#on.onHover(null);
        },
      },
      h("span", { class: "pill" }, label),
    );
    return element;
  }

  /** Draw the pills. Markers with the same text are kept, so that they keep pointer and focus. */
  #draw() {
    /** @type {Map<string, Drawn>} */
    const next = new Map();
    const isMany = this.#pills.length > MAX_MARKERS;
    const placed = isMany ? [] : this.#pills.map((pill) => ({ ...pill, ...placeOf(this.#map, pill.position) }));
    for (const group of mergePills(placed)) {
      const [first] = group.members;
      const key = JSON.stringify([group.label, lookOf(first), first.position, group.members.map((pill) => pill.key)]);
      const { element, marker } = this.#drawn.get(key) ?? this.#markerOf(group);
      next.set(key, { marker, element, members: group.members });
    }
    for (const [key, { marker, element }] of this.#drawn) {
      if (next.has(key)) continue;
      marker.remove();
      if (element !== this.#hovered) continue;
      this.#hovered = null;
      this.#on.onHover(null);
    }
    this.#drawn = next;
    this.#mark();
  }

  /** @param {Group<PlacedPill>} group */
  #markerOf(group) {
    const element = this.#elementOf(group);
    const marker = new maplibre.Marker({ element, subpixelPositioning: true });
    return { element, marker: marker.setLngLat(group.members[0].position).addTo(this.#map) };
  }

  #mark() {
    for (const { element, members } of this.#drawn.values()) {
      const isChosen = members.some((pill) => pill.key === this.#chosen);
      element.classList.toggle("far", this.#lookedAt !== null && members[0].sequence !== this.#lookedAt);
      element.classList.toggle("chosen", isChosen);
    }
  }
}

/** @param {MapLibreMap} map @param {[number, number]} position */
function placeOf(map, position) {
  const { x, y } = map.project(position);
  return { x, y };
}

/** @param {TargetPill} pill */
const featureOf = (pill) => ({
  type: "Feature",
  properties: {
    key: pill.key,
    route: pill.isMissed ? MISSED : pill.sequence === null ? 0 : routeNumber(pill.sequence),
    label: pill.isMissed ? "×" : `${pill.letter}${pill.number}`,
  },
  geometry: { type: "Point", coordinates: pill.position },
});
