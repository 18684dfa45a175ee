/** Administration: users, invitations, service accounts and the log of sign-ins, each a list with filters; and the organisation's rules. */

import { byId, find } from "../dom.js";
import { startChrome } from "../page/chrome.js";
import { notify, settle } from "../page/problem.js";
import { t } from "../text.js";
import { mountInvitations } from "./invitations.js";
import { mountOrganisation } from "./organisation.js";
import { mountRules } from "./rules.js";
import { mountServiceAccounts } from "./service_accounts.js";
import { mountSignIns } from "./sign_ins.js";
import { mountUsers } from "./users.js";

/** @typedef {"users" | "invitations" | "service-accounts" | "sign-ins" | "organisation" | "rules"} Tab */

/** @type {Tab[]} */
const TABS = ["users", "invitations", "service-accounts", "sign-ins", "organisation", "rules"];

const lists = {
  users: mountUsers({ notify, settle }),
  invitations: mountInvitations({ notify, settle, show: () => showTab("invitations") }),
  "service-accounts": mountServiceAccounts({ notify, settle }),
  "sign-ins": mountSignIns({ notify }),
  organisation: mountOrganisation({ notify, settle }),
  rules: mountRules({ notify, settle }),
};

/**
 * Shows a tab. It is in the address: it can be sent, and Back works.
 *
 * @param {Tab} name
 * @param {{ isNew?: boolean }} [how]
 * @returns {Promise<void>}
 */
function showTab(name, { isNew = true } = {}) {
  for (const tab of TABS) byId(`tab-${tab}`).hidden = tab !== name;
  find(document, `input[name=tab][value=${name}]`, HTMLInputElement).checked = true;
  if (isNew && tabInAddress() !== name)
    history.pushState(null, "", name === "users" ? location.pathname : `?tab=${name}`);
  settle();
  return lists[name].load();
}

function tabInAddress() {
  const name = new URLSearchParams(location.search).get("tab");
  return TABS.find((tab) => tab === name) ?? "users";
}

startChrome({
  bindings: [{ keys: ["/"], words: t("Find"), act: () => document.getElementById(`${tabInAddress()}-text`)?.focus() }],
});
for (const tab of TABS) find(document, `input[name=tab][value=${tab}]`).addEventListener("change", () => showTab(tab));
addEventListener("popstate", () => showTab(tabInAddress(), { isNew: false }));
byId("invite").addEventListener("click", () => lists.invitations.invite());
await showTab(tabInAddress(), { isNew: false });
document.documentElement.dataset.loaded = "true";
