/** Search for assets by what people call them, and for places; empty, it lists what is in view. The list does all that the map does. */

import { ApiError, get } from "../../api.js";
import { byId, h, icon } from "../../dom.js";
import { placesFound } from "../../map/places_found.js";
import { t, tn } from "../../text.js";
import { MOST_TARGETS } from "../picking.js";
import { detailOf } from "../selection.js";

const WAIT_MS = 180;
const MOST = 12;
const KINDS = [
  { kind: "tower", words: () => t("Towers") },
  { kind: "line", words: () => t("Lines") },
  { kind: "railway", words: () => t("Railways") },
  { kind: "bridge", words: () => t("Bridges") },
];

/** How many of all assets found can be targets; asked only where the answer does not show it. */
async function countFlyable(asked, found, signal) {
  if (found.total <= found.features.length)
    return found.features.filter(({ properties }) => properties.is_flyable).length;
  const { data } = await get(`/assets?${asked}&flyable=true&limit=1&total=true`, { signal });
  return data.total;
}

/** page: { box(), show(feature), add(feature), addAll(features), goTo(place), things(), canPlan } */
export function mountFinder({ box, show, add, addAll, goTo, things, canPlan }) {
  const input = byId("find");
  const list = byId("found");
  const panel = byId("found-panel");
  const head = byId("found-head");
  const foot = byId("found-foot");
  const frame = byId("finder");
  const filters = { inView: false, kinds: new Set() };
  let timer = 0;
  let asking = null;
  let results = []; // { words, detail, icon, end, act }
  let active = -1;
  let isBehind = false; // the list is not yet of what has been typed
  let takesFirst = false; // Enter came before the list

  const close = () => {
    asking?.abort();
    clearTimeout(timer);
    isBehind = takesFirst = false;
    panel.hidden = true;
    input.setAttribute("aria-expanded", "false");
    input.removeAttribute("aria-activedescendant");
    frame.classList.remove("open");
  };

  function option(result, index) {
    return h(
      "div",
      {
        role: "option",
        id: `found-${index}`,
        "aria-selected": String(index === active),
        onpointerdown: (event) => event.preventDefault(),
        onclick: () => take(index),
        onpointerenter: () => activate(index, false),
      },
      icon(result.icon),
      h("span", { class: "what" }, result.words, " ", h("span", {}, result.detail)),
      h("span", { class: "end" }, result.end),
    );
  }

  function draw(words, total) {
    head.textContent = words;
    head.hidden = !words;
    list.replaceChildren(...results.map(option));
    list.hidden = results.length === 0;
    panel.hidden = false;
    input.setAttribute("aria-expanded", "true");
    drawFoot(total);
  }

  function drawFoot(total) {
    foot.hidden = !canPlan || total < 2;
    if (foot.hidden) return;
    const isTooMany = total > MOST_TARGETS;
    const words = isTooMany
      ? t("{count} match; a mission takes {most}. Narrow the search to add all.", { count: total, most: MOST_TARGETS })
      : "";
    const button = h(
      "button",
      { type: "button", class: "button", onpointerdown: (event) => event.preventDefault(), onclick: takeAll },
      icon("list-plus", "small"),
      tn(total, "Add all {count}", "Add all {count}"),
    );
    foot.replaceChildren(isTooMany ? h("p", {}, words) : button);
  }

  function activate(index, scroll = true) {
    active = index;
    list
      .querySelectorAll("[role=option]")
      .forEach((element, place) => element.setAttribute("aria-selected", String(place === active)));
    const element = document.getElementById(`found-${active}`);
    if (element) input.setAttribute("aria-activedescendant", element.id);
    if (scroll) element?.scrollIntoView({ block: "nearest" });
  }

  function take(index) {
    const result = results[index];
    if (!result) return;
    result.act();
    input.value = "";
    close();
  }

  const assetResult = (feature) => {
    const { kind, label } = feature.properties;
    const act = () => {
      show(feature);
      if (canPlan) add(feature);
    };
    return {
      icon: kind,
      words: label,
      detail: detailOf(kind, feature.properties),
      end: canPlan ? t("Add") : t("Show"),
      act,
    };
  };
  const placeResult = (place) => ({
    icon: place.icon,
    words: place.label,
    detail: place.detail ?? "",
    end: t("Go there"),
    act: () => goTo(place),
  });

  /** What is asked of /assets: the text, and what is in view where that is meant. */
  function question() {
    const text = input.value.trim();
    const parts = new URLSearchParams();
    if (text) parts.set("text", text);
    if (filters.inView || !text)
      parts.set(
        "bbox",
        box()
          .map((degrees) => degrees.toFixed(6))
          .join(","),
      );
    if (filters.kinds.size) parts.set("kind", [...filters.kinds].join(","));
    return parts;
  }

  async function search() {
    const text = input.value.trim();
    asking?.abort();
    asking = new AbortController();
    const { signal } = asking;
    const asked = question();
    try {
      const [{ data }, places] = await Promise.all([
        get(`/assets?${asked}&limit=${MOST}&total=true`, { signal }),
        text && !filters.kinds.size ? placesFound(text, { signal, things: things() }) : [],
      ]);
      const flyable = canPlan ? await countFlyable(asked, data, signal) : 0;
      results = [...places.map(placeResult), ...data.features.map(assetResult)];
      active = -1;
      isBehind = false;
      draw(results.length ? headOf(asked, data.total) : emptyWords(text), flyable);
      if (results.length && text) activate(0);
      if (takesFirst) take(0);
      takesFirst = false;
    } catch (error) {
      if (error.name === "AbortError") return;
      isBehind = takesFirst = false;
      results = [];
      draw(error instanceof ApiError ? error.message : t("The search failed. Try again."), 0);
    }
  }

  function headOf(asked, total) {
    const count = tn(total, "{count} asset", "{count} assets");
    return asked.has("bbox") ? t("{count} in view", { count }) : total > MOST ? count : "";
  }

  function emptyWords(text) {
    const isFiltered = filters.kinds.size > 0 || filters.inView;
    if (text && isFiltered) return t("No asset matches “{text}” with these filters.", { text });
    if (text) return t("No asset matches “{text}”.", { text });
    return t("Nothing is in view. Type a reference, a name, an operator or a voltage.");
  }

  async function takeAll() {
    const asked = question();
    asked.set("flyable", "true");
    asked.set("limit", String(MOST_TARGETS));
    try {
      const { data } = await get(`/assets?${asked}`);
      addAll(data.features);
      input.value = "";
      close();
    } catch (error) {
      results = [];
      draw(error instanceof ApiError ? error.message : t("The search failed. Try again."), 0);
    }
  }

  function filter(words, change) {
    const button = h(
      "button",
      {
        type: "button",
        class: "filter-chip",
        "aria-pressed": "false",
        onpointerdown: (event) => event.preventDefault(),
      },
      words,
    );
    button.addEventListener("click", () => {
      button.setAttribute("aria-pressed", String(change()));
      search();
    });
    return button;
  }

  byId("found-filters").append(
    filter(t("In view"), () => (filters.inView = !filters.inView)),
    ...KINDS.map(({ kind, words }) =>
      filter(words(), () => !filters.kinds.delete(kind) && Boolean(filters.kinds.add(kind))),
    ),
  );
  input.addEventListener("input", () => {
    clearTimeout(timer);
    isBehind = true;
    takesFirst = false;
    timer = setTimeout(search, WAIT_MS);
  });
  input.addEventListener("focus", search);
  frame.addEventListener("focusout", (event) => {
    if (!frame.contains(event.relatedTarget)) close();
  });
  frame.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    event.preventDefault();
    input.value = "";
    close();
    document.activeElement?.blur();
  });
  input.addEventListener("keydown", (event) => {
    if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      event.preventDefault();
      const step = event.key === "ArrowDown" ? 1 : -1;
      if (results.length) activate((active + step + results.length) % results.length);
    } else if (event.key === "Enter") {
      event.preventDefault();
      if (isBehind) takesFirst = true;
      else take(Math.max(active, 0));
    }
  });
  const focus = () => {
    frame.classList.add("open");
    input.focus();
  };
  byId("open-finder").addEventListener("click", focus);
  return { focus };
}
