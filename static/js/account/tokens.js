/** Tokens: made with a name and an end, shown once, revoked. */

import { get, post, remove } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { shownOnce } from "../page/shown_once.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { dayText, exactText, whenText } from "../units.js";
import { proved } from "./proof.js";

export function mountTokens({ tell, settle }) {
  async function load() {
    try {
      const { data } = await get("/account/tokens");
      draw(data.results);
    } catch (error) {
      tell(t("Tokens could not be loaded."), error);
    }
  }

  function draw(tokens) {
    byId("tokens").replaceChildren(...tokens.map(row));
    byId("tokens-none").hidden = tokens.length > 0;
  }

  function row(token) {
    const used = token.last_used_at ? t("last used {when}", { when: whenText(token.last_used_at) }) : t("never used");
    const facts = h(
      "span",
      { class: "caption", title: exactText(token.created_at) },
      `${t("made {when}", { when: whenText(token.created_at) })} · ${used} · `,
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
          onclick: () => revoke(token),
        },
        t("Revoke"),
      ),
    );
  }

  function ending(token) {
    if (token.revoked_at) return t("revoked {when}", { when: whenText(token.revoked_at) });
    const day = dayText(token.expires_at);
    return token.is_valid ? t("works until {day}", { day }) : t("ended {day}", { day });
  }

  async function revoke(token) {
    try {
      await remove(`/account/tokens/${token.id}`);
      settle();
      toast(t("“{name}” works no more.", { name: token.name }));
      await load();
      byId("token_name").focus();
    } catch (error) {
      tell(t("The token is not revoked."), error);
    }
  }

  byId("token-form").addEventListener("submit", async (event) => {
    event.preventDefault();
    const name = byId("token_name").value.trim();
    document.getElementById("name-fault")?.remove();
    byId("token_name").removeAttribute("aria-invalid");
    if (!name) {
      byId("token_name").setAttribute("aria-invalid", "true");
      byId("token_name").after(
        h(
          "p",
          { class: "field-error", id: "name-fault", role: "alert" },
          icon("circle-alert", "small"),
          h("span", {}, t("Say what the token is for.")),
        ),
      );
      byId("token_name").focus();
      return;
    }
    try {
      const answer = await proved(() => post("/account/tokens", { name, days: Number(byId("token_days").value) }));
      if (answer === null) return;
      const { data } = answer;
      settle();
      byId("token-form").reset();
      byId("new-token").replaceChildren(
        shownOnce({
          title: t("“{name}” is made. Copy it now: it is not shown again.", { name }),
          secret: data.token,
          label: t("Token"),
        }),
      );
      byId("new-token").querySelector("button").focus();
      await load();
    } catch (error) {
      tell(t("No token is made."), error);
    }
  });
  return { load };
}
