/** Tokens: made with a name and an end, shown once, revoked. */

import { ApiError, get, post, remove } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { shownOnce } from "../page/shown_once.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { dayText, exactText, whenText } from "../units.js";
import { proved } from "./reauthentication.js";

/** @import { Answer } from "../api.js" */
/** @import { NewToken, Token, TokenList } from "../api_types.d.ts" */
/** @import { Reporter } from "../page/problem.js" */

/** @type {Record<Token["scopes"][number], string>} */
export const SCOPES = {
  read: t("Read"),
  plan: t("Plan"),
  fly: t("Fly"),
  curate: t("Curate"),
  administer: t("Administer"),
};

/** @param {Reporter} reporter */
export function mountTokens({ notify, settle }) {
  async function load() {
    try {
      const { data } = /** @type {Answer<TokenList>} */ (await get("/account/tokens"));
      draw(data.results);
    } catch (error) {
      notify(t("Tokens could not be loaded."), error);
    }
  }

  /** @param {Token[]} tokens */
  function draw(tokens) {
    byId("tokens").replaceChildren(...tokens.map((token) => tokenRow(token, () => revoke(token))));
    byId("tokens-none").hidden = tokens.length > 0;
  }

  /** @param {Token} token */
  async function revoke(token) {
    try {
      await remove(`/account/tokens/${token.id}`);
      settle();
      toast(t("“{name}” was revoked.", { name: token.name }));
      await load();
      byId("token_name").focus();
    } catch (error) {
      notify(t("The token is not revoked."), error);
    }
  }

  const form = byId("token-form", HTMLFormElement);
  const nameField = byId("token_name", HTMLInputElement);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    const name = nameField.value.trim();
    document.getElementById("name-fault")?.remove();
    nameField.removeAttribute("aria-invalid");
    if (!name) askForName();
    else if (new FormData(form).has("scope")) await make(name);
    else notify(t("No token is made."), new ApiError(t("Choose what it may be used for."), { status: 400 }));
  });

  function askForName() {
    const words = h("span", {}, t("Say what the token is for."));
    nameField.setAttribute("aria-invalid", "true");
    nameField.after(
      h("p", { class: "field-error", id: "name-fault", role: "alert" }, icon("circle-alert", "small"), words),
    );
    nameField.focus();
  }

  /** @param {string} name */
  async function make(name) {
    const days = Number(byId("token_days", HTMLSelectElement).value);
    const scopes = new FormData(form).getAll("scope");
    try {
      const answer = /** @type {Answer<NewToken> | null} */ (
        await proved(() => post("/account/tokens", { name, days, scopes }))
      );
      if (answer === null) return;
      settle();
      form.reset();
      byId("new-token").replaceChildren(
        shownOnce({
          title: t("“{name}” is made. Copy it now: it is not shown again.", { name }),
          secret: answer.data.token,
          label: t("Token"),
        }),
      );
      byId("new-token").querySelector("button")?.focus();
      await load();
    } catch (error) {
      notify(t("No token is made."), error);
    }
  }

  return { load };
}

/** @param {Token} token @param {() => void} revoke */
export function tokenRow(token, revoke) {
  const used = token.last_used_at ? t("last used {when}", { when: whenText(token.last_used_at) }) : t("never used");
  const facts = h(
    "span",
    { class: "caption", title: exactText(token.created_at) },
    `${token.scopes.map((scope) => SCOPES[scope]).join(", ")} · ${t("made {when}", { when: whenText(token.created_at) })} · ${used} · `,
    ending(token),
  );
  const what = h("div", { class: token.is_valid ? "what" : "what ended" }, h("strong", {}, token.name), facts);
  if (!token.is_valid)
    return h("li", {}, what, h("span", { class: "chip" }, token.revoked_at ? t("Revoked") : t("Ended")));
  return h(
    "li",
    {},
    what,
    h(
      "button",
      {
        type: "button",
        class: "button danger",
        "aria-label": t("Revoke {name}", { name: token.name }),
        onclick: revoke,
      },
      t("Revoke"),
    ),
  );
}

/** @param {Token} token */
function ending(token) {
  if (token.revoked_at) return t("revoked {when}", { when: whenText(token.revoked_at) });
  const day = dayText(token.expires_at);
  return token.is_valid ? t("works until {day}", { day }) : t("ended {day}", { day });
}
