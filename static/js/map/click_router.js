/** The feature at the pointer: the nearest one within reach, in the order of picking. */

import { h } from "../dom.js";
import { swallowDrawnClick } from "./drawn_click.js";
import { drawLassos } from "./lasso.js";
import { isAnswered } from "./layers/clicks.js";
import { PICKABLE, TILES } from "./look/voltages.js";

/** @import { MapGeoJSONFeature } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { ClickHandlers, Geometry, MapLibreMap, MapThing, PickKind, Position, ScreenPoint, ThingProperties } from "./types.d.ts" */

const REACH_PX = { fine: 6, coarse: 16 };
/** @typedef {Pick<MapGeoJSONFeature, "layer" | "sourceLayer" | "properties" | "geometry">} PickedFeature */

/** Kinds of things by their source layer. @type {Record<string, PickKind>} */
const KINDS = {
  towers: "tower",
  bridges: "bridge",
  bridge_points: "bridge",
  railways: "railway",
  lines: "line",
  zones: "zone",
};

/**
 * The first of the features under the pointer, in the order of picking: { kind, layer, id, properties, geometry } or null.
 *
 * @param {PickedFeature[]} features
 * @param {string[] | null} [kinds]
 * @returns {MapThing | null}
 */
export function firstInOrder(features, kinds = null) {
  /** @param {PickedFeature} feature */
  const isIdle = (feature) => feature.properties.flyable === false; // underground, out of use: behind all that can be flown to
  /** @param {PickedFeature} feature */
  const rank = (feature) => PICKABLE.indexOf(feature.layer.id) + (isIdle(feature) ? PICKABLE.length : 0);
  /** @param {PickedFeature} feature */
  const isWanted = (feature) =>
    PICKABLE.includes(feature.layer.id) && (!kinds || kinds.includes(KINDS[feature.sourceLayer ?? ""]));
  const best = features.filter(isWanted).sort((a, b) => rank(a) - rank(b))[0];
  if (!best) return null;
  return {
    kind: KINDS[best.sourceLayer ?? ""],
    layer: best.sourceLayer ?? "",
    id: best.properties.id,
    properties: /** @type {ThingProperties} */ (best.properties),
    geometry: /** @type {Geometry} */ (best.geometry),
  };
}

/**
 * All loaded pieces of a thing: a tile holds a line only up to its own edge.
 *
 * @param {MapLibreMap} map
 * @param {MapThing} thing
 * @returns {Geometry[]}
 */
export function piecesOf(map, thing) {
  if (thing.geometry.type === "Point") return [thing.geometry];
  const pieces = map
    .querySourceFeatures(TILES, { sourceLayer: thing.layer, filter: ["==", ["get", "id"], thing.id] })
    .map((feature) => /** @type {Geometry} */ (feature.geometry));
  return pieces.length ? pieces : [thing.geometry];
}

/**
 * Calls `on` for clicks, hovering, boxes and lassos.
 *
 * @param {MapLibreMap} map
 * @param {ClickHandlers} on
 */
export function routeClicks(map, on) {
  const canvas = map.getCanvasContainer();
  const reach = matchMedia("(pointer: coarse)").matches ? REACH_PX.coarse : REACH_PX.fine;
  /** @param {ScreenPoint} point */
  const thingAt = (point) => {
    const layers = PICKABLE.filter((id) => map.getLayer(id));
    return firstInOrder(
      map.queryRenderedFeatures(
        [
          [point.x - reach, point.y - reach],
          [point.x + reach, point.y + reach],
        ],
        { layers },
      ),
      on.kinds(),
    );
  };

  map.on("click", ({ point, lngLat }) => {
    if (!isAnswered(map, point)) on.click(thingAt(point), [lngLat.lng, lngLat.lat], point);
  });

  let frame = 0;
  map.on("mousemove", (event) => {
    cancelAnimationFrame(frame);
    frame = requestAnimationFrame(() => {
      const thing = map.isMoving() ? null : thingAt(event.point);
      canvas.classList.toggle("over-thing", thing !== null && thing.kind !== "zone");
      on.hover(thing, event.point, [event.lngLat.lng, event.lngLat.lat]);
    });
  });
  // After a tap the browser may report the position of the resting mouse, outside the map. The tapped thing stays shown.
  let isTouched = false;
  /** @param {PointerEvent} event */
  const notePointer = (event) => {
    isTouched = event.pointerType === "touch";
  };
  canvas.addEventListener("pointerdown", notePointer, true);
  canvas.addEventListener("pointermove", notePointer, true);
  map.on("mouseout", () => {
    if (isTouched) return;
    cancelAnimationFrame(frame);
    on.hover(null, null, null);
  });

  dragBoxes(map, canvas, on);
  if (on.lasso) drawLassos(map, canvas, { tool: on.tool, lasso: on.lasso });
}

/**
 * Shift and drag, or the box tool and drag: a box in lon lat.
 *
 * @param {MapLibreMap} map
 * @param {HTMLElement} canvas
 * @param {ClickHandlers} on
 */
function dragBoxes(map, canvas, on) {
  map.boxZoom.disable();
  /** @type {Position | null} */
  let start = null;
  const frame = h("div", { class: "box-frame" });
  const click = swallowDrawnClick(canvas);
  /** @param {PointerEvent} event @returns {Position} */
  const placeOf = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };

  canvas.addEventListener(
    "pointerdown",
    (event) => {
      click.begins();
      if (event.button !== 0 || (on.tool() !== "box" && !event.shiftKey)) return;
      event.stopPropagation();
      event.preventDefault();
      start = placeOf(event);
      map.dragPan.disable();
      frame.setAttribute("style", "");
      canvas.append(frame);
      canvas.setPointerCapture(event.pointerId);
    },
    true,
  );
  canvas.addEventListener("pointermove", (event) => {
    if (!start) return;
    const [x, y] = placeOf(event);
    frame.style.transform = `translate(${Math.min(x, start[0])}px, ${Math.min(y, start[1])}px)`;
    frame.style.width = `${Math.abs(x - start[0])}px`;
    frame.style.height = `${Math.abs(y - start[1])}px`;
  });
  /** @param {PointerEvent} event */
  const end = (event) => {
    if (!start) return;
    const [from, to] = [start, placeOf(event)];
    start = null;
    frame.remove();
    map.dragPan.enable();
    if (event.type === "pointerup" && Math.hypot(to[0] - from[0], to[1] - from[1]) > 6) {
      click.ends();
      const corners = [map.unproject(from), map.unproject(to)];
      const longitudes = corners.map((corner) => corner.lng);
      const latitudes = corners.map((corner) => corner.lat);
      on.box([Math.min(...longitudes), Math.min(...latitudes), Math.max(...longitudes), Math.max(...latitudes)]);
    }
  };
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);
}
