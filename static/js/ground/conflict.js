/** Somebody else was faster: both versions side by side, and nothing is overwritten unseen. */

import { h } from "../dom.js";
import { clockText } from "../units.js";
import { differences } from "./history_list.js";

/** Resolves to "theirs", "mine" or null (look again). `mine` and `theirs` are facts under the same names. */
export function askWhich({ changed_by, changed_at, mine, theirs }) {
  return new Promise((resolve) => {
    const rows = differences(theirs, mine);
    const answer = (which) => () => {
      dialog.close();
      dialog.remove();
      resolve(which);
    };
    const dialog = h(
      "dialog",
      { "aria-labelledby": "conflict-title" },
      h("h2", { id: "conflict-title" }, `Changed by ${changed_by}${changed_at ? ` at ${clockText(changed_at)}` : ""}`),
      h("p", {}, theirs ? "Nothing of yours was stored yet. Theirs → yours:" : "It was taken off the ground. Nothing of yours was stored."),
      h("dl", { class: "conflict-facts" }, rows.map(([name, words]) => h("div", {}, h("dt", {}, name), h("dd", {}, words)))),
      h(
        "div",
        { class: "acts" },
        h("button", { type: "button", class: "button", onclick: answer(null) }, "Go on editing"),
        h("button", { type: "button", class: "button", onclick: answer("theirs") }, "Take theirs"),
        theirs && h("button", { type: "button", class: "button danger", onclick: answer("mine") }, "Store mine over it"),
      ),
    );
    dialog.addEventListener("cancel", (event) => (event.preventDefault(), answer(null)()));
    document.body.append(dialog);
    dialog.showModal();
    dialog.querySelector("button").focus();
  });
}
