/** The live map: what the store knows is drawn, what the pointer picks goes to the store. */

import { byId } from "../../dom.js";
import { certaintyOf, LOST, MEASURED, standsAt } from "../../domain/certainty.js";
import { routeLetter, routeNumber } from "../../domain/palette.js";
import { mountControls } from "../../map/controls.js";
import { createTip } from "../../map/furniture.js";
import * as routesLayer from "../../map/layers/routes.js";
import { rememberedUnder } from "../../map/look/under.js";
import { boxAround, createMap } from "../../map/map_view.js";
import { showTipsOnly } from "../../map/tips_only.js";
import { t, tn } from "../../text.js";
import { exactClockText } from "../../units.js";
import { numbersOf, pillOf } from "../board.js";
import { mapFact } from "../uav_words.js";
import { createCloseUp } from "./close_up.js";
import * as flightLayers from "./flight_layers.js";
import { createTargetPills } from "./target_pills.js";
import { createUavMarkers } from "./uav_markers.js";

const NEAR_ZOOM = 13.5;
const calm = matchMedia("(prefers-reduced-motion: reduce)");

/** What is drawn of a UAV; null while it was never seen. */
export function drawnUav(uav, now_ms, chosen) {
  const certainty = certaintyOf(uav, now_ms);
  const at = standsAt(uav, certainty);
  if (!at) return null;
  const isSure = certainty === MEASURED;
  return {
    ...at,
    id: uav.id,
    name: uav.name,
    place: uav.place,
    letter: uav.place === null ? "" : routeLetter(uav.place),
    certainty,
    fact: mapFact(uav, certainty),
    isChosen: uav.id === chosen,
    isSimulated: uav.is_simulated,
    routeClass: uav.place === null ? "" : `route-${routeNumber(uav.place)}`,
    bound: isSure || certainty === LOST ? null : uav.estimated.bound,
    last: isSure ? null : (uav.measured?.position ?? null),
    words: uav.measured ? t("last report {time}", { time: exactClockText(uav.measured.measured_at) }) : "",
  };
}

export function mountMonitorMap(store, page, { pick }) {
  const container = byId("map");
  const frame = container.parentElement;
  const view = createMap(container, {
    baseMap: page.baseMap,
    satellite: page.satellite,
    under: rememberedUnder(page),
    describe: t("Map"),
    bounds: page.bounds ?? page.extent,
    extent: page.extent,
  });
  const { map } = view;
  const tip = createTip(frame);
  let parts = null; // once the map has its style
  const controls = mountControls(view, page, {
    fit: () => fit(),
    recoloured: (palette) => (flightLayers.recolour(map, palette), parts?.closeUp.recolour()),
  });
  map.on("dragstart", () => store.update({ isFollowing: false }));
  showTipsOnly(map, { controls, tip });

  const drawn = ({ uavs, now_ms, chosen }) => uavs.map((uav) => drawnUav(uav, now_ms, chosen)).filter(Boolean);
  const routesShown = ({ missions, details }) =>
    missions.flatMap(({ id }) =>
      (details.get(id)?.plan?.routes ?? []).map((route, sequence) => ({ sequence, geometry: route.geometry })),
    );
  const flownOf = ({ uavs, flown }) =>
    uavs.filter(({ id }) => flown.has(id)).map((uav) => ({ place: uav.place, parts: flown.get(uav.id) }));
  const collection = (routes) => ({
    type: "FeatureCollection",
    features: routes
      .filter(({ geometry }) => geometry)
      .map(({ sequence, geometry }) => ({
        type: "Feature",
        properties: { sequence, route: routeNumber(sequence), dashed: false },
        geometry,
      })),
  });

  function drawUavs(state) {
    const shown = drawn(state);
    const isMixed = !state.uavs.every(({ is_simulated }) => is_simulated); // else the head of the page says it once
    parts.markers.update(shown.map((uav) => ({ ...uav, isMarked: uav.isSimulated && isMixed })));
    flightLayers.showUncertain(
      map,
      shown.filter(({ certainty }) => certainty !== MEASURED),
    );
    const chosen = shown.find(({ isChosen }) => isChosen) ?? null;
    parts.closeUp.update(chosen, collection(routesShown(state)), flownOf(state));
    if (state.isFollowing && chosen) map.easeTo({ center: chosen.position, duration: calm.matches ? 0 : 300 });
  }

  function drawTargets({ missions, details }) {
    parts.pills.update(
      missions
        .flatMap((mission) => {
          const detail = details.get(mission.id);
          const numbers = numbersOf(detail);
          return mission.targets.map((target) => ({
            key: `${mission.id} ${target.place}`,
            position: detail?.targets[target.place]?.position ?? null,
            sequence: target.uav,
            letter: target.uav === null ? "" : routeLetter(target.uav),
            number: numbers.get(target.place) ?? target.place + 1,
            name: `${pillOf(target, numbers)} ${target.label}`,
            state: target.state,
            isMissed: false,
          }));
        })
        .filter(({ position }) => position),
    );
  }

  function start() {
    flightLayers.addTo(map, view.palette());
    parts = {
      markers: createUavMarkers(map, { onPick: pick }),
      pills: createTargetPills(map),
      closeUp: createCloseUp(view, frame, page),
    };
    store.listen(["missions", "details"], (state) => {
      routesLayer.update(map, routesShown(state));
      drawTargets(state);
    });
    store.listen(["flown", "uavs"], (state) => flightLayers.showFlown(map, flownOf(state)));
    store.listen(["uavs", "now_ms", "chosen", "details", "isFollowing"], drawUavs);
    store.listen(["offered"], ({ offered }) => flightLayers.showOffered(map, offered));
    store.listen(["ground"], ({ ground }) => controls.setGround(ground));
    map.on("zoomend", () => drawUavs(store.state));
    store.listen(["uavs"], ({ uavs }) =>
      map
        .getCanvas()
        .setAttribute("aria-label", t("Map, {uavs}", { uavs: tn(uavs.length, "{count} UAV", "{count} UAVs") })),
    );
  }

  function positions(state) {
    const routes = routesShown(state).flatMap(({ geometry }) => geometry?.coordinates ?? []);
    return [...routes, ...drawn(state).map(({ position }) => position)];
  }

  function fit(options) {
    map.resize();
    const places = positions(store.state);
    view.fit(places.length > 1 ? boxAround(places) : (page.extent ?? boxAround(places)), options);
  }

  return {
    ready: view.ready.then(start),
    opensAtPlace: view.opensAtPlace,
    fit,
    zoom: (steps) => map.zoomTo(map.getZoom() + steps),
    bindings: controls.bindings,
    closeTop: () => controls.closeTop(),
    /** Brings a UAV into view, near enough to see what it does. */
    jumpTo(id) {
      const uav = drawn(store.state).find((entry) => entry.id === id);
      if (uav)
        map.easeTo({
          center: uav.position,
          zoom: Math.max(map.getZoom(), NEAR_ZOOM),
          duration: calm.matches ? 0 : 350,
        });
      return Boolean(uav);
    },
    showPlace(position) {
      map.easeTo({ center: position, zoom: Math.max(map.getZoom(), NEAR_ZOOM), duration: calm.matches ? 0 : 350 });
    },
  };
}
