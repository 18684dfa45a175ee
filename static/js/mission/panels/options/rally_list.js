/** The rally points of a mission as a list: put on the map, typed, moved, removed. */

import { find, h, icon, keyedList } from "../../../dom.js";
import { rallyName } from "../../../domain/palette.js";
import { positionIn } from "../../../map/coordinates_read.js";
import { toast } from "../../../page/toast.js";
import { t } from "../../../text.js";
import * as link from "../../options/lost_link.js";
import { faultPlace, showFault } from "./field_fault.js";

/** @import { LostLink, MissionActions, MissionStore } from "../../types.d.ts" */

/** @typedef {(positions: number[][]) => void} ShowPlaces brings them into view */
/** @typedef {{ position: number[], index: number }} RallyPoint */

const WANTED = t("Latitude and longitude are wanted, such as 39.9612, −82.9988.");

/** @param {number[]} position longitude, latitude */
const typed = ([longitude, latitude]) => [latitude, longitude].map((degrees) => degrees.toFixed(6)).join(", ");

/** @param {Record<string, unknown>} properties */
const coordinatesInput = (properties) =>
  h("input", { class: "input", autocomplete: "off", spellcheck: "false", maxlength: 80, ...properties });

/** @param {MissionStore} store @param {MissionActions} actions @param {ShowPlaces} showPlaces */
export function createRallyList(store, actions, showPlaces) {
  const count = h("span", { class: "count" });
  const onMap = h("button", { type: "button", class: "text-button", "aria-pressed": "false" }, t("Add on the map"));
  onMap.addEventListener("click", () => store.update({ tool: store.state.tool === "rally" ? "point" : "rally" }));
  const none = h(
    "p",
    { class: "caption" },
    t("None yet: each UAV returns to its own start. A rally point nearer to the routes saves way and can avoid zones."),
  );
  const rows = createRows(store, actions, { showPlaces, focusElsewhere: () => onMap.focus() });
  const adding = createAdding(actions, showPlaces);
  const element = h(
    "div",
    { class: "rally", role: "group", "aria-labelledby": "rally-title" },
    h(
      "div",
      { class: "option-head" },
      h("h4", { id: "rally-title", class: "field-label" }, t("Rally points"), " ", count),
      onMap,
    ),
    none,
    rows.element,
    adding.element,
  );

  store.listen(["selection"], ({ selection }) => {
    const { rally_points } = link.wholeLostLink(selection.lost_link);
    element.hidden = !link.usesRallyPoints(selection.lost_link);
    none.hidden = rally_points.length > 0;
    count.textContent = rally_points.length ? `${rally_points.length}` : "";
    const isFull = rally_points.length >= link.MAX_RALLY_POINTS;
    onMap.disabled = isFull;
    adding.refresh(isFull);
    rows.draw(rally_points.map((position, index) => ({ position, index })));
  });
  store.listen(["tool", "selection"], ({ tool, selection }) => {
    onMap.setAttribute("aria-pressed", String(tool === "rally"));
    if (tool === "rally" && !link.usesRallyPoints(selection.lost_link)) store.update({ tool: "point" });
  });
  return element;
}

/** The field for one more. @param {MissionActions} actions @param {ShowPlaces} showPlaces */
function createAdding(actions, showPlaces) {
  const fault = faultPlace("rally-fault");
  const coordinates = coordinatesInput({
    id: "rally-coordinates",
    placeholder: t("Latitude, longitude"),
    "aria-describedby": fault.id,
  });
  const add = h("button", { type: "button", class: "button", onclick: addTyped }, icon("plus", "small"), t("Add"));
  coordinates.addEventListener("keydown", (event) => {
    if (event.key !== "Enter") return;
    event.preventDefault();
    addTyped();
  });

  function addTyped() {
    const found = positionIn(coordinates.value);
    showFault(coordinates, fault, found ? "" : WANTED);
    if (!found) {
      coordinates.focus();
      return;
    }
    actions.addRallyPoint(found.position);
    coordinates.value = "";
    showPlaces([found.position]);
  }

  return {
    element: h(
      "div",
      { class: "field" },
      h("label", { for: coordinates.id }, t("Add by coordinates")),
      h("div", { class: "rally-add" }, coordinates, add),
      fault,
    ),
    /** @param {boolean} isFull */
    refresh(isFull) {
      add.disabled = isFull;
      coordinates.disabled = isFull;
      if (isFull)
        showFault(coordinates, fault, t("A mission has at most {most} rally points.", { most: link.MAX_RALLY_POINTS }));
      else if (coordinates.value === "") showFault(coordinates, fault, "");
    },
  };
}

/**
 * @param {MissionStore} store
 * @param {MissionActions} actions
 * @param {{ showPlaces: ShowPlaces, focusElsewhere: () => void }} how
 */
function createRows(store, actions, { showPlaces, focusElsewhere }) {
  const list = h("ol", { class: "rally-list", "aria-label": t("Rally points") });
  const wish = () => store.state.selection.lost_link;
  /** @param {LostLink | null} lost_link */
  const set = (lost_link) => actions.setOption("lost_link", lost_link);
  /** @param {number} index */
  const positionAt = (index) => link.wholeLostLink(wish()).rally_points[index];

  /** @param {number} index */
  function remove(index) {
    set(link.withoutRallyPoint(wish(), index));
    const next = list.children[Math.min(index, list.children.length - 1)];
    const button = /** @type {HTMLElement | null | undefined} */ (next?.querySelector("button:last-of-type"));
    if (button)
      button.focus(); // no field: there, undo is of typing
    else focusElsewhere();
    toast(t("{name} is removed.", { name: rallyName(index) }), { label: t("Undo"), act: actions.undo });
  }

  /** @param {number} index */
  function field(index) {
    const name = rallyName(index);
    const fault = faultPlace(`rally-${index}-fault`);
    const input = coordinatesInput({
      "aria-label": t("Latitude and longitude of {name}", { name }),
      "aria-describedby": fault.id,
    });
    input.addEventListener("change", () => {
      const found = positionIn(input.value);
      showFault(input, fault, found ? "" : WANTED);
      if (found) set(link.withRallyPointAt(wish(), index, found.position));
    });
    input.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.stopPropagation();
      input.value = typed(positionAt(index));
      showFault(input, fault, "");
    });
    return { input, fault };
  }

  /** @param {RallyPoint} point */
  function make({ index }) {
    const name = rallyName(index);
    const { input, fault } = field(index);
    /** @param {string} image @param {string} label @param {string} title @param {() => unknown} act */
    const button = (image, label, title, act) =>
      h(
        "button",
        { type: "button", class: "icon-button tight", "aria-label": label, title, onclick: act },
        icon(image, "small"),
      );
    const showIt = () => showPlaces([positionAt(index)]);
    return h(
      "li",
      { class: "rally-row" },
      h("span", { class: "rally-mark", "aria-hidden": "true" }, name),
      input,
      button("locate-fixed", t("Show {name} on the map", { name }), t("Show on the map"), showIt),
      button("trash-2", t("Remove {name}", { name }), t("Remove"), () => remove(index)),
      fault,
    );
  }

  const draw = keyedList(
    list,
    /** @param {RallyPoint} point */ ({ index }) => `${index}`,
    make,
    (row, { position }) => {
      const input = find(row, "input", HTMLInputElement);
      if (input.dataset.at === typed(position)) return;
      input.dataset.at = typed(position);
      input.value = typed(position);
      showFault(input, find(row, ".field-error", HTMLElement), "");
    },
  );
  return { element: list, draw };
}
