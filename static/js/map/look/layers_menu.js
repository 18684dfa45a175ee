/** The layers menu: the base map, the map data shown, and the legend where the map has no room for it. */

import { find, h, refill } from "../../dom.js";
import { t } from "../../text.js";
import { bandSample, legendItems } from "./legend.js";
import { bandName, groupName } from "./shown.js";
import { BANDS, GROUPS } from "./voltages.js";

/** @import { Shown } from "./shown.js" */
/** @import { SwitchedLayer } from "../types.d.ts" */

/**
 * @param {object} parts
 * @param {{ choices: { value: string, words: string }[], chosen: () => string, choose: (value: string) => void }} parts.under
 * @param {Shown} parts.shown
 * @param {SwitchedLayer[]} [parts.more] layers of the page
 */
export function layersMenu({ under, shown, more = [] }) {
  const menu = h("div", { class: "menu float layers-menu", role: "group", "aria-label": t("Layers") });
  /** @param {string} words @param {boolean} isOn @param {(isOn: boolean) => void} turn @param {SVGElement | null} [drawing] */
  const check = (words, isOn, turn, drawing = null) =>
    h(
      "label",
      {},
      h("input", {
        type: "checkbox",
        class: "check",
        checked: isOn,
        onchange: (event) => {
          turn(/** @type {HTMLInputElement} */ (event.target).checked);
          notifyAll();
        },
      }),
      drawing,
      words,
    );

  const all = h("button", { type: "button", class: "button", onclick: showEverything }, t("Show everything"));
  const notifyAll = () => {
    all.hidden = shown.isWhole();
  };

  function showEverything() {
    shown.showAll();
    draw();
    find(menu, "input").focus();
  }

  let drawn = 0;
  function draw() {
    drawn += 1;
    const underRows = under.choices.map(({ value, words }) =>
      h(
        "label",
        {},
        h("input", {
          type: "radio",
          name: "under",
          class: "radio",
          value,
          checked: under.chosen() === value,
          onchange: () => under.choose(value),
        }),
        words,
      ),
    );
    refill(menu, String(drawn), () => [
      ...(under.choices.length > 1 ? [h("h2", {}, t("Base map")), ...underRows] : []),
      h("h2", {}, t("Shown")),
      ...GROUPS.flatMap(({ key }) => [
        check(groupName(key), shown.hasGroup(key), (isOn) => shown.showGroup(key, isOn)),
        key === "lines" &&
          h(
            "div",
            { class: "layers-more", role: "group", "aria-label": t("Voltages") },
            BANDS.map((band) =>
              check(bandName(band), shown.hasBand(band), (isOn) => shown.showBand(band, isOn), bandSample(band)),
            ),
          ),
        key === "zones" &&
          h(
            "div",
            { class: "layers-more" },
            check(t("Also zones not in force now"), shown.hasResting(), shown.showResting),
          ),
      ]),
      ...more.map(({ words, isOn, turn }) => check(words, isOn(), turn)),
      all,
      h("h2", { class: "legend-head" }, t("Legend")),
      h("ul", { class: "legend" }, legendItems()),
    ]);
    notifyAll();
  }
  draw();
  return menu;
}
