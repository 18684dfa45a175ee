/** The map of a mission: draws the store's state and passes pointer events to the actions. */

import { byId, h } from "../../dom.js";
import { boxAround } from "../../domain/geodesy.js";
import { isAround } from "../../domain/regions.js";
import { mountControls } from "../../map/controls.js";
import { showPlanPhotos } from "../../map/layers/photos.js";
import * as rehearsedLayer from "../../map/layers/rehearsed.js";
import * as routesLayer from "../../map/layers/routes.js";
import { createTargets } from "../../map/layers/targets.js";
import { createUavs } from "../../map/layers/uavs.js";
import * as zonesLayer from "../../map/layers/zones.js";
import { optionsOf } from "../../map/look/under.js";
import { TILES } from "../../map/look/voltages.js";
import { createMap } from "../../map/map_view.js";
import { goTo } from "../../map/places_found.js";
import { tilesAddress } from "../../map/tiles_address.js";
import { t, tn } from "../../text.js";
import { mountHandMap } from "../hand/hand_map.js";
import { usesRallyPoints } from "../options/lost_link.js";
import { mountCaught } from "../panels/caught.js";
import { askForZone as askForFacts } from "../panels/temporary_zone.js";
import { isPlanCurrent, photosOf, routesOf, shownPlaces } from "../plan/plan_view.js";
import { staysOf } from "../plan/route_times.js";
import { nameOf, placeTarget } from "../selection.js";
import { isWhole } from "../tasks.js";
import { standingUavs } from "../uavs/fleet.js";
import { baseView } from "./base_view.js";
import { mountLostLinkMap } from "./lost_link_map.js";
import { toolWords } from "./map_picking.js";
import { mountMapPointer } from "./map_pointer.js";
import { createPickedShapes } from "./picked_shapes.js";
import { mountReachLayer } from "./reach_layer.js";

/** @import { VectorTileSource } from "/static/lib/maplibre-gl/maplibre-gl.mjs" */
/** @import { Box, Geometry, MapLibreMap, MapView, Position } from "../../map/types.d.ts" */
/** @import { Drawn } from "../panels/temporary_zone.js" */
/** @import { BestSoFar, MissionActions, MissionPageData, MissionPageState, MissionStore, PickedTarget } from "../types.d.ts" */

/** @typedef {Parameters<ReturnType<typeof createTargets>["update"]>[0]} TargetPills */
/** @typedef {Parameters<ReturnType<typeof createUavs>["update"]>[0]} MapUavs */
/** @typedef {ReturnType<typeof createFitting>} Fitting */

/** @param {Box[]} boxes */
const cornersOf = (...boxes) =>
  boxes.flatMap(([west, south, east, north]) => [
    [west, south],
    [east, north],
  ]);

/** Every position of a geometry. @param {Geometry} shape @returns {number[][]} */
const positionsOf = (shape) =>
  shape.type === "MultiLineString"
    ? shape.coordinates.flat()
    : /** @type {{ coordinates: number[][] }} */ (shape).coordinates;

/**
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {MissionPageData} page
 * @param {{ askForUav: (position: number[]) => void }} acts
 */
