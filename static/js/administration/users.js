/** Users: their role, whether they may sign in, their sessions and tokens. Each act reports what it did and can be undone. */

import { ApiError, patch, post, remove } from "../api.js";
import { h, icon } from "../dom.js";
import { menuOf, readPage, toggleMenu } from "../page/chrome.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { exactText, whenText } from "../units.js";
import { filteredList } from "./filtered_list.js";
import { ROLES, roleOptions } from "./roles.js";
import { confirmRemoval, editUser } from "./user_dialogs.js";

/** @import { Answer } from "../api.js" */
/** @import { User, Role } from "../api_types.d.ts" */
/** @import { MenuItem } from "../page/chrome.js" */
/** @import { Reporter } from "../page/problem.js" */

/** @typedef {Partial<Pick<User, "role" | "is_active" | "first_name" | "last_name" | "email">>} UserChange */

const HERE_WITHIN_MS = 5 * 60_000;
const me = readPage().userId;

/** @param {User} user */
const fullName = (user) => [user.first_name, user.last_name].filter(Boolean).join(" ");

/** @param {User} user */
function accessChip({ is_active, last_seen_at }) {
  if (!is_active) return h("span", { class: "chip aborted" }, t("Blocked"));
  if (last_seen_at && Date.now() - Date.parse(last_seen_at) < HERE_WITHIN_MS)
    return h("span", { class: "chip active" }, icon("check"), t("Online"));
  return h("span", { class: "chip" }, t("May sign in"));
}

/** @param {Reporter} reporter */
export function mountUsers(reporter) {
  const users = new Users(reporter);
  return filteredList({
    list: "users",
    path: "/users",
    filters: ["text", "role", "access"],
    row: (/** @type {User} */ user) => users.row(user),
    countWords: (count) => tn(count, "{count} user", "{count} users"),
    none: { icon: "users", title: t("Nobody is online"), words: t("Invite a user.") },
    notify: reporter.notify,
    titleOfFault: t("Users could not be loaded."),
  });
}

/** Rows of users with their acts. */
class Users {
  #notify;
  #settle;

  /** @param {Reporter} reporter */
  constructor({ notify, settle }) {
    this.#notify = notify;
    this.#settle = settle;
  }

