/** Search for assets by what people call them; empty, it lists what is in view. The list does all that the map does. */

import { ApiError, get } from "../../api.js";
import { byId, h, icon } from "../../dom.js";
import { detailOf } from "../selection.js";

const WAIT_MS = 180;
const MOST = 12;

export function mountFinder({ box, show, add, canPlan }) {
  const input = byId("find");
  const list = byId("found");
  const frame = byId("finder");
  let timer = 0;
  let asking = null;
  let features = [];
  let active = -1;

  const close = () => {
    asking?.abort();
    clearTimeout(timer);
    list.hidden = true;
    input.setAttribute("aria-expanded", "false");
    input.removeAttribute("aria-activedescendant");
    frame.classList.remove("open");
  };

  function draw(head, lines) {
    list.replaceChildren(...(head ? [h("p", { class: "found-head" }, head)] : []), ...lines);
    list.hidden = false;
    input.setAttribute("aria-expanded", "true");
  }

  function option(feature, index) {
    const { kind, label } = feature.properties;
    return h(
      "div",
      { role: "option", id: `found-${index}`, "aria-selected": String(index === active), onpointerdown: (event) => event.preventDefault(), onclick: () => take(index), onpointerenter: () => activate(index, false) },
      icon(kind),
      h("span", { class: "what" }, label, " ", h("span", {}, detailOf(kind, feature.properties))),
      h("span", { class: "end" }, canPlan ? "Add" : "Show"),
    );
  }

  function activate(index, scroll = true) {
    active = index;
    list.querySelectorAll("[role=option]").forEach((element, place) => element.setAttribute("aria-selected", String(place === active)));
    const element = document.getElementById(`found-${active}`);
    if (element) input.setAttribute("aria-activedescendant", element.id);
    if (scroll) element?.scrollIntoView({ block: "nearest" });
  }

  function take(index) {
    const feature = features[index];
    if (!feature) return;
    show(feature);
    if (canPlan) add(feature);
    input.value = "";
    close();
  }

  async function search() {
    const text = input.value.trim();
    asking?.abort();
    asking = new AbortController();
    const { signal } = asking;
    const query = text ? `text=${encodeURIComponent(text)}` : `bbox=${box().map((degrees) => degrees.toFixed(6)).join(",")}`;
    try {
      const { data } = await get(`/assets?${query}&limit=${MOST}`, { signal });
      features = data.features;
      active = -1;
      const head = text ? "" : features.length ? "In view" : "";
      const none = text ? `No asset matches “${text}”.` : "Nothing is in view. Type a reference, a name, an operator or a voltage.";
      draw(head, features.length ? features.map(option) : [h("p", {}, none)]);
      if (features.length && text) activate(0);
    } catch (error) {
      if (error.name === "AbortError") return;
      features = [];
      draw("", [h("p", {}, error instanceof ApiError ? error.message : "The search failed.")]);
    }
  }

  input.addEventListener("input", () => {
    clearTimeout(timer);
    timer = setTimeout(search, WAIT_MS);
  });
  input.addEventListener("focus", search);
  input.addEventListener("blur", close);
  input.addEventListener("keydown", (event) => {
    if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      event.preventDefault();
      const step = event.key === "ArrowDown" ? 1 : -1;
      if (features.length) activate((active + step + features.length) % features.length);
    } else if (event.key === "Enter") {
      event.preventDefault();
      take(Math.max(active, 0));
    } else if (event.key === "Escape") {
      event.preventDefault();
      input.value = "";
      input.blur();
    }
  });
  const focus = () => {
    frame.classList.add("open");
    input.focus();
  };
  byId("open-finder").addEventListener("click", focus);
  return { focus };
}
