/** Administration: people, invitations and the log of sign-ins, each a list with filters; and the organisation's rules. */

import { ApiError, signInAddress } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { startChrome } from "../page/chrome.js";
import { t } from "../text.js";
import { mountInvitations } from "./invitations.js";
import { mountPeople } from "./people.js";
import { mountRules } from "./rules.js";
import { mountSignIns } from "./sign_ins.js";

const TABS = ["people", "invitations", "sign-ins", "rules"];

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
}

function settle() {
  byId("problem").replaceChildren();
}

const lists = {
  people: mountPeople({ tell, settle }),
  invitations: mountInvitations({ tell, settle, show: () => showTab("invitations") }),
  "sign-ins": mountSignIns({ tell, settle }),
  rules: mountRules({ tell, settle }),
};

/** The tab is in the address: it can be sent, and Back works. */
function showTab(name, { isNew = true } = {}) {
  for (const tab of TABS) byId(`tab-${tab}`).hidden = tab !== name;
  document.querySelector(`input[name=tab][value=${name}]`).checked = true;
  if (isNew && tabInAddress() !== name)
    history.pushState(null, "", name === "people" ? location.pathname : `?tab=${name}`);
  settle();
  return lists[name].load();
}

function tabInAddress() {
  const name = new URLSearchParams(location.search).get("tab");
  return TABS.includes(name) ? name : "people";
}

startChrome({
  bindings: [{ keys: ["/"], words: t("Find"), act: () => document.getElementById(`${tabInAddress()}-text`)?.focus() }],
});
for (const radio of document.querySelectorAll("input[name=tab]"))
  radio.addEventListener("change", () => showTab(radio.value));
addEventListener("popstate", () => showTab(tabInAddress(), { isNew: false }));
byId("invite").addEventListener("click", lists.invitations.invite);
showTab(tabInAddress(), { isNew: false }).then(() => (document.documentElement.dataset.loaded = "true"));
