/** The map of a mission: what the store says is drawn, what the pointer says goes to the actions. */

import { get } from "../../api.js";
import { byId, h } from "../../dom.js";
import { piecesOf, routeClicks } from "../../map/click_router.js";
import { mountControls } from "../../map/controls.js";
import { createTip } from "../../map/furniture.js";
import * as rehearsedLayer from "../../map/layers/rehearsed.js";
import * as routesLayer from "../../map/layers/routes.js";
import * as selectionLayer from "../../map/layers/selection.js";
import { createTargets } from "../../map/layers/targets.js";
import { createUavs } from "../../map/layers/uavs.js";
import * as zonesLayer from "../../map/layers/zones.js";
import { partOfLine } from "../../map/line_part.js";
import { rememberedUnder } from "../../map/look/under.js";
import { TILES } from "../../map/look/voltages.js";
import { boxAround, createMap } from "../../map/map_view.js";
import { goTo } from "../../map/places_found.js";
import { tipOf } from "../../map/tips.js";
import { t, tn } from "../../text.js";
import { standingUavs } from "../fleet.js";
import { mountHandMap } from "../hand/hand_map.js";
import { usesRallyPoints } from "../lost_link.js";
import { isPlanCurrent, routesOf, shownPlaces } from "../plan_view.js";
import { staysOf } from "../route_times.js";
import { isWhole, nameOf } from "../selection.js";
import { mountLostLinkMap } from "./lost_link_map.js";
import { createMapPicking } from "./map_picking.js";
import { mountReachLayer } from "./reach_layer.js";

const cornersOf = (...boxes) =>
  boxes.flatMap(([west, south, east, north]) => [
    [west, south],
    [east, north],
  ]);

