/** The map of a record: planned thin, flown solid, targets by result, UAVs at the time of the cursor. */

import { get } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { LOST } from "../domain/certainty.js";
import { boxAround } from "../domain/geodesy.js";
import { routeLetter } from "../domain/palette.js";
import { mapBindings, mountControls } from "../map/controls.js";
import { createTip } from "../map/furniture.js";
import * as routesLayer from "../map/layers/routes.js";
import { optionsOf } from "../map/look/under.js";
import { createMap } from "../map/map_view.js";
import { maplibre } from "../map/maplibre.js";
import { showTipsOnly } from "../map/tips_only.js";
import { createTargetPills } from "../monitor/map/target_pills.js";
import { createUavMarkers } from "../monitor/map/uav_markers.js";
import { capital } from "../record/sentence.js";
import { ESTIMATED, momentOf, SILENT } from "../record/track.js";
import { t, tn } from "../text.js";
import { clockText, heightText } from "../units.js";
import { INCIDENTS } from "./lists.js";
import * as layers from "./record_layers.js";

/** @import { MarkedUav } from "../monitor/types.d.ts" */

/** @import { Answer } from "../api.js" */
/** @import { Incident, RecordTarget } from "../api_types.d.ts" */
/** @import { Marker } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Geometry, Ground, MapControls, MapLibreMap } from "../map/types.d.ts" */
/** @import { Moment } from "../record/track.js" */
/** @import { Labels } from "../record/labels.js" */
/** @import { ReplayRoute, ReportPage } from "./types.d.ts" */

/** @typedef {{ routes: ReplayRoute[], targets: RecordTarget[], labels: Labels, incidents: Incident[] }} Shown */

const REST = { light: 0.3, dark: 0.42 }; // of routes that are not selected
const NEAR_ZOOM = 14;
const calm = matchMedia("(prefers-reduced-motion: reduce)");

/** Id of its marker. @param {Pick<ReplayRoute, "uav" | "place">} route */
const idOf = ({ uav, place }) => uav ?? `place ${place}`;

/**
 * A UAV as drawn at a moment; null where its position is unknown.
 *
 * @param {Pick<ReplayRoute, "uav" | "place" | "colour" | "name" | "track">} route
 * @param {number} at_ms
 * @param {number | null} looked place of the selected UAV
 * @returns {MarkedUav | null}
 */
export function markerOf({ uav, place, colour, name, track }, at_ms, looked) {
  const moment = momentOf(track, at_ms);
  const position = moment?.sample.position;
  if (!moment || !position) return null;
  const { kind, sample } = moment;
  return {
    id: idOf({ uav, place }),
    name,
    place,
    colour,
    letter: routeLetter(place),
    position,
    heading_deg: sample.heading_deg,
    certainty: kind === SILENT ? LOST : kind,
    fact: factOf(moment),
    isMarked: false,
    isChosen: looked === place,
  };
}

/** @param {NonNullable<Moment>} moment */
function factOf(moment) {
  if (moment.kind === SILENT) return t("no telemetry");
  if (moment.kind === ESTIMATED) return t("estimated, ±{bound}", { bound: heightText(moment.sample.bound_m) });
  return moment.sample.height_m === null ? "" : heightText(moment.sample.height_m);
}

/** @param {Shown} shown @returns {{ sequence: number, geometry: Geometry | null, colour: number }[]} */
const plannedLines = ({ routes }) =>
  routes.map(({ place, colour, waypoints }) => ({
    sequence: place,
    colour,
    geometry:
      waypoints.length > 1 ? { type: "LineString", coordinates: waypoints.map(({ position }) => position) } : null,
  }));

/** @param {Shown} shown */
const pillsOf = ({ targets, labels }) =>
  targets.flatMap(({ place, uav, label: name, state }) => {
    const known = labels.get(place);
    if (!known) return [];
    const { label, colour, number, position } = known;
    return [
      {
        key: `${place}`,
        position,
        sequence: uav,
        colour: uav === null ? null : colour,
        letter: uav === null ? "" : routeLetter(uav),
        number,
        name: `${label} ${name}`,
        state,
        isMissed: false,
      },
    ];
  });

/** @param {Shown} shown */
const placesOf = ({ routes }) =>
  routes.flatMap(({ waypoints, track }) =>
    [...waypoints, ...track.samples].flatMap(({ position }) => (position ? [position] : [])),
  );

