/** Search for assets by their names, and for places; empty, it lists the assets in view. The list offers all acts of the map. */

import { ApiError, get } from "../../api.js";
import { byId, h, icon } from "../../dom.js";
import { placesFound, toldApart } from "../../map/places_found.js";
import { t, tn } from "../../text.js";
import { detailOf, MAX_TARGETS } from "../selection.js";

/** @import { Answer } from "../../api.js" */
/** @import { AssetCollection, AssetFeature } from "../../api_types.d.ts" */
/** @import { Box, FoundPlace } from "../../map/types.d.ts" */

/**
 * Functions that the page offers to the search.
 *
 * @typedef {object} FinderHow
 * @property {boolean} canPlan
 * @property {() => Box} box box of the view
 * @property {(feature: AssetFeature) => void} show
 * @property {(feature: AssetFeature) => void} add
 * @property {(features: AssetFeature[]) => void} addAll
 * @property {(place: FoundPlace) => void} goTo
 * @property {() => NonNullable<NonNullable<Parameters<typeof placesFound>[1]>["things"]>} things
 */
/** @typedef {{ words: string, detail: string, icon: string, end: string, centre?: number[], act: () => void }} Result */

const WAIT_MS = 180;
const MAX_RESULTS = 12;
const KINDS = [
  { kind: "tower", words: () => t("Towers") },
  { kind: "line", words: () => t("Lines") },
  { kind: "railway", words: () => t("Railways") },
  { kind: "bridge", words: () => t("Bridges") },
];

/** @param {unknown} error */
const failureWords = (error) => (error instanceof ApiError ? error.message : t("The search failed. Try again."));

/** Pressing a button beside the field leaves the focus in it. @param {PointerEvent} event */
const keepFocus = (event) => event.preventDefault();

/**
 * How many of all assets found can be targets; requested only where the answer does not show it.
 *
 * @param {URLSearchParams} asked
 * @param {AssetCollection} found
 * @param {AbortSignal} signal
 */
async function countFlyable(asked, found, signal) {
  const { total = 0, features } = found;
  if (total <= features.length) return features.filter(({ properties }) => properties.is_flyable).length;
  const address = `/assets?${asked}&flyable=true&limit=1&total=true`;
  const { data } = /** @type {Answer<AssetCollection>} */ (await get(address, { signal }));
  return data.total ?? 0;
}

/** The list of results, one of them active. @param {HTMLInputElement} input */
function createFoundList(input) {
  const list = byId("found");
  const head = byId("found-head");
  /** @type {Result[]} */
  let results = [];
  let active = -1;

  /** @param {number} index @param {boolean} [scroll] */
  function activate(index, scroll = true) {
    active = index;
    [...list.querySelectorAll("[role=option]")].forEach((element, place) => {
      element.setAttribute("aria-selected", String(place === active));
    });
    const element = document.getElementById(`found-${active}`);
    if (element) input.setAttribute("aria-activedescendant", element.id);
    if (scroll) element?.scrollIntoView({ block: "nearest" });
  }

  /** @param {Result} result @param {number} index @param {(index: number) => void} take */
  const option = (result, index, take) =>
    h(
      "div",
      {
        role: "option",
        id: `found-${index}`,
        "aria-selected": "false",
        onpointerdown: keepFocus,
        onclick: () => take(index),
        onpointerenter: () => activate(index, false),
      },
      icon(result.icon),
      h("span", { class: "what" }, result.words, " ", h("span", {}, result.detail)),
      h("span", { class: "end" }, result.end),
    );

  return {
    activate,
    resultAt: (/** @type {number} */ index) => results.at(index) ?? null,
    active: () => active,
    /** @param {1 | -1} by */
    step(by) {
      if (results.length) activate((active + by + results.length) % results.length);
    },
    /** @param {Result[]} found @param {string} words @param {(index: number) => void} take */
    draw(found, words, take) {
      results = found;
      active = -1;
      head.textContent = words;
      head.hidden = !words;
      list.replaceChildren(...results.map((result, index) => option(result, index, take)));
      list.hidden = results.length === 0;
    },
  };
}

