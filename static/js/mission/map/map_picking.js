/** What a click on an asset picks, by the tool in hand; where it may mean several things, a small choice beside it. */

import { h, icon } from "../../dom.js";
import { nearestOnLine } from "../../domain/geodesy.js";
import { say, toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import { lengthText } from "../../units.js";
import { extentOf, nameOf, targetOf } from "../selection.js";

const sentence = (words) => words[0].toUpperCase() + words.slice(1);

/** A choice of a few acts at a place of the map; opened() is told when one opens. */
function createChoice(frame, opened) {
  let box = null;
  let opener = null;
  const close = () => {
    const was = box;
    box = null;
    if (was?.contains(document.activeElement)) {
      const map = opener?.closest("#map");
      if (map) map.dataset.pointed = "true"; // it came by a click: no focus ring round the map
      opener?.focus();
    }
    was?.remove();
    return was !== null;
  };
  return {
    close,
    isOpen: () => box !== null,
    /** items: [{ icon, words, act }] */
    open(title, items, point) {
      close();
      opened();
      opener = document.activeElement instanceof HTMLElement ? document.activeElement : null;
      box = h(
        "div",
        { class: "map-choice float", role: "group", "aria-label": title },
        h("p", { class: "caption" }, title),
        items.map((item) =>
          h("button", { type: "button", onclick: () => (close(), item.act()) }, icon(item.icon), item.words),
        ),
      );
      frame.append(box);
      box.style.left = `${Math.min(Math.max(8, point.x - 60), frame.clientWidth - box.offsetWidth - 8)}px`;
      box.style.top = `${Math.max(8, Math.min(point.y + 12, frame.clientHeight - box.offsetHeight - 8))}px`;
      box.querySelector("button").focus();
    },
  };
}

export function createMapPicking({ frame, store, actions, opened }) {
  const choice = createChoice(frame, opened);

  /** A line can be flown end to end, looked at in one place, or be left to its towers: the operator says which. */
  function chooseOnLine(thing, place, point) {
    const { kind, properties } = thing;
    const whole = {
      icon: kind,
      words: sentence(extentOf(kind, properties.length_m)),
      act: () => actions.addTargets([targetOf({ ...thing, centre: place })]),
    };
    const here = {
      icon: "map-pin",
      words: t("This point"),
      act: () => actions.addTargets([targetOf({ ...thing, position: place })]),
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

  async function pickStretch(thing, centre, point) {
    const first = store.state.stretchFrom;
    if (!first || first.id === thing.id) {
      const next = first ? null : { id: thing.id, label: thing.properties.label, centre };
      store.update({ stretchFrom: next });
      say(next ? t("From {name}. Now the last tower.", { name: next.label }) : t("Begin again with the first tower."));
      return;
    }
    const found = await actions.stretchBetween(first.id, thing.id);
    if (store.state.stretchFrom !== first) return;
    store.update({ stretchFrom: null });
    if (found) offerStretch(found, point);
  }

  function offerStretch({ supports, parts, length_m }, point) {
    const lines = parts.length > 1 ? `, ${tn(parts.length, "{count} line", "{count} lines")}` : "";
    const title = `${supports[0].label} – ${supports.at(-1).label}${lines}`;
    const towers = {
      icon: "tower",
      words: tn(supports.length, "{count} tower", "All {count} towers"),
      act: () => actions.addSupports(supports),
    };
    const flown = {
      icon: "line",
      words: t("Fly along, {length}", { length: lengthText(length_m) }),
      act: () => actions.addStretch(parts),
    };
    choice.open(title, [towers, flown], point);
  }

  /** A click with a tool that picks. place: lon lat of the click; point: where that is on the screen. */
  function pick(thing, place, point) {
    const { tool } = store.state;
    if (thing.properties.flyable === false) {
      toast(
        t("{name} cannot be flown to: it is underground, out of use or a siding or busbar.", {
          name: thing.properties.label,
        }),
      );
      return;
    }
    const centre = thing.geometry.type === "Point" ? thing.geometry.coordinates : place;
    if (tool === "stretch") pickStretch(thing, centre, point);
    else if (thing.kind === "tower" || thing.kind === "bridge") actions.addTargets([targetOf({ ...thing, centre })]);
    else {
      const onLine = nearestOnLine(thing.geometry, place) ?? place;
      if (tool === "line" && thing.kind === "line") actions.addTargets([targetOf({ ...thing, centre: onLine })]);
      else if (tool === "line" || thing.kind === "line") chooseOnLine(thing, onLine, point);
      else pickRailwayPoint(thing, onLine);
    }
  }

  function pickRailwayPoint(thing, position) {
    const target = targetOf({ ...thing, position });
    const added = actions.addTargets([target]);
    if (!added) return;
    toast(t("One point of {name} is picked.", { name: thing.properties.label }), {
      label: t("Every bridge of it instead"),
      act: () => {
        actions.removeTargets([target.key]);
        actions.addBridgesOf(thing.id);
      },
    });
  }

  store.listen(["tool"], ({ tool, stretchFrom }) => {
    choice.close();
    if (tool !== "stretch" && stretchFrom) store.update({ stretchFrom: null });
  });

  return {
    pick,
    close: choice.close,
    isOpen: choice.isOpen,
    offerStretch,
    /** Which kinds count for the tool in hand; null: all. */
    kinds: () => ({ line: ["line", "railway"], stretch: ["tower"] })[store.state.tool] ?? null,
    /** What to do with the tool in hand; nothing where that needs no words. */
    words: ({ tool, stretchFrom }) =>
      ({
        box: t("Drag a box round towers and bridges."),
        lasso: t("Draw a line round towers and bridges."),
        line: t("Click a line, or a section of a railway: it is flown end to end."),
        stretch: stretchFrom
          ? t("From {name}. Now click the last tower.", { name: stretchFrom.label })
          : t("Click the first tower of the stretch."),
      })[tool],
  };
}
