/** The fields of one camera in the form of a UAV type. */

import { h, icon } from "../dom.js";
import { numberField, switchField, textField } from "../page/fields.js";
import { t } from "../text.js";
import { SHORT_UNIT } from "../units.js";
import { sourcesList } from "./catalogue.js";
import { cameraText } from "./words.js";

/** @import { Camera, CatalogueCamera } from "../api_types.d.ts" */
/** @import { Field } from "../page/fields.js" */

/** @typedef {Partial<Camera>} Figures a camera whose fields may still be empty */

/** @typedef {ReturnType<typeof fieldsOf>} CameraFields */

const MAY_BE_NULL = ["gimbal_yaw_min_deg", "gimbal_yaw_max_deg"]; // null: the UAV turns instead
const OFFSETS = [
  { name: "offset_forward", words: t("Lens ahead of the antenna") },
  { name: "offset_right", words: t("Lens right of the antenna") },
  { name: "offset_up", words: t("Lens above the antenna") },
];

/** "24, 35.5" → [24, 35.5]; what is no number becomes NaN. @param {string} text */
const figuresOf = (text) =>
  text
    .split(/[;,\s]+/)
    .filter(Boolean)
    .map(Number);

/** @param {...Field} fields side by side */
const pair = (...fields) =>
  h(
    "div",
    { class: "pair" },
    fields.map(({ element }) => element),
  );

/** @param {Figures} camera @returns {Field<number[]>} */
function focalField({ focal_lengths_mm: steps }) {
  const shown = steps?.join(", ") ?? "";
  const field = textField("focal_lengths_mm", t("Focal lengths"), shown, {
    required: true,
    maxlength: 200,
    unit: "mm",
    hint: t("Real ones, not equivalents of 35 mm film. Of a zoom several, shortest first, divided by commas."),
  });
  const isFigures = () => figuresOf(field.input.value).every(Number.isFinite);
  field.input.addEventListener("input", () =>
    field.input.setCustomValidity(isFigures() ? "" : t("A number is wanted here.")),
  );
  return { ...field, read: () => (field.read() === shown && steps ? steps : figuresOf(field.read())) };
}

/** @param {Figures} camera */
function fieldsOf(camera) {
  /** @param {keyof Figures & string} name @param {string} words @param {Parameters<typeof numberField>[3]} how */
  const number = (name, words, how) => numberField(name, words, /** @type {number | null} */ (camera[name]), how);
  const pixels = { unit: "px", step: 1, min: 1, max: 50_000, required: true };
  const sensor = { unit: "mm", digits: 4, min: 0.1, max: 1000, required: true };
  const pitch = { unit: "°", min: -180, max: 180 };
  const yaw = { unit: "°", min: -360, max: 360 };
  return {
    name: textField("name", t("Camera name"), camera.name, { required: true }),
    wide: number("pixels_wide", t("Pixels across"), pixels),
    high: number("pixels_high", t("Pixels down"), pixels),
    width: number("sensor_width_mm", t("Sensor width"), sensor),
    height: number("sensor_height_mm", t("Sensor height"), sensor),
    focal: focalField(camera),
    interval: number("min_interval_s", t("Shortest interval"), {
      unit: "s",
      min: 0.01,
      max: 1000,
      usual: 2,
      hint: t("Between two photos."),
    }),
    exposure: number("shutter_s", t("Exposure time"), {
      unit: "ms",
      factor: 0.001,
      min: 0.01,
      max: 10_000,
      usual: 0.001,
      hint: t("Of one photo."),
    }),
    focus: number("nearest_focus_m", t("Nearest focus"), {
      unit: SHORT_UNIT.unit,
      factor: SHORT_UNIT.metres,
      min: 0,
      max: 1000,
      usual: 1,
      hint: t("No photo is taken from nearer."),
    }),
    pitchMin: number("gimbal_pitch_min_deg", t("Lowest gimbal pitch"), {
      ...pitch,
      usual: -90,
      hint: t("−90° is straight down."),
    }),
    pitchMax: number("gimbal_pitch_max_deg", t("Highest gimbal pitch"), {
      ...pitch,
      usual: 0,
      hint: t("0° is the horizon."),
    }),
    yawMin: number("gimbal_yaw_min_deg", t("Gimbal yaw, left"), { ...yaw, hint: t("Blank: the UAV turns instead.") }),
    yawMax: number("gimbal_yaw_max_deg", t("Gimbal yaw, right"), yaw),
    offsets: OFFSETS.map(({ name, words }, place) =>
      numberField(name, words, camera.offset_m?.[place], {
        unit: SHORT_UNIT.unit,
        factor: SHORT_UNIT.metres,
        min: -10,
        max: 10,
        usual: 0,
      }),
    ),
    thermal: switchField("is_thermal", t("Thermal"), camera.is_thermal),
  };
}

