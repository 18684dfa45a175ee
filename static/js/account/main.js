/** The account: each preference is kept as soon as it is chosen; the password, tokens and sign-ins. */

import { ApiError, get, patch, signInAddress } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { startChrome } from "../page/chrome.js";
import { chooseTheme, chosenTheme, onTheme } from "../page/theme.js";
import { language, localeOf, t } from "../text.js";
import { heightText, lengthText, speedText } from "../units.js";
import { mountPassword } from "./password.js";
import { mountSessions } from "./sessions.js";
import { signInRow } from "./sign_in_row.js";
import { mountTokens } from "./tokens.js";

const WORKS_AFTER_LOADING = ["language", "time_zone", "units"];
const SAMPLE = { length_m: 12_400, height_m: 60, speed_mps: 12 };

startChrome();

function tell(title, error) {
  if (!(error instanceof ApiError)) throw error;
  const way = error.isSignedOut ? h("a", { class: "text-button", href: signInAddress() }, t("Sign in")) : null;
  byId("problem").replaceChildren(
    h(
      "div",
      { class: "notice critical", role: "alert" },
      icon("circle-alert"),
      h("p", {}, h("strong", {}, title), ` ${error.message} `, way),
    ),
  );
  byId("problem").scrollIntoView({ block: "nearest" });
}

function settle() {
  byId("problem").replaceChildren();
}

const valueOf = (control) => (control.type === "checkbox" ? control.checked : control.value);

async function keep(control) {
  const name = control.dataset.keep;
  const saved = byId("saved");
  saved.replaceChildren(t("Saving…"));
  try {
    await patch("/account", { [name]: valueOf(control) });
    settle();
    saved.replaceChildren(icon("check", "small"), t("Saved"));
  } catch (error) {
    saved.replaceChildren();
    tell(t("Not saved."), error);
    return;
  }
  if (name === "single_keys") document.documentElement.dataset.singleKeys = control.checked ? "on" : "off";
  if (WORKS_AFTER_LOADING.includes(name)) {
    history.replaceState(null, "", `#${control.id || name}`);
    location.reload();
  }
}

for (const control of document.querySelectorAll("[data-keep]")) control.addEventListener("change", () => keep(control));

const themes = [...document.querySelectorAll("input[name=theme]")];
for (const radio of themes) radio.addEventListener("change", () => chooseTheme(radio.value));
onTheme(() => themes.forEach((radio) => (radio.checked = radio.value === chosenTheme())));

byId("units-sample").textContent = t("Such as {length}, {height} above ground, {speed}.", {
  length: lengthText(SAMPLE.length_m),
  height: heightText(SAMPLE.height_m),
  speed: speedText(SAMPLE.speed_mps),
});
const browserZone = new Intl.DateTimeFormat().resolvedOptions().timeZone;
byId("browser-zone").textContent = t("As the browser ({zone})", { zone: browserZone });

function showZone() {
  const timeZone = byId("time_zone").value || browserZone;
  const clock = new Date().toLocaleTimeString(localeOf(language), {
    timeZone,
    hour: "2-digit",
    minute: "2-digit",
    timeZoneName: "short",
  });
  byId("zone-sample").textContent = t("It is {time} there.", { time: clock });
}
showZone();

mountPassword({ tell, settle });
const tokens = mountTokens({ tell, settle });
const sessions = mountSessions({ tell, settle });

let nextSignIns = null;
async function loadSignIns(address = "/account/sign-ins?limit=5") {
  try {
    const { data } = await get(address);
    byId("sign-ins").append(...data.results.map((entry) => signInRow(entry)));
    nextSignIns = data.next;
    byId("more-sign-ins").hidden = data.next === null;
  } catch (error) {
    tell(t("Sign-ins could not be loaded."), error);
  }
}

byId("more-sign-ins").addEventListener("click", () => loadSignIns(nextSignIns));
Promise.all([tokens.load(), sessions.load(), loadSignIns()]).then(() => {
  document.documentElement.dataset.loaded = "true";
  if (location.hash) document.getElementById(location.hash.slice(1))?.focus({ preventScroll: false });
});
