/** The instruments on the page: whose they are, and figures that change in place. */

import { h } from "../../dom.js";
import { routeLetter, routeNumber } from "../../domain/palette.js";
import { markSimulated } from "../../simulated.js";
import { t } from "../../text.js";
import { certaintyText } from "./readings.js";

/** show(route, drawn, readings, isMarked): isMarked where it is simulated and others are not. */
export function createInstruments() {
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
  const rows = new Map();

  function row({ name: key, words }) {
    if (!rows.has(key)) {
      const parts = { value: h("span", { class: "scene-value" }), note: h("small", {}) };
      const item = h("div", { "data-reading": key }, h("dt", {}, words), h("dd", {}, parts.value, parts.note));
      rows.set(key, { ...parts, item });
      list.append(item);
    }
    return rows.get(key);
  }

  const put = (element_, text) => element_.textContent !== text && (element_.textContent = text);

  return {
    element,
    show(route, drawn, readings, isMarked = false) {
      element.hidden = !route;
      if (!route) return;
      put(letter, routeLetter(route.place));
      letter.className = `letter route-${routeNumber(route.place)}`;
      put(name, route.name);
      markSimulated(name, isMarked);
      list.hidden = !drawn;
      empty.hidden = Boolean(drawn);
      put(certainty, drawn ? certaintyText(drawn.moment) : "");
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
