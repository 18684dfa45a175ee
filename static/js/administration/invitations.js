/** Invitations: a link for a new account, shown once, sent by mail where mail is configured; can be revoked. */

import { ApiError, post, remove } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { readPage } from "../page/chrome.js";
import { open } from "../page/keyboard.js";
import { shownOnce } from "../page/shown_once.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { clockText, dayText, exactText, whenText } from "../units.js";
import { filteredList } from "./filtered_list.js";
import { MAY, ROLES } from "./roles.js";

/** @import { Answer } from "../api.js" */
/** @import { Invitation, NewInvitation, Role } from "../api_types.d.ts" */
/** @import { Reporter } from "../page/problem.js" */

/** @type {Record<string, [string, string]>} */
const STATES = {
  open: [t("Open"), "active"],
  accepted: [t("Accepted"), ""],
  expired: [t("Expired"), "draft"],
  revoked: [t("Revoked"), "draft"],
};
const DAYS = [1, 7, 14, 30];

/** @param {Reporter & { show: () => Promise<unknown> }} options show: turns to the tab */
export function mountInvitations({ notify, settle, show }) {
  const list = filteredList({
    list: "invitations",
    path: "/invitations",
    filters: ["state"],
    row,
    countWords: (count) => tn(count, "{count} invitation", "{count} invitations"),
    none: { icon: "users", title: t("No invitations"), words: t("Invite a user: a link creates the account.") },
    notify,
    titleOfFault: t("Invitations could not be loaded."),
  });

  /** @param {Invitation} invitation */
  function row(invitation) {
    const [words, style] = STATES[invitation.state];
    const whom = invitation.email || t("whoever has the link");
    const takeBack = h(
      "button",
      {
        type: "button",
        class: "button danger",
        "aria-label": t("Revoke the invitation for {whom}", { whom }),
        onclick: () => revoke(invitation),
      },
      t("Revoke"),
    );
    return h(
      "tr",
      {},
      h(
        "td",
        { class: "name" },
        h("strong", {}, whom),
        invitation.accepted_by &&
          h("span", { class: "caption" }, t("accepted by {name}", { name: invitation.accepted_by })),
      ),
      h("td", { class: "role" }, ROLES[invitation.role]),
      h("td", { class: "state" }, h("span", { class: `chip ${style}`.trim() }, words)),
      h("td", { class: "by" }, invitation.invited_by ?? "—"),
      h("td", { class: "when made", title: exactText(invitation.created_at) }, whenText(invitation.created_at)),
      h(
        "td",
        { class: "when", title: exactText(invitation.expires_at) },
        h("span", { class: "phone-label" }, `${t("Works until")}: `),
        t("{day}, {time}", { day: dayText(invitation.expires_at), time: clockText(invitation.expires_at) }),
      ),
      h("td", {}, invitation.state === "open" && takeBack),
    );
  }

  /** @param {Invitation} invitation */
  async function revoke(invitation) {
    try {
      await remove(`/invitations/${invitation.id}`);
      settle();
      byId("new-link").replaceChildren();
      toast(t("The link was revoked."));
      await list.load();
      byId("invite").focus();
    } catch (error) {
      notify(t("The invitation was not revoked."), error);
    }
  }

  /** Asks for a role and an address, makes the link, and shows it once. */
  function invite() {
    askInvitation(async (invitation) => {
      await show();
      present(invitation);
    });
  }

  return { ...list, invite };
}

/** @param {(invitation: NewInvitation) => void} made */
function askInvitation(made) {
  const fault = h("div", {});
  const { elements, read } = invitationFields();
  const close = () => dialog.close();
  const form = h(
    "form",
    { class: "stack", novalidate: true },
    h("h2", { id: "invite-title" }, t("Invite user")),
    elements,
    fault,
    h(
      "div",
      { class: "acts" },
      h("button", { type: "button", class: "button", onclick: close }, t("Cancel")),
      h("button", { class: "button primary" }, t("Create link")),
    ),
  );
  /** @type {HTMLDialogElement} */
  const dialog = h("dialog", { "aria-labelledby": "invite-title" }, form);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    try {
      const { data } = /** @type {Answer<NewInvitation>} */ (await post("/invitations", read()));
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

function invitationFields() {
  const roles = Object.entries(ROLES).map(([value, words]) => {
    const may = MAY[/** @type {Role} */ (value)];
    const input = h("input", { type: "radio", name: "role", value, checked: value === "operator" });
    const label = h(
      "label",
      { class: "role-choice" },
      input,
      h("span", {}, h("strong", {}, words), h("span", { class: "caption" }, ` ${may}`)),
    );
    return { input, label };
  });
  const email = h("input", {
    class: "input",
    id: "invite-email",
    type: "email",
    maxlength: 254,
    autocomplete: "off",
    "aria-describedby": "invite-mail",
  });
  const days = h(
    "select",
    { class: "input", id: "invite-days" },
    DAYS.map((number) => {
      const words = number === 1 ? t("1 day") : t("{days} days", { days: number });
      return h("option", { value: number, selected: number === 7 }, words);
    }),
  );
  const mail = readPage().mailLeavesHere
    ? t("The link is sent there, and shown to you.")
    : t("No mail leaves this server: you hand the link over yourself.");
  const elements = [
    h(
      "fieldset",
      { class: "role-choices" },
      h("legend", { class: "field-label" }, t("Role")),
      roles.map(({ label }) => label),
    ),
    h(
      "div",
      { class: "field" },
      h("label", { for: "invite-email" }, t("E-mail address, if you like")),
      email,
      h("p", { class: "caption", id: "invite-mail" }, mail),
    ),
    h("div", { class: "field" }, h("label", { for: "invite-days" }, t("Expires after")), days),
  ];
  const read = () => ({
    role: roles.find(({ input }) => input.checked)?.input.value,
    email: email.value.trim(),
    days: Number(days.value),
  });
  return { elements, read };
}

/** Shows the link, which is not shown again. @param {NewInvitation} invitation */
function present({ role, email, link, was_mailed }) {
  const title = t("A link for one account with the role {role}. Copy it now: it is not shown again.", {
    role: ROLES[role],
  });
  const sent = t("It was sent to {email}.", { email });
  const words = was_mailed ? sent : email ? t("It was not sent: hand it over yourself.") : "";
  const place = byId("new-link");
  const more = words && h("p", { class: "caption" }, words);
  place.replaceChildren(shownOnce({ title, secret: link, label: t("Link of the invitation"), more }));
  place.querySelector("button")?.focus();
}
