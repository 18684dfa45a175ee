/** The panel that plans photos of a tower or a bridge: of every part, an overview or a tower's wires, camera, GSD and least height. Each change plans anew. */

import { ApiError, isAbort, post } from "../api.js";
import { gsdText } from "../cameras/words.js";
import { h, icon, setChildren } from "../dom.js";
import { numberField } from "../page/fields.js";
import { announce } from "../page/toast.js";
import { t, tn } from "../text.js";
import { SHORT_UNIT } from "../units.js";
import { firstThatReaches, readCameras } from "./cameras.js";
import { createViewPlanLayer } from "./layer.js";
import { resultOf } from "./result.js";

/** @import { Answer } from "../api.js" */
/** @import { Camera, ViewPattern, ViewPlan } from "../api_types.d.ts" */
/** @import { MapLibreMap } from "../map/types.d.ts" */

/** @typedef {{ id: number, kind: string }} Photographed a tower or a bridge */
/** @typedef {{ map: MapLibreMap, onRecolour: (act: () => void) => unknown }} Ground */
/** @typedef {{ pattern?: ViewPattern, gsd_mm: number, min_height_m: number, camera: Camera }} Views what photos are planned by */
/** @typedef {{ words: string, act: (views: Views) => unknown }} Take what can be done with planned photos */
/**
 * @typedef {object} PanelOptions
 * @property {string} [title]
 * @property {Views | null} [views] to begin with
 * @property {Take} take
 * @property {() => void} [closed]
 */

const [MIN_GSD_MM, MAX_GSD_MM, GSD_STEP_MM] = [0.5, 10, 0.1];
const [MIN_HEIGHT_M, MAX_HEIGHT_M] = [2, 60];
const SETTLED_MS = 300;
const KEPT = "kept"; // the value of a camera that a target was planned with and no type carries now
/** @type {{ value: ViewPattern, words: string, kinds: readonly string[] }[]} */
const PATTERNS = [
  { value: "detail", words: t("Every part"), kinds: ["tower", "bridge"] },
  { value: "overview", words: t("Overview from four sides"), kinds: ["tower", "bridge"] },
  { value: "spans", words: t("Wires from both sides"), kinds: ["tower"] },
];
/**
 * What was asked last is asked first of the next asset; camera: "" until one was chosen or has shown anything.
 *
 * @type {{ pattern: ViewPattern, camera: string, gsd_mm: number, min_height_m: number }}
 */
const asked = { pattern: "detail", camera: "", gsd_mm: 2, min_height_m: 4 };

/** @param {number} height_m @param {(figure: number) => number} round inwards */
const heightBound = (height_m, round) => round((height_m / SHORT_UNIT.metres) * 10) / 10;

function gsdField() {
  const field = numberField("gsd_mm", t("GSD"), asked.gsd_mm, {
    unit: "mm",
    min: MIN_GSD_MM,
    max: MAX_GSD_MM,
    required: true,
    hint: t("Ground sample distance: what one pixel shows at most."),
  });
  const slider = h("input", {
    type: "range",
    min: MIN_GSD_MM,
    max: MAX_GSD_MM,
    step: GSD_STEP_MM,
    value: `${asked.gsd_mm}`,
    "aria-label": t("GSD in millimetres"),
    "aria-valuetext": gsdText(asked.gsd_mm),
  });
  slider.addEventListener("input", () => {
    field.input.value = slider.value;
    field.notify("");
    slider.setAttribute("aria-valuetext", gsdText(slider.valueAsNumber));
  });
  field.input.addEventListener("input", () => {
    slider.value = field.input.value;
  });
  field.input.after(slider);
  return field;
}

function heightField() {
  return numberField("min_height_m", t("Least height above ground"), asked.min_height_m, {
    unit: SHORT_UNIT.unit,
    factor: SHORT_UNIT.metres,
    digits: 1,
    min: heightBound(MIN_HEIGHT_M, Math.ceil),
    max: heightBound(MAX_HEIGHT_M, Math.floor),
    required: true,
  });
}

