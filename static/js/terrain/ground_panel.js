/** The dock: the height of the ground at a place, or its profile along a line. */

import { byId, h, icon, setChildren } from "../dom.js";
import { t } from "../text.js";
import { coordinateText, heightText, lengthText } from "../units.js";
import { drawProfile, nearestSample, profileSentence, rowsOf } from "./profile_chart.js";

/** @import { Child } from "../dom.js" */
/** @import { GroundHeight } from "../api_types.d.ts" */
/** @import { ProfileLine, TowerAlong } from "./profile_chart.js" */

const CHART_PX = 150;

/** @typedef {{ cursor: (index: number | null) => void, back: () => void, close: () => void }} PanelHandlers */
/**
 * The profile in the dock.
 *
 * @typedef {object} ShownProfile
 * @property {ProfileLine} profile
 * @property {TowerAlong[]} towers
 * @property {HTMLElement} frame
 * @property {HTMLElement} figures
 * @property {number} width [px]
 * @property {Partial<ReturnType<typeof drawProfile>> & { point: (index: number | null) => void }} chart
 */

/** @param {PanelHandlers} on */
export function mountGroundPanel(on) {
  const dock = byId("dock");
  const panel = byId("terrain-panel");
  /** @type {ShownProfile | null} */
  let shown = null;

  const closer = () =>
    h(
      "button",
      {
        class: "icon-button tight terrain-close",
        type: "button",
        "aria-label": t("Close"),
        title: t("Close (Esc)"),
        onclick: on.close,
      },
      icon("x"),
    );

  /** @param {...Child} content */
  function put(...content) {
    shown = null;
    dock.hidden = false;
    setChildren(panel, ...content, closer());
  }

  /** @param {number | null} index */
  function point(index) {
    if (!shown) return;
    shown.chart.point(index);
    shown.figures.replaceChildren(...figuresAt(shown, index));
  }

  function redraw() {
    if (!shown) return;
    const width = Math.floor(shown.frame.clientWidth);
    if (!width || width === shown.width) return;
    shown.width = width;
    const chart = drawProfile(shown.profile, shown.towers, width, CHART_PX);
    shown.chart = chart;
    shown.frame.replaceChildren(chart.element);
  }
  new ResizeObserver(redraw).observe(panel);

  return {
    close() {
      shown = null;
      dock.hidden = true;
      panel.replaceChildren();
    },
    /** @param {string} sentence */
    words: (sentence) => put(h("p", { class: "terrain-sentence" }, sentence)),
    height: (/** @type {number[]} */ position, /** @type {GroundHeight} */ height) =>
      put(...heightWords(position, height)),
    /**
     * Show a profile; `title` names the line, `canStepBack` offers to remove the last point.
     *
     * @param {ProfileLine} profile
     * @param {TowerAlong[]} towers
     * @param {{ title: string, canStepBack: boolean }} how
     */
    profile(profile, towers, { title, canStepBack }) {
      const frame = h("div", { class: "profile-frame" });
      const figures = h("div", { class: "profile-figures" });
      put(
        profileHead(profile, towers, title, canStepBack ? on.back : null),
        h("div", { class: "profile-body" }, figures, frame),
        tableOf(profile, towers),
      );
      shown = { profile, towers, frame, figures, width: 0, chart: { point: () => {} } };
      redraw();
      point(null);
      const follow = (/** @type {PointerEvent} */ { clientX }) => {
        if (!shown?.chart.scales) return;
        const along_m = shown.chart.scales.distanceAt(clientX - frame.getBoundingClientRect().left);
        on.cursor(nearestSample(profile.distance_m, along_m));
      };
      frame.addEventListener("pointermove", follow);
      frame.addEventListener("pointerdown", follow);
      frame.addEventListener("pointerleave", () => on.cursor(null));
    },
    point,
  };
}

/** @param {number[]} position @param {GroundHeight} height */
function heightWords(position, { ground_amsl_m, vertical_datum, source }) {
  const isKnown = ground_amsl_m !== null;
  const words = isKnown
    ? t("{height} above sea level", { height: heightText(ground_amsl_m) })
    : t("No terrain model knows the ground here.");
  const caption = [coordinateText(position), isKnown && vertical_datum, isKnown && source].filter(Boolean).join(" · ");
  return [h("h2", { class: "terrain-sentence" }, words), h("p", { class: "caption" }, caption)];
}

/** @param {ProfileLine} profile @param {TowerAlong[]} towers @param {string} title @param {(() => void) | null} stepBack */
function profileHead(profile, towers, title, stepBack) {
  const back =
    stepBack &&
    h(
      "button",
      { class: "button quiet", type: "button", onclick: stepBack },
      icon("undo-2"),
      t("Take the last point back"),
    );
  return h(
    "div",
    { class: "profile-head" },
    h("h2", { class: "terrain-sentence" }, title),
    h("p", { class: "caption" }, profileSentence(profile, towers)),
    back,
  );
}

/** @param {ShownProfile} shown @param {number | null} index */
function figuresAt({ profile, towers }, index) {
  /** @param {string} term @param {string} words */
  const place = (term, words) => h("div", {}, h("dt", {}, term), h("dd", {}, words));
  if (index === null) {
    if (profile.lowest_m === null || profile.highest_m === null) return [];
    return [
      h(
        "dl",
        {},
        place(t("Highest"), heightText(profile.highest_m)),
        place(t("Lowest"), heightText(profile.lowest_m)),
        place(t("Length"), lengthText(profile.length_m)),
      ),
    ];
  }
  const ground = profile.ground_amsl_m[index];
  const tower = towers.find((candidate) => candidate.index === index);
  return [
    h(
      "dl",
      {},
      place(t("Ground"), ground === null ? t("not known") : heightText(ground)),
      place(t("Along"), lengthText(profile.distance_m[index])),
      tower && place(t("Tower"), towerText(tower)),
    ),
  ];
}

/** @param {TowerAlong} tower */
const towerText = ({ label, height_m }) =>
  `${label}, ${height_m === null ? t("height not stated") : heightText(height_m)}`;

/** @param {ProfileLine} profile @param {TowerAlong[]} towers */
function tableOf(profile, towers) {
  /** @param {ReturnType<typeof rowsOf>[number]} row */
  const cells = ({ distance_m, ground_amsl_m, tower }) => [
    lengthText(distance_m),
    ground_amsl_m === null ? t("not known") : heightText(ground_amsl_m),
    tower ? towerText(tower) : "",
  ];
  return h(
    "details",
    { class: "profile-table" },
    h("summary", {}, t("As a table")),
    h(
      "table",
      {},
      h(
        "thead",
        {},
        h(
          "tr",
          {},
          [t("Along"), t("Ground above sea level"), t("Tower")].map((name) => h("th", { scope: "col" }, name)),
        ),
      ),
      h(
        "tbody",
        {},
        rowsOf(profile, towers).map((row) =>
          h(
            "tr",
            {},
            cells(row).map((words) => h("td", {}, words)),
          ),
        ),
      ),
    ),
  );
}
