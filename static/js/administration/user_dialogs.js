/** Dialogs about one user: name and address, and a confirmation before rights are removed. */

import { ApiError } from "../api.js";
import { h, icon } from "../dom.js";
import { open } from "../page/keyboard.js";
import { t } from "../text.js";

/** @import { User } from "../api_types.d.ts" */
/** @import { UserChange } from "./users.js" */

/** @param {{ title: string, words: string, keep: string, go: string, act: () => unknown }} question */
export function confirmRemoval({ title, words, keep, go, act }) {
  const doIt = () => {
    dialog.close();
    act();
  };
  /** @type {HTMLDialogElement} */
  const dialog = h(
    "dialog",
    { "aria-labelledby": "ask-title" },
    h("h2", { id: "ask-title" }, title),
    h("p", {}, words),
    h(
      "form",
      { method: "dialog", class: "acts" },
      h("button", { class: "button", autofocus: true }, keep),
      h("button", { type: "button", class: "button danger filled", onclick: doIt }, go),
    ),
  );
  open(dialog);
}

/**
 * Edit name and address. Another user's change in the meantime is shown in the row, and then counts as seen.
 *
 * @param {User} user
 * @param {object} on
 * @param {(user: User, values: UserChange) => Promise<User>} on.send
 * @param {(user: User) => void} on.redraw
 * @param {(changed: User) => void} on.done
 */
export function editUser(user, { send, redraw, done }) {
  let current = user;
  const first = inputOf("first_name", user.first_name, { maxlength: 150 });
  const last = inputOf("last_name", user.last_name, { maxlength: 150 });
  const email = inputOf("email", user.email, { type: "email", maxlength: 254 });
  const fault = h("div", {});
  const close = () => dialog.close();
  const form = h(
    "form",
    { class: "stack", novalidate: true },
    h("h2", { id: "user-title" }, user.username),
    h("div", { class: "pair" }, field(t("First name"), first), field(t("Last name"), last)),
    field(t("E-mail address"), email),
    fault,
    h(
      "div",
      { class: "acts" },
      h("button", { type: "button", class: "button", onclick: close }, t("Cancel")),
      h("button", { class: "button primary" }, t("Save")),
    ),
  );
  /** @type {HTMLDialogElement} */
  const dialog = h("dialog", { "aria-labelledby": "user-title" }, form);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    const values = { first_name: first.value.trim(), last_name: last.value.trim(), email: email.value.trim() };
    try {
      const changed = await send(current, values);
      dialog.close();
      done(changed);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      if (error.details?.current) {
        current = error.details.current;
        redraw(current);
      }
      fault.replaceChildren(
        h("p", { class: "field-error", role: "alert" }, icon("circle-alert", "small"), h("span", {}, error.message)),
      );
    }
  });
  open(dialog);
}

/** @param {string} label @param {HTMLElement} input */
const field = (label, input) => h("div", { class: "field" }, h("label", { for: input.id }, label), input);

/** @param {string} name @param {string} value @param {object} properties */
const inputOf = (name, value, properties) =>
  h("input", { class: "input", id: `user-${name}`, value, autocomplete: "off", ...properties });