export function mountMap(store, actions, page, { askForUav }) {
  const container = byId("map");
  const frame = /** @type {HTMLElement} */ (container.parentElement);
  const { extent, bounds } = page;
  const view = createMap(container, {
    ...optionsOf(page),
    describe: t("Map"),
    bounds,
    extent: bounds && extent ? boxAround(cornersOf(bounds, extent)) : extent,
  });
  const { map, opensAtPlace } = view;
  const fitting = createFitting(view, store);
  const layers = createLayers(view, frame, store, actions, page);
  /** @type {Set<() => void>} */
  const recolouring = new Set();
  const controls = mountControls(view, page, {
    fit: () => fitting.fit(),
    isBusy: () => ["place", "rally", "zone"].includes(store.state.tool),
    measures: (isOn) => {
      if (isOn) store.update({ tool: "point" });
    },
    recoloured() {
      layers.recolour();
      for (const recolour of recolouring) recolour();
    },
    layers: () => layers.entries(),
    placeActs: (place) => [
      ...(page.canPlan
        ? [
            { icon: "map-pin", label: t("Inspect here"), act: () => actions.addTargets([placeTarget(place)]) },
            { icon: "plus", label: t("Add a UAV here"), act: () => askForUav(place) },
          ]
        : []),
      ...(page.canCurate
        ? [{ icon: "zone", label: t("Temporary no-fly zone"), act: () => store.update({ tool: "zone" }) }]
        : []),
    ],
  });
  const { targets, shapes } = layers;
  const canPlan = page.canPlan;
  const askForZone = zoneAsking(store);
  const pointing = { map, frame, store, actions, canPlan, controls, targets, shapes, askForUav, askForZone };
  const picking = mountMapPointer({ ...pointing, reach: layers.reach, isHandOn: () => layers.isHandOn() });

  store.listen(["tool"], ({ tool }) => {
    frame.dataset.tool = tool;
    if (tool !== "point") controls.closeTop();
  });
  mountBanner(store);
  mountCaught(frame, store, actions);
  describeMap(map, store);

  function start() {
    layers.start();
    watchPlans(view, store, fitting);
    store.listen(["ground"], ({ ground }) => controls.setGround(ground));
  }

  return {
    ready: view.ready.then(start),
    fit: fitting.fit,
    opensAtPlace,
    askForZone,
    /** @param {number} steps */
    zoom: (steps) => map.zoomTo(map.getZoom() + steps),
    controls,
    ground: { map, onRecolour: (/** @type {() => void} */ act) => recolouring.add(act) },
    closeTop: () => controls.closeTop() || picking.close() || Boolean(layers.reach()?.close()),
    centre: () => map.getCenter().toArray(),
    box: () => /** @type {Box} */ (map.getBounds().toArray().flat()),
    /** @param {number[] | null} position */
    showPoint: (position) => routesLayer.showPoint(map, position),
    ...createViewing(view, shapes),
  };
}

/** Bringing places into view. @param {MapView} view @param {ReturnType<typeof createPickedShapes>} shapes */
function createViewing({ map, fit }, shapes) {
  return {
    /** @param {Parameters<typeof goTo>[1]} place */
    goTo: (place) => goTo(map, place, (box) => fit(box)),
    /** @param {number[][]} positions */
    showPlaces(positions) {
      if (positions.length > 1) return fit(boxAround(positions));
      const [longitude, latitude] = positions[0];
      return easeTo(map, [longitude, latitude], 13);
    },
    /** Move near enough to a target to see the assets. @param {PickedTarget} target */
    show(target) {
      const shape = isWhole(target) ? shapes.shapeOf(target) : null;
      if (shape) fit(boxAround(positionsOf(shape)));
      else if (target.centre) easeTo(map, /** @type {Position} */ (target.centre), 13.5);
    },
  };
}

/** @param {MapLibreMap} map @param {Position} center @param {number} least_zoom */
function easeTo(map, center, least_zoom) {
  const isCalm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  map.easeTo({ center, zoom: Math.max(map.getZoom(), least_zoom), duration: isCalm ? 0 : 350 });
}

/**
 * Positions of routes, targets and rally points; of UAVs only while the plan does not state which of them fly.
 *
 * @param {MissionPageState} state
 */
function positionsOfMission({ plan, selection }) {
  const flown = routesOf(plan).flatMap((route) => route.geometry?.coordinates ?? []);
  const { lost_link } = selection;
  const rally = lost_link && usesRallyPoints(lost_link) ? lost_link.rally_points : [];
  const places = [...flown, ...rally, ...selection.targets.flatMap(({ centre }) => (centre ? [centre] : []))];
  return flown.length ? places : [...places, ...selection.uavs.map((uav) => uav.position)];
}

/** @param {MapView} view @param {MissionStore} store */
function createFitting({ map, fit, home }, store) {
  let wasFitted = false;
  return {
    wasFitted: () => wasFitted,
    /** @param {{ animate?: boolean }} [how] */
    fit(how) {
      wasFitted = true;
      map.resize(); // the dock may just have appeared: fit into the remaining space
      const positions = positionsOfMission(store.state);
      const region = home();
      const ground = /** @type {Box | null} */ (region ?? store.state.ground?.extent ?? null);
      const around = store.state.mission ? null : baseView(store.state.fleet);
      const bases = around && (!region || isAround(region, around)) ? around : null; // those of several regions are no place
      fit(positions.length > 1 ? boxAround(positions) : (bases ?? ground ?? boxAround(positions)), how);
    },
  };
}

