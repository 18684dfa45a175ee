/** Elements made from data. Text is always set as text. */

import { staticAddress } from "./static_address.js";

const SPRITE = staticAddress("lib/icons.svg");
const SVG = "http://www.w3.org/2000/svg";

/** h("button", { class: "button", onclick: save, disabled: true }, icon("x"), "Save") */
export function h(tag, properties = {}, ...children) {
  return fill(document.createElement(tag), properties, children);
}

export function svg(tag, attributes = {}, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

function fill(element, properties, children) {
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name === "dataset") Object.assign(element.dataset, value);
    else if (name === "value" || name === "checked") element[name] = value;
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(
    ...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false),
  );
  return element;
}

export function icon(name, size = "") {
  return svg("svg", { class: `icon ${size}`.trim(), "aria-hidden": "true" }, svg("use", { href: `${SPRITE}#${name}` }));
}

/** Puts children into an element only where they would be others than before: the pointer and the focus stay with the same ones. */
export function refill(element, key, make) {
  if (element.dataset.filled === key) return;
  element.dataset.filled = key;
  element.replaceChildren(
    ...[make()]
      .flat(Infinity)
      .filter((child) => child !== null && child !== undefined && child !== false && child !== ""),
  );
}

/** Keeps a list's elements by key, so that focus, hover and transitions survive a new drawing. */
export function keyedList(container, keyOf, make, refresh) {
  const kept = new Map();
  return (items) => {
    const focused = container.contains(document.activeElement) ? document.activeElement : null;
    const seen = new Set();
    items.forEach((item, index) => {
      const key = keyOf(item);
      seen.add(key);
      if (!kept.has(key)) kept.set(key, make(item));
      const element = kept.get(key);
      refresh(element, item, index);
      if (container.children[index] !== element) container.insertBefore(element, container.children[index] ?? null);
    });
    for (const [key, element] of kept) {
      if (seen.has(key)) continue;
      const next = element.contains(focused) ? (element.nextElementSibling ?? element.previousElementSibling) : null;
      element.remove();
      kept.delete(key);
      next?.querySelector("button, input, [tabindex]")?.focus();
    }
  };
}

export function byId(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no #${id}`);
  return element;
}
