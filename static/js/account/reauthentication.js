/** Reauthentication: asks for the password or a passkey, then continues the act. */

import { ApiError, get, post } from "../api.js";
import { h, icon } from "../dom.js";
import { open } from "../page/keyboard.js";
import { t } from "../text.js";
import { passkeyFault, passkeysWork, usePasskey } from "./webauthn.js";

/** @import { Answer } from "../api.js" */
/** @import { ReauthenticationMethods } from "../api_types.d.ts" */

/**
 * Send a request, and repeat it after a reauthentication if the server requires one. Null where the user cancels.
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
  const { data } = /** @type {Answer<ReauthenticationMethods>} */ (await get("/account/proof"));
  return (await confirm(data)) ? send() : null;
}

/** The way to the identity provider and back to this page. @param {{ address: string }} provider */
function addressOf({ address }) {
  const here = location.pathname + location.search + location.hash;
  return `${address}?${new URLSearchParams({ next: here })}`;
}

/** @param {Pick<ReauthenticationMethods, "has_password" | "single_sign_on">} methods */
function reasonFor({ has_password, single_sign_on }) {
  if (has_password || !single_sign_on) return t("You signed in a while ago, and this could outlive the session.");
  return t("This could outlive the session. {provider} asks you once more, then do it again.", {
    provider: single_sign_on.name,
  });
}

/** @param {ReauthenticationMethods} methods @returns {Promise<boolean>} */
function confirm({ has_password, passkey_options, single_sign_on }) {
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
      h("h2", { id: "proof-title" }, t("Confirm that it is you")),
      h("p", {}, reasonFor({ has_password, single_sign_on })),
      has_password ? h("div", { class: "field" }, h("label", { for: "proof-password" }, t("Password")), input) : null,
      fault,
      h(
        "div",
        { class: "acts" },
        h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Cancel")),
        passkey_options && passkeysWork()
          ? h("button", { type: "button", class: "button", onclick: () => byPasskey() }, t("Use a passkey"))
          : null,
        single_sign_on
          ? h(
              "a",
              { class: has_password ? "button" : "button primary", href: addressOf(single_sign_on) },
              t("Confirm with {provider}", { provider: single_sign_on.name }),
            )
          : null,
        has_password ? h("button", { class: "button primary" }, t("Go on")) : null,
      ),
    );
    /** @type {HTMLDialogElement} */
    const dialog = h("dialog", { "aria-labelledby": "proof-title" }, form);
    let isProved = false;
    dialog.addEventListener("close", () => resolve(isProved));
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      await send({ password: input.value });
      input.focus();
    });

    async function byPasskey() {
      try {
        await send({ passkey: await usePasskey(passkey_options) });
      } catch (error) {
        say(passkeyFault(error) ?? t("The passkey was not accepted. Try again."));
      }
    }

    /** @param {{ password: string } | { passkey: any }} confirmation */
    async function send(confirmation) {
      try {
        await post("/account/proof", confirmation);
      } catch (error) {
        if (!(error instanceof ApiError)) throw error;
        say(error.details?.password?.join(" ") ?? error.message);
        return;
      }
      isProved = true;
      dialog.close();
    }

    /** @param {string} words */
    function say(words) {
      const line = h("p", { class: "field-error", role: "alert" }, icon("circle-alert", "small"), h("span", {}, words));
      fault.replaceChildren(line);
    }

    open(dialog);
  });
}