/**
 * Create the layers: targets, UAVs, routes, zones, and those added once the map has its style.
 *
 * @param {MapView} view
 * @param {HTMLElement} frame
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {MissionPageData} page
 */
function createLayers(view, frame, store, actions, page) {
  const { map, palette } = view;
  const shapes = createPickedShapes(map, store);
  const targets = createTargets(map, {
    onPick: (key) => store.update({ chosenTarget: key }),
    onHover: (key) => store.update({ litTarget: key }),
  });
  const uavs = createUavs(map, {
    onMove: actions.moveUav,
    onPick: (id) => {
      if (page.canPlan && typeof id === "number") actions.addUavOfFleet(id);
    },
    onLook: (sequence) => store.update({ lookedAt: store.state.plan ? sequence : null }),
  });
  /**
   * @type {{ hand: ReturnType<typeof mountHandMap>, reach: ReturnType<typeof mountReachLayer>, lostLink: ReturnType<typeof mountLostLinkMap> } | null}
   */
  let styled = null; // once the map has its style

  /**
   * Highlight one route; fade all while they do not match the selection, or a better plan is being searched for.
   *
   * @param {Readonly<MissionPageState>} state
   */
  function lookAt(state) {
    const sequence = state.lookedAt ?? state.chosenRoute;
    const isOutdated = (state.plan !== null && !isPlanCurrent(state)) || Boolean(state.planning?.best);
    routesLayer.lookAt(map, palette(), isOutdated ? -1 : sequence);
    targets.lookAt(isOutdated ? null : sequence);
  }

  return {
    shapes,
    targets,
    reach: () => styled?.reach ?? null,
    isHandOn: () => styled?.hand.isOn() ?? false,
    entries: () => (styled && page.canPlan ? [styled.reach.entry] : []),
    recolour() {
      styled?.hand.recolour();
      styled?.reach.recolour();
      styled?.lostLink.recolour();
      rehearsedLayer.recolour(map, palette());
    },
    start() {
      store.listen(["selection", "plan"], (state) => targets.update(pillsOf(state)));
      store.listen(["fleet", "selection"], (state) => uavs.update(markedUavs(state, page.canPlan)));
      store.listen(["plan"], ({ plan }) => {
        const routes = routesOf(plan);
        routesLayer.update(map, routes);
        const stops = routes.flatMap((route) =>
          staysOf(route).map(({ kind, index }) => ({ kind, position: route.waypoints[index].position })),
        );
        routesLayer.showStops(map, stops);
        showPlanPhotos(map, photosOf(routes));
      });
      showSearch(view, store, () => lookAt(store.state));
      store.listen(["lookedAt", "chosenRoute", "plan", "selection"], lookAt);
      styled = {
        lostLink: mountLostLinkMap(map, store, actions, page),
        hand: mountHandMap(map, store, actions),
        reach: mountReachLayer(map, frame, store),
      };
      store.listen(["rehearsal"], ({ rehearsal }) =>
        rehearsedLayer.show(map, palette(), rehearsal.track?.routes ?? null),
      );
      store.listen(["litZones"], ({ litZones }) => zonesLayer.light(map, litZones));
      shapes.start();
      store.listen(["chosenTarget"], ({ chosenTarget }) => targets.choose(chosenTarget));
    },
  };
}

/** @param {Readonly<MissionPageState>} state @returns {TargetPills} */
function pillsOf(state) {
  const { places, missed } = shownPlaces(state);
  return state.selection.targets.flatMap((target, index) => {
    if (!target.centre) return [];
    const place = places.get(target.key);
    return {
      key: target.key,
      name: nameOf(target),
      position: /** @type {Position} */ (target.centre),
      sequence: place?.sequence ?? null,
      letter: place?.letter ?? "",
      number: place?.number ?? index + 1,
      isMissed: missed.has(target.key),
    };
  });
}

