/** The map of a mission: what the store says is drawn, what the pointer says goes to the actions. */

import { get } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { nearestOnLine, piecesOf, routeClicks } from "../map/click_router.js";
import { createTip, layersMenu, mountCoordinates, mountLegend, mountScale, setAttribution, tipOf } from "../map/furniture.js";
import * as routesLayer from "../map/layers/routes.js";
import * as selectionLayer from "../map/layers/selection.js";
import { createTargets } from "../map/layers/targets.js";
import { createUavs } from "../map/layers/uavs.js";
import { boxAround, createMap } from "../map/map_view.js";
import { rememberedUnder, rememberUnder, underChoices } from "../map/under.js";
import { toggleMenu } from "../page/chrome.js";
import { onTheme } from "../page/theme.js";
import { toast } from "../page/toast.js";
import { isPlanCurrent, placesOf, routesOf, unreachedOf } from "./plan_view.js";
import { standingUavs } from "./fleet.js";
import { extentOf, isWhole, nameOf, targetOf } from "./selection.js";

const sentence = (words) => words[0].toUpperCase() + words.slice(1);
const cornersOf = (...boxes) => boxes.flatMap(([west, south, east, north]) => [[west, south], [east, north]]);

export function mountMap(store, actions, page, { askForUav }) {
  const frame = byId("map").parentElement;
  const container = byId("map");
  let under = rememberedUnder(page);
  const { baseMap, satellite, extent } = page;
  const view = createMap(container, { baseMap, satellite, under, describe: "Map", bounds: page.bounds ?? extent, extent: page.bounds && extent ? boxAround(cornersOf(page.bounds, extent)) : extent });
  const { map, opensAtPlace } = view;
  const shapes = new Map(); // asset id → geometry of what is picked whole
  const hidden = new Set();
  let pointed = null; // what the pointer is at on the map
  const targets = createTargets(map, { onPick: (key) => store.update({ chosenTarget: key }), onHover: (key) => store.update({ litTarget: key }) });
  const uavs = createUavs(map, {
    onMove: actions.moveUav,
    onPick: (id) => page.canPlan && actions.addUavOfFleet(id),
    onLook: (sequence) => store.update({ lookedAt: store.state.plan ? sequence : null }),
  });
  const tip = createTip(frame);
  const showCoordinates = mountCoordinates();

  // The focus ring is for the keyboard: a click into the map gives it the focus too, and a key pressed later would show the ring.
  container.addEventListener("pointerdown", () => (container.dataset.pointed = "true"));
  container.addEventListener("focusout", () => delete container.dataset.pointed);

  container.project = (position) => map.project(position); // screen place of a position, for tests
  map.on("idle", () => (container.dataset.idle = "true"));
  map.on("movestart", () => delete container.dataset.idle);
  mountScale(map);
  mountLegend(map);
  byId("zoom-in").addEventListener("click", () => map.zoomIn());
  byId("zoom-out").addEventListener("click", () => map.zoomOut());
  byId("fit").addEventListener("click", () => fit());
  onTheme(() => requestAnimationFrame(() => view.recolour()));

  const attribute = () => setAttribution([...(store.state.ground?.attribution ?? []), under === "base-map" && page.baseMap.attribution, under === "satellite" && page.satellite.attribution]);
  const layers = byId("open-layers");
  layers.addEventListener("click", () =>
    toggleMenu(layers, () =>
      layersMenu({
        under: {
          choices: underChoices(page),
          chosen: () => under,
          choose(name) {
            under = name;
            view.putUnder(name);
            attribute();
            rememberUnder(name);
          },
        },
        isShown: (group) => !hidden.has(group.name),
        show(group, visible) {
          if (visible) hidden.delete(group.name);
          else hidden.add(group.name);
          view.show(group.layers, visible);
        },
      }),
    ),
  );

  // clicks

  let choice = null;
  const closeChoice = () => {
    choice?.remove();
    choice = null;
  };

  /** A line can be flown end to end or looked at in one place: the operator says which. */
  function chooseOnLine(thing, place, point) {
    closeChoice();
    const pick = (position) => () => {
      closeChoice();
      actions.addTargets([targetOf({ ...thing, centre: place, position })]);
    };
    choice = h(
      "div",
      { class: "map-choice float", role: "group", "aria-label": nameOf(thing.properties) },
      h("p", { class: "caption" }, nameOf(thing.properties)),
      h("button", { type: "button", onclick: pick(null) }, icon(thing.kind), sentence(extentOf(thing.kind, thing.properties.length_m))),
      h("button", { type: "button", onclick: pick(place) }, icon("map-pin"), "This point"),
    );
    frame.append(choice);
    choice.style.left = `${Math.min(Math.max(8, point.x - 60), frame.clientWidth - choice.offsetWidth - 8)}px`;
    choice.style.top = `${Math.min(point.y + 12, frame.clientHeight - choice.offsetHeight - 8)}px`;
    choice.querySelector("button").focus();
  }
  map.on("movestart", () => {
    closeChoice();
    tip(null);
    pointed = null; // what was under the pointer moves away from it
    ringHovered(store.state);
  });

  function click(thing, place, point) {
    closeChoice();
    tip(null);
    const { tool } = store.state;
    if (tool === "place") {
      askForUav(place.map((degrees) => Number(degrees.toFixed(6))));
      return;
    }
    if (!page.canPlan || !thing || thing.kind === "zone") return;
    if (thing.properties.flyable === false) {
      toast(`${thing.properties.label} cannot be flown to: it is underground, out of use or a siding or busbar.`);
      return;
    }
    if (thing.kind === "tower" || thing.kind === "bridge") {
      const centre = thing.geometry.type === "Point" ? thing.geometry.coordinates : place;
      actions.addTargets([targetOf({ ...thing, centre })]);
      return;
    }
    const onLine = nearestOnLine(thing.geometry, place) ?? place;
    if (tool === "line") actions.addTargets([targetOf({ ...thing, centre: onLine })]);
    else if (thing.kind === "railway") actions.addTargets([targetOf({ ...thing, position: onLine })]);
    else chooseOnLine(thing, onLine, point);
  }

  routeClicks(map, {
    tool: () => store.state.tool,
    kinds: () => (store.state.tool === "line" ? ["line", "railway"] : null),
    click,
    hover(thing, point, place) {
      showCoordinates(place);
      tip(thing ? `${thing.kind} ${thing.id}` : null, point, () => tipOf(thing));
      const next = thing && thing.kind !== "zone" && !choice ? thing : null;
      if (next?.id === pointed?.id && next?.kind === pointed?.kind) return;
      pointed = next;
      ringHovered(store.state);
    },
    box: (box) => {
      if (page.canPlan) actions.addBox(box);
    },
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

  function drawShapes({ selection }) {
    selectionLayer.update(map, selection.targets.filter(isWhole).map((target) => shapes.get(target.asset)).filter(Boolean));
  }

  /** The ring stands round what a list row or pill is at, else round what the pointer is at. */
  function ringHovered({ litTarget, selection }) {
    const target = selection.targets.find(({ key }) => key === litTarget);
    const shape = target && isWhole(target) ? shapes.get(target.asset) : null;
    if (shape) selectionLayer.showHovered(map, [shape]);
    else if (target?.centre) selectionLayer.showHovered(map, [{ type: "Point", coordinates: target.centre }]);
    else selectionLayer.showHovered(map, pointed ? piecesOf(map, pointed) : []);
  }

  function drawTargets(state) {
    const isCurrent = isPlanCurrent(state);
    const missed = new Set(isCurrent ? unreachedOf(state.plan).map(({ target }) => target?.key) : []);
    const places = isCurrent ? placesOf(state.plan) : new Map();
    const pills = state.selection.targets
      .map((target, index) => {
        const place = places.get(target.key);
        return { key: target.key, name: nameOf(target), position: target.centre, sequence: place?.sequence ?? null, letter: place?.letter ?? "", number: place?.number ?? index + 1, isMissed: missed.has(target.key) };
      })
      .filter((pill) => pill.position);
    targets.update(pills);
  }

  function start() {
    store.listen(["selection"], (state) => {
      drawShapes(state);
      fetchShapes(state.selection.targets);
    });
    store.listen(["selection", "plan"], drawTargets);
    store.listen(["plan"], ({ plan }) => {
      routesLayer.update(map, routesOf(plan));
      // A plan that was just made is looked at. A stored one is what the map opened at, but the dock took room from it; after saving nothing moves.
      if (plan && !store.state.planIsStored) fit();
      else if (plan && !opensAtPlace && !wasFitted) fit({ animate: false });
    });
    store.listen(["fleet", "selection"], (state) => uavs.update(standingUavs(state).map((uav) => ({ ...uav, canMove: page.canPlan }))));
    store.listen(["lookedAt", "chosenRoute", "plan", "selection"], (state) => {
      const sequence = state.lookedAt ?? state.chosenRoute;
      const isOutdated = state.plan !== null && !isPlanCurrent(state);
      routesLayer.lookAt(map, view.palette(), isOutdated ? -1 : sequence);
      targets.lookAt(isOutdated ? null : sequence);
    });
    store.listen(["litTarget", "selection"], ringHovered);
    store.listen(["chosenTarget"], ({ chosenTarget }) => targets.choose(chosenTarget));
    store.listen(["ground"], ({ ground }) => {
      attribute();
      byId("demo-badge").hidden = !ground?.is_synthetic;
      byId("map-empty").hidden = !ground || ground.extent !== null;
    });
  }

  store.listen(["tool"], ({ tool }) => {
    frame.dataset.tool = tool;
    const banner = byId("map-banner");
    const words = { box: "Drag a box round towers and bridges.", line: "Click a line, or a section of a railway: it is flown end to end.", place: "Click where the UAV takes off, or press Enter for the middle of the map." }[tool];
    banner.hidden = !words;
    banner.replaceChildren(words ?? "", h("button", { type: "button", class: "text-button", onclick: () => store.update({ tool: "point" }) }, tool === "place" ? "Cancel" : "Done"));
  });
  store.listen(["selection", "plan"], ({ selection, plan }) => {
    const routes = plan ? plan.result.routes.filter((route) => route.geometry).length : 0;
    map.getCanvas().setAttribute("aria-label", `Map, ${selection.targets.length} targets, ${routes} routes`);
  });

  /** Routes and targets; UAVs only as long as nothing says which of them fly. */
  function positionsOfMission({ plan, selection }) {
    const flown = routesOf(plan).flatMap((route) => route.geometry?.coordinates ?? []);
    const places = [...flown, ...selection.targets.map((target) => target.centre).filter(Boolean)];
    return flown.length ? places : [...places, ...selection.uavs.map((uav) => uav.position)];
  }

  let wasFitted = false;
  function fit(options) {
    wasFitted = true;
    map.resize(); // the dock may just have come: fit into what is left
    const positions = positionsOfMission(store.state);
    view.fit(positions.length > 1 ? boxAround(positions) : (store.state.ground?.extent ?? extent ?? boxAround(positions)), options);
  }

  return {
    ready: view.ready.then(start),
    fit,
    opensAtPlace,
    zoom: (steps) => map.zoomTo(map.getZoom() + steps),
    closeTop: () => {
      const had = choice !== null;
      closeChoice();
      return had;
    },
    centre: () => map.getCenter().toArray(),
    box: () => map.getBounds().toArray().flat(),
    showPoint: (position) => routesLayer.showPoint(map, position),
    /** Brings a place into view, near enough to see what stands there. */
    show(target) {
      const shape = isWhole(target) ? shapes.get(target.asset) : null;
      if (shape) view.fit(boxAround(shape.type === "MultiLineString" ? shape.coordinates.flat() : shape.coordinates));
      else if (target.centre) map.easeTo({ center: target.centre, zoom: Math.max(map.getZoom(), 13.5), duration: matchMedia("(prefers-reduced-motion: reduce)").matches ? 0 : 350 });
    },
  };
}
