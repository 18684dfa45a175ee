/** A small map round the chosen UAV while its ring would be too small on the large one. */

import { h, icon } from "../../dom.js";
import { ESTIMATED, withinOf_m } from "../../domain/certainty.js";
import { boxAround } from "../../domain/geodesy.js";
import { colourClass } from "../../domain/palette.js";
import { provideImages } from "../../map/look/images.js";
import { mapStyle, repaint, sourceOf } from "../../map/look/style.js";
import { showFaults } from "../../map/map_view.js";
import { maplibre } from "../../map/maplibre.js";
import { tilesAddress } from "../../map/tiles_address.js";
import { t } from "../../text.js";
import { ellipseRing, metresPerPixel } from "./ellipse.js";
import * as flightLayers from "./flight_layers.js";
import { createUavMarkers } from "./uav_markers.js";

/** @import { FeatureCollection, MapLibreMap, MapView, StyleOptions } from "../../map/types.d.ts" */
/** @import { Bound, DrawnUav, FlownLine, MonitorPage } from "../types.d.ts" */

/** @typedef {DrawnUav & { bound: Bound }} EstimatedUav */
/** @typedef {{ uav: EstimatedUav, routes: FeatureCollection, flown: FlownLine[] }} Latest the newest content */
/** @typedef {{ map: MapLibreMap, redrawImages: () => void, markers: ReturnType<typeof createUavMarkers> | null }} SmallMap */

const READABLE_PX = 24;
const ROUND = 1.6; // of the shown ring

/**
 * Whether the ring of an estimate is too small to read at a zoom.
 *
 * @param {Pick<EstimatedUav, "position" | "bound">} uav
 * @param {number} zoom
 */
export const isTooSmall = ({ position, bound }, zoom) =>
  withinOf_m({ bound }) / metresPerPixel(zoom, position[1]) < READABLE_PX;

/** @param {DrawnUav | null} uav @returns {uav is EstimatedUav} */
const isEstimated = (uav) => uav !== null && uav.certainty === ESTIMATED && uav.bound !== null;

/** @param {MapView} view the large map @param {HTMLElement} frame @param {MonitorPage} page */
export const createCloseUp = (view, frame, page) => new CloseUp(view, frame, page);

class CloseUp {
  #view;
  /** @type {StyleOptions} */
  #style;
  #title = h("strong", {});
  #letter = h("span", { class: "letter" });
  #place = h("div", { class: "close-up-map", "aria-hidden": "true" });
  #box = h("section", { class: "close-up float", "aria-label": t("Close-up"), hidden: true });
  /** @type {number | null} */
  #shownFor = null;
  /** @type {number | null} */
  #closedFor = null;
  /** @type {SmallMap | null} */
  #small = null;
  /** @type {Latest | null} */
  #latest = null;
  #drawn = "";

  /** @param {MapView} view @param {HTMLElement} frame @param {MonitorPage} page */
  constructor(view, frame, page) {
    this.#view = view;
    this.#style = {
      tilesAddress: tilesAddress(),
      baseMap: page.baseMap,
      satellite: page.satellite,
      under: "",
    };
    const close = h(
      "button",
      {
        type: "button",
        class: "icon-button tight",
        "aria-label": t("Close the close-up"),
        onclick: () => this.#close(),
      },
      icon("x", "small"),
    );
    const words = h("span", { class: "quiet-text" }, t("close up"));
    this.#box.append(h("header", {}, this.#letter, this.#title, words, close), this.#place);
    frame.append(this.#box);
  }

  /**
   * Show the surroundings of the chosen UAV while its ring is too small on the large map.
   *
   * @param {DrawnUav | null} uav the chosen one
   * @param {FeatureCollection} routes
   * @param {FlownLine[]} flown
   */
  update(uav, routes, flown) {
    const wanted = isEstimated(uav) && isTooSmall(uav, this.#view.map.getZoom()) ? uav : null;
    this.#shownFor = wanted?.id ?? null;
    if (this.#closedFor !== this.#shownFor) this.#closedFor = null;
    this.#box.hidden = wanted === null || this.#closedFor === wanted.id;
    if (!wanted || this.#box.hidden) return;
    this.#latest = { uav: wanted, routes, flown };
    this.#letter.textContent = wanted.letter;
    this.#letter.className = `letter ${colourClass(wanted.colour)}`;
    this.#title.textContent = wanted.name;
    if (this.#small) this.#draw();
    else this.#small = this.#start(wanted.position);
  }

  recolour() {
    if (!this.#small?.markers) return;
    const palette = this.#view.palette();
    repaint(this.#small.map, palette, this.#style);
    flightLayers.recolour(this.#small.map, palette);
    this.#small.redrawImages();
  }

  #close() {
    this.#closedFor = this.#shownFor;
    this.#box.hidden = true;
  }

  /** @param {number[]} centre @returns {SmallMap} */
  #start([longitude, latitude]) {
    const map = new maplibre.Map({
      container: this.#place,
      style: mapStyle(this.#view.palette(), this.#style),
      interactive: false,
      attributionControl: false,
      fadeDuration: 0,
      center: [longitude, latitude],
      zoom: 14,
    });
    showFaults(map);
    /** @type {SmallMap} */
    const small = { map, redrawImages: provideImages(map, () => this.#view.palette()), markers: null };
    map.on("load", () => {
      flightLayers.addTo(map, this.#view.palette());
      small.markers = createUavMarkers(map, { onPick: () => {} });
      this.#draw();
    });
    return small;
  }

  #draw() {
    if (!this.#small?.markers || !this.#latest) return;
    const { map, markers } = this.#small;
    const { uav, routes, flown } = this.#latest;
    const key = JSON.stringify([uav.id, uav.position, uav.bound]);
    if (key === this.#drawn) return;
    this.#drawn = key;
    const { along_m, across_m } = uav.bound;
    const round = { ...uav.bound, along_m: along_m * ROUND, across_m: across_m * ROUND };
    const box = boxAround(ellipseRing(uav.position, round, 20));
    if (box) map.fitBounds(box, { duration: 0, padding: 12, maxZoom: 16 });
    sourceOf(map, "routes")?.setData(routes);
    flightLayers.showFlown(map, flown);
    flightLayers.showUncertain(map, [uav]);
    markers.update([{ ...uav, fact: "", isMarked: false }]);
  }
}
