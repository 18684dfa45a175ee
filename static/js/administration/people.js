/** People: their role, whether they may sign in, their sessions and tokens. Each act says what it did and can be taken back. */

import { ApiError, patch, post, remove } from "../api.js";
import { h, icon } from "../dom.js";
import { menuOf, readPage, toggleMenu } from "../page/chrome.js";
import { open } from "../page/keyboard.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { exactText, whenText } from "../units.js";
import { filteredList } from "./filtered_list.js";
import { ROLES, roleOptions } from "./roles.js";

const HERE_WITHIN_MS = 5 * 60_000;
const me = readPage().userId;

const fullName = (person) => [person.first_name, person.last_name].filter(Boolean).join(" ");

function accessChip(person) {
  if (!person.is_active) return h("span", { class: "chip aborted" }, t("Kept out"));
  if (person.last_seen_at && Date.now() - new Date(person.last_seen_at) < HERE_WITHIN_MS)
    return h("span", { class: "chip active" }, icon("check"), t("Here now"));
  return h("span", { class: "chip" }, t("May sign in"));
}

export function mountPeople({ tell, settle }) {
  const list = filteredList({
    list: "people",
    path: "/people",
    filters: ["text", "role", "access"],
    row,
    countWords: (count) => tn(count, "{count} person", "{count} people"),
    none: { icon: "users", title: t("Nobody is here"), words: t("Invite somebody.") },
    tell,
    titleOfFault: t("People could not be loaded."),
  });

  function row(person) {
    const name = person.username;
    const isMe = person.id === me;
    const reason = isMe && t("Another administrator changes your role.");
    const role = h(
      "select",
      { class: "input", "aria-label": t("Role of {name}", { name }), disabled: isMe, title: reason },
      roleOptions(person.role),
    );
    role.addEventListener("change", () => changeRole(person, role));
    const more = h(
      "button",
      {
        type: "button",
        class: "icon-button",
        "aria-label": t("More for {name}", { name }),
        "aria-haspopup": "true",
        "aria-expanded": "false",
      },
      icon("ellipsis"),
    );
    more.addEventListener("click", (event) => {
      event.stopPropagation();
      toggleMenu(more, () => menuOf(name, acts(person)));
    });
    const second = [fullName(person), person.email].filter(Boolean).join(" · ");
    return h(
      "tr",
      { dataset: { person: person.id }, class: person.is_active ? null : "kept-out" },
      h(
        "td",
        { class: "name" },
        h("strong", {}, name, isMe && ` (${t("you")})`),
        second && h("span", { class: "caption" }, second),
      ),
      h("td", { class: "role" }, role),
      h("td", { class: "access" }, accessChip(person)),
      h(
        "td",
        { class: "seen", title: person.last_seen_at && exactText(person.last_seen_at) },
        h("span", { class: "phone-label" }, `${t("Last here")}: `),
        person.last_seen_at ? whenText(person.last_seen_at) : t("never"),
      ),
      h("td", { class: "number tokens" }, person.valid_tokens ? `${person.valid_tokens}` : "—"),
      h("td", {}, more),
    );
  }

  function acts(person) {
    return [
      { icon: "pencil", label: t("Name and address"), act: () => editPerson(person) },
      { icon: "log-out", label: t("Sign out everywhere"), act: () => signOut(person) },
      person.valid_tokens && { icon: "key-round", label: t("Revoke all tokens"), act: () => askToRevoke(person) },
      person.has_second_factor &&
        person.id !== me && { icon: "lock-open", label: t("Reset the second factor"), act: () => askToReset(person) },
      person.id === me
        ? null
        : person.is_active
          ? {
              icon: "circle-x",
              label: t("Keep out"),
              act: () =>
                change(person, { is_active: false }, t("{name} can no longer sign in.", { name: person.username }), {
                  is_active: true,
                }),
            }
          : {
              icon: "check",
              label: t("Let in again"),
              act: () =>
                change(person, { is_active: true }, t("{name} may sign in.", { name: person.username }), {
                  is_active: false,
                }),
            },
    ].filter(Boolean);
  }

  function redraw(person, focus) {
    const old = document.querySelector(`#people-rows [data-person="${person.id}"]`);
    if (!old) return;
    const fresh = row(person);
    old.replaceWith(fresh);
    fresh.querySelector(focus)?.focus({ preventScroll: true });
  }

  const send = (person, values) =>
    patch(`/people/${person.id}`, values, { headers: { "If-Match": `"${person.revision}"` } });

  async function change(person, values, words, back, focus = ".icon-button") {
    try {
      const { data } = await send(person, values);
      settle();
      redraw(data, focus);
      toast(words, back && { label: t("Undo"), act: () => change(data, back, t("As before."), null, focus) });
    } catch (error) {
      const now = error instanceof ApiError ? error.details?.current : null;
      redraw(now ?? person, focus);
      tell(t("Nothing was changed."), error);
    }
  }

  function changeRole(person, select) {
    const words = t("{name} has the role {role} now.", { name: person.username, role: ROLES[select.value] });
    return change(person, { role: select.value }, words, { role: person.role }, "select");
  }

  async function signOut(person) {
    try {
      await post(`/people/${person.id}/sign-out`);
      settle();
      toast(t("{name} is signed out everywhere.", { name: person.username }));
    } catch (error) {
      tell(t("Nobody was signed out."), error);
    }
  }

  function ask({ title, words, keep, go, act }) {
    const doIt = () => (dialog.close(), act());
    const dialog = h(
      "dialog",
      { "aria-labelledby": "ask-title" },
      h("h2", { id: "ask-title" }, title),
      h("p", {}, words),
      h(
        "form",
        { method: "dialog", class: "acts" },
        h("button", { class: "button", autofocus: true }, keep),
        h("button", { type: "button", class: "button danger filled", onclick: doIt }, go),
      ),
    );
    open(dialog);
  }

  async function take(path, person, without, { done, title }) {
    try {
      await remove(path);
      settle();
      redraw({ ...person, ...without }, ".icon-button");
      toast(done);
    } catch (error) {
      tell(title, error);
    }
  }

  function askToRevoke(person) {
    const name = person.username;
    ask({
      title: t("Revoke all tokens of {name}?", { name }),
      words: t("Programs that use them stop working at once. This cannot be taken back; new tokens can be made."),
      keep: t("Keep them"),
      go: t("Revoke"),
      act: () =>
        take(
          `/people/${person.id}/tokens`,
          person,
          { valid_tokens: 0 },
          { done: t("All tokens of {name} work no more.", { name }), title: t("Nothing was revoked.") },
        ),
    });
  }

  function askToReset(person) {
    const name = person.username;
    ask({
      title: t("Reset the second factor of {name}?", { name }),
      words: t(
        "For somebody who has lost the telephone and the recovery codes. Be sure that it is really they who ask. They are signed out everywhere, and the password alone lets them in until they set up another one.",
      ),
      keep: t("Keep it"),
      go: t("Reset"),
      act: () =>
        take(
          `/people/${person.id}/second-factor`,
          person,
          { has_second_factor: false },
          { done: t("{name} has no second factor any more.", { name }), title: t("Nothing was changed.") },
        ),
    });
  }

  function editPerson(person) {
    const field = (name, label, properties) =>
      h(
        "div",
        { class: "field" },
        h("label", { for: `person-${name}` }, label),
        h("input", { class: "input", id: `person-${name}`, value: person[name], autocomplete: "off", ...properties }),
      );
    const fault = h("div", {});
    const form = h(
      "form",
      { class: "stack", novalidate: true },
      h("h2", { id: "person-title" }, person.username),
      h(
        "div",
        { class: "pair" },
        field("first_name", t("First name"), { maxlength: 150 }),
        field("last_name", t("Last name"), { maxlength: 150 }),
      ),
      field("email", t("E-mail address"), { type: "email", maxlength: 254 }),
      fault,
      h(
        "div",
        { class: "acts" },
        h("button", { type: "button", class: "button", onclick: () => dialog.close() }, t("Cancel")),
        h("button", { class: "button primary" }, t("Save")),
      ),
    );
    const dialog = h("dialog", { "aria-labelledby": "person-title" }, form);
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      const values = Object.fromEntries(
        ["first_name", "last_name", "email"].map((name) => [name, form.querySelector(`#person-${name}`).value.trim()]),
      );
      try {
        const { data } = await send(person, values);
        dialog.close();
        settle();
        redraw(data, ".icon-button");
        toast(t("{name} is changed.", { name: person.username }));
      } catch (error) {
        if (!(error instanceof ApiError)) throw error;
        if (error.details?.current) redraw((person = error.details.current), "");
        fault.replaceChildren(
          h("p", { class: "field-error", role: "alert" }, icon("circle-alert", "small"), h("span", {}, error.message)),
        );
      }
    });
    open(dialog);
  }

  return list;
}
