/** Cameras, UAVs and what else can be done with the picture, as buttons over it. */

import { h, icon } from "../dom.js";
import { routeLetter, routeNumber } from "../domain/palette.js";
import { t } from "../text.js";

export const CAMERA_WORDS = {
  chase: t("Chase"),
  orbit: t("Target"),
  free: t("Free"),
  top: t("Top"),
  onboard: t("Its camera"),
};
export const CAMERA_LONG = {
  chase: t("Behind the UAV"),
  orbit: t("Round a target"),
  free: t("Free camera"),
  top: t("From above"),
  onboard: t("From the UAV's camera"),
};
export const CAMERA_KEYS = { chase: "c", orbit: "o", free: "v", top: "t", onboard: "u" };
export const CAMERA_ICONS = {
  chase: "send",
  orbit: "crosshair",
  free: "move-3d",
  top: "square-arrow-down",
  onboard: "video",
};

/** acts: of stage.js. show({ mode, chosen, isFlat }). */
export function createCameraBar({ routes, acts, isPanel, openAddress }) {
  const name = `scene-camera-${Math.random().toString(36).slice(2)}`;
  const cameras = Object.keys(CAMERA_WORDS).map((mode) => ({
    mode,
    input: h("input", { type: "radio", name, value: mode, onchange: () => acts.setCamera(mode) }),
  }));
  const uavs = routes.map(({ place, name: uav }) => ({
    place,
    button: h(
      "button",
      {
        type: "button",
        class: `scene-uav route-${routeNumber(place)}`,
        "aria-pressed": "false",
        "aria-label": t("Follow {name}", { name: `${routeLetter(place)} ${uav}` }),
        title: uav,
        onclick: () => acts.choose(place),
      },
      h("span", { class: `letter route-${routeNumber(place)}` }, routeLetter(place)),
    ),
  }));
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
  const element = h(
    "div",
    { class: "scene-bar", role: "group", "aria-label": t("Camera") },
    h(
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
    ),
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
      isPanel &&
        h(
          "a",
          {
            class: "icon-button of-panel",
            href: openAddress(),
            "aria-label": t("Open the whole 3D view"),
            title: t("Open the whole 3D view"),
            onclick: (event) => (event.currentTarget.href = openAddress()),
          },
          icon("external-link"),
        ),
      isPanel && button("x", t("Close the 3D view"), "", () => acts.close(), { isOfPage: false }),
    ),
  );
  return {
    element,
    show({ mode, chosen, isFlat }) {
      for (const one of cameras) {
        one.input.checked = one.mode === mode;
        one.input.disabled = isFlat && one.mode !== "top";
      }
      for (const { place, button: own } of uavs) own.setAttribute("aria-pressed", String(place === chosen));
    },
  };
}
