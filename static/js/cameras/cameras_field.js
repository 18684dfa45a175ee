/** The cameras of a UAV type in its form: chosen from the catalogue or stated by the user, six at most. */

import { ApiError } from "../api.js";
import { h, icon, setChildren } from "../dom.js";
import { t } from "../text.js";
import { cameraForm } from "./camera_form.js";
import { cameraOf, matching, optionsOf, readCatalogue, sourcesList } from "./catalogue.js";
import { cameraText } from "./words.js";

/** @import { Camera, CatalogueCamera } from "../api_types.d.ts" */
/** @import { Field } from "../page/fields.js" */
/** @import { Figures } from "./camera_form.js" */

export const MAX_CAMERAS = 6; // as in missions/serializers/fleet.py
const LIST_ROWS = 8;

/**
 * A field with the fields of each camera within; `within("cameras.0.name")` is one of these.
 *
 * @param {readonly Camera[]} cameras
 * @returns {Field<Figures[]> & { within: (name: string) => Field | undefined }}
 */
export function camerasField(cameras) {
  const list = new CameraForms(cameras);
  return {
    name: "cameras",
    label: t("Cameras"),
    element: list.element,
    input: /** @type {any} */ (list.add),
    read: () => list.read(),
    notify: (words) => list.notify(words),
    within: (name) => list.within(name),
  };
}

class CameraForms {
  add = h(
    "button",
    { type: "button", class: "button", onclick: () => void this.#choose() },
    icon("plus", "small"),
    t("Add a camera"),
  );
  #list = h("div", { class: "cameras" });
  #picker = h("div", {});
  #fault = h("p", { class: "field-error", hidden: true });
  #most = h("p", { class: "caption", hidden: true }, t("Six cameras at most."));
  element = h(
    "section",
    { class: "camera-fields" },
    h("h3", {}, t("Cameras")),
    this.#list,
    this.#fault,
    this.#picker,
    this.add,
    this.#most,
  );
  /** @type {readonly CatalogueCamera[]} */
  #catalogue = [];
  /** @type {ReturnType<typeof cameraForm>[]} */
  #forms = [];

  /** @param {readonly Camera[]} cameras */
  constructor(cameras) {
    for (const camera of cameras) this.#put(camera, false);
    this.#refresh();
    if (cameras.length)
      readCatalogue().then(
        (known) => this.#showSources(known),
        () => {}, // without the catalogue there are no sources to show
      );
  }

  read() {
    return this.#forms.map((form) => form.read());
  }

  /** @param {string} words */
  notify(words) {
    this.#fault.hidden = !words;
    this.#fault.replaceChildren(...(words ? [icon("circle-alert", "small"), words] : []));
    if (!words) for (const form of this.#forms) form.clear();
  }

  /** @param {string} name "cameras.0.pixels_high" */
  within(name) {
    const [, number, figure] = /^cameras\.(\d+)\.(\w+)/.exec(name) ?? [];
    const form = this.#forms[Number(number)];
    const field = figure ? form?.field(figure) : undefined;
    if (field) form.open();
    return field;
  }

  #refresh() {
    setChildren(
      this.#list,
      this.#forms.map((form) => form.element),
    );
    const isFull = this.#forms.length >= MAX_CAMERAS;
    this.add.hidden = isFull || this.#picker.hasChildNodes();
    this.#most.hidden = !isFull;
  }

  #changed() {
    this.element.dispatchEvent(new Event("input", { bubbles: true }));
  }

  /** @param {Figures} camera @param {boolean} isOpen */
  #put(camera, isOpen) {
    const form = cameraForm(camera, {
      isOpen,
      catalogue: () => this.#catalogue,
      remove: () => {
        this.#forms = this.#forms.filter((own) => own !== form);
        this.notify("");
        this.#refresh();
        this.#changed();
        this.add.focus();
      },
    });
    this.#forms.push(form);
    return form;
  }

  /** @param {readonly CatalogueCamera[]} known */
  #showSources(known) {
    this.#catalogue = known;
    for (const form of this.#forms) form.draw();
  }

  #close() {
    this.#picker.replaceChildren();
    this.#refresh();
    this.add.focus();
  }

  /** @param {Figures} camera @param {boolean} isOpen */
  #take(camera, isOpen) {
    this.#close();
    const form = this.#put(camera, isOpen);
    this.#refresh();
    this.#changed();
    if (isOpen) form.first.focus();
  }

  async #choose() {
    try {
      this.#showSources(await readCatalogue());
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      this.notify(error.message);
      return;
    }
    const { element, first } = catalogueList(this.#catalogue, {
      take: (camera, isOpen) => this.#take(camera, isOpen),
      close: () => this.#close(),
    });
    setChildren(this.#picker, element);
    this.#refresh();
    first.focus();
  }
}

/**
 * The catalogue as a list that is narrowed by a text, with the figures of the chosen camera.
 *
 * @param {readonly CatalogueCamera[]} cameras
 * @param {{ take: (camera: Figures, isOpen: boolean) => void, close: () => void }} acts
 */
function catalogueList(cameras, { take, close }) {
  const text = h("input", { class: "input", type: "search", id: "camera-text", autocomplete: "off", maxlength: 100 });
  const list = h("select", { class: "input", id: "camera-list", size: LIST_ROWS });
  const shown = h("div", { class: "camera-chosen", role: "status" });
  const add = h("button", { type: "button", class: "button", disabled: true }, t("Add this camera"));

  const chosen = () => cameras.find(({ key }) => key === list.value);
  function draw() {
    const known = chosen();
    add.disabled = !known;
    setChildren(shown, known && [h("p", {}, cameraText(known)), sourcesList(cameraOf(known), cameras)]);
  }
  function narrow() {
    const before = list.value;
    const found = matching(cameras, text.value);
    setChildren(list, optionsOf(found));
    list.size = Math.max(2, Math.min(LIST_ROWS, list.querySelectorAll("option, optgroup").length));
    list.value = found.some(({ key }) => key === before) ? before : found.length === 1 ? found[0].key : "";
    draw();
    if (!found.length) shown.textContent = t("The catalogue has none of this name. State your own camera.");
  }
  const takeChosen = () => {
    const known = chosen();
    if (known) take(cameraOf(known), false);
  };
  text.addEventListener("input", (event) => {
    event.stopPropagation(); // it is no value of the form
    narrow();
  });
  list.addEventListener("input", (event) => event.stopPropagation());
  list.addEventListener("change", draw);
  list.addEventListener("dblclick", takeChosen);
  add.addEventListener("click", takeChosen);
  for (const control of [text, list])
    control.addEventListener("keydown", (event) => {
      if (/** @type {KeyboardEvent} */ (event).key === "Enter") {
        event.preventDefault(); // it would save the form
        takeChosen();
      } else if (/** @type {KeyboardEvent} */ (event).key === "Escape") {
        event.stopPropagation();
        close();
      }
    });
  narrow();
  const own = () => take({}, true);
  return {
    first: text,
    element: h(
      "div",
      { class: "camera-picker" },
      h("div", { class: "field" }, h("label", { for: text.id }, t("Find a camera")), text),
      h("div", { class: "field" }, h("label", { for: list.id }, t("Catalogue")), list),
      shown,
      h(
        "div",
        { class: "camera-acts" },
        add,
        h("button", { type: "button", class: "button", onclick: own }, t("Own camera")),
        h("button", { type: "button", class: "text-button", onclick: close }, t("Cancel")),
      ),
    ),
  };
}
