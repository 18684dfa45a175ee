/** One's own passkeys: list, add, remove. */

import { get, post, remove } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { exactText, whenText } from "../units.js";
import { proved } from "./reauthentication.js";
import { browserName } from "./sign_in_row.js";
import { createPasskey, passkeyFault, passkeysWork } from "./webauthn.js";

/** @import { Answer } from "../api.js" */
/** @import { Passkey, PasskeyList, PasskeyOptions } from "../api_types.d.ts" */
/** @import { Reporter } from "../page/problem.js" */

/** @param {Reporter} reporter */
export function mountPasskeys({ notify, settle }) {
  const form = byId("passkey-form", HTMLFormElement);
  const name = byId("passkey_name", HTMLInputElement);
  const fault = byId("passkey-fault");
  form.hidden = !passkeysWork();
  byId("passkeys-unavailable").hidden = passkeysWork();
  name.value = browserName(navigator.userAgent);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    void add();
  });

  async function load() {
    try {
      const { data } = /** @type {Answer<PasskeyList>} */ (await get("/account/passkeys"));
      byId("passkeys").replaceChildren(...data.results.map(row));
      byId("passkeys-none").hidden = data.results.length > 0;
    } catch (error) {
      notify(t("Passkeys could not be loaded."), error);
    }
  }

  /** @param {Passkey} passkey */
  function row(passkey) {
    const made = t("Made {when}", { when: whenText(passkey.created_at) });
    const used = passkey.last_used_at ? t("used {when}", { when: whenText(passkey.last_used_at) }) : t("never used");
    return h(
      "li",
      { dataset: { passkey: passkey.id } },
      icon("key-round"),
      h(
        "div",
        { class: "what" },
        h("strong", {}, passkey.name),
        h("span", { class: "caption", title: exactText(passkey.created_at) }, `${made}, ${used}`),
      ),
      h(
        "button",
        {
          type: "button",
          class: "button quiet",
          "aria-label": t("Remove {name}", { name: passkey.name }),
          onclick: () => takeAway(passkey),
        },
        t("Remove"),
      ),
    );
  }

  async function add() {
    fault.hidden = true;
    try {
      const answer = /** @type {Answer<PasskeyOptions> | null} */ (
        await proved(() => post("/account/passkeys/options"))
      );
      if (!answer) return;
      const passkey = await createPasskey(answer.data.options);
      await post("/account/passkeys", { name: name.value.trim() || browserName(navigator.userAgent), passkey });
    } catch (error) {
      const words = passkeyFault(error);
      if (words === null) notify(t("The passkey is not added."), error);
      else fault.textContent = words;
      fault.hidden = words === null;
      return;
    }
    settle();
    toast(t("The passkey is added. You can sign in with it."));
    await load();
  }

  /** @param {Passkey} passkey */
  async function takeAway(passkey) {
    try {
      if (!(await proved(() => remove(`/account/passkeys/${passkey.id}`)))) return;
    } catch (error) {
      notify(t("The passkey is not removed."), error);
      return;
    }
    settle();
    toast(t("The passkey is removed. Delete it in the device’s password manager, too."));
    await load();
  }

  return { load };
}
