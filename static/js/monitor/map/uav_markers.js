/** UAVs on the map: a filled dart where one is measured, a hollow one where it is estimated, grey in a dotted ring where it is lost. */

import { h, icon, svg } from "../../dom.js";
import { colourClass } from "../../domain/palette.js";
import { maplibre } from "../../map/maplibre.js";
import { markSimulated } from "../../simulated.js";
import { t } from "../../text.js";
import { between, GLIDE_MS } from "./glide.js";
import { createSpread } from "./spread_markers.js";

/** @import { Marker } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Certainty } from "../../domain/certainty.js" */
/** @import { MapLibreMap } from "../../map/types.d.ts" */
/** @import { MarkedUav } from "../types.d.ts" */

/** @template {number | string} Id @typedef {MarkedUav & { id: Id }} MarkedBy */
/**
 * A marker that moves from one place to another.
 * @typedef {{ marker: Marker, parts: Parts, from: number[], to: number[], began_ms: number }} Flyer
 */
/** @typedef {ReturnType<typeof drawMarker>} Parts */

/** @type {Record<Certainty, string>} */
const CERTAINTIES = { measured: t("measured"), estimated: t("estimated"), lost: t("lost") };
const LOOKS = [...Object.keys(CERTAINTIES), ...[1, 2, 3, 4, 5, 6, 7, 8].map((number) => `route-${number}`)];
const calm = matchMedia("(prefers-reduced-motion: reduce)");

/** @param {() => void} onPick */
function drawMarker(onPick) {
  const dart = svg("svg", { class: "flyer-dart", viewBox: "0 0 26 26", "aria-hidden": "true" });
  const letter = h("span", { class: "letter" });
  const name = h("strong", {});
  const certainty = h("span", { class: "unseen" });
  const alarm = h("span", { class: "flyer-alarm", hidden: true });
  const fact = h("span", {});
  const label = h("span", { class: "flyer-label" }, alarm, letter, name, certainty, fact);
  const leader = h("span", { class: "flyer-leader", hidden: true });
  /** @param {Event} event */
  const onclick = (event) => {
    event.stopPropagation();
    onPick();
  };
  const element = h(
    "button",
    { type: "button", tabindex: "-1", class: "map-flyer", onclick },
    leader,
    h("span", { class: "flyer-mark" }, dart),
    label,
  );
  return { element, dart, letter, name, certainty, fact, alarm, label, leader };
}

/** @param {string} words */
const unseen = (words) => h("span", { class: "unseen" }, `${words}: `);

/** A dart along its heading; without one a round mark that points nowhere. @param {number | null | undefined} heading_deg */
function shapeOf(heading_deg) {
  if (heading_deg === null || heading_deg === undefined) return svg("circle", { cx: 13, cy: 13, r: 7 });
  return svg("path", { d: "M13 2L21 23L13 18L5 23Z", transform: `rotate(${heading_deg} 13 13)` });
}

/** @param {Parts} parts @param {MarkedUav} uav */
function dress({ element, dart, letter, name, certainty, fact, alarm }, uav) {
  const look = new Set([uav.certainty, colourClass(uav.colour)]);
  for (const kind of LOOKS) element.classList.toggle(kind, look.has(kind)); // the map adds its own classes
  element.classList.toggle("chosen", uav.isChosen);
  const level = uav.alarm ?? null;
  for (const kind of /** @type {const} */ (["critical", "warning"])) element.classList.toggle(kind, level === kind);
  if (alarm.dataset.level !== `${level}`) {
    alarm.dataset.level = `${level}`;
    alarm.hidden = level === null || level === "advisory";
    if (level === "critical") alarm.replaceChildren(icon("octagon-alert", "small"), unseen(t("Critical alert")));
    else if (level === "warning") alarm.replaceChildren(icon("triangle-alert", "small"), unseen(t("Warning")));
  }
  const words = CERTAINTIES[uav.certainty];
  certainty.textContent = uav.fact.includes(words) ? ", " : `, ${words}, `;
  dart.replaceChildren(shapeOf(uav.heading_deg));
  letter.hidden = uav.letter === "";
  letter.textContent = uav.letter;
  name.textContent = uav.name;
  markSimulated(name, uav.isMarked);
  fact.textContent = uav.fact;
}

/** @param {readonly number[]} place @returns {[number, number]} */
const lngLatOf = ([longitude, latitude]) => [longitude, latitude];

/**
 * Markers of UAVs that glide from place to place.
 *
 * @template {number | string} Id
 * @param {MapLibreMap} map
 * @param {{ onPick: (id: Id) => void, glide_ms?: number, spreads?: boolean }} options glide_ms: between two places; 0 where positions arrive in every frame; spreads: labels do not overlap, and a count replaces many overlapping markers
 */
export function createUavMarkers(map, { onPick, glide_ms = GLIDE_MS, spreads = false }) {
  /** @type {Map<Id, Flyer>} */
  const flyers = new Map();
  const spread = spreads ? createSpread(map) : null;
  /** @type {MarkedBy<Id>[]} */
  let latest = [];
  let frame = 0;

  function layOut() {
    spread?.(latest.flatMap((uav) => ({ uav, .../** @type {Flyer} */ (flyers.get(uav.id)).parts })));
  }
  if (spread) for (const moved of /** @type {const} */ (["zoom", "moveend", "resize"])) map.on(moved, layOut);

  /** @param {number} now_ms */
  function glide(now_ms) {
    frame = 0;
    let isMoving = false;
    for (const flyer of flyers.values()) {
      const since_ms = now_ms - flyer.began_ms;
      flyer.marker.setLngLat(between(flyer.from, flyer.to, since_ms, calm.matches ? 0 : glide_ms));
      isMoving ||= since_ms < glide_ms && !calm.matches;
    }
    if (isMoving) frame = requestAnimationFrame(glide);
  }

  /** @param {Flyer} flyer @param {number[]} position */
  function place(flyer, position) {
    if (flyer.to[0] === position[0] && flyer.to[1] === position[1]) return;
    Object.assign(flyer, { from: flyer.marker.getLngLat().toArray(), to: position, began_ms: performance.now() });
    if (!frame) frame = requestAnimationFrame(glide);
  }

  /** @param {MarkedBy<Id>} uav @returns {Flyer} */
  function added(uav) {
    const parts = drawMarker(() => onPick(uav.id));
    parts.element.classList.toggle("spread", spreads);
    const look = { element: parts.element, anchor: /** @type {const} */ ("left"), subpixelPositioning: true };
    const marker = new maplibre.Marker({ ...look, offset: [-20, 0] }).setLngLat(lngLatOf(uav.position)).addTo(map);
    const flyer = { marker, parts, from: uav.position, to: uav.position, began_ms: 0 };
    flyers.set(uav.id, flyer);
    return flyer;
  }

  return {
    /** Shows these UAVs and no others. @param {MarkedBy<Id>[]} shown */
    update(shown) {
      const seen = new Set(shown.map(({ id }) => id));
      for (const [id, { marker }] of flyers) {
        if (seen.has(id)) continue;
        marker.remove();
        flyers.delete(id);
      }
      for (const uav of shown) {
        const flyer = flyers.get(uav.id) ?? added(uav);
        dress(flyer.parts, uav);
        place(flyer, uav.position);
      }
      latest = shown;
      layOut();
    },
  };
}
