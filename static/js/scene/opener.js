/** The button "3D" on a page's map. The view behind it is loaded with the first click: a page without it pays for this alone. */

import { h } from "../dom.js";
import { say } from "../page/toast.js";
import { t } from "../text.js";

/** options() → what openPanel of panel.js takes, or null where there is nothing to see. → { toggle, open, close, isOpen, stage, show(isThere), binding }. */
export function mountSceneOpener(options) {
  const frame = document.querySelector(".map-frame");
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
  frame.querySelector(".map-controls").append(group);
  let panel = null; // a promise
  let stage = null; // of the open panel, once it is there

  async function open({ takesFocus = true } = {}) {
    const asked = options();
    if (!asked) return false;
    close();
    button.setAttribute("aria-pressed", "true");
    frame.classList.add("with-scene");
    const own = import("./panel.js").then(({ openPanel }) =>
      openPanel(frame, {
        ...asked,
        takesFocus,
        onClose() {
          if (panel !== own && panel !== null) return;
          panel = stage = null;
          button.setAttribute("aria-pressed", "false");
          frame.classList.remove("with-scene");
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
      button.setAttribute("aria-pressed", "false");
      frame.classList.remove("with-scene");
      say(t("The 3D view could not be opened."));
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

  const toggle = () => (panel ? close() : (void open(), true));

  return {
    toggle,
    open,
    close,
    isOpen: () => panel !== null,
    /** What is seen, or null while nothing is. */
    stage: () => stage,
    show: (isThere) => (group.hidden = !isThere),
    binding: { keys: ["d"], words: t("3D view, and back"), act: () => toggle() },
  };
}
