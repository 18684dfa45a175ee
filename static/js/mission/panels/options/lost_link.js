/** What UAVs do when their link is lost, the rally points where they may land then, and the check of both in words. */

import { byId, h, icon, keyedList } from "../../../dom.js";
import { routeNumber } from "../../../domain/palette.js";
import { positionIn } from "../../../map/coordinates_read.js";
import { toast } from "../../../page/toast.js";
import { t, tn } from "../../../text.js";
import * as link from "../../lost_link.js";
import { isPlanCurrent } from "../../plan_view.js";

const SHOWN_FIRST = 6; // groups of waypoints that fail
const ICONS = { home: "circle-check", lost: "triangle-alert" };

const typed = (position) =>
  position
    .slice(0, 2)
    .toReversed()
    .map((degrees) => degrees.toFixed(6))
    .join(", ");

/** showPlaces(positions): brings them into view. */
export function mountLostLink(store, actions, { canPlan, showPlaces }) {
  const place = byId("lost-link");
  const wish = () => store.state.selection.lost_link;
  const set = (lost_link) => actions.setOption("lost_link", lost_link);
  const check = checkOf(store, { showPlaces });
  if (!canPlan) {
    place.append(check);
    return;
  }

  const radios = link.BEHAVIOURS.map(({ value, words, meaning }) => {
    const radio = h("input", {
      type: "radio",
      name: "lost-link",
      value,
      onchange: () => set(link.withBehaviour(wish(), value)),
    });
    return {
      value,
      radio,
      meaning,
      label: h("label", { title: meaning }, radio, h("span", { class: "segment" }, words)),
    };
  });
  const meaning = h("p", { class: "caption" });
  const hold = h("input", {
    class: "input",
    type: "number",
    id: "lost-link-hold",
    min: 0,
    max: link.LONGEST_HOLD_S,
    step: 1,
    required: true,
    "aria-describedby": "lost-link-hold-fault",
    onchange: holds,
  });
  const holdFault = fault("lost-link-hold-fault");
  const holdField = h(
    "div",
    { class: "field lost-link-hold" },
    h("label", { for: hold.id }, t("Holds for")),
    h("div", { class: "with-unit" }, hold, h("span", { class: "unit" }, "s")),
    holdFault,
  );

  function holds() {
    const isRight = hold.validity.valid && hold.value !== "";
    tell(hold, holdFault, isRight ? "" : t("From 0 to {most} s.", { most: link.LONGEST_HOLD_S }));
    if (isRight) set(link.withHold(wish(), hold.valueAsNumber));
  }

  // rally points

  const count = h("span", { class: "count" });
  const onMap = h(
    "button",
    {
      type: "button",
      class: "text-button",
      "aria-pressed": "false",
      onclick: () => store.update({ tool: store.state.tool === "rally" ? "point" : "rally" }),
    },
    t("Add on the map"),
  );
  const none = h(
    "p",
    { class: "caption" },
    t("None yet: each UAV returns to its own start. A rally point nearer to the routes saves way and can avoid zones."),
  );
  const list = h("ol", { class: "rally-list", "aria-label": t("Rally points") });
  const coordinates = h("input", {
    class: "input",
    id: "rally-coordinates",
    autocomplete: "off",
    spellcheck: "false",
    maxlength: 80,
    placeholder: t("Latitude, longitude"),
    "aria-describedby": "rally-fault",
    onkeydown: (event) => event.key === "Enter" && (event.preventDefault(), addTyped()),
  });
  const coordinatesFault = fault("rally-fault");
  const add = h("button", { type: "button", class: "button", onclick: addTyped }, icon("plus", "small"), t("Add"));
  const adding = h(
    "div",
    { class: "field" },
    h("label", { for: coordinates.id }, t("Add by coordinates")),
    h("div", { class: "rally-add" }, coordinates, add),
    coordinatesFault,
  );
  const rally = h(
    "div",
    { class: "rally", role: "group", "aria-labelledby": "rally-title" },
    h(
      "div",
      { class: "option-head" },
      h("h4", { id: "rally-title", class: "field-label" }, t("Rally points"), " ", count),
      onMap,
    ),
    none,
    list,
    adding,
  );

  function addTyped() {
    const found = positionIn(coordinates.value);
    tell(
      coordinates,
      coordinatesFault,
      found ? "" : t("Latitude and longitude are wanted, such as 39.9612, −82.9988."),
    );
    if (!found) return coordinates.focus();
    actions.addRallyPoint(found.position);
    coordinates.value = "";
    showPlaces([found.position]);
    return undefined;
  }

  const draw = keyedList(
    list,
    ({ index }) => `${index}`,
    ({ index }) => {
      const name = link.rallyName(index);
      const said = fault(`rally-${index}-fault`);
      const input = h("input", {
        class: "input",
        autocomplete: "off",
        spellcheck: "false",
        maxlength: 80,
        "aria-label": t("Latitude and longitude of {name}", { name }),
        "aria-describedby": said.id,
        onchange: () => moves(index, input, said),
        onkeydown: (event) =>
          event.key === "Escape" &&
          (event.stopPropagation(), (input.value = typed(pointsNow()[index])), tell(input, said, "")),
      });
      return h(
        "li",
        { class: "rally-row" },
        h("span", { class: "rally-mark", "aria-hidden": "true" }, name),
        input,
        h(
          "button",
          {
            type: "button",
            class: "icon-button tight",
            "aria-label": t("Show {name} on the map", { name }),
            title: t("Show on the map"),
            onclick: () => showPlaces([pointsNow()[index]]),
          },
          icon("locate-fixed", "small"),
        ),
        h(
          "button",
          {
            type: "button",
            class: "icon-button tight",
            "aria-label": t("Remove {name}", { name }),
            title: t("Remove"),
            onclick: () => removes(index),
          },
          icon("trash-2", "small"),
        ),
        said,
      );
    },
    (row, { position }) => {
      const input = row.querySelector("input");
      if (input.dataset.at === typed(position)) return;
      input.dataset.at = input.value = typed(position);
      tell(input, row.querySelector(".field-error"), "");
    },
  );

  const pointsNow = () => link.wholeLostLink(wish()).rally_points;

  function moves(index, input, said) {
    const found = positionIn(input.value);
    tell(input, said, found ? "" : t("Latitude and longitude are wanted, such as 39.9612, −82.9988."));
    if (found) set(link.withRallyPointAt(wish(), index, found.position));
  }

  function removes(index) {
    set(link.withoutRallyPoint(wish(), index));
    (list.children[Math.min(index, list.children.length - 1)]?.querySelector("button:last-of-type") ?? onMap).focus(); // no field: there, undo is of typing
    toast(t("{name} is removed.", { name: link.rallyName(index) }), { label: t("Undo"), act: actions.undo });
  }

  place.append(
    h("h3", { class: "field-label", id: "lost-link-title" }, t("If the link is lost")),
    h(
      "fieldset",
      { class: "segments", "aria-labelledby": "lost-link-title" },
      radios.map(({ label }) => label),
    ),
    meaning,
    holdField,
    rally,
    check,
  );

  store.listen(["selection"], ({ selection }) => {
    const { behaviour, rally_points, hold_s } = link.wholeLostLink(selection.lost_link);
    for (const { value, radio } of radios) radio.checked = value === behaviour;
    const isUsed = link.usesRallyPoints(selection.lost_link);
    const kept =
      !isUsed &&
      rally_points.length > 0 &&
      tn(
        rally_points.length,
        "Its rally point is kept, and not used.",
        "Its {count} rally points are kept, and not used.",
      );
    meaning.textContent = [radios.find(({ value }) => value === behaviour).meaning, kept].filter(Boolean).join(" ");
    holdField.hidden = behaviour !== "hold";
    if (behaviour === "hold" && hold.valueAsNumber !== hold_s) {
      hold.value = hold_s;
      tell(hold, holdFault, "");
    }
    rally.hidden = !isUsed;
    none.hidden = rally_points.length > 0;
    count.textContent = rally_points.length ? `${rally_points.length}` : "";
    const isFull = rally_points.length >= link.MOST_RALLY_POINTS;
    for (const way of [onMap, add, coordinates]) way.disabled = isFull;
    if (isFull)
      tell(
        coordinates,
        coordinatesFault,
        t("A mission has at most {most} rally points.", { most: link.MOST_RALLY_POINTS }),
      );
    else if (coordinates.value === "") tell(coordinates, coordinatesFault, "");
    draw(rally_points.map((position, index) => ({ position, index })));
  });
  store.listen(["tool", "selection"], ({ tool, selection }) => {
    onMap.setAttribute("aria-pressed", String(tool === "rally"));
    if (tool === "rally" && !link.usesRallyPoints(selection.lost_link)) store.update({ tool: "point" });
  });
}

