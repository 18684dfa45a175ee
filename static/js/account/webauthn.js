/** Passkeys by the browser's WebAuthn: options and responses are in their JSON forms. */

import { t } from "../text.js";

const IP_ADDRESS = /^[\d.]+$|:/; // of which browsers make no passkeys

/** Whether this browser can make and use passkeys at this address. */
export function passkeysWork() {
  const isSupported = typeof PublicKeyCredential?.parseRequestOptionsFromJSON === "function";
  return window.isSecureContext && isSupported && !IP_ADDRESS.test(location.hostname);
}

/** Ask for a new passkey. @param {any} options @returns {Promise<any>} */
export async function createPasskey(options) {
  const publicKey = PublicKeyCredential.parseCreationOptionsFromJSON(options);
  return asJson(await navigator.credentials.create({ publicKey }));
}

/** Ask for the signature of a passkey. @param {any} options @returns {Promise<any>} */
export async function usePasskey(options) {
  const publicKey = PublicKeyCredential.parseRequestOptionsFromJSON(options);
  return asJson(await navigator.credentials.get({ publicKey }));
}

/** @param {Credential | null} credential */
function asJson(credential) {
  if (!(credential instanceof PublicKeyCredential)) throw new DOMException("no passkey", "NotAllowedError");
  return credential.toJSON();
}

/** Say why the browser gave no passkey; null for errors of something else. @param {unknown} error */
export function passkeyFault(error) {
  if (!(error instanceof DOMException)) return null;
  if (error.name === "InvalidStateError") return t("This device has a passkey for this account already.");
  if (error.name === "NotAllowedError") return t("No passkey was chosen in time. Try again.");
  return t("The browser made no passkey: {why}", { why: error.message });
}
