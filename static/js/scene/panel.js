/** The 3D view over the lower half of a page's map: the same view as on the page of its own. */

import { ApiError, get } from "../api.js";
import { h, icon } from "../dom.js";
import { keyName, showKeys } from "../page/keyboard.js";
import { staticAddress } from "../static_address.js";
import { t } from "../text.js";
import { sceneKeys } from "./keys.js";
import { readSource } from "./sources/read.js";
import { recordSource } from "./sources/record_source.js";
import { openStage } from "./stage.js";

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

/**
 * frame: the element that holds the map. mission: its id; wanted: a source of link.js or null for the usual; player: the page's own, or null;
 * record: of report/load.js, where the page has it already; follow(stage) → a function that ends it: for a source that lives. onClose(). takesFocus: the picture.
 */
export async function openPanel(
  frame,
  {
    takesFocus = true,
    mission,
    wanted = null,
    record = null,
    player = null,
    now_ms,
    follow = () => () => {},
    onClose = () => {},
  },
) {
  const root = h(
    "div",
    { class: "scene-root" },
    h("p", { class: "scene-waiting" }, t("Reading what there is to see.")),
  );
  const element = h("section", { class: "scene-panel", "aria-label": t("3D view") }, root);
  await loadStyles();
  frame.append(element);
  let stage = null;
  let unfollow = () => {};

  function close() {
    unfollow();
    stage?.dispose();
    element.remove();
    onClose();
  }

  try {
    const { data: detail } = await get(`/missions/${mission}`);
    const source = record ? recordSource(record) : (await readSource(detail, wanted)).source;
    if (!source.routes.length) throw new ApiError(t("There is nothing to see yet: plan the mission first."));
    stage = await openStage(root, {
      mission: { id: mission, name: detail.name },
      source,
      isPanel: true,
      player,
      now_ms,
      onClose: close,
      openAddress: () => stage?.address() ?? `/missions/${mission}/3d`,
    });
    unfollow = follow(stage);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    root.replaceChildren(
      h(
        "p",
        { class: "scene-waiting" },
        icon("cloud-off"),
        ` ${error.message} `,
        h("button", { class: "button small", type: "button", onclick: close }, t("Close")),
      ),
    );
    return { close, stage: null };
  }
  const bindings = [
    ...sceneKeys(stage, { hasOwnTime: player === null }),
    { keys: ["escape"], words: t("Close the 3D view"), act: () => (close(), true) },
  ];
  element.addEventListener("keydown", (event) => {
    if (
      event.defaultPrevented ||
      event.target.closest("input, select") ||
      document.documentElement.dataset.singleKeys === "off"
    )
      return;
    const name = keyName(event);
    if (name === "?") showKeys(bindings);
    else if (
      bindings.find(({ keys }) => keys.includes(name))?.act(event) === false ||
      !bindings.some(({ keys }) => keys.includes(name))
    )
      return;
    event.preventDefault();
    event.stopPropagation(); // the page's own keys rest while the view has the focus
  });
  if (takesFocus) element.querySelector("canvas")?.focus({ preventScroll: true });
  return { close, stage };
}