class ViewPlanPanel {
  #asset;
  #on;
  #reading = new AbortController();
  #planning = new AbortController();
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;
  #isFitted = false;
  /** @type {Views | null} */
  #begun = null;
  /** @type {Awaited<ReturnType<typeof readCameras>>["choices"]} */
  #choices = new Map();
  #pattern = h("select", { class: "input", id: "view-plan-pattern" });
  #camera = h("select", { class: "input", id: "view-plan-camera" });
  #gsd = gsdField();
  #height = heightField();
  #state = h("p", { class: "caption", role: "status" });
  #result = h("div", { class: "view-plan-result" });
  /** @type {ViewPlan | null} */
  #shown = null;
  #form = h(
    "form",
    {},
    h("div", { class: "field" }, h("label", { for: this.#pattern.id }, t("Photos")), this.#pattern),
    h("div", { class: "field" }, h("label", { for: this.#camera.id }, t("Camera")), this.#camera),
    this.#gsd.element,
    this.#height.element,
  );
  #taking = h("button", { type: "button", class: "button primary", hidden: true });
  title = h("h3", { tabindex: -1 });
  element = h(
    "section",
    { class: "view-plan", "aria-label": t("Plan photos") },
    h(
      "div",
      { class: "view-plan-head" },
      this.title,
      h(
        "button",
        { type: "button", class: "icon-button", "aria-label": t("Close"), onclick: () => this.close() },
        icon("x"),
      ),
    ),
    this.#form,
    this.#state,
    this.#result,
    this.#taking,
  );

  /**
   * @param {Photographed} asset
   * @param {{ layer: ReturnType<typeof createViewPlanLayer>, take: Take, closed: () => void }} on
   * @param {Pick<PanelOptions, "title" | "views">} options
   */
  constructor(asset, on, { title = t("Plan photos"), views = null }) {
    this.#asset = asset.id;
    const patterns = PATTERNS.filter(({ kinds }) => kinds.includes(asset.kind));
    setChildren(
      this.#pattern,
      patterns.map(({ value, words }) => h("option", { value, selected: value === asked.pattern }, words)),
    );
    this.#on = on;
    this.#begun = views;
    this.title.append(icon("camera", "small"), title);
    this.#taking.textContent = on.take.words;
    this.#taking.addEventListener("click", () => this.#take());
    this.#form.addEventListener("submit", (event) => event.preventDefault());
    this.#pattern.addEventListener("change", () => {
      this.#isFitted = false;
    });
    this.#camera.addEventListener("change", () => {
      asked.camera = this.#camera.value;
    });
    this.#showFields();
    this.#form.addEventListener("change", () => {
      this.#showFields();
      clearTimeout(this.#timer);
      this.#timer = setTimeout(() => this.#plan(), SETTLED_MS);
    });
    this.element.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.stopPropagation();
      this.close();
    });
    void this.#start();
  }

  /** Whatever is being read or planned is abandoned. */
  close() {
    this.#reading.abort();
    this.#planning.abort();
    clearTimeout(this.#timer);
    this.#on.layer.show(null);
    this.element.remove();
    this.#on.closed();
  }

  /** As a click on its row: chosen, or chosen no more. @param {number} number */
  pressPhoto(number) {
    const row = this.#result.querySelectorAll(".photo-row")[number];
    if (!(row instanceof HTMLElement)) return;
    row.closest("details")?.toggleAttribute("open", true);
    row.click();
    row.scrollIntoView({ block: "nearest" });
  }

  /** An overview has the GSD that the distance gives. */
  #showFields() {
    const isOverview = this.#pattern.value === "overview";
    this.#gsd.element.hidden = isOverview;
    this.#gsd.input.disabled = isOverview;
  }

  async #start() {
    this.#wait(t("Reading cameras…"));
    try {
      const { options, choices } = await readCameras(this.#reading.signal);
      this.#choices = choices;
      setChildren(this.#camera, options);
      if (this.#begun) this.#beginWith(this.#begun);
      else if (choices.has(asked.camera)) this.#camera.value = asked.camera;
      await this.#plan();
    } catch (error) {
      this.#failed(error, () => this.#start());
    }
  }

  /** As it was chosen before; a camera that is not carried any more stays to choose. @param {Views} views */
  #beginWith({ camera }) {
    const known = [...this.#choices].find(([, choice]) => choice.camera.name === camera.name)?.[0];
    if (!known) {
      this.#choices.set(KEPT, { camera, request: { camera } });
      this.#camera.prepend(h("option", { value: KEPT }, camera.name));
    }
    this.#camera.value = known ?? KEPT;
    asked.camera = this.#camera.value;
  }

  #take() {
    const chosen = this.#choices.get(this.#camera.value);
    if (!chosen || !this.#shown) return;
    const { pattern, gsd_mm, min_height_m } = this.#shown;
    this.#on.take.act({ ...(pattern ? { pattern } : {}), gsd_mm, min_height_m, camera: chosen.camera });
    this.close();
  }

  async #plan() {
    this.#planning.abort();
    this.#taking.hidden = true;
    const chosen = this.#choices.get(this.#camera.value);
    if (!chosen || !this.#form.checkValidity()) return;
    this.#planning = new AbortController();
    const isOverview = this.#pattern.value === "overview";
    Object.assign(asked, { pattern: this.#pattern.value, min_height_m: this.#height.read() });
    if (!isOverview) asked.gsd_mm = this.#gsd.read() ?? asked.gsd_mm;
    this.#wait(t("Planning photos…"));
    const { pattern, gsd_mm, min_height_m } = asked;
    const fineness = isOverview ? {} : { gsd_mm };
    const body = { asset: this.#asset, pattern, ...chosen.request, ...fineness, min_height_m };
    const { signal } = this.#planning;
    try {
      const { data } = /** @type {Answer<ViewPlan>} */ (await post("/view-plans", body, { signal }));
      if (this.#changesCamera(data)) await this.#plan();
      else this.#show(data);
    } catch (error) {
      this.#failed(error, () => this.#plan());
    }
  }

  /** Before a camera was chosen or has shown anything: to the first one that can. @param {ViewPlan} plan */
  #changesCamera(plan) {
    if (plan.photos.length) asked.camera ||= this.#camera.value;
    const next = asked.camera || plan.pattern === "overview" ? null : firstThatReaches(this.#choices, plan);
    if (next === null || next === this.#camera.value) return false;
    this.#camera.value = next;
    return true;
  }

  /** The plan before stays in grey. @param {string} words */
  #wait(words) {
    this.#state.textContent = words;
    this.#result.setAttribute("aria-busy", "true");
    if (!this.#result.querySelector("table"))
      setChildren(this.#result, h("div", { class: "skeleton" }), h("div", { class: "skeleton" }));
  }

  #waited() {
    this.#state.textContent = "";
    this.#result.removeAttribute("aria-busy");
  }

  /** @param {ViewPlan} plan */
  #show(plan) {
    this.#waited();
    this.#shown = plan;
    const isOpen = this.#result.querySelector("details")?.open ?? false;
    setChildren(
      this.#result,
      resultOf(plan, (number) => this.#on.layer.choose(plan, number)),
    );
    this.#result.querySelector("details")?.toggleAttribute("open", isOpen);
    this.#on.layer.show(plan, { isNew: !this.#isFitted });
    this.#isFitted ||= plan.photos.length > 0;
    this.#taking.hidden = !plan.photos.length;
    announce(tn(plan.photos.length, "{count} photo planned", "{count} photos planned"));
  }

  /** @param {unknown} error @param {() => unknown} again */
  #failed(error, again) {
    if (isAbort(error)) return;
    if (!(error instanceof ApiError)) throw error;
    this.#waited();
    this.#on.layer.show(null);
    const retry = h("button", { type: "button", class: "text-button", onclick: again }, t("Try again"));
    setChildren(
      this.#result,
      h(
        "div",
        { class: "notice critical", role: "alert" },
        icon("circle-alert"),
        h("p", {}, h("strong", {}, t("No photos planned.")), ` ${error.message} `, error.isAway && retry),
      ),
    );
  }
}

/** @type {ReturnType<typeof createViewPlanLayer> | null} */
let layer = null;
/** @type {ViewPlanPanel | null} */
let open = null;

/** Close the panel, where one is open: the asset is no longer shown. */
export function closeViewPlan() {
  open?.close();
}

/** @param {Ground} ground */
function layerOf({ map, onRecolour }) {
  const made = createViewPlanLayer(map, (number) => open?.pressPhoto(number));
  onRecolour(() => made.recolour());
  return made;
}

/**
 * Opens the panel in a place, in place of what is there. One panel is open at a time.
 *
 * @param {HTMLElement} place
 * @param {Photographed} asset
 * @param {Ground} ground
 * @param {PanelOptions} options
 */
export function openViewPlan(place, asset, ground, { take, closed = () => {}, ...options }) {
  open?.close();
  layer ??= layerOf(ground);
  if (options.views) {
    const { pattern = "detail", gsd_mm, min_height_m } = options.views;
    Object.assign(asked, { pattern, min_height_m, ...(pattern === "overview" ? {} : { gsd_mm }) });
  }
  open = new ViewPlanPanel(
    asset,
    {
      layer,
      take,
      closed() {
        open = null;
        closed();
      },
    },
    options,
  );
  setChildren(place, open.element);
  open.title.focus({ preventScroll: true });
  open.element.scrollIntoView({ block: "start" });
}

/**
 * The button that opens the panel in the details of a tower or a bridge.
 *
 * @param {Photographed} asset
 * @param {Ground} ground
 * @param {Take} take
 */
export function viewPlanPart(asset, ground, take) {
  const place = h("div", {});
  const button = h(
    "button",
    { type: "button", class: "button", onclick: show },
    icon("camera", "small"),
    t("Plan photos"),
  );
  function show() {
    openViewPlan(place, asset, ground, {
      take,
      closed() {
        setChildren(place, button);
        if (button.isConnected) button.focus();
      },
    });
  }
  setChildren(place, button);
  return h("div", { class: "record-acts" }, place);
}
