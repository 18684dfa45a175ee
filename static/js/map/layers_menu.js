/** The layers menu: what lies under the map, what is shown of the ground, and the legend where the map has no room for it. */

import { h } from "../dom.js";
import { t } from "../text.js";
import { bandSample, legendItems } from "./legend.js";
import { bandName, groupName } from "./shown.js";
import { BANDS, GROUPS } from "./style.js";

/** under: { choices: [{ value, words }], chosen(), choose(value) }; shown: createShown's; more: layers of the page: [{ words, isOn(), turn(isOn) }]. */
export function layersMenu({ under, shown, more = [] }) {
  const menu = h("div", { class: "menu float layers-menu", role: "group", "aria-label": t("Layers") });
  const check = (words, isOn, turn, drawing = null) =>
    h(
      "label",
      {},
      h("input", {
        type: "checkbox",
        class: "check",
        checked: isOn,
        onchange: (event) => (turn(event.target.checked), tellAll()),
      }),
      drawing,
      words,
    );

  const all = h(
    "button",
    { type: "button", class: "button", onclick: () => (shown.showAll(), draw(), menu.querySelector("input").focus()) },
    t("Show everything"),
  );
  const tellAll = () => (all.hidden = shown.isWhole());

  function draw() {
    const under_rows = under.choices.map(({ value, words }) =>
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
    menu.replaceChildren(
      ...(under.choices.length > 1 ? [h("h2", {}, t("Base map")), ...under_rows] : []),
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
      ]).filter(Boolean),
      ...more.map(({ words, isOn, turn }) => check(words, isOn(), turn)),
      all,
      h("h2", { class: "legend-head" }, t("Legend")),
      h("ul", { class: "legend" }, legendItems()),
    );
    tellAll();
  }
  draw();
  return menu;
}