/** Mount the filters of the search: the view, kinds of assets. @param {() => void} onChange */
function mountFilters(onChange) {
  let inView = false;
  /** @type {Set<string>} */
  const kinds = new Set();

  /** @param {string} words @param {() => boolean} change */
  function filter(words, change) {
    const button = h(
      "button",
      { type: "button", class: "filter-chip", "aria-pressed": "false", onpointerdown: keepFocus },
      words,
    );
    button.addEventListener("click", () => {
      button.setAttribute("aria-pressed", String(change()));
      onChange();
    });
    return button;
  }

  byId("found-filters").append(
    filter(t("In view"), () => {
      inView = !inView;
      return inView;
    }),
    ...KINDS.map(({ kind, words }) => filter(words(), () => !kinds.delete(kind) && Boolean(kinds.add(kind)))),
  );
  return { isInView: () => inView, kinds };
}

class Finder {
  #how;
  #input = byId("find", HTMLInputElement);
  #panel = byId("found-panel");
  #frame = byId("finder");
  #list = createFoundList(this.#input);
  #filters = mountFilters(() => void this.search());
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;
  /** @type {AbortController | null} */
  #asking = null;
  #isBehind = false; // the list does not yet match the typed text
  #takesFirst = false; // Enter was pressed before the list arrived

  /** @param {FinderHow} how */
  constructor(how) {
    this.#how = how;
  }

