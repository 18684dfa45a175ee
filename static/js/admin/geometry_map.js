/** The admin's geometry fields: the map shows the text's geometry; a point can be dragged or set by a click. */

import { find, h } from "../dom.js";
import { boxAround } from "../domain/geodesy.js";
import { addSources, setFeatures } from "../map/look/style.js";
import { createMap } from "../map/map_view.js";
import { loadMapLibrary, maplibre } from "../map/maplibre.js";
import { t } from "../text.js";
import { outlineOf, parseGeometry, pointText, positionsOf } from "./geometry_text.js";

/** @import { LngLatLike } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */

/** @type {NodeListOf<HTMLElement>} */
const fields = document.querySelectorAll("[data-geometry]");
await loadMapLibrary();
for (const field of fields) {
  const text = find(field, "textarea", HTMLTextAreaElement);
  const note = find(field, ".geometry-note");
  const hint = note.textContent;
  const isPoint = "isPoint" in field.dataset;
  const view = createMap(find(field, ".geometry-map"), { under: "", describe: t("Map of the geometry") });
  /** @type {InstanceType<typeof maplibre.Marker> | null} */
  let point = null;

  /** @param {string | null | undefined} fault */
  const notify = (fault) => {
    note.textContent = fault ?? hint;
    note.classList.toggle("fault", Boolean(fault));
  };

  /** @param {LngLatLike} position */
  function placePoint(position) {
    if (point) {
      point.setLngLat(position);
      return;
    }
    const marker = new maplibre.Marker({ element: h("div", { class: "geometry-point" }), draggable: !text.readOnly });
    marker.on("dragend", () => write(marker.getLngLat()));
    point = marker.setLngLat(position).addTo(view.map);
  }

  /** @param {{ lng: number, lat: number }} place */
  function write({ lng, lat }) {
    text.value = pointText(lng, lat);
    notify(null);
  }

  /** @param {{ move: boolean }} how */
  function show({ move }) {
    const { geometry, fault } = parseGeometry(text.value);
    notify(fault);
    if (geometry?.type === "Point") placePoint([geometry.coordinates[0], geometry.coordinates[1]]);
    else setFeatures(view.map, "drawn", geometry ? [outlineOf(geometry)] : []);
    if (move && geometry) view.fit(boxAround(positionsOf(geometry)), { animate: false });
  }

  async function showSurroundings() {
    const answer = await fetch("/api/v1/ground", { headers: { Accept: "application/json" } });
    if (answer.ok) view.fit((await answer.json()).extent, { animate: false });
  }

  view.ready.then(() => {
    addSources(view.map, ["drawn"]);
    view.map.addLayer({
      id: "drawn",
      type: "line",
      source: "drawn",
      paint: { "line-color": view.palette().select, "line-width": 2.5 },
    });
    show({ move: true });
    if (!text.value.trim()) showSurroundings();
    text.addEventListener("input", () => show({ move: false }));
    text.addEventListener("change", () => show({ move: true }));
    if (isPoint) {
      view.map.on("click", ({ lngLat }) => {
        placePoint(lngLat);
        write(lngLat);
      });
    }
  });
}
