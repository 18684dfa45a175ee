/** The instruments on the page: name of their UAV, and figures that are updated in place. */

import { h } from "../../dom.js";
import { routeLetter, routeNumber } from "../../domain/palette.js";
import { markSimulated } from "../../simulated.js";
import { t } from "../../text.js";
import { certaintyText } from "./readings.js";

/** @import { DrawnUav, FlightRoute } from "../types.d.ts" */
/** @import { Reading } from "./readings.js" */

/** @typedef {ReturnType<typeof createInstruments>} Instruments */

/** @param {readonly number[]} [colours] of the mission */
export function createInstruments(colours) {
  const letter = h("span", { class: "letter" });
  const name = h("strong", {});
  const certainty = h("span", { class: "scene-certainty caption" });
  const list = h("dl", { class: "scene-readings" });
  const empty = h("p", { class: "caption", hidden: true }, t("Nothing is known of it at this moment."));
  const element = h(
    "section",
    { class: "scene-instruments", "aria-label": t("Instruments") },
    h("header", {}, letter, h("div", {}, name, certainty)),
    list,
    empty,
  );
  /** @type {Map<string, { item: HTMLElement, value: HTMLElement, note: HTMLElement }>} by the reading's name */
  const rows = new Map();

  /** @param {Reading} reading */
  function row({ name: key, words }) {
    const known = rows.get(key);
    if (known) return known;
    const [value, note] = [h("span", { class: "scene-value" }), h("small", {})];
    const item = h("div", { "data-reading": key }, h("dt", {}, words), h("dd", {}, value, note));
    list.append(item);
    const made = { item, value, note };
    rows.set(key, made);
    return made;
  }

  /** @param {HTMLElement} place @param {string} text */
  const put = (place, text) => {
    if (place.textContent !== text) place.textContent = text;
  };

  return {
    element,
    /**
     * @param {FlightRoute | null} route
     * @param {DrawnUav | null} drawn
     * @param {readonly Reading[]} readings
     * @param {boolean} [isMarked] it is simulated and others are not
     */
    show(route, drawn, readings, isMarked = false) {
      element.hidden = !route;
      if (!route) return;
      put(letter, routeLetter(route.place));
      letter.className = `letter route-${routeNumber(route.place, colours)}`;
      put(name, route.name);
      markSimulated(name, isMarked);
      list.hidden = !drawn;
      empty.hidden = Boolean(drawn);
      put(certainty, drawn ? certaintyText(drawn.moment, Boolean(route.isSimulated)) : "");
      certainty.dataset.kind = drawn?.moment.kind ?? "";
      for (const reading of readings) {
        const { item, value, note } = row(reading);
        put(value, reading.value);
        put(note, reading.note);
        item.classList.toggle("bad", Boolean(reading.isBad));
      }
    },
  };
}