  /** @param {User} user */
  row(user) {
    const name = user.username;
    const isMe = user.id === me;
    const reason = isMe && t("Another administrator changes your role.");
    const role = h(
      "select",
      { class: "input", "aria-label": t("Role of {name}", { name }), disabled: isMe, title: reason },
      roleOptions(user.role),
    );
    role.addEventListener("change", () => this.#changeRole(user, /** @type {Role} */ (role.value)));
    const second = [fullName(user), user.email].filter(Boolean).join(" · ");
    return h(
      "tr",
      { dataset: { user: user.id }, class: user.is_active ? null : "kept-out" },
      h(
        "td",
        { class: "name" },
        h("strong", {}, name, isMe && ` (${t("you")})`),
        second && h("span", { class: "caption" }, second),
      ),
      h("td", { class: "role" }, role),
      h("td", { class: "access" }, accessChip(user)),
      h(
        "td",
        { class: "seen", title: user.last_seen_at && exactText(user.last_seen_at) },
        h("span", { class: "phone-label" }, `${t("Last seen")}: `),
        user.last_seen_at ? whenText(user.last_seen_at) : t("never"),
      ),
      h("td", { class: "number tokens" }, user.valid_tokens ? `${user.valid_tokens}` : "—"),
      h("td", {}, this.#menuButton(user)),
    );
  }

  /** @param {User} user */
  #menuButton(user) {
    const label = t("More for {name}", { name: user.username });
    const look = { type: "button", class: "icon-button", "aria-label": label };
    const more = h("button", { ...look, "aria-haspopup": "true", "aria-expanded": "false" }, icon("ellipsis"));
    more.addEventListener("click", (event) => {
      event.stopPropagation();
      toggleMenu(more, () => menuOf(user.username, this.#acts(user)));
    });
    return more;
  }

  /** @param {User} user @returns {MenuItem[]} */
  #acts(user) {
    const isMe = user.id === me;
    return [
      { icon: "pencil", label: t("Name and address"), act: () => this.#edit(user) },
      { icon: "log-out", label: t("Sign out everywhere"), act: () => this.#signOut(user) },
      ...(user.valid_tokens
        ? [{ icon: "key-round", label: t("Revoke all tokens"), act: () => this.#revokeTokens(user) }]
        : []),
      ...(user.has_second_factor && !isMe
        ? [{ icon: "lock-open", label: t("Reset the second factor"), act: () => this.#resetSecondFactor(user) }]
        : []),
      ...(isMe ? [] : [this.#accessAct(user)]),
    ];
  }

  /** Deny a user to sign in, or allow it again. @param {User} user @returns {MenuItem} */
  #accessAct(user) {
    const { username: name, is_active } = user;
    const words = is_active ? t("{name} can no longer sign in.", { name }) : t("{name} may sign in.", { name });
    const act = () => this.#change(user, { is_active: !is_active }, words, { is_active });
    return is_active ? { icon: "circle-x", label: t("Block"), act } : { icon: "check", label: t("Unblock"), act };
  }

  /** Draws the row again, with the focus inside it. @param {User} user @param {string} focus selector */
  #redraw(user, focus) {
    const old = document.querySelector(`#users-rows [data-user="${user.id}"]`);
    if (!old) return;
    const fresh = this.row(user);
    old.replaceWith(fresh);
    /** @type {HTMLElement | null} */
    const control = focus ? fresh.querySelector(focus) : null;
    control?.focus({ preventScroll: true });
  }

  /** @param {User} user @param {UserChange} values @returns {Promise<User>} */
  async #send(user, values) {
    const headers = { "If-Match": `"${user.revision}"` };
    return /** @type {Answer<User>} */ (await patch(`/users/${user.id}`, values, { headers })).data;
  }

  /**
   * @param {User} user
   * @param {UserChange} values
   * @param {string} words what was done
   * @param {UserChange | null} back values that undo it
   * @param {string} [focus]
   */
  async #change(user, values, words, back, focus = ".icon-button") {
    try {
      const changed = await this.#send(user, values);
      this.#settle();
      this.#redraw(changed, focus);
      const undo = back && (() => this.#change(changed, back, t("As before."), null, focus));
      toast(words, undo && { label: t("Undo"), act: undo });
    } catch (error) {
      const now = error instanceof ApiError ? error.details?.current : null;
      this.#redraw(now ?? user, focus);
      this.#notify(t("Nothing was changed."), error);
    }
  }

  /** @param {User} user @param {Role} role */
  #changeRole(user, role) {
    const words = t("{name} has the role {role} now.", { name: user.username, role: ROLES[role] });
    return this.#change(user, { role }, words, { role: user.role }, "select");
  }

  /** @param {User} user */
  async #signOut(user) {
    try {
      await post(`/users/${user.id}/sign-out`);
      this.#settle();
      toast(t("{name} is signed out everywhere.", { name: user.username }));
    } catch (error) {
      this.#notify(t("Nobody was signed out."), error);
    }
  }

  /** @param {User} user */
  #edit(user) {
    editUser(user, {
      send: (current, values) => this.#send(current, values),
      redraw: (current) => this.#redraw(current, ""),
      done: (changed) => {
        this.#settle();
        this.#redraw(changed, ".icon-button");
        toast(t("{name} is changed.", { name: user.username }));
      },
    });
  }

  /**
   * @param {string} path
   * @param {User} without as they are afterwards
   * @param {{ done: string, title: string }} words title: of the message on failure
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

  /** @param {User} user */
  #revokeTokens(user) {
    const name = user.username;
    const words = { done: t("All tokens of {name} work no more.", { name }), title: t("Nothing was revoked.") };
    confirmRemoval({
      title: t("Revoke all tokens of {name}?", { name }),
      words: t("Programs that use them stop working at once. This cannot be taken back; new tokens can be made."),
      keep: t("Keep them"),
      go: t("Revoke"),
      act: () => this.#take(`/users/${user.id}/tokens`, { ...user, valid_tokens: 0 }, words),
    });
  }

  /** @param {User} user */
  #resetSecondFactor(user) {
    const name = user.username;
    const words = { done: t("{name} has no second factor any more.", { name }), title: t("Nothing was changed.") };
    confirmRemoval({
      title: t("Reset the second factor of {name}?", { name }),
      words: t(
        "For somebody who has lost the telephone and the recovery codes. Be sure that it is really they who ask. They are signed out everywhere, and the password alone lets them in until they set up another one.",
      ),
      keep: t("Keep it"),
      go: t("Reset"),
      act: () => this.#take(`/users/${user.id}/second-factor`, { ...user, has_second_factor: false }, words),
    });
  }
}