  close() {
    this.#asking?.abort();
    clearTimeout(this.#timer);
    this.#isBehind = false;
    this.#takesFirst = false;
    this.#panel.hidden = true;
    this.#input.setAttribute("aria-expanded", "false");
    this.#input.removeAttribute("aria-activedescendant");
    this.#frame.classList.remove("open");
  }

  clear() {
    this.#input.value = "";
    this.close();
  }

  /** Search after a change of the text. */
  searchSoon() {
    clearTimeout(this.#timer);
    this.#isBehind = true;
    this.#takesFirst = false;
    this.#timer = setTimeout(() => void this.search(), WAIT_MS);
  }

  async search() {
    const { canPlan, things } = this.#how;
    const text = this.#input.value.trim();
    this.#asking?.abort();
    this.#asking = new AbortController();
    const { signal } = this.#asking;
    const asked = this.#question();
    try {
      const [answer, places] = await Promise.all([
        get(`/assets?${asked}&limit=${MAX_RESULTS}&total=true`, { signal }),
        text && !this.#filters.kinds.size ? placesFound(text, { signal, things: things() }) : [],
      ]);
      const { data } = /** @type {Answer<AssetCollection>} */ (answer);
      const flyable = canPlan ? await countFlyable(asked, data, signal) : 0;
      const results = [
        ...places.filter(({ isTown }) => !isTown).map((place) => this.#placeResult(place)),
        ...toldApart(data.features.map((feature) => this.#assetResult(feature))),
        ...places.filter(({ isTown }) => isTown).map((place) => this.#placeResult(place)),
      ];
      this.#isBehind = false;
      this.#draw(results, results.length ? headOf(asked, data.total ?? 0) : this.#emptyWords(text), flyable);
      if (results.length && text) this.#list.activate(0);
      if (this.#takesFirst) this.#take(0);
      this.#takesFirst = false;
    } catch (error) {
      if (error instanceof DOMException && error.name === "AbortError") return;
      this.#isBehind = false;
      this.#takesFirst = false;
      this.#draw([], failureWords(error), 0);
    }
  }

  /** What a key does in the field. @param {KeyboardEvent} event */
  press(event) {
    if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      event.preventDefault();
      this.#list.step(event.key === "ArrowDown" ? 1 : -1);
    } else if (event.key === "Enter") {
      event.preventDefault();
      if (this.#isBehind) this.#takesFirst = true;
      else this.#take(Math.max(this.#list.active(), 0));
    }
  }

  /** @param {Result[]} results @param {string} words @param {number} flyable how many can be added at once */
  #draw(results, words, flyable) {
    this.#list.draw(results, words, (index) => this.#take(index));
    this.#panel.hidden = false;
    this.#input.setAttribute("aria-expanded", "true");
    this.#drawFoot(flyable);
  }

  /** @param {number} total */
  #drawFoot(total) {
    const foot = byId("found-foot");
    foot.hidden = !this.#how.canPlan || total < 2;
    if (foot.hidden) return;
    if (total > MAX_TARGETS) {
      const values = { count: total, most: MAX_TARGETS };
      foot.replaceChildren(
        h("p", {}, t("{count} match; a mission takes {most}. Narrow the search to add all.", values)),
      );
    } else
      foot.replaceChildren(
        h(
          "button",
          { type: "button", class: "button", onpointerdown: keepFocus, onclick: () => this.#takeAll() },
          icon("list-plus", "small"),
          tn(total, "Add all {count}", "Add all {count}"),
        ),
      );
  }

  /** @param {number} index */
  #take(index) {
    const result = this.#list.resultAt(index);
    if (!result) return;
    result.act();
    this.clear();
  }

  async #takeAll() {
    const asked = this.#question();
    asked.set("flyable", "true");
    asked.set("limit", String(MAX_TARGETS));
    try {
      const { data } = /** @type {Answer<AssetCollection>} */ (await get(`/assets?${asked}`));
      this.#how.addAll(data.features);
      this.clear();
    } catch (error) {
      this.#draw([], failureWords(error), 0);
    }
  }

  /** @param {AssetFeature} feature @returns {Result} */
  #assetResult(feature) {
    const { canPlan, show, add } = this.#how;
    const { kind, label } = feature.properties;
    return {
      icon: kind,
      words: label,
      detail: detailOf(kind, feature.properties),
      centre: feature.properties.centre,
      end: canPlan ? t("Add") : t("Show"),
      act() {
        show(feature);
        if (canPlan) add(feature);
      },
    };
  }

  /** @param {FoundPlace} place @returns {Result} */
  #placeResult(place) {
    const { icon: image, label: words, detail = "" } = place;
    return { icon: image, words, detail, end: t("Go there"), act: () => this.#how.goTo(place) };
  }

  /** The query of /assets: the text, and the view where it applies. */
  #question() {
    const { kinds, isInView } = this.#filters;
    const text = this.#input.value.trim();
    const parts = new URLSearchParams();
    if (text) parts.set("text", text);
    if (isInView() || !text) {
      const box = this.#how.box().map((degrees) => degrees.toFixed(6));
      parts.set("bbox", box.join(","));
    }
    if (kinds.size) parts.set("kind", [...kinds].join(","));
    return parts;
  }

  /** @param {string} text */
  #emptyWords(text) {
    const isFiltered = this.#filters.kinds.size > 0 || this.#filters.isInView();
    if (text && isFiltered) return t("No asset matches “{text}” with these filters.", { text });
    if (text) return t("No asset matches “{text}”.", { text });
    return t("Nothing is in view. Type a reference, a name, an operator or a voltage.");
  }
}

/** @param {URLSearchParams} asked @param {number} total */
function headOf(asked, total) {
  const count = tn(total, "{count} asset", "{count} assets");
  return asked.has("bbox") ? t("{count} in view", { count }) : total > MAX_RESULTS ? count : "";
}

/** @param {FinderHow} how */
export function mountFinder(how) {
  const finder = new Finder(how);
  const input = byId("find", HTMLInputElement);
  const frame = byId("finder");
  input.addEventListener("input", () => finder.searchSoon());
  input.addEventListener("focus", () => void finder.search());
  input.addEventListener("keydown", (event) => finder.press(event));
  frame.addEventListener("focusout", (event) => {
    if (!frame.contains(/** @type {Node | null} */ (event.relatedTarget))) finder.close();
  });
  frame.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    event.preventDefault();
    finder.clear();
    /** @type {HTMLElement | null} */ (document.activeElement)?.blur();
  });
  const focus = () => {
    frame.classList.add("open");
    input.focus();
  };
  byId("open-finder").addEventListener("click", focus);
  return { focus };
}
