/** Change of the password: faults are shown at their field. */

import { ApiError, post } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";

/** @import { Reporter } from "../page/problem.js" */

const FIELDS = ["old_password", "new_password", "once_more"];

/** @param {string} name of a field @param {string} words */
function fault(name, words) {
  const input = byId(name);
  const place = `${name}-fault`;
  input.setAttribute("aria-invalid", "true");
  input.setAttribute("aria-describedby", place);
  input.after(
    h("p", { class: "field-error", id: place, role: "alert" }, icon("circle-alert", "small"), h("span", {}, words)),
  );
  input.focus();
}

function forgetFaults() {
  for (const name of FIELDS) {
    byId(name).removeAttribute("aria-invalid");
    document.getElementById(`${name}-fault`)?.remove();
  }
}

/** @param {Reporter} reporter @param {() => void} onChange tokens may have ended with it */
export function mountPassword({ notify, settle }, onChange) {
  const form = byId("password-form", HTMLFormElement);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    forgetFaults();
    const [old_password, new_password, once_more] = FIELDS.map((name) => byId(name, HTMLInputElement).value);
    if (!old_password) fault("old_password", t("Type the password that you have now."));
    else if (!new_password) fault("new_password", t("Type a new password."));
    else if (new_password !== once_more) fault("once_more", t("The two are not the same."));
    else await change({ old_password, new_password, end_tokens: byId("end_tokens", HTMLInputElement).checked });
  });

  /** @param {{ old_password: string, new_password: string, end_tokens: boolean }} passwords */
  async function change(passwords) {
    try {
      await post("/account/password", passwords);
    } catch (error) {
      const faults = error instanceof ApiError ? Object.entries(error.details ?? {}) : [];
      const [name, words] = faults.find(([place]) => FIELDS.includes(place)) ?? [];
      if (name) fault(name, words.join(" "));
      else notify(t("The password is not changed."), error);
      return;
    }
    settle();
    form.reset();
    onChange();
    toast(t("The password is changed. Other browsers are signed out."));
  }
}
