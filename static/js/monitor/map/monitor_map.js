/** The live map: draws the store's state, and stores what the pointer picks. */

import { byId } from "../../dom.js";
import { certaintyOf, LOST, MEASURED, standsAt } from "../../domain/certainty.js";
import { boxAround } from "../../domain/geodesy.js";
import { inAir } from "../../domain/in_air.js";
import { alarmOf } from "../../domain/order.js";
import { rallyName, routeLetter, routeNumber } from "../../domain/palette.js";
import { mountControls } from "../../map/controls.js";
import { createTip } from "../../map/furniture.js";
import * as fenceLayer from "../../map/layers/fences.js";
import { createRallyPoints } from "../../map/layers/lost_link.js";
import * as routesLayer from "../../map/layers/routes.js";
import { optionsOf } from "../../map/look/under.js";
import { createMap } from "../../map/map_view.js";
import { showTipsOnly } from "../../map/tips_only.js";
import { t, tn } from "../../text.js";
import { exactClockText } from "../../units.js";
import { numbersOf, pillOf } from "../board.js";
import { letterOf, prefixOf } from "../call_signs.js";
import { mapFact } from "../text/uav_text.js";
import { createCloseUp } from "./close_up.js";
import * as flightLayers from "./flight_layers.js";
import { createTargetPills } from "./target_pills.js";
import { createUavMarkers } from "./uav_markers.js";

/** @import { LiveUav } from "../../api_types.d.ts" */
/** @import { FeatureCollection } from "../../map/types.d.ts" */
/** @import { MissionNumbers } from "../call_signs.js" */
/** @import { DrawnUav, FlownLine, MonitorPage, MonitorState, MonitorStore, PlannedLine } from "../types.d.ts" */

const NEAR_ZOOM = 13.5;
const JUMP_MS = 350;
const FOLLOW_MS = 300;
const calm = matchMedia("(prefers-reduced-motion: reduce)");

/**
 * The drawing of a UAV; null before it was first seen.
 *
 * @param {LiveUav} uav
 * @param {number} now_ms
 * @param {number | null} chosen
 * @param {MissionNumbers} [numbers] on the page of all missions
 * @returns {DrawnUav | null}
 */
export function drawnUav(uav, now_ms, chosen, numbers = new Map()) {
  const certainty = certaintyOf(uav, now_ms);
  const at = standsAt(uav, certainty);
  if (!at || !certainty) return null;
  const isSure = certainty === MEASURED;
  return {
    ...at,
    id: uav.id,
    name: uav.name,
    place: uav.place,
    letter: letterOf(uav, numbers),
    certainty,
    fact: mapFact(uav, certainty),
    isChosen: uav.id === chosen,
    isSimulated: uav.is_simulated,
    colour: uav.colour,
    bound: isSure || certainty === LOST ? null : (uav.estimated?.bound ?? null),
    last: isSure ? null : (uav.measured?.position ?? null),
    words: uav.measured ? t("last report {time}", { time: exactClockText(uav.measured.measured_at) }) : "",
  };
}

/** @param {Pick<MonitorState, "uavs" | "now_ms" | "chosen" | "numbers">} state */
const drawnUavs = ({ uavs, now_ms, chosen, numbers }) =>
  uavs.flatMap((uav) => drawnUav(uav, now_ms, chosen, numbers) ?? []);

/** Positions of UAVs in the air, and the routes of their missions; all planned routes where none flies. @param {MonitorState} state */
function placesToFit(state) {
  const flying = new Set(state.uavs.filter((uav) => inAir(uav) === true).map(({ id }) => id));
  const drawn = drawnUavs(state);
  const missions = state.missions.filter(({ uavs }) => uavs.some(({ uav }) => uav !== null && flying.has(uav)));
  const lines = plannedLines(missions.length ? { ...state, missions } : state);
  const inTheAir = drawn.filter(({ id }) => flying.has(id));
  return [
    ...lines.flatMap(({ geometry }) => (geometry?.type === "LineString" ? geometry.coordinates : [])),
    ...(inTheAir.length ? inTheAir : drawn).map(({ position }) => position),
  ];
}

/** @param {Pick<MonitorState, "missions" | "details">} state @returns {PlannedLine[]} */
const plannedLines = ({ missions, details }) =>
  missions.flatMap(({ id, colours }) =>
    (details.get(id)?.plan?.routes ?? []).map(({ geometry }, sequence) => ({
      sequence,
      geometry,
      colour: routeNumber(sequence, colours),
    })),
  );

/** @param {Pick<MonitorState, "uavs" | "flown">} state @returns {FlownLine[]} */
const flownLines = ({ uavs, flown }) => uavs.flatMap(({ id, colour }) => ({ colour, parts: flown.get(id) ?? [] }));

/** @param {PlannedLine[]} routes @returns {FeatureCollection} */
const collection = (routes) => ({
  type: "FeatureCollection",
  features: routes.flatMap(({ sequence, geometry, colour }) =>
    geometry ? [{ type: "Feature", properties: { sequence, route: colour, dashed: false }, geometry }] : [],
  ),
});

/** @param {Pick<MonitorState, "missions" | "details" | "numbers">} state */
const pillsOf = ({ missions, details, numbers: order }) =>
  missions.flatMap((mission) => {
    const prefix = prefixOf(mission.id, order);
    const detail = details.get(mission.id);
    const numbers = numbersOf(detail);
    return mission.targets.flatMap((target) => {
      const position = detail?.targets[target.place]?.position;
      if (!position) return [];
      return {
        key: `${mission.id} ${target.place}`,
        position,
        sequence: target.uav,
        colour: target.uav === null ? null : routeNumber(target.uav, mission.colours),
        letter: target.uav === null ? "" : `${prefix}${routeLetter(target.uav)}`,
        number: numbers.get(target.place) ?? target.place + 1,
        name: `${pillOf(target, numbers, prefix)} ${target.label}`,
        state: target.state,
        isMissed: false,
      };
    });
  });