/** A place for what is wrong with a field. */
const fault = (id) => h("p", { class: "field-error", id, hidden: true });

function tell(input, element, words) {
  element.hidden = !words;
  element.replaceChildren(...(words ? [icon("circle-alert", "small"), words] : []));
  if (words) input.setAttribute("aria-invalid", "true");
  else input.removeAttribute("aria-invalid");
}

/** The check in words; each group of waypoints that fails is a row that shows itself on the map. It follows the store. */
function checkOf(store, { showPlaces }) {
  const said = h("p", { class: "link-said", role: "status" });
  const heights = h("p", { class: "caption" });
  const uncounted = h("p", { class: "caption" });
  const rows = h("ul", { class: "link-failures", "aria-label": t("From where a UAV would not get home") });
  const more = h("button", {
    type: "button",
    class: "text-button",
    onclick: () => ((showsAll = true), draw(store.state)),
  });
  const barred = h("p", { class: "field-error", role: "alert" });
  const element = h("div", { class: "link-check" }, said, barred, rows, more, heights, uncounted);
  let showsAll = false;
  let held = null; // the group that was clicked stays lit while its row has focus

  const light = (group) =>
    store.update({ litReturn: group?.key ?? null, litZones: group?.zone_id ? [group.zone_id] : [] });

  function row(plan, group) {
    const { where, why } = link.failureText(group);
    const places = plan.result.routes[group.sequence].waypoints;
    const look = () => {
      light((held = group));
      showPlaces(
        link
          .returnLinesOf(plan)
          .filter(({ key }) => key === group.key)
          .flatMap(({ from, to }) => [from, to])
          .concat(group.waypoints.slice(0, 1).map((index) => places[index].position)),
      );
    };
    return h(
      "li",
      {},
      h(
        "button",
        {
          type: "button",
          title: t("Show on the map"),
          onclick: look,
          onpointerenter: () => light(group),
          onpointerleave: () => light(held),
          onfocus: () => light(group),
          onblur: () => light((held = null)),
        },
        h("span", { class: `letter route-${routeNumber(group.sequence)}` }, group.letter),
        h("span", {}, h("strong", {}, `${group.name}: ${where}`), h("small", {}, why)),
      ),
    );
  }

  function draw(state) {
    const { plan, selection } = state;
    const now = link.checkStateOf(selection.lost_link, plan, isPlanCurrent(state));
    const isChecked = now === "home" || now === "lost";
    const words = link.checkText(now, plan);
    element.hidden = now === "go-on";
    const inZones = isChecked ? link.inZonesText(plan) : "";
    const seen = inZones ? "lost" : now; // no tick over a place where nothing may land
    element.dataset.state = seen;
    said.replaceChildren(...(ICONS[seen] ? [icon(ICONS[seen], "small")] : []), h("span", {}, words));
    barred.hidden = !inZones;
    barred.replaceChildren(icon("circle-alert", "small"), inZones);
    const groups = now === "lost" ? link.failuresOf(plan) : [];
    const shown = showsAll ? groups : groups.slice(0, SHOWN_FIRST);
    rows.hidden = !groups.length;
    rows.replaceChildren(...shown.map((group) => row(plan, group)));
    more.hidden = shown.length === groups.length;
    more.textContent = tn(groups.length - shown.length, "Show {count} more", "Show {count} more");
    heights.textContent = isChecked ? link.heightsText(plan) : "";
    heights.hidden = !heights.textContent;
    uncounted.textContent = isChecked ? link.uncountedText(plan) : "";
    uncounted.hidden = !uncounted.textContent;
  }

  store.listen(["plan", "selection"], draw);
  return element;
}
