/** The account: each preference is kept as soon as it is chosen; the password, tokens and sign-ins. */

import { get, patch, post } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { startChrome } from "../page/chrome.js";
import { notify, settle } from "../page/problem.js";
import { chooseTheme, chosenTheme, onTheme } from "../page/theme.js";
import { locale, t } from "../text.js";
import { heightText, lengthText, speedText } from "../units.js";
import { mountJobs } from "./jobs.js";
import { mountPasskeys } from "./passkeys.js";
import { mountPassword } from "./password.js";
import { mountSessions } from "./sessions.js";
import { signInRow } from "./sign_in_row.js";
import { mountTokens } from "./tokens.js";

/** @import { Answer } from "../api.js" */
/** @import { SignInPage, VerificationMail } from "../api_types.d.ts" */

const WORKS_AFTER_LOADING = ["language", "time_zone", "units"];
const SAMPLE = { length_m: 12_400, height_m: 60, speed_mps: 12 };

startChrome();

/** @typedef {HTMLInputElement | HTMLSelectElement} Control */

/** @param {Control} control */
const isOn = (control) => control instanceof HTMLInputElement && control.checked;
/** @param {Control} control */
const preferenceOf = (control) => (control.type === "checkbox" ? isOn(control) : control.value);

/** Store the preference of a control. @param {Control} control */
async function keep(control) {
  const name = control.dataset.keep ?? "";
  const saved = byId("saved");
  saved.replaceChildren(t("Saving…"));
  try {
    await patch("/account", { [name]: preferenceOf(control) });
    settle();
    saved.replaceChildren(icon("check", "small"), t("Saved"));
  } catch (error) {
    saved.replaceChildren();
    notify(t("Not saved."), error);
    return;
  }
  if (name === "single_keys") document.documentElement.dataset.singleKeys = isOn(control) ? "on" : "off";
  if (WORKS_AFTER_LOADING.includes(name)) {
    history.replaceState(null, "", `#${control.id || name}`);
    location.reload();
  }
}

/** @type {NodeListOf<Control>} */
const controls = document.querySelectorAll("[data-keep]");
for (const control of controls) control.addEventListener("change", () => keep(control));

/** @type {NodeListOf<HTMLInputElement>} */
const themes = document.querySelectorAll("input[name=theme]");
for (const radio of themes) radio.addEventListener("change", () => chooseTheme(radio.value));
onTheme(() => {
  for (const radio of themes) radio.checked = radio.value === chosenTheme();
});

byId("units-sample").textContent = t("Such as {length}, {height} above ground, {speed}.", {
  length: lengthText(SAMPLE.length_m),
  height: heightText(SAMPLE.height_m),
  speed: speedText(SAMPLE.speed_mps),
});
const ofOrganisation = byId("browser-zone").dataset.zone;
const usualZone = ofOrganisation || new Intl.DateTimeFormat().resolvedOptions().timeZone;
byId("browser-zone").textContent = ofOrganisation
  ? t("As the organisation ({zone})", { zone: ofOrganisation })
  : t("As the browser ({zone})", { zone: usualZone });

function showZone() {
  const timeZone = byId("time_zone", HTMLSelectElement).value || usualZone;
  const clock = new Date().toLocaleTimeString(locale, {
    timeZone,
    hour: "2-digit",
    minute: "2-digit",
    timeZoneName: "short",
  });
  byId("zone-sample").textContent = t("It is {time} there.", { time: clock });
}
showZone();

const tokens = mountTokens({ notify, settle });
if (document.getElementById("password-form")) mountPassword({ notify, settle }, () => void tokens.load());
const passkeys = document.getElementById("passkeys") ? mountPasskeys({ notify, settle }) : null;
const sessions = mountSessions({ notify, settle });
const jobs = mountJobs({ notify, settle });

document.getElementById("verify-address")?.addEventListener("click", async () => {
  try {
    const { data } = /** @type {Answer<VerificationMail>} */ (await post("/account/email-address/verification"));
    settle();
    const words = data.was_mailed
      ? t("The link is mailed. It works for three days.")
      : t("The mail could not be sent.");
    byId("verification").replaceChildren(h("p", { class: "caption", role: "status" }, words));
  } catch (error) {
    notify(t("The mail could not be sent."), error);
  }
});

/** @type {string | null} */
let nextSignIns = null;
async function loadSignIns(address = "/account/sign-ins?limit=5") {
  try {
    const { data } = /** @type {Answer<SignInPage>} */ (await get(address));
    byId("sign-ins").append(...data.results.map((entry) => signInRow(entry)));
    nextSignIns = data.next;
    byId("more-sign-ins").hidden = data.next === null;
  } catch (error) {
    notify(t("Sign-ins could not be loaded."), error);
  }
}

byId("more-sign-ins").addEventListener("click", () => nextSignIns && loadSignIns(nextSignIns));
Promise.all([tokens.load(), jobs.load(), sessions.load(), passkeys?.load(), loadSignIns()]).then(() => {
  document.documentElement.dataset.loaded = "true";
  if (location.hash) document.getElementById(location.hash.slice(1))?.focus({ preventScroll: false });
});