/** @param {CameraFields} own */
const layoutOf = (own) =>
  h(
    "div",
    {},
    own.name.element,
    pair(own.wide, own.high),
    pair(own.width, own.height),
    own.focal.element,
    pair(own.interval, own.exposure),
    own.focus.element,
    pair(own.pitchMin, own.pitchMax),
    pair(own.yawMin, own.yawMax),
    own.offsets.map(({ element }) => element),
    own.thermal.element,
  );

/** The figures that are stated; those left blank have their defaults. @param {CameraFields} own @param {Figures} camera as it was @returns {Figures} */
function readFields(own, camera) {
  const offset = own.offsets.map((field) => field.read() ?? 0);
  const stated = {
    name: own.name.read(),
    pixels_wide: own.wide.read(),
    pixels_high: own.high.read(),
    sensor_width_mm: own.width.read(),
    sensor_height_mm: own.height.read(),
    focal_lengths_mm: own.focal.read(),
    min_interval_s: own.interval.read(),
    nearest_focus_m: own.focus.read(),
    shutter_s: own.exposure.read(),
    gimbal_pitch_min_deg: own.pitchMin.read(),
    gimbal_pitch_max_deg: own.pitchMax.read(),
    gimbal_yaw_min_deg: own.yawMin.read(),
    gimbal_yaw_max_deg: own.yawMax.read(),
    offset_m: camera.offset_m || offset.some(Boolean) ? offset : null,
    is_thermal: own.thermal.read(),
  };
  return Object.fromEntries(
    Object.entries({ ...camera, ...stated }).filter(([name, value]) => value !== null || MAY_BE_NULL.includes(name)),
  );
}

/** @param {Figures} camera */
const isWhole = (camera) =>
  Boolean(camera.focal_lengths_mm?.length && camera.sensor_width_mm && camera.sensor_height_mm) &&
  Boolean(camera.pixels_wide && camera.pixels_high);

/**
 * One camera: its name and reach, its fields below, and where its figures come from.
 *
 * @param {Figures} camera
 * @param {object} how
 * @param {boolean} how.isOpen whether its fields are shown
 * @param {() => readonly CatalogueCamera[]} how.catalogue empty until it is read
 * @param {() => void} how.remove
 */
export function cameraForm(camera, { isOpen, catalogue, remove }) {
  const own = fieldsOf(camera);
  /** @type {Field[]} */
  const fields = Object.values(own).flat();
  const [name, facts, sources] = [h("strong", { translate: "no" }), h("span", { class: "caption" }), h("div", {})];
  const details = h(
    "details",
    { class: "camera-figures", open: isOpen },
    h("summary", {}, t("Figures")),
    layoutOf(own),
  );
  // A field in closed details cannot be focused.
  details.addEventListener("invalid", () => details.toggleAttribute("open", true), true);
  const button = h(
    "button",
    { type: "button", class: "icon-button", title: t("Remove"), onclick: () => remove() },
    icon("trash-2"),
  );
  const element = h(
    "fieldset",
    { class: "camera" },
    h("legend", { class: "unseen" }, t("Camera")),
    h("div", { class: "camera-head" }, h("div", {}, name, facts), button),
    details,
    sources,
  );

  const read = () => readFields(own, camera);
  function draw() {
    const now = read();
    name.textContent = now.name || t("New camera");
    facts.textContent = isWhole(now) ? cameraText(/** @type {Camera} */ (now)) : t("Figures are missing.");
    button.setAttribute("aria-label", t("Remove {name}", { name: name.textContent }));
    const wasOpen = sources.querySelector("details")?.open ?? false;
    const list = sourcesList(/** @type {Camera} */ (now), catalogue());
    list?.toggleAttribute("open", wasOpen);
    sources.replaceChildren(...(list ? [list] : []));
  }
  element.addEventListener("input", draw);
  draw();

  return {
    element,
    read,
    draw,
    first: own.name.input,
    /** @param {string} figure as the API names it; the gimbal's and the offset's are at their first fields */
    field: (figure) => fields.find((field) => field.name === (figure === "offset_m" ? OFFSETS[0].name : figure)),
    clear() {
      for (const field of fields) field.notify("");
    },
    open: () => details.toggleAttribute("open", true),
  };
}
