/** The button "3D" on a page's map. The view behind it is loaded with the first click: a page without it pays for this alone. */

import { find, h } from "../dom.js";
import { announce } from "../page/toast.js";
import { t } from "../text.js";

/** @import { Panel, PanelOptions } from "./panel.js" */
/** @import { Stage } from "./stage.js" */

/** @typedef {ReturnType<typeof mountSceneOpener>} SceneOpener */

/**
 * @param {() => Omit<PanelOptions, "onClose" | "takesFocus"> | null | undefined | false} options what the panel shows, or null where there is nothing to see
 */
export function mountSceneOpener(options) {
  const frame = find(document, ".map-frame", HTMLElement);
  const button = h(
    "button",
    {
      class: "icon-button scene-open",
      type: "button",
      "aria-pressed": "false",
      "aria-label": t("3D view"),
      title: `${t("3D view")} (D)`,
      onclick: () => void toggle(),
    },
    h("b", {}, "3D"),
  );
  const group = h("div", { class: "control-group" }, button);
  find(frame, ".map-controls").append(group);
  /** @type {Promise<Panel> | null} */
  let panel = null;
  /** @type {Stage | null} of the open panel, once it is there */
  let stage = null;

  /** @param {boolean} isOpen */
  function showOpen(isOpen) {
    button.setAttribute("aria-pressed", String(isOpen));
    frame.classList.toggle("with-scene", isOpen);
  }

  async function open({ takesFocus = true } = {}) {
    const asked = options();
    if (!asked) return false;
    close();
    showOpen(true);
    const own = import("/static/js/scene/panel.js").then(({ openPanel }) =>
      openPanel(frame, {
        ...asked,
        takesFocus,
        onClose() {
          if (panel !== own && panel !== null) return;
          panel = stage = null;
          showOpen(false);
          button.focus({ preventScroll: true });
        },
      }),
    );
    panel = own;
    try {
      const opened = await own;
      if (panel === own) stage = opened.stage;
      return opened;
    } catch (error) {
      if (panel === own) panel = null;
      showOpen(false);
      announce(t("The 3D view could not be opened."));
      throw error;
    }
  }

  function close() {
    const open_ = panel;
    panel = stage = null;
    void open_?.then(
      ({ close: end }) => end(),
      () => {},
    );
    return open_ !== null;
  }

  function toggle() {
    if (panel) return close();
    void open();
    return true;
  }

  return {
    toggle,
    open,
    close,
    isOpen: () => panel !== null,
    /** The open stage, or null. */
    stage: () => stage,
    /** @param {boolean} isThere */
    show(isThere) {
      group.hidden = !isThere;
    },
    binding: { keys: ["d"], words: t("3D view, and back"), act: () => toggle() },
  };
}