/** @param {Readonly<MissionPageState>} state @param {boolean} canMove @returns {MapUavs} */
const markedUavs = (state, canMove) =>
  standingUavs(state).map(({ id, position, ...uav }) => ({
    ...uav,
    id: id ?? `at ${uav.sequence}`,
    position: /** @type {Position} */ (position),
    canMove,
  }));

/**
 * The best plan of a search so far; the first one is brought into view.
 *
 * @param {MapView} view
 * @param {MissionStore} store
 * @param {() => void} drawn
 */
function showSearch({ map, fit }, store, drawn) {
  /** @type {BestSoFar | null} */
  let shown = null;
  store.listen(["planning"], ({ planning }) => {
    const best = planning?.best ?? null;
    if (best === shown) return;
    const isFirst = shown === null;
    shown = best;
    routesLayer.showSoFar(map, best?.routes ?? null);
    drawn();
    if (isFirst && best?.routes.features.length)
      fit(boxAround(best.routes.features.flatMap(({ geometry }) => geometry.coordinates)));
  });
}

/**
 * A new plan is brought into view, and the tiles of another state of the map data are read.
 *
 * @param {MapView} view
 * @param {MissionStore} store
 * @param {Fitting} fitting
 */
function watchPlans({ map, opensAtPlace }, store, fitting) {
  store.listen(["plan"], ({ plan }) => {
    // Fit a plan that was just made. The map opened at a stored one, but the dock then took room from it; after saving nothing moves.
    if (plan && !store.state.planIsStored) fitting.fit();
    else if (plan && !opensAtPlace && !fitting.wasFitted()) fitting.fit({ animate: false });
  });
  /** @type {number | null} */
  let drawnGround = null;
  /** @param {number | null | undefined} revision */
  const drawGround = (revision) => {
    if (revision === null || revision === undefined || revision <= (drawnGround ?? -1)) return;
    const tiles = /** @type {VectorTileSource | undefined} */ (map.getSource(TILES));
    if (drawnGround !== null) tiles?.setTiles([tilesAddress(revision)]); // a zone may have been added
    drawnGround = revision;
  };
  store.listen(["groundRevision", "plan"], ({ groundRevision, plan }) => {
    drawGround(plan?.result.ground_revision);
    drawGround(groundRevision);
  });
}

/** The tool ends with the zone, or with the question. @param {MissionStore} store @returns {(drawn: Drawn) => void} */
const zoneAsking = (store) => (drawn) => {
  const end = () => store.update({ tool: "point" });
  askForFacts(drawn, { closed: end });
};

/** What to do with the tool in hand, over the map. @param {MissionStore} store */
function mountBanner(store) {
  const banner = byId("map-banner");
  /** @type {Partial<Record<MissionPageState["tool"], string>>} */
  const placing = {
    place: t("Click where the UAV takes off, or press Enter for the middle of the map."),
    rally: t("Click where UAVs may land without a link, or press Enter for the middle of the map."),
    zone: t("Draw a line round the zone, or click its middle; Enter takes the middle of the map."),
  };
  store.listen(["tool", "stretchFrom"], (state) => {
    const words = placing[state.tool] ?? toolWords(state);
    const end = state.tool === "place" || state.tool === "zone" ? t("Cancel") : t("Done");
    const onclick = () => store.update({ tool: "point" });
    banner.hidden = !words;
    banner.replaceChildren(words ?? "", h("button", { type: "button", class: "text-button", onclick }, end));
  });
}

/** The map's name for screen readers. @param {MapLibreMap} map @param {MissionStore} store */
function describeMap(map, store) {
  store.listen(["selection", "plan", "planning"], ({ selection, plan, planning }) => {
    const count = planning?.best?.routes.features.length ?? routesOf(plan).filter(({ geometry }) => geometry).length;
    const routes = planning?.best
      ? tn(count, "{count} route so far", "{count} routes so far")
      : tn(count, "{count} route", "{count} routes");
    const targets = tn(selection.targets.length, "{count} target", "{count} targets");
    map.getCanvas().setAttribute("aria-label", t("Map, {targets}, {routes}", { targets, routes }));
  });
}
