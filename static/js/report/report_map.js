/** The map of a record: planned thin, flown solid, targets by what became of them, UAVs where they were at the cursor. */

import { get } from "../api.js";
import { byId } from "../dom.js";
import { routeLetter } from "../domain/palette.js";
import { mountControls } from "../map/controls.js";
import { createTip } from "../map/furniture.js";
import * as routesLayer from "../map/layers/routes.js";
import { boxAround, createMap } from "../map/map_view.js";
import { showTipsOnly } from "../map/tips_only.js";
import { rememberedUnder } from "../map/look/under.js";
import { createTargetPills } from "../monitor/map/target_pills.js";
import { createUavMarkers } from "../monitor/map/uav_markers.js";
import { ESTIMATED, MEASURED, momentOf } from "../record/track.js";
import { t, tn } from "../text.js";
import { heightText } from "../units.js";
import * as layers from "./record_layers.js";

const REST = { light: 0.3, dark: 0.42 }; // of routes that are not looked at
const NEAR_ZOOM = 14;
const calm = matchMedia("(prefers-reduced-motion: reduce)");

/** A UAV as it is drawn at a moment; null where nothing is known of it. */
export function markerOf({ uav, place, name, track }, at_ms, looked) {
  const moment = momentOf(track, at_ms);
  if (!moment?.sample.position) return null;
  const { kind, sample } = moment;
  const fact =
    kind === MEASURED
      ? sample.height_m === null
        ? ""
        : heightText(sample.height_m)
      : kind === ESTIMATED
        ? t("estimated, ±{bound}", { bound: heightText(sample.bound_m) })
        : t("no report");
  const certainty = kind === MEASURED || kind === ESTIMATED ? kind : "lost";
  return {
    id: uav ?? `place ${place}`,
    name,
    place,
    letter: routeLetter(place),
    position: sample.position,
    heading_deg: sample.heading_deg,
    certainty,
    fact,
    isChosen: looked === place,
  };
}

/** onPick(place of a UAV). */
export function createReportMap(page, { onPick }) {
  const container = byId("map");
  const view = createMap(container, {
    baseMap: page.baseMap,
    satellite: page.satellite,
    under: rememberedUnder(page),
    describe: t("Map"),
    bounds: page.bounds ?? page.extent,
    extent: page.extent,
  });
  const { map } = view;
  const tip = createTip(container.parentElement);
  let shown = null; // { routes, targets, labels }
  let looked = null;
  let parts = null;
  let hasFitted = view.opensAtPlace;
  const rest = () => (view.palette().isDark ? REST.dark : REST.light);
  const light = () => {
    routesLayer.lookAt(map, view.palette(), looked);
    layers.lookAt(map, looked, rest());
  };
  const controls = mountControls(view, page, {
    fit: () => fit(),
    recoloured: (palette) => parts && (layers.recolour(map, palette), light()),
  });
  showTipsOnly(map, { controls, tip });

  const ready = view.ready.then(() => {
    layers.addTo(map, view.palette());
    parts = {
      pills: createTargetPills(map),
      markers: createUavMarkers(map, {
        onPick: (id) => onPick(shown.routes.find(({ uav }) => uav === id)?.place ?? null),
        glide_ms: 0,
      }),
    };
    void get("/ground").then(
      ({ data }) => controls.setGround(data),
      () => {},
    );
    draw();
  });

  function draw() {
    if (!parts || !shown) return;
    routesLayer.update(
      map,
      shown.routes.map(({ place, waypoints }) => ({
        sequence: place,
        geometry:
          waypoints.length > 1 ? { type: "LineString", coordinates: waypoints.map(({ position }) => position) } : null,
      })),
    );
    layers.showTracks(map, shown.routes);
    parts.pills.update(
      shown.targets
        .filter(({ place }) => shown.labels.has(place))
        .map(({ place, uav, label: name, state }) => {
          const { label, number, position } = shown.labels.get(place);
          return {
            key: `${place}`,
            position,
            sequence: uav,
            letter: routeLetter(uav),
            number,
            name: `${label} ${name}`,
            state,
            isMissed: false,
          };
        }),
    );
    const words = [
      tn(shown.routes.length, "{count} route", "{count} routes"),
      tn(shown.targets.length, "{count} target", "{count} targets"),
    ];
    map.getCanvas().setAttribute("aria-label", t("Map of what was flown, {words}", { words: words.join(", ") }));
    if (!hasFitted) fit({ animate: false });
    hasFitted = true;
  }

  function fit(options) {
    const places = (shown?.routes ?? []).flatMap(({ waypoints, track }) => [
      ...waypoints.map(({ position }) => position),
      ...track.samples.map(({ position }) => position).filter(Boolean),
    ]);
    view.fit(boxAround(places) ?? page.bounds ?? page.extent, options);
  }

  return {
    ready,
    fit,
    bindings: controls.bindings,
    closeTop: () => controls.closeTop(),
    zoom: (steps) => map.zoomTo(map.getZoom() + steps),
    resize: () => map.resize(),
    show(next) {
      shown = next;
      draw();
    },
    /** UAVs as they were then; one of them may be looked at. */
    point(at_ms, place) {
      if (!parts || !shown) return;
      parts.markers.update(shown.routes.map((route) => markerOf(route, at_ms, place)).filter(Boolean));
      if (place === looked) return;
      looked = place;
      light();
    },
    lightLeg: (positions) => parts && layers.lightLeg(map, positions),
    showPlace: (position) =>
      map.easeTo({ center: position, zoom: Math.max(map.getZoom(), NEAR_ZOOM), duration: calm.matches ? 0 : 350 }),
  };
}
