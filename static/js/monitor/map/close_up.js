/** A small map round the chosen UAV while its ring would be too small to read on the large one. */

import { h, icon } from "../../dom.js";
import { ESTIMATED, withinOf_m } from "../../domain/certainty.js";
import { provideImages } from "../../map/look/images.js";
import { mapStyle, repaint } from "../../map/look/style.js";
import { boxAround, tellFaults } from "../../map/map_view.js";
import { maplibre } from "../../map/maplibre.js";
import { t } from "../../text.js";
import { ellipseRing, metresPerPixel } from "./ellipse.js";
import * as flightLayers from "./flight_layers.js";
import { createUavMarkers } from "./uav_markers.js";

const READABLE_PX = 24;
const ROUND = 1.6; // of the ring that is shown

/** Whether the ring of an estimate is too small to read: at a zoom, lon lat. */
export const isTooSmall = ({ position, bound }, zoom) =>
  withinOf_m({ bound }) / metresPerPixel(zoom, position[1]) < READABLE_PX;

export function createCloseUp(view, frame, page) {
  const { map: large } = view;
  const title = h("strong", {});
  const letter = h("span", { class: "letter" });
  const place = h("div", { class: "close-up-map", "aria-hidden": "true" });
  const box = h(
    "section",
    { class: "close-up float", "aria-label": t("Close-up"), hidden: true },
    h(
      "header",
      {},
      letter,
      title,
      h("span", { class: "quiet-text" }, t("close up")),
      h(
        "button",
        {
          type: "button",
          class: "icon-button tight",
          "aria-label": t("Close the close-up"),
          onclick: () => ((box.dataset.closed = shownFor), (box.hidden = true)),
        },
        icon("x", "small"),
      ),
    ),
    place,
  );
  frame.append(box);
  let shownFor = "";
  const options = {
    tilesAddress: `${location.origin}/api/v1/tiles/{z}/{x}/{y}`,
    baseMap: page.baseMap,
    satellite: page.satellite,
    under: "",
  };
  let small = null;
  let redrawImages = null;
  let markers = null;
  let isReady = false;
  let latest = null;
  let drawn = "";

  function start() {
    small = new maplibre.Map({
      container: place,
      style: mapStyle(view.palette(), options),
      interactive: false,
      attributionControl: false,
      fadeDuration: 0,
      center: latest.position,
      zoom: 14,
    });
    tellFaults(small);
    redrawImages = provideImages(small, () => view.palette());
    small.on("load", () => {
      flightLayers.addTo(small, view.palette());
      markers = createUavMarkers(small, { onPick: () => {} });
      isReady = true;
      draw();
    });
  }

  function draw() {
    const { uav, routes, flown } = latest;
    const key = JSON.stringify([uav.id, uav.position, uav.bound]);
    if (key === drawn) return;
    drawn = key;
    const ring = ellipseRing(
      uav.position,
      { ...uav.bound, along_m: uav.bound.along_m * ROUND, across_m: uav.bound.across_m * ROUND },
      20,
    );
    const [west, south, east, north] = boxAround([...ring]);
    small.fitBounds(
      [
        [west, south],
        [east, north],
      ],
      { duration: 0, padding: 12, maxZoom: 16 },
    );
    small.getSource("routes").setData(routes);
    flightLayers.showFlown(small, flown);
    flightLayers.showUncertain(small, [uav]);
    markers.update([{ ...uav, fact: "" }]);
  }

  return {
    /** uav: the chosen one as flight_layers and uav_markers take it, null where none is; routes: GeoJSON; flown: as flight_layers takes it. */
    update(uav, routes, flown) {
      const isWanted = uav !== null && uav.certainty === ESTIMATED && uav.bound && isTooSmall(uav, large.getZoom());
      const name = isWanted ? `${uav.id}` : "";
      if (box.dataset.closed && box.dataset.closed !== name) delete box.dataset.closed;
      shownFor = name;
      box.hidden = !isWanted || box.dataset.closed === name;
      if (box.hidden) return;
      latest = { uav, routes, flown, position: uav.position };
      letter.textContent = uav.letter;
      letter.className = `letter ${uav.routeClass}`;
      title.textContent = uav.name;
      if (!small) start();
      else if (isReady) draw();
    },
    recolour() {
      if (!isReady) return;
      repaint(small, view.palette(), options);
      flightLayers.recolour(small, view.palette());
      redrawImages();
    },
  };
}
