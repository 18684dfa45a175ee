/** What a UAV proves itself with: one token and one key, made, replaced and revoked; a secret is shown once. */

import { proved } from "../account/reauthentication.js";
import { ApiError, get, post, remove } from "../api.js";
import { find, h, icon, svg } from "../dom.js";
import { announce, toast } from "../page/toast.js";
import { t } from "../text.js";
import { exactText, whenText } from "../units.js";
import { CREDENTIALS } from "./words.js";

/** @import { Answer } from "../api.js" */
/** @import { Credential, CredentialKind, CredentialPage, NewCredential } from "../api_types.d.ts" */
/** @import { Child } from "../dom.js" */
/** @import { Uav } from "./types.d.ts" */

/** @typedef {{ kind: CredentialKind, secret: string, qr: string[] }} Shown a secret that was just made */

const QUIET = 4; // modules around a QR code, by ISO/IEC 18004
const KINDS = /** @type {CredentialKind[]} */ (Object.keys(CREDENTIALS));
const SECRET_WORDS = {
  "link-token": t("This is the token. It is shown only now: put it into the UAV's program."),
  "mavlink-key": t(
    "This is the key, 32 bytes in hexadecimal. It is shown only now: put it into the autopilot over a cable.",
  ),
};

const NEEDED_NOW = ["in_flight", "commands_waiting", "mission_on_its_way"]; // an administrator may insist

/** @param {Credential | undefined} credential @param {Credential | undefined} earlier */
function factsOf(credential, earlier) {
  if (!credential) return t("Not set.");
  const made = t("Created {when} by {who}", {
    when: whenText(credential.created_at),
    who: credential.created_by ?? t("somebody who has left"),
  });
  const used = credential.last_used_at
    ? t("used {when}", { when: whenText(credential.last_used_at) })
    : earlier
      ? t("not used yet: the one before it still works until then")
      : t("not used yet");
  return `${made} · ${used}`;
}

/** @param {string} text */
async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    announce(t("Copied."));
    toast(t("Copied."));
  } catch {
    toast(t("This browser does not allow copying: mark the text and copy it."));
  }
}

/** @param {Shown} shown @param {() => unknown} onAway */
const secretBox = ({ kind, secret, qr }, onAway) =>
  h(
    "div",
    { class: "secret" },
    h("p", {}, SECRET_WORDS[kind]),
    h("code", {}, secret),
    qrCode(qr, t("QR code of it")),
    h(
      "div",
      { class: "acts" },
      h("button", { type: "button", class: "button", onclick: () => copy(secret) }, icon("copy", "small"), t("Copy")),
      h("button", { type: "button", class: "button quiet", onclick: onAway }, t("Done")),
    ),
  );

/** @param {string} name of the UAV @param {{ keep: () => unknown, revoke: () => unknown }} acts */
const revokeQuestion = (name, { keep, revoke }) =>
  h(
    "div",
    { class: "secret" },
    h("p", {}, t("Revoke it? {name} is cut off at once and needs a new one to connect again.", { name })),
    h(
      "div",
      { class: "acts" },
      h("button", { type: "button", class: "button", onclick: keep }, t("Keep it")),
      h("button", { type: "button", class: "button danger filled", onclick: revoke }, t("Revoke it")),
    ),
  );

/**
 * @typedef {object} Insisting an act that was refused for now
 * @property {CredentialKind} kind
 * @property {string} why
 * @property {string} act text of the button
 * @property {(reason: string) => unknown} again
 */

/** @param {Insisting} insisting @param {() => unknown} keep */
function insistQuestion({ why, act, again }, keep) {
  const reason = h("input", {
    class: "input",
    id: "insist-reason",
    maxlength: 300,
    required: true,
    autocomplete: "off",
  });
  return h(
    "form",
    {
      class: "secret",
      /** @param {SubmitEvent} event */
      onsubmit: (event) => {
        event.preventDefault();
        again(reason.value);
      },
    },
    h("p", {}, why),
    h("div", { class: "field" }, h("label", { for: "insist-reason" }, t("Reason")), reason),
    h(
      "div",
      { class: "acts" },
      h("button", { type: "button", class: "button", onclick: keep }, t("Cancel")),
      h("button", { class: "button danger filled" }, act),
    ),
  );
}

/**
 * @param {CredentialKind} kind
 * @param {Credential | undefined} credential
 * @param {Credential | undefined} earlier valid until the newest was used
 * @param {{ make?: (() => unknown) | null, ask?: (() => unknown) | null }} acts null: there is no such button
 * @param {...Child} below
 */
const credentialRow = (kind, credential, earlier, { make, ask }, ...below) =>
  h(
    "li",
    {},
    h(
      "div",
      { class: "what" },
      h("strong", {}, CREDENTIALS[kind]),
      h(
        "span",
        { class: "caption", title: credential && exactText(credential.created_at) },
        factsOf(credential, earlier),
      ),
    ),
    (make || ask) &&
      h(
        "div",
        { class: "acts" },
        make &&
          h(
            "button",
            {
              type: "button",
              class: "button",
              onclick: make,
              "aria-label": `${credential ? t("Replace") : t("Create")}: ${CREDENTIALS[kind]}`,
            },
            credential ? t("Replace") : t("Create"),
          ),
        ask &&
          h(
            "button",
            {
              type: "button",
              class: "icon-button",
              onclick: ask,
              "aria-label": `${t("Revoke")}: ${CREDENTIALS[kind]}`,
              title: t("Revoke"),
            },
            icon("x"),
          ),
      ),
    below,
  );

