/** Keys of the 3D view, in the form of the page's keyboard. */

import { t } from "../text.js";
import { CAMERA_KEYS, CAMERA_LONG } from "./camera_bar.js";
import { CAMERAS } from "./cameras/rig.js";

/** @import { Binding } from "../page/keyboard.js" */
/** @import { SceneActs } from "./acts.js" */

const HELD = ["arrowleft", "arrowright", "arrowup", "arrowdown", "w", "a", "s", "d", "q", "e"];
/** @param {SceneActs} acts @returns {Binding["act"]} */
const held = (acts) => (event) => acts.press(event);
/** @param {Event} event */
const isOnControl = ({ target }) =>
  target instanceof Element && target.closest("button, a, summary, select, input, [role=menu]") !== null;

/**
 * Those that a page has by itself (time, UAVs) are left out where `hasOwnTime` is false.
 *
 * @param {SceneActs} acts
 * @param {{ hasOwnTime?: boolean }} [how]
 * @returns {Binding[]}
 */
export function sceneKeys(acts, { hasOwnTime = true } = {}) {
  const cameras = CAMERAS.map((mode) => ({
    keys: [CAMERA_KEYS[mode]],
    words: CAMERA_LONG[mode],
    act: () => acts.setCamera(mode),
  }));
  /** @type {Binding[]} */
  const time = [
    { keys: [" "], words: t("Play, stop"), act: (event) => !isOnControl(event) && acts.toggle() },
    { keys: [","], words: t("Previous event"), act: () => acts.step(-1) },
    { keys: ["."], words: t("Next event"), act: () => acts.step(1) },
    { keys: ["<"], words: t("Slower"), act: () => acts.changeSpeed(-1) },
    { keys: [">"], words: t("Faster"), act: () => acts.changeSpeed(1) },
  ];
  return [
    ...cameras,
    { keys: ["j"], words: t("Next UAV"), act: () => acts.next(1) },
    { keys: ["k"], words: t("Previous UAV"), act: () => acts.next(-1) },
    ...Array.from({ length: 8 }, (_, index) => ({
      keys: [`${index + 1}`],
      words: index ? undefined : t("Follow UAV A to H (1 to 8)"),
      act: () => acts.chooseNumber(index),
    })),
    { keys: ["b"], words: t("Next target"), act: () => acts.nextTarget(1) },
    ...(hasOwnTime ? time : []),
    {
      keys: ["arrowleft", "arrowright", "arrowup", "arrowdown"],
      words: t("Turn the camera, with the other arrows too"),
      act: (event) => (isOnControl(event) ? false : acts.press(event)),
    },
    {
      keys: ["w", ...HELD.slice(5)],
      words: t("Free camera: W A S D, E up, Q down, with Shift faster"),
      act: held(acts),
    },
    { keys: ["shift+w", "shift+a", "shift+s", "shift+d", "shift+q", "shift+e"], act: held(acts) },
    { keys: ["+", "="], words: t("Nearer"), act: () => acts.zoom(0.8) },
    { keys: ["-"], words: t("Farther"), act: () => acts.zoom(1.25) },
    { keys: ["f"], words: t("See all of it"), act: () => acts.fit() },
    { keys: ["p"], words: t("Keep a picture (PNG)"), act: () => void acts.keepPicture() },
    { keys: ["l"], words: t("Copy the link to this moment"), act: () => void acts.copyLink() },
  ];
}
