/** Placement of the labels of UAV markers, with a count where too many overlap. */

import { h, refill } from "../../dom.js";
import { boxAround } from "../../domain/geodesy.js";
import { maplibre } from "../../map/maplibre.js";
import { tn } from "../../text.js";
import { ALONE, clustersOf, spotsOf } from "./marker_layout.js";

/** @import { Marker } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { MapLibreMap } from "../../map/types.d.ts" */
/** @import { LabelPlaces } from "../../scene/label_places.js" */
/** @import { LabelSpot } from "./marker_layout.js" */
/** @import { MarkedUav } from "../types.d.ts" */

/** @typedef {{ uav: MarkedUav, element: HTMLElement, label: HTMLElement, leader: HTMLElement }} SpreadMark */

const ZOOMS_TO = 17;
const PADDING_PX = 80;
/** @type {Record<string, number>} */
const WEIGHTS = { critical: ALONE, warning: 2, advisory: 1 };

/** @param {MarkedUav} uav */
const weightOf = ({ isChosen, alarm }) => (isChosen ? ALONE + 1 : (WEIGHTS[alarm ?? ""] ?? 0));

/**
 * Returns a function that lays out the marks.
 *
 * @param {MapLibreMap} map
 */
export function createSpread(map) {
  /** @type {LabelPlaces} */
  let places = new Map();
  /** @type {Marker[]} */
  let bubbles = [];
  let drawn = "";

  /** @param {SpreadMark[][]} clusters */
  function drawBubbles(clusters) {
    const key = JSON.stringify(clusters.map((group) => group.map(({ uav }) => [uav.id, uav.position, uav.alarm])));
    if (key === drawn) return;
    drawn = key;
    for (const bubble of bubbles) bubble.remove();
    bubbles = clusters.map((group) =>
      bubbleOf(
        map,
        group.map(({ uav }) => uav),
      ),
    );
  }

  /** @param {SpreadMark[]} all */
  return function layOut(all) {
    const { clientWidth: width, clientHeight: height } = map.getContainer();
    const marks = all.map((mark) => {
      const { x, y } = map.project([mark.uav.position[0], mark.uav.position[1]]);
      return { mark, id: mark.uav.id, x, y, weight: weightOf(mark.uav) };
    });
    const clusters = clustersOf(marks);
    const hidden = new Set(clusters.flat());
    const seen = marks.filter((one) => !hidden.has(one) && one.x > 0 && one.y > 0 && one.x < width && one.y < height);
    const sized = seen.map((one) => ({ ...one, ...sizeOf(one.mark.label) }));
    const centres = clusters.map((group) => middle(group));
    const laid = spotsOf(sized, centres, { width, height }, places);
    places = laid.places;
    drawBubbles(clusters.map((group) => group.map(({ mark }) => mark)));
    for (const one of marks) {
      one.mark.element.hidden = hidden.has(one);
      dress(one.mark, laid.spots.get(one.id) ?? null);
    }
  };
}

/** @param {{ x: number, y: number }[]} group */
const middle = (group) => ({
  x: group.reduce((sum, { x }) => sum + x, 0) / group.length,
  y: group.reduce((sum, { y }) => sum + y, 0) / group.length,
});

/** Measured once for each text: reading it makes the browser lay out the page. @param {HTMLElement} label */
function sizeOf(label) {
  const text = label.textContent ?? "";
  if (label.dataset.measured !== text || !label.dataset.size) {
    label.dataset.measured = text;
    label.dataset.size = `${label.offsetWidth} ${label.offsetHeight}`;
  }
  const [width, height] = label.dataset.size.split(" ").map(Number);
  return { width, height };
}

/** @param {SpreadMark} mark @param {LabelSpot | null} spot */
function dress({ element, label, leader }, spot) {
  element.classList.toggle("unlabelled", spot === null);
  leader.hidden = !spot?.leader;
  if (!spot) return;
  label.style.translate = `${Math.round(spot.left)}px ${Math.round(spot.top)}px`;
  if (!spot.leader) return;
  leader.style.width = `${Math.round(Math.hypot(spot.leader.x, spot.leader.y))}px`;
  leader.style.rotate = `${Math.atan2(spot.leader.y, spot.leader.x)}rad`;
}

/** @param {MapLibreMap} map @param {MarkedUav[]} uavs */
function bubbleOf(map, uavs) {
  const box = boxAround(uavs.map(({ position }) => position));
  const names = uavs.map(({ letter, name }) => `${letter} ${name}`.trim()).join(", ");
  const level = ["critical", "warning"].find((one) => uavs.some(({ alarm }) => alarm === one)) ?? "";
  const element = h("button", {
    type: "button",
    tabindex: "-1",
    class: `map-cluster ${level}`,
    title: names,
    "aria-label": `${tn(uavs.length, "{count} UAV", "{count} UAVs")}: ${names}`,
    onclick: (event) => {
      event.stopPropagation();
      if (box) map.fitBounds(box, { padding: PADDING_PX, maxZoom: ZOOMS_TO });
    },
  });
  refill(element, `${uavs.length}`, () => [`${uavs.length}`]);
  const [west, south, east, north] = box ?? [0, 0, 0, 0];
  return new maplibre.Marker({ element }).setLngLat([(west + east) / 2, (south + north) / 2]).addTo(map);
}
