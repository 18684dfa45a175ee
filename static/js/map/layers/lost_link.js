/** Rally points as marks that can be dragged, and the ways back: a line to where a UAV would land, and a dot at each waypoint where that fails. */

import { h } from "../../dom.js";
import { t } from "../../text.js";
import { addSources, readToken, setFeatures, setPaint } from "../look/style.js";
import { maplibre } from "../maplibre.js";

/** @import { LayerSpecification } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { MapLibreMap, Position } from "../types.d.ts" */

const SOURCE = "lost-link";
/** @param {string} type */
const isKind = (type) => ["==", ["geometry-type"], type];

/** @returns {LayerSpecification[]} */
function layers() {
  const [critical, casing, quiet] = ["--critical", "--map-casing", "--ink-2"].map(readToken);
  const lit = ["get", "lit"];
  const fails = ["get", "fails"];
  const layers = [
    {
      id: "lost-link-quiet",
      type: "line",
      source: SOURCE,
      filter: ["all", isKind("LineString"), ["!", fails]],
      paint: { "line-color": quiet, "line-width": 1, "line-opacity": 0.3, "line-dasharray": [2, 3] },
    },
    {
      id: "lost-link-casing",
      type: "line",
      source: SOURCE,
      filter: ["all", isKind("LineString"), lit],
      paint: { "line-color": casing, "line-width": 5 },
    },
    {
      id: "lost-link-lines",
      type: "line",
      source: SOURCE,
      filter: ["all", isKind("LineString"), fails],
      paint: {
        "line-color": critical,
        "line-width": ["case", lit, 2, 1],
        "line-opacity": ["case", lit, 1, 0.35],
        "line-dasharray": [4, 3],
      },
    },
    {
      id: "lost-link-dots",
      type: "circle",
      source: SOURCE,
      filter: isKind("Point"),
      paint: {
        "circle-radius": ["interpolate", ["linear"], ["zoom"], 9, ["case", lit, 4, 2], 13, ["case", lit, 7, 5]],
        "circle-color": ["case", lit, critical, readToken("--raised")],
        "circle-stroke-color": critical,
        "circle-stroke-width": 2,
      },
    },
  ];
  return /** @type {LayerSpecification[]} */ (layers);
}

/** @param {string} type @param {unknown} coordinates @param {{ fails?: boolean, lit?: boolean }} how */
const feature = (type, coordinates, { fails = false, lit = false }) => ({
  type: "Feature",
  properties: { fails, lit },
  geometry: { type, coordinates },
});

/**
 * returns: [{ from, to, fails, lit }]; an empty list removes them.
 *
 * @param {MapLibreMap} map
 * @param {{ from: number[], to: number[], fails?: boolean, lit?: boolean }[]} returns
 */
export function showReturns(map, returns) {
  if (!map.getSource(SOURCE)) {
    if (!returns.length) return;
    addSources(map, [SOURCE]);
    for (const layer of layers()) map.addLayer(layer);
  }
  const features = returns.flatMap(({ from, to, ...how }) => [
    feature("LineString", [from, to], how),
    ...(how.fails ? [feature("Point", from, how)] : []),
  ]);
  setFeatures(map, SOURCE, features);
}

/** @param {MapLibreMap} map */
export function recolour(map) {
  if (!map.getSource(SOURCE)) return;
  for (const layer of layers()) setPaint(map, layer);
}

/**
 * Marks of the rally points. onMove(index, position).
 *
 * @param {MapLibreMap} map
 * @param {{ onMove: (index: number, position: Position) => void }} on
 */
export function createRallyPoints(map, { onMove }) {
  /** @type {InstanceType<typeof maplibre.Marker>[]} */
  let marks = [];
  let drawn = "";
  return {
    /** @param {{ name: string, position: number[] }[]} points @param {boolean} canMove */
    update(points, canMove) {
      const now = JSON.stringify([points, canMove]);
      if (now === drawn) return;
      drawn = now;
      for (const mark of marks) mark.remove();
      marks = points.map(({ name, position }, index) => {
        const words = t("Rally point {name}", { name });
        const element = h(
          "div",
          {
            class: `map-rally${canMove ? " movable" : ""}`,
            role: "img",
            "aria-label": words,
            title: canMove ? t("Rally point {name}. Drag it to another place", { name }) : words,
            onclick: (event) => event.stopPropagation(),
          },
          h("span", { class: "rally-mark" }, name),
        );
        const mark = new maplibre.Marker({ element, draggable: canMove });
        mark.on("dragend", () => {
          const { lng, lat } = mark.getLngLat();
          onMove(index, [lng, lat]);
        });
        return mark.setLngLat(/** @type {Position} */ (position)).addTo(map);
      });
    },
  };
}
