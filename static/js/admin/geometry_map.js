/** The admin's geometry fields: the map shows what the text says; a point can be dragged or set by a click. */

import { boxAround, createMap } from "../map/map_view.js";
import { maplibre } from "../map/maplibre.js";
import { t } from "../text.js";
import { outlineOf, parseGeometry, pointText, positionsOf } from "./geometry_text.js";

const NOTHING = { type: "FeatureCollection", features: [] };

for (const field of document.querySelectorAll("[data-geometry]")) {
  const text = field.querySelector("textarea");
  const note = field.querySelector(".geometry-note");
  const hint = note.textContent;
  const isPoint = "isPoint" in field.dataset;
  const view = createMap(field.querySelector(".geometry-map"), { under: "", describe: t("Map of the geometry") });
  let point = null;

  const tell = (fault) => {
    note.textContent = fault ?? hint;
    note.classList.toggle("fault", Boolean(fault));
  };

  function placePoint(position) {
    if (point) return point.setLngLat(position);
    const element = document.createElement("div");
    element.className = "geometry-point";
    point = new maplibre.Marker({ element, draggable: !text.readOnly }).setLngLat(position).addTo(view.map);
    point.on("dragend", () => write(point.getLngLat()));
    return point;
  }

  function write({ lng, lat }) {
    text.value = pointText(lng, lat);
    tell(null);
  }

  function show({ move }) {
    const { geometry, fault } = parseGeometry(text.value);
    tell(fault);
    if (geometry?.type === "Point") placePoint(geometry.coordinates);
    else view.map.getSource("drawn").setData(geometry ? outlineOf(geometry) : NOTHING);
    if (move && geometry) view.fit(boxAround(positionsOf(geometry)), { animate: false });
  }

  async function showSurroundings() {
    const answer = await fetch("/api/v1/ground", { headers: { Accept: "application/json" } });
    if (answer.ok) view.fit((await answer.json()).extent, { animate: false });
  }

  view.ready.then(() => {
    view.map.addSource("drawn", { type: "geojson", data: NOTHING });
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