export function mountMap(store, actions, page, { askForUav }) {
  const frame = byId("map").parentElement;
  const container = byId("map");
  const { baseMap, satellite, extent } = page;
  const view = createMap(container, {
    baseMap,
    satellite,
    under: rememberedUnder(page),
    describe: t("Map"),
    bounds: page.bounds ?? extent,
    extent: page.bounds && extent ? boxAround(cornersOf(page.bounds, extent)) : extent,
  });
  const { map, opensAtPlace } = view;
  const shapes = new Map(); // asset id → geometry of what is picked whole
  let pointed = null; // what the pointer is at on the map
  let litHere = false; // the target that is lit is under the pointer
  const targets = createTargets(map, {
    onPick: (key) => store.update({ chosenTarget: key }),
    onHover: (key) => store.update({ litTarget: key }),
  });
  const uavs = createUavs(map, {
    onMove: actions.moveUav,
    onPick: (id) => page.canPlan && actions.addUavOfFleet(id),
    onLook: (sequence) => store.update({ lookedAt: store.state.plan ? sequence : null }),
  });
  const tip = createTip(frame);
  let [handMap, reachLayer, lostLinkMap] = [null, null, null]; // once the map has its style

  const controls = mountControls(view, page, {
    fit: () => fit(),
    isBusy: () => ["place", "rally"].includes(store.state.tool),
    measures: (isOn) => isOn && store.update({ tool: "point" }),
    recoloured: () =>
      [handMap, reachLayer, lostLinkMap, { recolour: () => rehearsedLayer.recolour(map, view.palette()) }].forEach(
        (drawn) => drawn?.recolour(),
      ),
    layers: () => (reachLayer && page.canPlan ? [reachLayer.entry] : []),
  });

  // clicks

  const picking = createMapPicking({ frame, store, actions, opened: () => tip(null) });
  map.on("movestart", () => {
    picking.close();
    tip(null);
    pointed = null; // what was under the pointer moves away from it
    ringHovered(store.state);
  });

  function click(thing, place, point) {
    picking.close();
    tip(null);
    if (controls.click(place)) return;
    const { tool } = store.state;
    if (tool === "rally") return void actions.addRallyPoint(place);
    if (handMap?.isOn()) return;
    if (tool === "place") {
      askForUav(place.map((degrees) => Number(degrees.toFixed(6))));
      return;
    }
    const met = tool !== "stretch" && targets.at(point);
    if (met) return void store.update({ chosenTarget: met });
    if (!thing) return;
    if (!page.canPlan || thing.kind === "zone") {
      // with a finger there is no hovering: what cannot be picked is told
      tip(`${thing.kind} ${thing.id}`, point, (refresh) => saidOf({ ...thing, place }, refresh), { soon: true });
      return;
    }
    picking.pick(thing, place, point);
    if (["no", "partly"].includes(reachLayer?.verdict(thing.id)))
      tip(`${thing.kind} ${thing.id}`, point, (refresh) => saidOf({ ...thing, place }, refresh), { soon: true });
  }

  /** What the tooltip says, with the reason why the asset can be inspected or not while that layer is shown. */
  function saidOf(thing, refresh) {
    const said = tipOf(thing, refresh);
    const words = thing.kind === "zone" ? "" : reachLayer?.textOf(thing.id);
    return words ? [...said, h("div", { class: "reach-said" }, words)] : said;
  }

  routeClicks(map, {
    tool: () => store.state.tool,
    kinds: picking.kinds,
    click,
    hover(thing, point, place) {
      controls.hover(place);
      const target = point && targets.at(point);
      if (target !== (store.state.litTarget ?? null) && (target || litHere)) store.update({ litTarget: target });
      litHere = Boolean(target);
      if (controls.isMeasuring() || target || picking.isOpen() || handMap?.isOn()) thing = null;
      tip(thing ? `${thing.kind} ${thing.id}` : null, point, (refresh) => saidOf({ ...thing, place }, refresh));
      const next = thing && thing.kind !== "zone" && !picking.isOpen() ? thing : null;
      if (next?.id === pointed?.id && next?.kind === pointed?.kind) return;
      pointed = next;
      ringHovered(store.state);
    },
    box: (box) => {
      if (page.canPlan) actions.addBox(box);
    },
    lasso: (ring) => actions.addArea(ring),
  });

  // what is drawn

  async function fetchShapes(list) {
    const wanted = list.filter((target) => target.asset !== null && isWhole(target) && !shapes.has(target.asset));
    await Promise.all(
      wanted.map(async (target) => {
        shapes.set(target.asset, null);
        try {
          shapes.set(target.asset, (await get(`/assets/${target.asset}`)).data.geometry);
        } catch {
          shapes.delete(target.asset); // drawn with the next change
        }
      }),
    );
    if (wanted.length) drawShapes(store.state);
  }

  /** What of a line is picked, where its shape has been loaded. */
  function shapeOf(target) {
    const shape = shapes.get(target.asset);
    return shape && target.stretch ? partOfLine(shape, target.stretch) : shape;
  }

  function drawShapes({ selection }) {
    selectionLayer.update(map, selection.targets.filter(isWhole).map(shapeOf).filter(Boolean));
  }

  /** The ring stands round what a list row or pill is at, else round what the pointer is at. */
  function ringHovered({ litTarget, selection, stretchFrom }) {
    const target = selection.targets.find(({ key }) => key === litTarget);
    const shape = target && isWhole(target) ? shapeOf(target) : null;
    const begun = stretchFrom ? [{ type: "Point", coordinates: stretchFrom.centre }] : [];
    if (shape) selectionLayer.showHovered(map, [shape]);
    else if (target?.centre) selectionLayer.showHovered(map, [{ type: "Point", coordinates: target.centre }]);
    else selectionLayer.showHovered(map, pointed ? [...begun, ...piecesOf(map, pointed)] : begun);
  }

  function drawTargets(state) {
    const { places, missed } = shownPlaces(state);
    const pills = state.selection.targets
      .map((target, index) => {
        const place = places.get(target.key);
        return {
          key: target.key,
          name: nameOf(target),
          position: target.centre,
          sequence: place?.sequence ?? null,
          letter: place?.letter ?? "",
          number: place?.number ?? index + 1,
          isMissed: missed.has(target.key),
        };
      })
      .filter((pill) => pill.position);
    targets.update(pills);
  }

  /** One route forward; all of them back while they are no plan of what is picked, or a better one is being searched for. */
  function lookAt(state) {
    const sequence = state.lookedAt ?? state.chosenRoute;
    const isOutdated = (state.plan !== null && !isPlanCurrent(state)) || Boolean(state.planning?.best);
    routesLayer.lookAt(map, view.palette(), isOutdated ? -1 : sequence);
    targets.lookAt(isOutdated ? null : sequence);
  }

  function start() {
    store.listen(["selection"], (state) => {
      drawShapes(state);
      fetchShapes(state.selection.targets);
    });
    store.listen(["selection", "plan"], drawTargets);
    store.listen(["plan"], ({ plan }) => {
      routesLayer.update(map, routesOf(plan));
      routesLayer.showStops(
        map,
        routesOf(plan).flatMap((route) =>
          staysOf(route).map(({ kind, index }) => ({ kind, position: route.waypoints[index].position })),
        ),
      );
      // A plan that was just made is looked at. A stored one is what the map opened at, but the dock took room from it; after saving nothing moves.
      if (plan && !store.state.planIsStored) fit();
      else if (plan && !opensAtPlace && !wasFitted) fit({ animate: false });
    });
    let soFar = null;
    store.listen(["planning"], ({ planning }) => {
      const best = planning?.best ?? null;
      if (best === soFar) return;
      const isFirst = soFar === null;
      soFar = best;
      routesLayer.showSoFar(map, best?.routes ?? null);
      lookAt(store.state);
      if (isFirst && best.routes.features.length)
        view.fit(boxAround(best.routes.features.flatMap(({ geometry }) => geometry.coordinates)));
    });
    store.listen(["fleet", "selection"], (state) =>
      uavs.update(standingUavs(state).map((uav) => ({ ...uav, canMove: page.canPlan }))),
    );
    store.listen(["lookedAt", "chosenRoute", "plan", "selection"], lookAt);
    lostLinkMap = mountLostLinkMap(map, store, actions, page);
    handMap = mountHandMap(map, store, actions);
    reachLayer = mountReachLayer(map, frame, store);
    store.listen(["rehearsal"], ({ rehearsal }) =>
      rehearsedLayer.show(map, view.palette(), rehearsal.track?.routes ?? null),
    );
    store.listen(["litZones"], ({ litZones }) => zonesLayer.light(map, litZones));
    store.listen(["litTarget", "selection", "stretchFrom"], ringHovered);
    store.listen(["chosenTarget"], ({ chosenTarget }) => targets.choose(chosenTarget));
    let drawnGround = null;
    const drawGround = (revision) => {
      if (!(revision > (drawnGround ?? -1))) return;
      if (drawnGround !== null)
        map.getSource(TILES)?.setTiles([`${location.origin}/api/v1/tiles/{z}/{x}/{y}?of=${revision}`]); // a zone may have come in
      drawnGround = revision;
    };
    store.listen(["groundRevision", "plan"], ({ groundRevision, plan }) =>
      [plan?.result.ground_revision, groundRevision].forEach(drawGround),
    );
    store.listen(["ground"], ({ ground }) => {
      controls.setGround(ground);
    });
  }

  store.listen(["tool"], ({ tool }) => {
    frame.dataset.tool = tool;
    if (tool !== "point") controls.closeTop();
  });
  store.listen(["tool", "stretchFrom"], (state) => {
    const isPlacing = state.tool === "place";
    const banner = byId("map-banner");
    const placing = {
      place: t("Click where the UAV takes off, or press Enter for the middle of the map."),
      rally: t("Click where UAVs may land without a link, or press Enter for the middle of the map."),
    };
    const words = placing[state.tool] ?? picking.words(state);
    banner.hidden = !words;
    banner.replaceChildren(
      words ?? "",
      h(
        "button",
        { type: "button", class: "text-button", onclick: () => store.update({ tool: "point" }) },
        isPlacing ? t("Cancel") : t("Done"),
      ),
    );
  });
  store.listen(["selection", "plan", "planning"], ({ selection, plan, planning }) => {
    const flown = planning?.best?.routes.features ?? (plan?.result.routes ?? []).filter((route) => route.geometry);
    const routes = planning?.best
      ? tn(flown.length, "{count} route so far", "{count} routes so far")
      : tn(flown.length, "{count} route", "{count} routes");
    map.getCanvas().setAttribute(
      "aria-label",
      t("Map, {targets}, {routes}", {
        targets: tn(selection.targets.length, "{count} target", "{count} targets"),
        routes,
      }),
    );
  });

  /** Routes, targets and rally points; UAVs only as long as nothing says which of them fly. */
  function positionsOfMission({ plan, selection }) {
    const flown = routesOf(plan).flatMap((route) => route.geometry?.coordinates ?? []);
    const rally = usesRallyPoints(selection.lost_link) ? selection.lost_link.rally_points : [];
    const places = [...flown, ...rally, ...selection.targets.map((target) => target.centre).filter(Boolean)];
    return flown.length ? places : [...places, ...selection.uavs.map((uav) => uav.position)];
  }

  let wasFitted = false;
  function fit(options) {
    wasFitted = true;
    map.resize(); // the dock may just have come: fit into what is left
    const positions = positionsOfMission(store.state);
    view.fit(
      positions.length > 1 ? boxAround(positions) : (store.state.ground?.extent ?? extent ?? boxAround(positions)),
      options,
    );
  }

  return {
    ready: view.ready.then(start),
    fit,
    opensAtPlace,
    zoom: (steps) => map.zoomTo(map.getZoom() + steps),
    bindings: controls.bindings,
    closeTop: () => {
      if (controls.closeTop() || picking.close()) return true;
      return Boolean(reachLayer?.close());
    },
    centre: () => map.getCenter().toArray(),
    box: () => map.getBounds().toArray().flat(),
    showPoint: (position) => routesLayer.showPoint(map, position),
    goTo: (place) => goTo(map, place, (box) => view.fit(box)),
    showPlaces(positions) {
      if (positions.length > 1) view.fit(boxAround(positions));
      else goTo(map, { position: positions[0], zoom: Math.max(map.getZoom(), 13) }, (box) => view.fit(box));
    },
    /** Brings a place into view, near enough to see what stands there. */
    show(target) {
      const shape = isWhole(target) ? shapeOf(target) : null;
      if (shape) view.fit(boxAround(shape.type === "MultiLineString" ? shape.coordinates.flat() : shape.coordinates));
      else if (target.centre)
        map.easeTo({
          center: target.centre,
          zoom: Math.max(map.getZoom(), 13.5),
          duration: matchMedia("(prefers-reduced-motion: reduce)").matches ? 0 : 350,
        });
    },
  };
}