/** A pin at an incident of a UAV. @param {MapLibreMap} map @param {Incident} incident @param {() => void} onPick */
function pinOf(map, { kind, message, at, position }, onPick) {
  if (!position) return [];
  const [longitude, latitude] = position;
  const { image, level } = INCIDENTS[kind];
  const words = `${clockText(at)} ${capital(message)}`;
  const element = h(
    "button",
    { type: "button", class: `report-pin ${level}`, "aria-label": words, title: words, onclick: onPick },
    icon(image, "small"),
  );
  return [new maplibre.Marker({ element, anchor: "bottom-left" }).setLngLat([longitude, latitude]).addTo(map)];
}

/** @param {Shown} shown */
function describe({ routes, targets }) {
  const words = [
    tn(routes.length, "{count} route", "{count} routes"),
    tn(targets.length, "{count} target", "{count} targets"),
  ];
  return t("Map of what was flown, {words}", { words: words.join(", ") });
}

/** @param {HTMLElement} container @param {ReportPage} page */
const openMap = (container, page) =>
  createMap(container, {
    ...optionsOf(page),
    describe: t("Map"),
    bounds: page.bounds,
  });

/** Read the sources of the map data; the map works without them, too. @param {MapControls} controls */
async function readGround(controls) {
  const answer = /** @type {Answer<Ground> | null} */ (await get("/ground").catch(() => null));
  if (answer) controls.setGround(answer.data);
}

/**
 * @param {ReportPage} page
 * @param {{ onPick: (place: number) => void, onIncident: (incident: Incident) => void }} options onPick: a UAV was clicked
 */
export function createReportMap(page, { onPick, onIncident }) {
  const container = byId("map");
  const view = openMap(container, page);
  const { map } = view;
  const tip = createTip(/** @type {HTMLElement} */ (container.parentElement));
  /** @type {Shown | null} */
  let shown = null;
  /** @type {number | null} */
  let looked = null;
  /** @type {{ pills: ReturnType<typeof createTargetPills>, markers: ReturnType<typeof createUavMarkers> } | null} */
  let parts = null;
  /** @type {Marker[]} */
  let pins = [];
  let hasFitted = view.opensAtPlace;
  const light = () => {
    routesLayer.lookAt(map, view.palette(), looked);
    layers.lookAt(map, looked, view.palette().isDark ? REST.dark : REST.light);
  };
  const controls = mountControls(view, page, {
    fit: () => fit(),
    recoloured(palette) {
      if (!parts) return;
      layers.recolour(map, palette);
      light();
    },
  });
  showTipsOnly(map, { controls, tip });

  /** @param {number | string} id of a UAV's marker */
  function pick(id) {
    const route = shown?.routes.find((one) => idOf(one) === id);
    if (route) onPick(route.place);
  }

  const ready = view.ready.then(() => {
    layers.addTo(map, view.palette());
    parts = {
      pills: createTargetPills(map),
      markers: createUavMarkers(map, {
        onPick: pick,
        glide_ms: 0,
      }),
    };
    void readGround(controls);
    draw();
  });

  function draw() {
    if (!parts || !shown) return;
    routesLayer.update(map, plannedLines(shown));
    layers.showTracks(map, shown.routes);
    parts.pills.update(pillsOf(shown));
    for (const pin of pins) pin.remove();
    pins = shown.incidents.flatMap((incident) => pinOf(map, incident, () => onIncident(incident)));
    map.getCanvas().setAttribute("aria-label", describe(shown));
    if (!hasFitted) fit({ animate: false });
    hasFitted = true;
  }

  /** @param {{ animate?: boolean }} [how] */
  function fit(how) {
    view.fit(boxAround(shown ? placesOf(shown) : []) ?? page.bounds ?? page.extent, how);
  }

  return {
    ready,
    fit,
    bindings: mapBindings(() => controls),
    closeTop: controls.closeTop,
    /** @param {number} steps */
    zoom: (steps) => map.zoomTo(map.getZoom() + steps),
    /** @param {Shown} next */
    show(next) {
      shown = next;
      draw();
    },
    /** Show the UAVs at a moment; one may be selected. @param {number} at_ms @param {number | null} place */
    point(at_ms, place) {
      if (!parts || !shown) return;
      parts.markers.update(shown.routes.flatMap((route) => markerOf(route, at_ms, place) ?? []));
      if (place === looked) return;
      looked = place;
      light();
    },
    /** @param {number[][] | null} positions of a leg */
    lightLeg: (positions) => parts && layers.lightLeg(map, positions),
    /** @param {number[]} position */
    showPlace: ([longitude, latitude]) =>
      map.easeTo({
        center: [longitude, latitude],
        zoom: Math.max(map.getZoom(), NEAR_ZOOM),
        duration: calm.matches ? 0 : 350,
      }),
  };
}
