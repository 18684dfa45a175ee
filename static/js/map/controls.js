/** The controls that every map has: zoom, fit, layers, measuring, coordinates, and what is said when the map cannot be read. */

import { byId, h, icon } from "../dom.js";
import { closeMenu, menuOf, toggleMenu } from "../page/chrome.js";
import { copyText } from "../page/clipboard.js";
import { onTheme } from "../page/theme.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { coordinateText } from "../units.js";
import { mountCoordinates, mountScale, setAttribution } from "./furniture.js";
import { layersMenu } from "./layers_menu.js";
import { mountLegend } from "./legend.js";
import { createMeasure } from "./measure_tool.js";
import { createShown } from "./shown.js";
import { TILES } from "./style.js";
import { rememberedUnder, rememberUnder, underChoices } from "./under.js";

const COPIED_DIGITS = 6; // some 0.1 m
const ASK_AGAIN_MS = 8_000;

/**
 * act: { fit(), recoloured(palette)?, isBusy()?: the pointer belongs to something else, measures(isOn)?,
 * layers()?: more of them for the menu }
 * Returns { hover(place), click(place): true where the click was for the measuring, setGround(ground), closeTop(), isMeasuring(), bindings }.
 */
export function mountControls(view, page, act) {
  const { map } = view;
  const container = byId("map");
  const frame = container.parentElement;
  let under = rememberedUnder(page);
  let ground = null;
  let pointer = null;

  // The focus ring is for the keyboard: a click into the map gives it the focus too, and a key pressed later would show the ring.
  container.addEventListener("pointerdown", () => (container.dataset.pointed = "true"));
  container.addEventListener("focusout", () => delete container.dataset.pointed);
  container.project = (position) => map.project(position); // screen place of a position, for tests
  map.on("idle", () => (container.dataset.idle = "true"));
  map.on("movestart", () => delete container.dataset.idle);
  mountScale(map);
  mountLegend(map);
  const showCoordinates = mountCoordinates();
  byId("zoom-in").addEventListener("click", () => map.zoomIn());
  byId("zoom-out").addEventListener("click", () => map.zoomOut());
  byId("fit").addEventListener("click", () => act.fit());
  onTheme(() =>
    requestAnimationFrame(() => {
      view.recolour();
      act.recoloured?.(view.palette());
    }),
  );

  const attribute = () =>
    setAttribution([
      ...(ground?.attribution ?? []),
      under === "base-map" && page.baseMap.attribution,
      under === "satellite" && page.satellite.attribution,
    ]);

  const layers = byId("open-layers");
  const shown = createShown(map, () => {
    layers.toggleAttribute("data-some-hidden", !shown.isWhole());
    layers.setAttribute("aria-label", shown.isWhole() ? t("Layers") : t("Layers: some are hidden"));
    layers.title = layers.getAttribute("aria-label");
  });
  const choices = {
    choices: underChoices(page),
    chosen: () => under,
    choose(name) {
      under = name;
      view.putUnder(name);
      attribute();
      rememberUnder(name);
    },
  };
  layers.addEventListener("click", () =>
    toggleMenu(layers, () => layersMenu({ under: choices, shown, more: act.layers?.() })),
  );

  const measure = createMeasure(map, frame, byId("measure"), { onSwitch: act.measures, isBusy: act.isBusy });
  const middle = () => map.getCenter().toArray();

  async function copyPlace(place) {
    const text = [place[1], place[0]].map((degrees) => degrees.toFixed(COPIED_DIGITS)).join(", ");
    toast((await copyText(text)) ? t("Copied: {coordinates}", { coordinates: text }) : text);
  }

  // The menu of a place: right click, or a long touch.
  const anchor = h("span", { class: "map-anchor" });
  frame.append(anchor);
  map.on("contextmenu", ({ point, lngLat, originalEvent }) => {
    if (act.isBusy?.()) return;
    originalEvent.preventDefault();
    const place = [lngLat.lng, lngLat.lat];
    anchor.style.transform = `translate(${point.x}px, ${point.y}px)`;
    closeMenu();
    byId("map-tip").hidden = true;
    toggleMenu(anchor, () => {
      const menu = menuOf(t("This place"), [
        { icon: "copy", label: t("Copy the coordinates"), act: () => copyPlace(place) },
        { icon: "ruler", label: t("Measure from here"), act: () => (measure.end(), measure.start(place)) },
      ]);
      menu.prepend(h("p", { class: "caption" }, coordinateText(place)));
      return menu;
    });
  });
  map.on("movestart", closeMenu);

  watchTiles(map, frame);

  return {
    attribute,
    isMeasuring: measure.isOn,
    hover(place) {
      pointer = place;
      showCoordinates(place);
      measure.at(place);
    },
    click(place) {
      if (!measure.isOn()) return false;
      measure.add(place);
      return true;
    },
    setGround(next) {
      ground = next;
      attribute();
      byId("demo-badge").hidden = !ground?.is_synthetic;
      byId("map-empty").hidden = !ground || ground.extent !== null;
    },
    closeTop: measure.end,
    bindings: [
      { keys: ["m"], words: t("Measure"), act: () => (measure.isOn() ? measure.end() : measure.start()) },
      {
        keys: ["c"],
        words: t("Copy the coordinates at the pointer, or of the middle"),
        act: () => copyPlace(pointer ?? middle()),
      },
    ],
  };
}

/** Says so when the ground cannot be read, asks again by itself, and says nothing more once it can. */
function watchTiles(map, frame) {
  let timer = 0;
  let failed = []; // tiles, since they were last asked for
  const again = () => {
    clearTimeout(timer);
    timer = 0;
    const wanted = failed;
    failed = [];
    // by their names: MapLibre 6.17 leaves tiles that failed alone when it is asked for all
    map.refreshTiles(TILES, wanted);
  };
  const words = h(
    "span",
    {},
    h("strong", {}, t("The map cannot be read.")),
    " ",
    t("What you see may be incomplete. It is tried again every few seconds."),
  );
  const notice = h(
    "div",
    { class: "map-fault notice warning float", role: "status", hidden: true },
    icon("cloud-off"),
    words,
    h("button", { type: "button", class: "text-button", onclick: again }, t("Try now")),
  );
  frame.append(notice);
  map.on("error", ({ sourceId, error, tile }) => {
    if (sourceId !== TILES || error?.name === "AbortError") return;
    if (tile) failed.push(tile.tileID.canonical);
    notice.hidden = false;
    timer ||= setTimeout(again, ASK_AGAIN_MS);
  });
  map.on("idle", () => {
    if (!failed.length) notice.hidden = true;
  });
  addEventListener("online", () => notice.hidden || again());
}
