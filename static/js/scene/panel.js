/** The 3D view over the lower half of a page's map: the same view as on its own page. */

import { ApiError, get } from "../api.js";
import { h, icon } from "../dom.js";
import { keyName, showKeys } from "../page/keyboard.js";
import { staticAddress } from "../static_address.js";
import { t } from "../text.js";
import { sceneKeys } from "./keys.js";
import { readSource } from "./sources/read.js";
import { recordSource } from "./sources/record_source.js";
import { openStage } from "./stage.js";

/** @import { Answer } from "../api.js" */
/** @import { Mission } from "../api_types.d.ts" */
/** @import { Binding } from "../page/keyboard.js" */
/** @import { LoadedMission } from "../record/load.js" */
/** @import { Player } from "../record/player.js" */
/** @import { Stage } from "./stage.js" */
/** @import { WantedSource } from "./types.d.ts" */

/**
 * What a panel shows.
 *
 * @typedef {object} PanelOptions
 * @property {string} mission
 * @property {WantedSource | null} [wanted] null: the default
 * @property {LoadedMission | null} [record] where the page has it already
 * @property {Player | null} [player] the page's own
 * @property {() => number} [now_ms] of a source that lives
 * @property {(stage: Stage) => () => void} [follow] for a source that lives; returns what ends it
 * @property {() => void} [onClose]
 * @property {boolean} [takesFocus] the picture
 */
/** @typedef {{ close: () => void, stage: Stage | null }} Panel */

/** @type {Promise<unknown> | null} */
let styles = null;

/** The view's style sheet, loaded with the first panel. */
function loadStyles() {
  styles ??= new Promise((resolve) => {
    const sheet = h("link", {
      rel: "stylesheet",
      href: staticAddress("css/scene.css"),
      onload: resolve,
      onerror: resolve,
    });
    document.head.append(sheet);
  });
  return styles;
}

/** Keys of the view while the focus is in it. @param {HTMLElement} element @param {Binding[]} bindings */
function listenInside(element, bindings) {
  element.addEventListener("keydown", (event) => {
    if (
      event.defaultPrevented ||
      /** @type {Element} */ (event.target).closest("input, select") ||
      document.documentElement.dataset.singleKeys === "off"
    )
      return;
    const name = keyName(event);
    const binding = bindings.find(({ keys }) => keys.includes(name));
    if (name === "?") showKeys(bindings);
    else if (!binding || binding.act(event) === false) return;
    event.preventDefault();
    event.stopPropagation(); // the page's own keys rest while the view has the focus
  });
}

/** @param {string} words @param {() => void} close */
const faultWords = (words, close) =>
  h(
    "p",
    { class: "scene-waiting" },
    icon("cloud-off"),
    ` ${words} `,
    h("button", { class: "button small", type: "button", onclick: close }, t("Close")),
  );

/**
 * @param {HTMLElement} root
 * @param {PanelOptions & { onClose: () => void }} options
 * @returns {Promise<Stage | null>}
 */
async function openInside(root, { mission, wanted = null, record = null, player = null, now_ms, onClose }) {
  const { data: detail } = /** @type {Answer<Mission>} */ (await get(`/missions/${mission}`));
  const source = record ? recordSource(record) : (await readSource(detail, wanted)).source;
  if (!source.routes.length) throw new ApiError(t("There is nothing to see yet: plan the mission first."));
  /** @type {Stage | null} */
  let stage = null; // openAddress may be called before the stage is complete
  stage = await openStage(root, {
    mission: { id: mission, name: detail.name },
    source,
    isPanel: true,
    player,
    now_ms,
    onClose,
    openAddress: () => stage?.address() ?? `/missions/${mission}/3d`,
  });
  return stage;
}

/** @param {HTMLElement} frame holds the map @param {PanelOptions} options @returns {Promise<Panel>} */
export async function openPanel(frame, options) {
  const { takesFocus = true, player = null, follow = () => () => {}, onClose = () => {} } = options;
  const waiting = h("p", { class: "scene-waiting" }, t("Reading what there is to see."));
  const root = h("div", { class: "scene-root" }, waiting);
  const element = h("section", { class: "scene-panel", "aria-label": t("3D view") }, root);
  await loadStyles();
  frame.append(element);
  /** @type {Stage | null} */
  let stage = null;
  let unfollow = () => {};

  function close() {
    unfollow();
    stage?.dispose();
    element.remove();
    onClose();
  }

  try {
    stage = await openInside(root, { ...options, onClose: close });
    if (!stage) return { close, stage };
    unfollow = follow(stage);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    root.replaceChildren(faultWords(error.message, close));
    return { close, stage: null };
  }
  listenInside(element, [
    ...sceneKeys(stage, { hasOwnTime: player === null }),
    { keys: ["escape"], words: t("Close the 3D view"), act: close },
  ]);
  if (takesFocus) element.querySelector("canvas")?.focus({ preventScroll: true });
  return { close, stage };
}
