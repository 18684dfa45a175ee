/** Changing the password: faults stand at the field that they are about. */

import { ApiError, post } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";

const FIELDS = ["old_password", "new_password", "once_more"];

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

export function mountPassword({ tell, settle }) {
  byId("password-form").addEventListener("submit", async (event) => {
    event.preventDefault();
    forgetFaults();
    const [old_password, new_password, once_more] = FIELDS.map((name) => byId(name).value);
    if (!old_password) return fault("old_password", t("Type the password that you have now."));
    if (!new_password) return fault("new_password", t("Type a new password."));
    if (new_password !== once_more) return fault("once_more", t("The two are not the same."));
    try {
      await post("/account/password", { old_password, new_password });
    } catch (error) {
      const faults = error instanceof ApiError ? Object.entries(error.details ?? {}) : [];
      const [name, words] = faults.find(([place]) => FIELDS.includes(place)) ?? [];
      if (name) return fault(name, words.join(" "));
      return tell(t("The password is not changed."), error);
    }
    settle();
    byId("password-form").reset();
    toast(t("The password is changed. Other browsers are signed out."));
  });
}
