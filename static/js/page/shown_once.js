/** A secret that is shown once, with a button that copies it. */

import { h, icon } from "../dom.js";
import { t } from "../text.js";
import { copyText } from "./clipboard.js";
import { announce, toast } from "./toast.js";

/** @param {{ title: string, secret: string, label: string, more?: import("../dom.js").Child }} what */
export function shownOnce({ title, secret, label, more = null }) {
  const code = h("code", { tabindex: "0", role: "textbox", "aria-readonly": "true", "aria-label": label }, secret);
  const copy = h("button", { type: "button", class: "button" }, icon("copy", "small"), t("Copy"));
  copy.addEventListener("click", async () => {
    if (await copyText(secret)) {
      toast(t("Copied."));
      return;
    }
    getSelection()?.selectAllChildren(code);
    announce(t("It is selected. Copy it with Ctrl+C."));
  });
  return h(
    "div",
    { class: "once", role: "group", "aria-label": label },
    h("strong", {}, title),
    h("div", { class: "secret" }, code, copy),
    more,
  );
}