/** Reads them: a kind → those that count, the newest first. @param {string} path */
async function credentialsInForce(path) {
  const { data } = /** @type {Answer<CredentialPage>} */ (await get(path));
  /** @param {CredentialKind} kind */
  return (kind) => data.results.filter((credential) => credential.kind === kind && !credential.revoked_at);
}

/**
 * Draws itself into `place`; onChange() after each change.
 *
 * @param {HTMLElement} place
 * @param {Uav} uav
 * @param {{ canPlan: boolean, isAdministrator: boolean, onChange: () => unknown }} how
 */
export async function mountCredentials(place, uav, { canPlan, isAdministrator, onChange }) {
  const path = `/uavs/${uav.id}/credentials`;
  /** @type {Shown | null} */
  let shown = null;
  /** @type {CredentialKind | null} */
  let asking = null; // which kind is about to be revoked
  /** @type {Insisting | null} */
  let insisting = null;

  /**
   * @template Result
   * @param {CredentialKind} kind
   * @param {() => Promise<Result>} send
   * @param {(answer: Result) => Promise<unknown>} then
   * @param {Pick<Insisting, "act" | "again">} anyway
   */
  async function attempt(kind, send, then, anyway) {
    insisting = null;
    try {
      const answer = await proved(send);
      if (answer === null) return;
      await then(answer);
      onChange();
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      if (!isAdministrator || !NEEDED_NOW.includes(error.code)) return toast(error.message);
      insisting = { kind, why: error.message, ...anyway };
      asking = null;
      await draw();
      find(place, "#insist-reason", HTMLElement).focus();
    }
  }

  /** @param {CredentialKind} kind @param {string} [reason] @returns {Promise<unknown>} */
  const make = (kind, reason) => {
    const send = () => post(path, reason ? { kind, insist_reason: reason } : { kind });
    /** @param {Answer<NewCredential>} answer */
    const show = async ({ data }) => {
      shown = { kind, secret: data.secret, qr: data.secret_qr };
      await draw();
      find(place, ".secret button", HTMLElement).focus();
    };
    const anyway = { act: t("Replace anyway"), again: (/** @type {string} */ why) => make(kind, why) };
    return attempt(kind, /** @type {() => Promise<Answer<NewCredential>>} */ (send), show, anyway);
  };

  /** @param {Credential} credential @param {string} [reason] @returns {Promise<unknown>} */
  const revoke = (credential, reason) => {
    const query = reason ? `?insist_reason=${encodeURIComponent(reason)}` : "";
    const send = () => remove(`${path}/${credential.id}${query}`);
    const show = async () => {
      if (shown?.kind === credential.kind) shown = null;
      asking = null;
      toast(t("Revoked. {name} cannot connect with it any more.", { name: uav.name }));
      await draw();
    };
    const anyway = { act: t("Revoke anyway"), again: (/** @type {string} */ why) => revoke(credential, why) };
    return attempt(credential.kind, send, show, anyway);
  };

  /** @param {CredentialKind | null} kind null: no longer */
  async function ask(kind) {
    asking = kind;
    await draw();
    if (kind) /** @type {HTMLElement | null} */ (place.querySelector(".secret .button"))?.focus();
  }

  /** @param {CredentialKind} kind @param {Credential[]} inForce the newest first */
  function row(kind, [credential, earlier]) {
    const acts = {
      make: canPlan && uav.state !== "retired" ? () => make(kind) : null,
      ask: canPlan && credential ? () => ask(kind) : null,
    };
    const putAway = () => {
      shown = null;
      return draw();
    };
    const leave = () => {
      insisting = null;
      return draw();
    };
    return credentialRow(
      kind,
      credential,
      earlier,
      acts,
      asking === kind &&
        credential &&
        revokeQuestion(uav.name, { keep: () => ask(null), revoke: () => revoke(credential) }),
      insisting?.kind === kind && insistQuestion(insisting, leave),
      shown?.kind === kind && secretBox(shown, putAway),
    );
  }

  async function draw() {
    const inForce = await credentialsInForce(path);
    place.replaceChildren(...KINDS.map((kind) => row(kind, inForce(kind))));
  }

  await draw();
}

/**
 * A QR code as a drawing.
 *
 * @param {readonly string[]} rows of modules, "1" is dark
 * @param {string} label
 */
function qrCode(rows, label) {
  const size = rows.length + 2 * QUIET;
  const path = rows.flatMap((row, y) =>
    [...row].flatMap((dark, x) => (dark === "1" ? [`M${x + QUIET} ${y + QUIET}h1v1h-1z`] : [])),
  );
  return svg(
    "svg",
    { class: "qr-code", viewBox: `0 0 ${size} ${size}`, role: "img", "aria-label": label },
    svg("rect", { width: size, height: size, class: "light" }),
    svg("path", { d: path.join(""), class: "dark" }),
  );
}
