/** A user's data in this browser, and their deletion at sign-out. Preferences of the browser itself stay. */

const DRAFT = /^spanwise\.([a-z]+-)?draft\./;

/** @param {number | string} user */
const isOf = (user) => {
  const own = new RegExp(`^spanwise\\.[a-z-]+\\.${user}(\\.|$)`);
  return (/** @type {string} */ key) => own.test(key);
};

/** @param {Storage} storage */
function keysOf(storage) {
  try {
    return Array.from({ length: storage.length }, (_, place) => storage.key(place) ?? "");
  } catch {
    return []; // closed
  }
}

/**
 * Count of the user's drafts that are not saved on the server: pages delete a draft once it is.
 *
 * @param {number | string} user
 * @param {Storage[]} [storages]
 */
export function draftsOf(user, storages = [globalThis.localStorage]) {
  return storages.flatMap((storage) =>
    keysOf(storage)
      .filter(isOf(user))
      .filter((key) => DRAFT.test(key)),
  ).length;
}

/**
 * Delete all data of the user, except the drafts where they are to be kept.
 *
 * @param {number | string} user
 * @param {{ keepsDrafts?: boolean, storages?: Storage[] }} [options]
 */
export function forget(
  user,
  { keepsDrafts = false, storages = [globalThis.localStorage, globalThis.sessionStorage] } = {},
) {
  for (const storage of storages) {
    for (const key of keysOf(storage).filter(isOf(user)))
      if (!(keepsDrafts && DRAFT.test(key))) storage.removeItem(key);
  }
}
