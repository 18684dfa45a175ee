/** UAVs on the map: a filled dart where one is measured, a hollow one where it is estimated, grey in a dotted ring where it is lost. */

import { h, svg } from "../../dom.js";
import { routeNumber } from "../../domain/palette.js";
import { maplibre } from "../../map/maplibre.js";
import { markSimulated } from "../../simulated.js";
import { t } from "../../text.js";
import { between, GLIDE_MS } from "./glide.js";

/** @import { MapLibreMap } from "../../map/types.d.ts" */
/** @import { MarkedUav } from "../types.d.ts" */

const CERTAINTIES = { measured: t("measured"), estimated: t("estimated"), lost: t("lost") };
const calm = matchMedia("(prefers-reduced-motion: reduce)");

function drawMarker({ id, onPick }) {
  const dart = svg("svg", { class: "flyer-dart", viewBox: "0 0 26 26", "aria-hidden": "true" });
  const letter = h("span", { class: "letter" });
  const name = h("strong", {});
  const certainty = h("span", { class: "unseen" });
  const fact = h("span", {});
  const element = h(
    "button",
    { type: "button", tabindex: "-1", class: "map-flyer", onclick: (event) => (event.stopPropagation(), onPick(id)) },
    h("span", { class: "flyer-mark" }, dart),
    h("span", { class: "flyer-label" }, letter, name, certainty, fact),
  );
  return { element, dart, letter, name, certainty, fact };
}

/** A dart along its heading; without one a round mark that points nowhere. */
function shapeOf(heading_deg) {
  if (heading_deg === null || heading_deg === undefined) return svg("circle", { cx: 13, cy: 13, r: 7 });
  return svg("path", { d: "M13 2L21 23L13 18L5 23Z", transform: `rotate(${heading_deg} 13 13)` });
}

/** onPick(id of a UAV). glide_ms: between two places; 0 where they follow each other as frames do. */
export function createUavMarkers(map, { onPick, glide_ms = GLIDE_MS }) {
  const flyers = new Map(); // id → { marker, parts, from, to, began_ms }
  let frame = 0;

  function glide(now_ms) {
    frame = 0;
    let isMoving = false;
    for (const flyer of flyers.values()) {
      const since_ms = now_ms - flyer.began_ms;
      flyer.marker.setLngLat(between(flyer.from, flyer.to, since_ms, calm.matches ? 0 : glide_ms));
      isMoving ||= since_ms < glide_ms && !calm.matches;
    }
    if (isMoving) frame = requestAnimationFrame(glide);
  }

  function place(flyer, position) {
    if (flyer.to[0] === position[0] && flyer.to[1] === position[1]) return;
    Object.assign(flyer, { from: flyer.marker.getLngLat().toArray(), to: position, began_ms: performance.now() });
    frame ||= requestAnimationFrame(glide);
  }

  return {
    /** shown: [{ id, name, letter, place, position, heading_deg, certainty, fact, isMarked, isChosen }]; isMarked: as simulated */
    update(shown) {
      const seen = new Set(shown.map(({ id }) => id));
      for (const [id, { marker }] of flyers) if (!seen.has(id)) marker.remove(), flyers.delete(id);
      for (const uav of shown) {
        if (!flyers.has(uav.id)) {
          const parts = drawMarker({ id: uav.id, onPick });
          const marker = new maplibre.Marker({
            element: parts.element,
            anchor: "left",
            offset: [-20, 0],
            subpixelPositioning: true,
          })
            .setLngLat(uav.position)
            .addTo(map);
          flyers.set(uav.id, { marker, parts, from: uav.position, to: uav.position, began_ms: 0 });
        }
        const flyer = flyers.get(uav.id);
        const { element, dart, letter, name, certainty, fact } = flyer.parts;
        const look = `map-flyer ${uav.certainty} ${uav.place === null ? "" : `route-${routeNumber(uav.place)}`}`.trim();
        for (const kind of [
          "map-flyer",
          "measured",
          "estimated",
          "lost",
          ...[1, 2, 3, 4, 5, 6, 7, 8].map((number) => `route-${number}`),
        ])
          element.classList.toggle(kind, look.split(" ").includes(kind));
        element.classList.toggle("chosen", uav.isChosen);
        certainty.textContent = uav.fact.includes(CERTAINTIES[uav.certainty])
          ? ", "
          : `, ${CERTAINTIES[uav.certainty]}, `;
        dart.replaceChildren(shapeOf(uav.heading_deg));
        letter.hidden = uav.letter === "";
        letter.textContent = uav.letter;
        name.textContent = uav.name;
        markSimulated(name, uav.isMarked);
        fact.textContent = uav.fact;
        place(flyer, uav.position);
      }
    },
  };
}
