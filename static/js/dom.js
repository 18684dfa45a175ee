/** Elements made from data. Text is always set as text. */

import { staticAddress } from "./static_address.js";

const SPRITE = staticAddress("lib/icons.svg");
const SVG = "http://www.w3.org/2000/svg";

/** @typedef {Node | string | number | boolean | null | undefined | Child[]} Child null, undefined and false make nothing */
/** @typedef {{ [E in keyof HTMLElementEventMap as `on${E}`]?: ((event: HTMLElementEventMap[E]) => unknown) | null | false }} Handlers */
/**
 * Attributes, event handlers ("onclick"), `dataset`, `value` and `checked`. null, undefined and false set nothing.
 *
 * @typedef {Handlers & { [name: string]: unknown }} Properties
 */

/**
 * Returns an HTML element: h("button", { class: "button", onclick: save, disabled: true }, icon("x"), "Save").
 *
 * @template {keyof HTMLElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Properties} [properties]
 * @param {...Child} children
 * @returns {HTMLElementTagNameMap[Tag]}
 */
export function h(tag, properties = {}, ...children) {
  return fill(document.createElement(tag), properties, children);
}

/**
 * @template {keyof SVGElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Properties} [attributes]
 * @param {...Child} children
 * @returns {SVGElementTagNameMap[Tag]}
 */
export function svg(tag, attributes = {}, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

/** @param {Child[]} children @returns {(Node | string)[]} */
function shown(children) {
  return /** @type {Exclude<Child, Child[]>[]} */ (children.flat(/** @type {1} */ (Infinity)))
    .filter((child) => child !== null && child !== undefined && child !== false)
    .map((child) => (child instanceof Object ? /** @type {Node} */ (child) : String(child)));
}

/**
 * @template {HTMLElement | SVGElement} Kind
 * @param {Kind} element
 * @param {Properties} properties
 * @param {Child[]} children
 */
function fill(element, properties, children) {
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), /** @type {EventListener} */ (value));
    else if (name === "dataset") Object.assign(element.dataset, value);
    else if (name === "value" || name === "checked") Object.assign(element, { [name]: value });
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  element.append(...shown(children));
  return element;
}

/**
 * A name and its value for a list of facts (dl); nothing where there is no value.
 *
 * @param {string} name
 * @param {Child} value
 * @returns {Child[]}
 */
export const term = (name, value) =>
  value === null || value === undefined || value === "" || value === false
    ? []
    : [h("dt", {}, name), h("dd", {}, value)];

/**
 * A choice between several options, drawn side by side: the value and text of each.
 *
 * @param {string} name of the radio buttons
 * @param {[string, Child][]} choices
 * @param {string} chosen
 * @param {(value: string) => unknown} choose
 */
export const segments = (name, choices, chosen, choose) =>
  choices.map(([value, words]) =>
    h(
      "label",
      {},
      h("input", { type: "radio", name, value, checked: value === chosen, onchange: () => choose(value) }),
      h("span", { class: "segment" }, words),
    ),
  );

/** @param {string} name of a Lucide icon @param {string} [size] a class */
export function icon(name, size = "") {
  return svg("svg", { class: `icon ${size}`.trim(), "aria-hidden": "true" }, svg("use", { href: `${SPRITE}#${name}` }));
}

/** Replace the children of an element. @param {Element} element @param {...Child} children */
export function setChildren(element, ...children) {
  element.replaceChildren(...shown(children));
}

/** Resolves once an element has been in sight. @param {Element} element @returns {Promise<void>} */
export const whenSeen = (element) =>
  new Promise((resolve) => {
    const watcher = new IntersectionObserver((entries) => {
      if (!entries.some(({ isIntersecting }) => isIntersecting)) return;
      watcher.disconnect();
      resolve();
    });
    watcher.observe(element);
  });

/**
 * Focus the control that takes the place of the focused one when an element is drawn anew: of the same words, else the one at its place.
 *
 * @param {Element} element
 * @param {() => unknown} draw
 */
export function keepingFocus(element, draw) {
  const controls = () =>
    /** @type {HTMLElement[]} */ ([...element.querySelectorAll("a[href], button, input, select, summary, [tabindex]")]);
  const focused = globalThis.document?.activeElement;
  const before = focused && element.contains(focused) ? controls() : [];
  const place = before.indexOf(/** @type {HTMLElement} */ (focused));
  const words = before[place]?.textContent;
  draw();
  if (place < 0 || element.contains(focused)) return;
  const now = controls();
  const same = now[place]?.textContent === words ? now[place] : now.find((one) => one.textContent === words);
  (same ?? now[place])?.focus({ preventScroll: true });
}

/**
 * Replace the children of an element only if they differ: otherwise pointer and focus stay on the present ones. Focus moves to the control
 * that takes the place of the focused one.
 *
 * @param {HTMLElement | SVGElement} element
 * @param {string} key is equal as long as the children are
 * @param {() => Child} make
 */
export function refill(element, key, make) {
  if (element.dataset.filled === key) return;
  element.dataset.filled = key;
  keepingFocus(element, () => element.replaceChildren(...shown([make()]).filter((child) => child !== "")));
}

/**
 * Keeps a list's elements by key, so that focus, hover and transitions survive a new drawing.
 *
 * @template Item
 * @template {HTMLElement} [Row=HTMLElement]
 * @param {HTMLElement} container
 * @param {(item: Item) => string | number} keyOf
 * @param {(item: Item) => Row} make
 * @param {(element: Row, item: Item, index: number) => void} refresh
 * @returns {(items: readonly Item[]) => void}
 */
export function keyedList(container, keyOf, make, refresh) {
  /** @type {Map<string | number, Row>} */
  const kept = new Map();
  return (items) => {
    const focused = container.contains(document.activeElement) ? document.activeElement : null;
    const seen = new Set();
    items.forEach((item, index) => {
      const key = keyOf(item);
      seen.add(key);
      const element = kept.get(key) ?? make(item);
      kept.set(key, element);
      refresh(element, item, index);
      if (container.children[index] !== element) container.insertBefore(element, container.children[index] ?? null);
    });
    for (const [key, element] of kept) {
      if (seen.has(key)) continue;
      const next = element.contains(focused) ? (element.nextElementSibling ?? element.previousElementSibling) : null;
      element.remove();
      kept.delete(key);
      /** @type {HTMLElement | null | undefined} */ (next?.querySelector("button, input, [tabindex]"))?.focus();
    }
  };
}

/**
 * Returns the element with this id: byId("name", HTMLInputElement).value.
 *
 * @template {HTMLElement} [Kind=HTMLElement]
 * @param {string} id
 * @param {new () => Kind} [kind] its class; a type alone, nothing is checked
 * @throws {Error} if the page has none
 */
export function byId(id, kind) {
  void kind;
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no #${id}`);
  return /** @type {Kind} */ (element);
}

/**
 * Returns the first element inside `parent` that matches: find(row, ".name", HTMLInputElement).value.
 *
 * @template {Element} [Kind=HTMLElement]
 * @param {ParentNode} parent
 * @param {string} selector
 * @param {new () => Kind} [kind] its class; a type alone, nothing is checked
 * @throws {Error} if there is none
 */
export function find(parent, selector, kind) {
  void kind;
  const element = parent.querySelector(selector);
  if (!element) throw new Error(`nothing matches ${selector}`);
  return /** @type {Kind} */ (element);
}
