/** Signing out deletes a user's data in this browser; unsaved changes are reported first. */

import { h } from "../dom.js";
import { t, tn } from "../text.js";
import { open } from "./keyboard.js";
import { draftsOf, forget } from "./left_behind.js";

/** Events of the window: keep what has just been changed; and keep nothing more. */
export const KEEP_NOW = "spanwise-keep-now";
export const KEEP_NO_MORE = "spanwise-keep-no-more";

/**
 * The sign-out form of the menu: sent at once where there are no unsaved changes.
 *
 * @param {HTMLFormElement} form
 * @param {number | string} user
 */
export function askBeforeSigningOut(form, user) {
  form.addEventListener("submit", (event) => {
    dispatchEvent(new Event(KEEP_NOW));
    const drafts = draftsOf(user);
    if (drafts === 0) {
      leave(user);
      return;
    }
    event.preventDefault();
    ask(drafts, (keepsDrafts) => {
      leave(user, keepsDrafts);
      form.hidden = true;
      document.body.append(form); // its menu has closed meanwhile
      form.submit();
    });
  });
}

/** @param {number | string} user @param {boolean} [keepsDrafts] */
function leave(user, keepsDrafts = false) {
  dispatchEvent(new Event(KEEP_NO_MORE));
  forget(user, { keepsDrafts });
}

/** @param {number} drafts @param {(keepsDrafts: boolean) => void} signOut */
function ask(drafts, signOut) {
  /** @param {boolean} keepsDrafts */
  const answer = (keepsDrafts) => () => {
    dialog.close();
    signOut(keepsDrafts);
  };
  /** @type {HTMLDialogElement} */
  const dialog = h(
    "dialog",
    { "aria-labelledby": "drafts-title" },
    h(
      "h2",
      { id: "drafts-title" },
      tn(drafts, "{count} draft is not saved on the server", "{count} drafts are not saved on the server"),
    ),
    h(
      "p",
      {},
      t(
        "Drafts are in this browser alone. Whoever uses this computer after you could find them; what you keep comes back when you sign in here again.",
      ),
    ),
    h(
      "form",
      { method: "dialog", class: "acts" },
      h("button", { class: "button", autofocus: true }, t("Stay signed in")),
      h("button", { type: "button", class: "button", onclick: answer(true) }, t("Keep here")),
      h("button", { type: "button", class: "button danger filled", onclick: answer(false) }, t("Delete")),
    ),
  );
  open(dialog);
}
