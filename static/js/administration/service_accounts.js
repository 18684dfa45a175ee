/** Service accounts: accounts for programs, their role, whether they are enabled, and their tokens. */

import { ApiError, patch, post } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { menuOf, toggleMenu } from "../page/chrome.js";
import { open } from "../page/keyboard.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { exactText, whenText } from "../units.js";
import { filteredList } from "./filtered_list.js";
import { ROLES, roleOptions } from "./roles.js";
import { showTokens } from "./service_account_tokens.js";

/** @import { Answer } from "../api.js" */
/** @import { Role, ServiceAccount } from "../api_types.d.ts" */
/** @import { MenuItem } from "../page/chrome.js" */
/** @import { Reporter } from "../page/problem.js" */

/** @typedef {Partial<Pick<ServiceAccount, "role" | "is_active">>} Change */

/** @param {Reporter} reporter */
export function mountServiceAccounts(reporter) {
  const accounts = new ServiceAccounts(reporter, () => list.load());
  const list = filteredList({
    list: "service-accounts",
    path: "/service-accounts",
    filters: [],
    row: (/** @type {ServiceAccount} */ account) => accounts.row(account),
    countWords: (count) => tn(count, "{count} service account", "{count} service accounts"),
    none: {
      icon: "key-round",
      title: t("No service accounts"),
      words: t("Add one for a program that is to use the API. It stays when people leave."),
    },
    notify: reporter.notify,
    titleOfFault: t("Service accounts could not be loaded."),
  });
  byId("add-service-account").addEventListener("click", () =>
    askAccount(async (account) => {
      await list.load();
      showTokens(account, () => list.load());
    }),
  );
  return list;
}

/** Rows of service accounts with their acts. */
class ServiceAccounts {
  #notify;
  #settle;
  #reload;

  /** @param {Reporter} reporter @param {() => unknown} reload */
  constructor({ notify, settle }, reload) {
    this.#notify = notify;
    this.#settle = settle;
    this.#reload = reload;
  }

  /** @param {ServiceAccount} account */
  row(account) {
    const { name, username, last_used_at } = account;
    const role = h(
      "select",
      { class: "input", "aria-label": t("Role of {name}", { name }) },
      roleOptions(account.role),
    );
    role.addEventListener("change", () => this.#changeRole(account, /** @type {Role} */ (role.value)));
    const access = account.is_active
      ? h("span", { class: "chip" }, t("Enabled"))
      : h("span", { class: "chip aborted" }, t("Disabled"));
    return h(
      "tr",
      { dataset: { account: account.id }, class: account.is_active ? null : "kept-out" },
      h("td", { class: "name" }, h("strong", {}, name), h("span", { class: "caption" }, username)),
      h("td", { class: "role" }, role),
      h("td", { class: "access" }, access),
      h(
        "td",
        { class: "seen", title: last_used_at && exactText(last_used_at) },
        h("span", { class: "phone-label" }, `${t("Last used")}: `),
        last_used_at ? whenText(last_used_at) : t("never"),
      ),
      h("td", { class: "number tokens" }, account.valid_tokens ? `${account.valid_tokens}` : "—"),
      h("td", {}, this.#menuButton(account)),
    );
  }

  /** @param {ServiceAccount} account */
  #menuButton(account) {
    const label = t("More for {name}", { name: account.name });
    const look = { type: "button", class: "icon-button", "aria-label": label };
    const more = h("button", { ...look, "aria-haspopup": "true", "aria-expanded": "false" }, icon("ellipsis"));
    more.addEventListener("click", (event) => {
      event.stopPropagation();
      toggleMenu(more, () => menuOf(account.name, this.#acts(account)));
    });
    return more;
  }

  /** @param {ServiceAccount} account @returns {MenuItem[]} */
  #acts(account) {
    const { name, is_active } = account;
    const disabled = t("{name} is disabled: none of its tokens works.", { name });
    const words = is_active ? disabled : t("{name} is enabled.", { name });
    const change = () => this.#send(account, { is_active: !is_active }, words);
    return [
      { icon: "key-round", label: t("Tokens"), act: () => showTokens(account, this.#reload) },
      is_active
        ? { icon: "circle-x", label: t("Disable"), act: change }
        : { icon: "check", label: t("Enable"), act: change },
    ];
  }

  /** @param {ServiceAccount} account @param {Role} role */
  #changeRole(account, role) {
    const words = t("{name} has the role {role} now.", { name: account.name, role: ROLES[role] });
    return this.#send(account, { role }, words, "select");
  }

  /** @param {ServiceAccount} account @param {Change} values @param {string} words @param {string} [focus] */
  async #send(account, values, words, focus = ".icon-button") {
    let now = account;
    try {
      const headers = { "If-Match": `"${account.revision}"` };
      const answer = /** @type {Answer<ServiceAccount>} */ (
        await patch(`/service-accounts/${account.id}`, values, { headers })
      );
      now = answer.data;
      this.#settle();
      toast(words);
    } catch (error) {
      if (error instanceof ApiError && error.details?.current) now = error.details.current;
      this.#notify(t("Nothing was changed."), error);
    }
    const fresh = this.row(now);
    document.querySelector(`#service-accounts-rows [data-account="${account.id}"]`)?.replaceWith(fresh);
    /** @type {HTMLElement | null} */ (fresh.querySelector(focus))?.focus({ preventScroll: true });
  }
}

/** @param {(account: ServiceAccount) => void} made */
function askAccount(made) {
  const fault = h("div", {});
  const name = h("input", {
    class: "input",
    id: "service-name",
    maxlength: 60,
    autocomplete: "off",
    spellcheck: false,
  });
  const role = h("select", { class: "input", id: "service-role" }, roleOptions("operator"));
  const close = () => dialog.close();
  const form = h(
    "form",
    { class: "stack", novalidate: true },
    h("h2", { id: "service-title" }, t("Add a service account")),
    h(
      "div",
      { class: "field" },
      h("label", { for: "service-name" }, t("Name")),
      name,
      h("p", { class: "caption" }, t("Letters, digits, dots, hyphens and underscores. The history names it by this.")),
    ),
    h("div", { class: "field" }, h("label", { for: "service-role" }, t("Role")), role),
    fault,
    h(
      "div",
      { class: "acts" },
      h("button", { type: "button", class: "button", onclick: close }, t("Cancel")),
      h("button", { class: "button primary" }, t("Add")),
    ),
  );
  /** @type {HTMLDialogElement} */
  const dialog = h("dialog", { "aria-labelledby": "service-title" }, form);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    try {
      const body = { name: name.value.trim(), role: role.value };
      const { data } = /** @type {Answer<ServiceAccount>} */ (await post("/service-accounts", body));
      dialog.close();
      made(data);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      fault.replaceChildren(
        h("p", { class: "field-error", role: "alert" }, icon("circle-alert", "small"), h("span", {}, error.message)),
      );
    }
  });
  open(dialog);
}
