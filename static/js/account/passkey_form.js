/** Sign-in with a passkey: its response is sent by the form. The options are in the page, or are fetched on submit. */

import { byId } from "../dom.js";
import { t } from "../text.js";
import { passkeyFault, passkeysWork, usePasskey } from "./webauthn.js";

const form = byId("passkey-form", HTMLFormElement);
const fault = /** @type {HTMLElement} */ (form.querySelector(".field-error"));
const credential = /** @type {HTMLInputElement} */ (form.elements.namedItem("credential"));

form.hidden = !passkeysWork();
form.addEventListener("submit", async (event) => {
  event.preventDefault();
  fault.hidden = true;
  try {
    credential.value = JSON.stringify(await usePasskey(await options()));
  } catch (error) {
    fault.textContent = passkeyFault(error) ?? t("The server did not answer. Try again.");
    fault.hidden = false;
    return;
  }
  form.submit();
});

document.documentElement.dataset.loaded = "true";

async function options() {
  const inPage = document.getElementById("passkey-options");
  if (inPage) return JSON.parse(inPage.textContent ?? "");
  const response = await fetch(form.dataset.options ?? "", { headers: { Accept: "application/json" } });
  if (!response.ok) throw new Error(`challenge: ${response.status}`);
  return response.json();
}
