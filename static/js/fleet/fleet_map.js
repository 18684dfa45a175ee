/** Where UAVs and bases stand, and the pin that sets the place of the one that is edited. */

import { byId, h, icon } from "../dom.js";
import { setAttribution } from "../map/furniture.js";
import { boxAround, createMap } from "../map/map_view.js";
import { maplibre } from "../map/maplibre.js";
import { rememberedUnder } from "../map/look/under.js";
import { onTheme } from "../page/theme.js";
import { t } from "../text.js";

const ROUND_DEG = 0.02; // what is seen round a lone place
const NEAR_ZOOM = 13;
const ROW_PX = 22;
const SQUARE_PX = 26;
const EDGE_PX = 56;

const around = (box) => box && [box[0] - ROUND_DEG, box[1] - ROUND_DEG, box[2] + ROUND_DEG, box[3] + ROUND_DEG];
const rounded = ({ lng, lat }) => [Number(lng.toFixed(6)), Number(lat.toFixed(6))];

/** rows: { uavs, bases }; onChoose(tab, id) when one is clicked. */
export function createFleetMap({ page, rows, ground, onChoose }) {
  const container = byId("fleet-map");
  const under = rememberedUnder(page);
  const places = [...rows.uavs, ...rows.bases].map((row) => row.position);
  const view = createMap(container, {
    baseMap: page.baseMap,
    satellite: page.satellite,
    under,
    describe: t("Map of the fleet"),
    bounds: around(boxAround(places)) ?? page.extent,
    extent: page.extent,
  });
  const { map } = view;
  let markers = [];
  let pin = null;

  setAttribution([
    ...(ground?.attribution ?? []),
    under === "base-map" && page.baseMap.attribution,
    under === "satellite" && page.satellite.attribution,
  ]);
  onTheme(() => requestAnimationFrame(view.recolour));
  new ResizeObserver(() => map.resize()).observe(container);
  container.project = (position) => map.project(position); // screen place of a position, for tests
  map.on("idle", () => (container.dataset.idle = "true"));
  map.on("click", ({ lngLat }) => pin && move(rounded(lngLat)));

  function marker(row, tab, isChosen) {
    const isBase = tab === "bases";
    const name = h("span", { class: "dart-name", "aria-hidden": "true" }, row.name);
    return h(
      "button",
      {
        type: "button",
        tabindex: "-1",
        title: row.name,
        "aria-label": isBase ? t("Base {name}", { name: row.name }) : t("UAV {name}", { name: row.name }),
        class: `${isBase ? "fleet-square" : `fleet-dart ${row.state}`}${isChosen ? " chosen" : ""}`,
        onclick: (event) => (event.stopPropagation(), onChoose(tab, row.id)),
      },
      isBase ? h("span", {}, icon("warehouse")) : icon("uav"),
      isBase ? null : name,
    );
  }

  function move(position) {
    pin.marker.setLngLat(position);
    pin.tell(position);
  }

  return {
    centre: () =>
      map
        .getCenter()
        .toArray()
        .map((degrees) => Number(degrees.toFixed(6))),

    /** chosen: { tab, id } or null; the one that is edited is shown by the pin instead. */
    show({ uavs, bases }, chosen) {
      markers.forEach((known) => known.remove());
      const standing = new Map();
      const isChosen = (tab, row) => chosen?.tab === tab && chosen.id === row.id;
      const isAside = (tab, row) => pin !== null && isChosen(tab, row);
      markers = [];
      for (const base of bases.filter((row) => !isAside("bases", row))) {
        standing.set(base.position.join(), { base: true, rows: 0 });
        markers.push(
          new maplibre.Marker({ element: marker(base, "bases", isChosen("bases", base)) })
            .setLngLat(base.position)
            .addTo(map),
        );
      }
      for (const uav of uavs.filter((row) => !isAside("uavs", row))) {
        const before = standing.get(uav.position.join()) ?? { base: false, rows: 0 };
        standing.set(uav.position.join(), { ...before, rows: before.rows + 1 });
        const offset = [before.base ? SQUARE_PX / 2 : -14, before.rows * ROW_PX];
        markers.push(
          new maplibre.Marker({ element: marker(uav, "uavs", isChosen("uavs", uav)), anchor: "left", offset })
            .setLngLat(uav.position)
            .addTo(map),
        );
      }
    },

    /** Everything again. */
    lookAtAll({ uavs, bases }) {
      const box = around(boxAround([...uavs, ...bases].map((row) => row.position)));
      map.resize();
      if (box) map.fitBounds([box.slice(0, 2), box.slice(2)], { padding: EDGE_PX, duration: 0 });
    },

    /** Brings a place into view. */
    look(position) {
      map.jumpTo({ center: position, zoom: Math.max(map.getZoom(), NEAR_ZOOM) });
    },

    /** A pin to drag, or a click into the map; tell(position) on each change. null ends it. */
    place(position, tell) {
      pin?.marker.remove();
      pin = null;
      delete container.parentElement.dataset.placing;
      if (!position) return;
      container.parentElement.dataset.placing = "true";
      const element = h(
        "button",
        {
          type: "button",
          class: "fleet-pin",
          tabindex: "-1",
          "aria-label": t("Place, drag it"),
          title: t("Drag it, or click into the map"),
        },
        icon("map-pin"),
      );
      pin = {
        tell,
        marker: new maplibre.Marker({ element, anchor: "bottom", draggable: true }).setLngLat(position).addTo(map),
      };
      pin.marker.on("dragend", () => pin.tell(rounded(pin.marker.getLngLat())));
    },

    /** The pin follows what was typed. */
    movePin(position) {
      pin?.marker.setLngLat(position);
      const bounds = map.getBounds();
      if (pin && !bounds.contains(position)) map.jumpTo({ center: position });
    },
  };
}
