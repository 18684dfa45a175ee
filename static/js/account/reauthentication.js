/** Reauthentication: asks for the password again, then continues the act. */

import { ApiError, post } from "../api.js";
import { h, icon } from "../dom.js";
import { open } from "../page/keyboard.js";
import { t } from "../text.js";

/**
 * Send a request, and repeat it after a password confirmation if the server requires one. Null where the user cancels.
 *
 * @template Result
 * @param {() => Promise<Result>} send
 * @returns {Promise<Result | null>}
 */
export async function proved(send) {
  try {
    return await send();
  } catch (error) {
    if (!(error instanceof ApiError) || error.code !== "password_needed") throw error;
  }
  return (await askForPassword()) ? send() : null;
}

/** @returns {Promise<boolean>} */
function askForPassword() {
  return new Promise((resolve) => {
    const input = h("input", {
      class: "input",
      id: "proof-password",
      type: "password",
      autocomplete: "current-password",
      required: true,
      autofocus: true,
    });
    const fault = h("div", {});
    const form = h(
      "form",
      { class: "stack", novalidate: true },
      h("h2", { id: "proof-title" }, t("Your password, please")),
      h("p", {}, t("You signed in a while ago, and this could outlive the session.")),
      h("div", { class: "field" }, h("label", { for: "proof-password" }, t("Password")), input),
      fault,
      h(
        "div",
        { class: "acts" },
        h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Cancel")),
        h("button", { class: "button primary" }, t("Go on")),
      ),
    );
    /** @type {HTMLDialogElement} */
    const dialog = h("dialog", { "aria-labelledby": "proof-title" }, form);
    let isProved = false;
    dialog.addEventListener("close", () => resolve(isProved));
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      try {
        await post("/account/proof", { password: input.value });
      } catch (error) {
        if (!(error instanceof ApiError)) throw error;
        fault.replaceChildren(
          h(
            "p",
            { class: "field-error", role: "alert" },
            icon("circle-alert", "small"),
            h("span", {}, error.details?.password?.join(" ") ?? error.message),
          ),
        );
        input.focus();
        return;
      }
      isProved = true;
      dialog.close();
    });
    open(dialog);
  });
}
