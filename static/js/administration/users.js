/** People: their role, whether they may sign in, their sessions and tokens. Each act says what it did and can be taken back. */

import { ApiError, patch, post, remove } from "../api.js";
import { h, icon } from "../dom.js";
import { menuOf, readPage, toggleMenu } from "../page/chrome.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { exactText, whenText } from "../units.js";
import { filteredList } from "./filtered_list.js";
import { ROLES, roleOptions } from "./roles.js";
import { confirmRemoval, editPerson } from "./user_dialogs.js";

/** @import { Answer } from "../api.js" */
/** @import { Person, Role } from "../api_types.d.ts" */
/** @import { MenuItem } from "../page/chrome.js" */
/** @import { Reporter } from "../page/problem.js" */

/** @typedef {Partial<Pick<Person, "role" | "is_active" | "first_name" | "last_name" | "email">>} PersonChange */

const HERE_WITHIN_MS = 5 * 60_000;
const me = readPage().userId;

/** @param {Person} person */
const fullName = (person) => [person.first_name, person.last_name].filter(Boolean).join(" ");

/** @param {Person} person */
function accessChip({ is_active, last_seen_at }) {
  if (!is_active) return h("span", { class: "chip aborted" }, t("Blocked"));
  if (last_seen_at && Date.now() - Date.parse(last_seen_at) < HERE_WITHIN_MS)
    return h("span", { class: "chip active" }, icon("check"), t("Online"));
  return h("span", { class: "chip" }, t("May sign in"));
}

/** @param {Reporter} reporter */
export function mountUsers(reporter) {
  const people = new Users(reporter);
  return filteredList({
    list: "people",
    path: "/people",
    filters: ["text", "role", "access"],
    row: (/** @type {Person} */ person) => people.row(person),
    countWords: (count) => tn(count, "{count} person", "{count} people"),
    none: { icon: "users", title: t("Nobody is online"), words: t("Invite a user.") },
    notify: reporter.notify,
    titleOfFault: t("People could not be loaded."),
  });
}

/** Rows of people, and what can be done with each. */
class Users {
  #notify;
  #settle;

  /** @param {Reporter} reporter */
  constructor({ notify, settle }) {
    this.#notify = notify;
    this.#settle = settle;
  }

  /** @param {Person} person */
  row(person) {
    const name = person.username;
    const isMe = person.id === me;
    const reason = isMe && t("Another administrator changes your role.");
    const role = h(
      "select",
      { class: "input", "aria-label": t("Role of {name}", { name }), disabled: isMe, title: reason },
      roleOptions(person.role),
    );
    role.addEventListener("change", () => this.#changeRole(person, /** @type {Role} */ (role.value)));
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
        h("span", { class: "phone-label" }, `${t("Last seen")}: `),
        person.last_seen_at ? whenText(person.last_seen_at) : t("never"),
      ),
      h("td", { class: "number tokens" }, person.valid_tokens ? `${person.valid_tokens}` : "—"),
      h("td", {}, this.#menuButton(person)),
    );
  }

