/** The tokens of a service account, in a dialog: made with scopes and an end, shown once, revoked. */

import { proved } from "../account/reauthentication.js";
import { SCOPES, tokenRow } from "../account/tokens.js";
import { ApiError, get, post, remove } from "../api.js";
import { h, icon } from "../dom.js";
import { open } from "../page/keyboard.js";
import { shownOnce } from "../page/shown_once.js";
import { t } from "../text.js";

/** @import { Answer } from "../api.js" */
/** @import { NewToken, ServiceAccount, Token, TokenList } from "../api_types.d.ts" */

/** @typedef {keyof typeof SCOPES} Scope */

/** @type {Record<ServiceAccount["role"], Scope[]>} */
const SCOPES_OF_ROLE = {
  viewer: ["read"],
  operator: ["read", "plan", "fly"],
  curator: ["read", "curate"],
  administrator: ["read", "plan", "fly", "curate", "administer"],
};
const DAYS = [7, 30, 90, 365];

/** @param {ServiceAccount} account @param {() => unknown} changed called after a token was made or revoked */
export function showTokens(account, changed) {
  const path = `/service-accounts/${account.id}/tokens`;
  const fault = h("div", {});
  const made = h("div", {});
  const rows = h("ul", { class: "rows", "aria-label": t("Tokens") });
  const { form, name, read } = tokenForm(account);
  const close = h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Close"));
  /** @type {HTMLDialogElement} */
  const dialog = h(
    "dialog",
    { class: "service-tokens", "aria-labelledby": "tokens-title" },
    h(
      "div",
      { class: "stack" },
      h("h2", { id: "tokens-title" }, t("Tokens of {name}", { name: account.name })),
      form,
      fault,
      made,
      rows,
      h("div", { class: "acts" }, close),
    ),
  );

  /** @param {() => Promise<unknown>} act */
  async function tried(act) {
    try {
      await act();
      fault.replaceChildren();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      fault.replaceChildren(
        h("p", { class: "field-error", role: "alert" }, icon("circle-alert", "small"), h("span", {}, error.message)),
      );
    }
  }

  async function load() {
    const { data } = /** @type {Answer<TokenList>} */ (await get(path));
    rows.replaceChildren(...data.results.map((token) => tokenRow(token, () => tried(() => revoke(token)))));
  }

  /** @param {Token} token */
  async function revoke(token) {
    await remove(`${path}/${token.id}`);
    made.replaceChildren();
    await load();
    changed();
    name.focus();
  }

  async function make() {
    const answer = /** @type {Answer<NewToken> | null} */ (await proved(() => post(path, read())));
    if (answer === null) return;
    const title = t("“{name}” is made. Copy it now: it is not shown again.", { name: answer.data.name });
    made.replaceChildren(shownOnce({ title, secret: answer.data.token, label: t("Token") }));
    made.querySelector("button")?.focus();
    form.reset();
    await load();
    changed();
  }

  form.addEventListener("submit", (event) => {
    event.preventDefault();
    tried(make);
  });
  open(dialog);
  tried(load);
}

/** @param {ServiceAccount} account */
function tokenForm({ role }) {
  const name = h("input", {
    class: "input",
    id: "service-token-name",
    maxlength: 100,
    autocomplete: "off",
    placeholder: t("What it is for"),
  });
  const days = h(
    "select",
    { class: "input", id: "service-token-days" },
    DAYS.map((number) => h("option", { value: number, selected: number === 90 }, t("{days} days", { days: number }))),
  );
  const scopes = SCOPES_OF_ROLE[role].map((scope) => h("input", { type: "checkbox", name: "scope", value: scope }));
  scopes[0].defaultChecked = true; // to read, also after the form is reset
  const labels = scopes.map((input) =>
    h("label", { class: "switch-line" }, input, h("span", {}, SCOPES[/** @type {Scope} */ (input.value)])),
  );
  const form = h(
    "form",
    { class: "token-form", novalidate: true },
    h("div", { class: "field" }, h("label", { for: "service-token-name" }, t("Name")), name),
    h("div", { class: "field" }, h("label", { for: "service-token-days" }, t("Expires after")), days),
    h("fieldset", { class: "token-scopes" }, h("legend", {}, t("May")), labels),
    h("button", { class: "button primary" }, t("Create token")),
  );
  const read = () => ({
    name: name.value.trim(),
    days: Number(days.value),
    scopes: scopes.filter(({ checked }) => checked).map(({ value }) => value),
  });
  return { form, name, read };
}