/** @param {MonitorStore} store @param {MonitorPage} page @param {{ pick: (uav: number) => void }} on */
export const mountMonitorMap = (store, page, on) => new MonitorMap(store, page, on);

class MonitorMap {
  #store;
  #page;
  #pick;
  #frame;
  #view;
  #controls;
  /** @type {{ markers: ReturnType<typeof createUavMarkers>, pills: ReturnType<typeof createTargetPills>, closeUp: ReturnType<typeof createCloseUp> } | null} */
  #parts = null; // once the map has its style

  /** @param {MonitorStore} store @param {MonitorPage} page @param {{ pick: (uav: number) => void }} on */
  constructor(store, page, { pick }) {
    this.#store = store;
    this.#page = page;
    this.#pick = pick;
    const container = byId("map");
    this.#frame = /** @type {HTMLElement} */ (container.parentElement);
    this.#view = createMap(container, {
      ...optionsOf(page),
      describe: t("Map"),
      bounds: page.bounds,
    });
    const { map } = this.#view;
    const tip = createTip(this.#frame);
    this.#controls = mountControls(this.#view, page, {
      fit: () => this.fit(),
      recoloured: (palette) => {
        flightLayers.recolour(map, palette);
        fenceLayer.recolour(map);
        this.#parts?.closeUp.recolour();
      },
    });
    map.on("dragstart", () => store.update({ isFollowing: false }));
    showTipsOnly(map, { controls: this.#controls, tip });
    this.ready = this.#view.ready.then(() => this.#start());
    this.opensAtLastView = this.#view.opensAtLastView;
    this.opensAtPlace = this.#view.opensAtPlace && !this.opensAtLastView; // UAVs in the air come before the last view
  }

  get controls() {
    return this.#controls;
  }

  closeTop() {
    return this.#controls.closeTop();
  }

  /** @param {number} steps */
  zoom(steps) {
    this.#view.map.zoomTo(this.#view.map.getZoom() + steps);
  }

  /** @param {{ animate?: boolean }} [how] */
  fit(how) {
    this.#view.map.resize();
    const places = placesToFit(this.#store.state);
    const box = boxAround(places);
    this.#view.fit(places.length > 1 ? box : (this.#view.home() ?? box), how);
  }

  /** Bring a UAV into view, near enough to see its manoeuvres. @param {number | null} id */
  jumpTo(id) {
    const uav = drawnUavs(this.#store.state).find((entry) => entry.id === id);
    if (uav) this.showPlace(uav.position);
    return Boolean(uav);
  }

  /** @param {number[]} position */
  showPlace([longitude, latitude]) {
    const { map } = this.#view;
    map.easeTo({
      center: [longitude, latitude],
      zoom: Math.max(map.getZoom(), NEAR_ZOOM),
      duration: calm.matches ? 0 : JUMP_MS,
    });
  }

  /** Show rally points and fences of the approved plan. @param {{ rally: number[][], fences: number[][][] }} approved */
  showApproved({ rally, fences }) {
    const { map } = this.#view;
    createRallyPoints(map, { onMove: () => {} }).update(
      rally.map((position, place) => ({ position, name: rallyName(place) })),
      false,
    );
    fenceLayer.show(map, fences);
  }

  #start() {
    const [store, { map }] = [this.#store, this.#view];
    flightLayers.addTo(map, this.#view.palette());
    const pills = createTargetPills(map);
    this.#parts = {
      markers: createUavMarkers(map, { onPick: this.#pick, spreads: true }),
      pills,
      closeUp: createCloseUp(this.#view, this.#frame, this.#page),
    };
    store.listen(["missions", "details", "numbers"], (state) => {
      routesLayer.update(map, plannedLines(state));
      pills.update(pillsOf(state));
    });
    store.listen(["flown", "uavs"], (state) => flightLayers.showFlown(map, flownLines(state)));
    store.listen(["uavs", "alerts", "now_ms", "chosen", "details", "isFollowing"], (state) => this.#drawUavs(state));
    store.listen(["offered"], ({ offered }) => flightLayers.showOffered(map, offered));
    store.listen(["ground"], ({ ground }) => this.#controls.setGround(ground));
    map.on("zoomend", () => this.#drawUavs(store.state));
    store.listen(["uavs"], ({ uavs }) =>
      map
        .getCanvas()
        .setAttribute("aria-label", t("Map, {uavs}", { uavs: tn(uavs.length, "{count} UAV", "{count} UAVs") })),
    );
  }

  /** @param {MonitorState} state */
  #drawUavs(state) {
    if (!this.#parts) return;
    const { map } = this.#view;
    const shown = drawnUavs(state);
    const isMixed = !state.uavs.every(({ is_simulated }) => is_simulated); // else the page's head reports it once
    this.#parts.markers.update(
      shown.map((uav) => ({
        ...uav,
        isMarked: uav.isSimulated && isMixed,
        alarm: alarmOf(uav.id, state.alerts),
      })),
    );
    flightLayers.showUncertain(
      map,
      shown.filter(({ certainty }) => certainty !== MEASURED),
    );
    const chosen = shown.find(({ isChosen }) => isChosen) ?? null;
    this.#parts.closeUp.update(chosen, collection(plannedLines(state)), flownLines(state));
    if (!state.isFollowing || !chosen) return;
    const [longitude, latitude] = chosen.position;
    map.easeTo({ center: [longitude, latitude], duration: calm.matches ? 0 : FOLLOW_MS });
  }
}
