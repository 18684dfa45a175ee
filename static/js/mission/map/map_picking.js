/** Effect of a click on an asset, by the active tool; where there are several, a small choice is shown beside it. */

import { nearestOnLine } from "../../domain/geodesy.js";
import { announce, toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import { lengthText } from "../../units.js";
import { extentOf, nameOf, targetOf } from "../selection.js";
import { createChoice } from "./choice.js";

/** @import { SupportsOutput } from "../../api_types.d.ts" */
/** @import { Line } from "../../domain/geodesy.js" */
/** @import { MapThing, Position, ScreenPoint } from "../../map/types.d.ts" */
/** @import { MissionActions, MissionPageState, MissionStore } from "../types.d.ts" */
/** @import { createChoice as CreateChoice } from "./choice.js" */

/** @typedef {Pick<MissionActions, "addTargets" | "addWhole" | "removeTargets" | "addTowersOf" | "addBridgesOf" | "addSupports" | "addStretch" | "stretchBetween">} Acts */
/** @typedef {ReturnType<typeof CreateChoice>} ChoiceBox */

/** @param {string} words */
const sentence = (words) => words[0].toUpperCase() + words.slice(1);

/** @param {MapThing} thing */
const assetOf = ({ id, kind, properties }) => ({ id, kind, properties });

/** @param {{ frame: HTMLElement, store: MissionStore, actions: MissionActions, opened: () => void }} options */
export function createMapPicking({ frame, store, actions, opened }) {
  const choice = createChoice(frame, opened);
  const pickStretch = stretchPicking(store, actions, choice);

  /**
   * A click with a tool that picks. place: of the click; point: where that is on the screen.
   *
   * @param {MapThing} thing
   * @param {Position} place
   * @param {ScreenPoint} point
   */
  function pick(thing, place, point) {
    const { tool } = store.state;
    if (thing.properties.flyable === false) {
      const words = { name: thing.properties.label };
      toast(t("{name} cannot be flown to: it is underground, out of use or a siding or busbar.", words));
      return;
    }
    const centre = thing.geometry.type === "Point" ? thing.geometry.coordinates : place;
    if (tool === "stretch") void pickStretch(thing, centre, point);
    else if (thing.kind === "tower" || thing.kind === "bridge")
      actions.addTargets([targetOf({ ...assetOf(thing), centre })]);
    else {
      const isLine = thing.geometry.type === "LineString" || thing.geometry.type === "MultiLineString";
      const onLine = (isLine && nearestOnLine(/** @type {Line} */ (thing.geometry), place)) || place;
      if (tool === "line" && thing.kind === "line")
        void actions.addWhole(targetOf({ ...assetOf(thing), centre: onLine }));
      else if (tool === "line" || thing.kind === "line") chooseOnLine(thing, onLine, point, actions, choice);
      else pickRailwayPoint(thing, onLine, actions);
    }
  }

  store.listen(["tool"], ({ tool, stretchFrom }) => {
    choice.close();
    if (tool !== "stretch" && stretchFrom) store.update({ stretchFrom: null });
  });

  return {
    pick,
    close: choice.close,
    isOpen: choice.isOpen,
    /** Which kinds count for the tool in hand; null: all. */
    kinds: () =>
      store.state.tool === "line" ? ["line", "railway"] : store.state.tool === "stretch" ? ["tower"] : null,
  };
}

/**
 * What to do with the tool in hand; undefined where that needs no words.
 *
 * @param {Pick<MissionPageState, "tool" | "stretchFrom">} state
 */
export function toolWords({ tool, stretchFrom }) {
  /** @type {Partial<Record<MissionPageState["tool"], string>>} */
  const words = {
    box: t("Drag a box round towers and bridges."),
    lasso: t("Draw a line round towers and bridges."),
    line: t("Click a line, or a section of a railway: it is flown end to end."),
    stretch: stretchFrom
      ? t("From {name}. Now click the last tower.", { name: stretchFrom.label })
      : t("Click the first tower."),
  };
  return words[tool];
}

/**
 * Ask on a click on a line: fly it end to end, inspect one place, or pick its towers.
 *
 * @param {MapThing} thing
 * @param {number[]} place
 * @param {ScreenPoint} point
 * @param {Acts} actions
 * @param {ChoiceBox} choice
 */
function chooseOnLine(thing, place, point, actions, choice) {
  const { kind, properties } = thing;
  const whole = {
    icon: kind,
    words: sentence(extentOf(kind, properties.length_m) ?? ""),
    act: () => actions.addWhole(targetOf({ ...assetOf(thing), centre: place })),
  };
  const here = {
    icon: "map-pin",
    words: t("This point"),
    act: () => actions.addTargets([targetOf({ ...assetOf(thing), position: place })]),
  };
  const others =
    kind === "line"
      ? [{ icon: "tower", words: t("Every tower of it"), act: () => actions.addTowersOf(thing.id) }]
      : [
          {
            icon: "bridge",
            words: t("Every bridge of this section"),
            act: () => actions.addBridgesOf(thing.id, { allSections: false }),
          },
          { icon: "bridge", words: t("Every bridge of the railway"), act: () => actions.addBridgesOf(thing.id) },
        ];
  choice.open(nameOf(properties), [whole, here, ...others], point);
}

/** @param {MapThing} thing @param {number[]} position @param {Acts} actions */
function pickRailwayPoint(thing, position, actions) {
  const target = targetOf({ ...assetOf(thing), position });
  const added = actions.addTargets([target]);
  if (!added) return;
  toast(t("One point of {name} is picked.", { name: thing.properties.label }), {
    label: t("Every bridge of it instead"),
    act: () => {
      actions.removeTargets([target.key]);
      void actions.addBridgesOf(thing.id);
    },
  });
}

/**
 * Pick a stretch: the first click sets its begin, the second its end.
 *
 * @param {MissionStore} store
 * @param {Acts} actions
 * @param {ChoiceBox} choice
 */
function stretchPicking(store, actions, choice) {
  /** @param {SupportsOutput} found @param {ScreenPoint} point */
  function offerStretch({ supports, parts, length_m }, point) {
    const lines = parts.length > 1 ? `, ${tn(parts.length, "{count} line", "{count} lines")}` : "";
    const title = `${supports[0].label} – ${supports[supports.length - 1].label}${lines}`;
    const towers = {
      icon: "tower",
      words: tn(supports.length, "{count} tower", "All {count} towers"),
      act: () => actions.addSupports(supports),
    };
    const flown = {
      icon: "line",
      words: t("Fly along, {length}", { length: lengthText(length_m) }),
      act: () => void actions.addStretch(parts),
    };
    choice.open(title, [towers, flown], point);
  }

  /** @param {MapThing} thing @param {number[]} centre @param {ScreenPoint} point */
  return async (thing, centre, point) => {
    const first = store.state.stretchFrom;
    if (!first || first.id === thing.id) {
      const next = first ? null : { id: thing.id, label: thing.properties.label, centre };
      store.update({ stretchFrom: next });
      announce(
        next ? t("From {name}. Now the last tower.", { name: next.label }) : t("Begin again with the first tower."),
      );
      return;
    }
    const found = await actions.stretchBetween(first.id, thing.id);
    if (store.state.stretchFrom !== first) return;
    store.update({ stretchFrom: null });
    if (found) offerStretch(found, point);
  };
}
