/** Cameras, UAVs and what else can be done with the picture, as buttons over it. */

import { h, icon } from "../dom.js";
import { routeLetter, routeNumber } from "../domain/palette.js";
import { t } from "../text.js";
import { CAMERAS } from "./cameras/rig.js";

/** @import { SceneActs } from "./acts.js" */
/** @import { CameraMode } from "./cameras/rig.js" */
/** @import { FlightRoute } from "./types.d.ts" */

/** @type {Record<CameraMode, string>} */
export const CAMERA_WORDS = {
  chase: t("Chase"),
  orbit: t("Target"),
  free: t("Free"),
  top: t("Top"),
  onboard: t("Its camera"),
};
/** @type {Record<CameraMode, string>} */
export const CAMERA_LONG = {
  chase: t("Behind the UAV"),
  orbit: t("Round a target"),
  free: t("Free camera"),
  top: t("From above"),
  onboard: t("From the UAV's camera"),
};
/** @type {Record<CameraMode, string>} */
export const CAMERA_KEYS = { chase: "c", orbit: "o", free: "v", top: "t", onboard: "u" };
/** @type {Record<CameraMode, string>} */
const CAMERA_ICONS = {
  chase: "send",
  orbit: "crosshair",
  free: "move-3d",
  top: "square-arrow-down",
  onboard: "video",
};

/** Radio buttons of the cameras. @param {(mode: CameraMode) => void} choose */
function camerasOf(choose) {
  const name = `scene-camera-${Math.random().toString(36).slice(2)}`;
  const cameras = CAMERAS.map((mode) => ({
    mode,
    input: h("input", { type: "radio", name, value: mode, onchange: () => choose(mode) }),
  }));
  const element = h(
    "fieldset",
    { class: "segments line scene-cameras" },
    h("legend", { class: "unseen" }, t("Camera")),
    cameras.map(({ mode, input }) =>
      h(
        "label",
        { title: `${CAMERA_LONG[mode]} (${CAMERA_KEYS[mode].toUpperCase()})` },
        input,
        h(
          "span",
          { class: "segment" },
          icon(CAMERA_ICONS[mode], "small"),
          h("span", { class: "scene-camera-name" }, CAMERA_WORDS[mode]),
        ),
      ),
    ),
  );
  return { element, cameras };
}

/** A button for each UAV. @param {readonly FlightRoute[]} routes @param {readonly number[]} colours of the mission @param {(place: number) => void} choose */
const uavsOf = (routes, colours, choose) =>
  routes.map(({ place, name: uav }) => ({
    place,
    button: h(
      "button",
      {
        type: "button",
        class: `scene-uav route-${routeNumber(place, colours)}`,
        "aria-pressed": "false",
        "aria-label": t("Follow {name}", { name: `${routeLetter(place)} ${uav}` }),
        title: uav,
        onclick: () => choose(place),
      },
      h("span", { class: `letter route-${routeNumber(place, colours)}` }, routeLetter(place)),
    ),
  }));

/**
 * @param {string} image
 * @param {string} words
 * @param {string} key
 * @param {() => unknown} act
 * @param {{ isOfPage?: boolean }} [how]
 */
const button = (image, words, key, act, { isOfPage = true } = {}) =>
  h(
    "button",
    {
      class: `icon-button${isOfPage ? "" : " of-panel"}`,
      type: "button",
      "aria-label": words,
      title: key ? `${words} (${key})` : words,
      onclick: act,
    },
    icon(image),
  );

/** @param {() => string} openAddress */
function openLink(openAddress) {
  const link = h(
    "a",
    {
      class: "icon-button of-panel",
      href: openAddress(),
      "aria-label": t("Open the whole 3D view"),
      title: t("Open the whole 3D view"),
      onclick: () => {
        link.href = openAddress();
      },
    },
    icon("external-link"),
  );
  return link;
}

/** @param {{ routes: readonly FlightRoute[], colours: readonly number[], acts: SceneActs, isPanel: boolean, openAddress: () => string }} options */
export function createCameraBar({ routes, colours, acts, isPanel, openAddress }) {
  const { element: choices, cameras } = camerasOf(acts.setCamera);
  const uavs = uavsOf(routes, colours, acts.choose);
  const element = h(
    "div",
    { class: "scene-bar", role: "group", "aria-label": t("Camera") },
    choices,
    routes.length > 1 &&
      h(
        "div",
        { class: "scene-uavs", role: "group", "aria-label": t("UAVs") },
        uavs.map(({ button: own }) => own),
      ),
    h(
      "div",
      { class: "control-group scene-acts" },
      button("maximize-2", t("See all of it"), "F", () => acts.fit()),
      button("camera", t("Keep a picture (PNG)"), "P", () => void acts.keepPicture()),
      button("link", t("Copy the link to this moment"), "L", () => void acts.copyLink()),
      isPanel && openLink(openAddress),
      isPanel && button("x", t("Close the 3D view"), "", () => acts.close(), { isOfPage: false }),
    ),
  );
  return {
    element,
    /** @param {{ mode: CameraMode, chosen: number | null, isFlat: boolean }} state */
    show({ mode, chosen, isFlat }) {
      for (const one of cameras) {
        one.input.checked = one.mode === mode;
        one.input.disabled = isFlat && one.mode !== "top";
      }
      for (const { place, button: own } of uavs) own.setAttribute("aria-pressed", String(place === chosen));
    },
  };
}
