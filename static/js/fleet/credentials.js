/** What a UAV proves itself with: one token and one key, made, replaced and revoked; a secret is shown once. */

import { ApiError, get, post, remove } from "../api.js";
import { h, icon } from "../dom.js";
import { say, toast } from "../page/toast.js";
import { t } from "../text.js";
import { exactText, whenText } from "../units.js";
import { CREDENTIALS } from "./words.js";

const SECRET_WORDS = {
  "link-token": t("This is the token. It is shown only now: put it into the UAV's program."),
  "mavlink-key": t(
    "This is the key, 32 bytes in hexadecimal. It is shown only now: put it into the autopilot over a cable.",
  ),
};

function factsOf(credential) {
  if (!credential) return t("None: it cannot connect this way.");
  const made = t("Made {when} by {who}", {
    when: whenText(credential.created_at),
    who: credential.created_by ?? t("somebody who has left"),
  });
  return `${made} · ${credential.last_used_at ? t("used {when}", { when: whenText(credential.last_used_at) }) : t("not used yet")}`;
}

async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    say(t("Copied."));
    toast(t("Copied."));
  } catch {
    toast(t("This browser does not allow copying: mark the text and copy it."));
  }
}

/** Draws itself into `place`; onChange() after each change. */
export async function mountCredentials(place, uav, { canPlan, onChange }) {
  const path = `/uavs/${uav.id}/credentials`;
  let shown = null; // { kind, secret }
  let asking = ""; // which kind is about to be revoked

  const tell = (error) => {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  };

  async function make(kind) {
    try {
      const { data } = await post(path, { kind });
      shown = { kind, secret: data.secret };
      await draw();
      place.querySelector(".secret button").focus();
      onChange();
    } catch (error) {
      tell(error);
    }
  }

  async function revoke(credential) {
    try {
      await remove(`${path}/${credential.id}`);
      if (shown?.kind === credential.kind) shown = null;
      asking = "";
      toast(t("Revoked. {name} cannot connect with it any more.", { name: uav.name }));
      await draw();
      onChange();
    } catch (error) {
      tell(error);
    }
  }

  const ask = (kind) => async () => {
    asking = kind;
    await draw();
    place.querySelector(".secret .button")?.focus();
  };

  function secretBox({ kind, secret }) {
    return h(
      "div",
      { class: "secret" },
      h("p", {}, SECRET_WORDS[kind]),
      h("code", {}, secret),
      h(
        "div",
        { class: "acts" },
        h("button", { type: "button", class: "button", onclick: () => copy(secret) }, icon("copy", "small"), t("Copy")),
        h(
          "button",
          { type: "button", class: "button quiet", onclick: () => ((shown = null), draw()) },
          t("Put it away"),
        ),
      ),
    );
  }

  function question(credential) {
    return h(
      "div",
      { class: "secret" },
      h("p", {}, t("Revoke it? {name} is cut off at once and needs a new one to connect again.", { name: uav.name })),
      h(
        "div",
        { class: "acts" },
        h("button", { type: "button", class: "button", onclick: () => ((asking = ""), draw()) }, t("Keep it")),
        h(
          "button",
          { type: "button", class: "button danger filled", onclick: () => revoke(credential) },
          t("Revoke it"),
        ),
      ),
    );
  }

  function row(kind, credential) {
    return h(
      "li",
      {},
      h(
        "div",
        { class: "what" },
        h("strong", {}, CREDENTIALS[kind]),
        h("span", { class: "caption", title: credential && exactText(credential.created_at) }, factsOf(credential)),
      ),
      canPlan &&
        h(
          "div",
          { class: "acts" },
          uav.state !== "retired" &&
            h(
              "button",
              {
                type: "button",
                class: "button",
                onclick: () => make(kind),
                "aria-label": `${credential ? t("Replace") : t("Make")}: ${CREDENTIALS[kind]}`,
              },
              credential ? t("Replace") : t("Make"),
            ),
          credential &&
            h(
              "button",
              {
                type: "button",
                class: "icon-button",
                onclick: ask(kind),
                "aria-label": `${t("Revoke")}: ${CREDENTIALS[kind]}`,
                title: t("Revoke"),
              },
              icon("x"),
            ),
        ),
      asking === kind && credential && question(credential),
      shown?.kind === kind && secretBox(shown),
    );
  }

  async function draw() {
    const { data } = await get(path);
    const inForce = (kind) => data.results.find((credential) => credential.kind === kind && !credential.revoked_at);
    place.replaceChildren(...Object.keys(CREDENTIALS).map((kind) => row(kind, inForce(kind))));
  }

  await draw();
}
