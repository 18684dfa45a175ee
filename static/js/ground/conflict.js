/** Another user's faster change: both versions side by side, and none is overwritten unseen. */

import { h } from "../dom.js";
import { t } from "../text.js";
import { clockText } from "../units.js";
import { differences } from "./history_list.js";

/** @import { Facts } from "./types.d.ts" */

/** @param {string[][]} rows name, words */
const list = (rows) =>
  h(
    "dl",
    { class: "conflict-facts" },
    rows.map(([name, words]) => h("div", {}, h("dt", {}, name), h("dd", {}, words))),
  );

/**
 * Ask which version to keep. Resolves to null where the user continues editing.
 *
 * @param {object} versions facts under the same names
 * @param {string} versions.changed_by
 * @param {string | null} versions.changed_at
 * @param {Facts | null} versions.seen
 * @param {Facts | null} versions.mine
 * @param {Facts | null} versions.theirs null where it was deleted
 * @returns {Promise<"theirs" | "mine" | null>}
 */
export function askWhich({ changed_by, changed_at, seen, mine, theirs }) {
  return new Promise((resolve) => {
    /** @param {"theirs" | "mine" | null} which */
    const answer = (which) => () => {
      dialog.close();
      dialog.remove();
      resolve(which);
    };
    /** @type {HTMLDialogElement} */
    const dialog = h(
      "dialog",
      { "aria-labelledby": "conflict-title" },
      h(
        "h2",
        { id: "conflict-title" },
        changed_at
          ? t("Changed by {name} at {time}", { name: changed_by, time: clockText(changed_at) })
          : t("Changed by {name}", { name: changed_by }),
      ),
      h("p", {}, theirs ? t("Nothing of yours is stored yet.") : t("It was deleted. Nothing of yours is stored.")),
      theirs && [
        h("h3", {}, t("Their changes")),
        list(differences(seen, theirs)),
        h("h3", {}, t("Your changes")),
        list(differences(theirs, mine)),
      ],
      h(
        "div",
        { class: "acts" },
        h("button", { type: "button", class: "button", onclick: answer(null) }, t("Go on editing")),
        h("button", { type: "button", class: "button", onclick: answer("theirs") }, t("Use theirs")),
        theirs && h("button", { type: "button", class: "button danger", onclick: answer("mine") }, t("Overwrite")),
      ),
    );
    dialog.addEventListener("cancel", (event) => {
      event.preventDefault();
      answer(null)();
    });
    document.body.append(dialog);
    dialog.showModal();
    dialog.querySelector("button")?.focus();
  });
}