  /** @param {Person} person */
  #menuButton(person) {
    const label = t("More for {name}", { name: person.username });
    const look = { type: "button", class: "icon-button", "aria-label": label };
    const more = h("button", { ...look, "aria-haspopup": "true", "aria-expanded": "false" }, icon("ellipsis"));
    more.addEventListener("click", (event) => {
      event.stopPropagation();
      toggleMenu(more, () => menuOf(person.username, this.#acts(person)));
    });
    return more;
  }

  /** @param {Person} person @returns {MenuItem[]} */
  #acts(person) {
    const isMe = person.id === me;
    return [
      { icon: "pencil", label: t("Name and address"), act: () => this.#edit(person) },
      { icon: "log-out", label: t("Sign out everywhere"), act: () => this.#signOut(person) },
      ...(person.valid_tokens
        ? [{ icon: "key-round", label: t("Revoke all tokens"), act: () => this.#revokeTokens(person) }]
        : []),
      ...(person.has_second_factor && !isMe
        ? [{ icon: "lock-open", label: t("Reset the second factor"), act: () => this.#resetSecondFactor(person) }]
        : []),
      ...(isMe ? [] : [this.#accessAct(person)]),
    ];
  }

  /** Keeps somebody out, or lets them in again. @param {Person} person @returns {MenuItem} */
  #accessAct(person) {
    const { username: name, is_active } = person;
    const words = is_active ? t("{name} can no longer sign in.", { name }) : t("{name} may sign in.", { name });
    const act = () => this.#change(person, { is_active: !is_active }, words, { is_active });
    return is_active ? { icon: "circle-x", label: t("Block"), act } : { icon: "check", label: t("Unblock"), act };
  }

  /** Draws the row again, with the focus inside it. @param {Person} person @param {string} focus selector */
  #redraw(person, focus) {
    const old = document.querySelector(`#people-rows [data-person="${person.id}"]`);
    if (!old) return;
    const fresh = this.row(person);
    old.replaceWith(fresh);
    /** @type {HTMLElement | null} */
    const control = focus ? fresh.querySelector(focus) : null;
    control?.focus({ preventScroll: true });
  }

  /** @param {Person} person @param {PersonChange} values @returns {Promise<Person>} */
  async #send(person, values) {
    const headers = { "If-Match": `"${person.revision}"` };
    return /** @type {Answer<Person>} */ (await patch(`/people/${person.id}`, values, { headers })).data;
  }

  /**
   * @param {Person} person
   * @param {PersonChange} values
   * @param {string} words what was done
   * @param {PersonChange | null} back values that take it back
   * @param {string} [focus]
   */
  async #change(person, values, words, back, focus = ".icon-button") {
    try {
      const changed = await this.#send(person, values);
      this.#settle();
      this.#redraw(changed, focus);
      const undo = back && (() => this.#change(changed, back, t("As before."), null, focus));
      toast(words, undo && { label: t("Undo"), act: undo });
    } catch (error) {
      const now = error instanceof ApiError ? error.details?.current : null;
      this.#redraw(now ?? person, focus);
      this.#notify(t("Nothing was changed."), error);
    }
  }

  /** @param {Person} person @param {Role} role */
  #changeRole(person, role) {
    const words = t("{name} has the role {role} now.", { name: person.username, role: ROLES[role] });
    return this.#change(person, { role }, words, { role: person.role }, "select");
  }

  /** @param {Person} person */
  async #signOut(person) {
    try {
      await post(`/people/${person.id}/sign-out`);
      this.#settle();
      toast(t("{name} is signed out everywhere.", { name: person.username }));
    } catch (error) {
      this.#notify(t("Nobody was signed out."), error);
    }
  }

  /** @param {Person} person */
  #edit(person) {
    editPerson(person, {
      send: (current, values) => this.#send(current, values),
      redraw: (current) => this.#redraw(current, ""),
      done: (changed) => {
        this.#settle();
        this.#redraw(changed, ".icon-button");
        toast(t("{name} is changed.", { name: person.username }));
      },
    });
  }

  /**
   * @param {string} path
   * @param {Person} without as they are afterwards
   * @param {{ done: string, title: string }} words title: of what is said where it fails
   */
  async #take(path, without, { done, title }) {
    try {
      await remove(path);
      this.#settle();
      this.#redraw(without, ".icon-button");
      toast(done);
    } catch (error) {
      this.#notify(title, error);
    }
  }

  /** @param {Person} person */
  #revokeTokens(person) {
    const name = person.username;
    const words = { done: t("All tokens of {name} work no more.", { name }), title: t("Nothing was revoked.") };
    confirmRemoval({
      title: t("Revoke all tokens of {name}?", { name }),
      words: t("Programs that use them stop working at once. This cannot be taken back; new tokens can be made."),
      keep: t("Keep them"),
      go: t("Revoke"),
      act: () => this.#take(`/people/${person.id}/tokens`, { ...person, valid_tokens: 0 }, words),
    });
  }

  /** @param {Person} person */
  #resetSecondFactor(person) {
    const name = person.username;
    const words = { done: t("{name} has no second factor any more.", { name }), title: t("Nothing was changed.") };
    confirmRemoval({
      title: t("Reset the second factor of {name}?", { name }),
      words: t(
        "For somebody who has lost the telephone and the recovery codes. Be sure that it is really they who ask. They are signed out everywhere, and the password alone lets them in until they set up another one.",
      ),
      keep: t("Keep it"),
      go: t("Reset"),
      act: () => this.#take(`/people/${person.id}/second-factor`, { ...person, has_second_factor: false }, words),
    });
  }
}
