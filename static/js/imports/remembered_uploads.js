/** Files that were on their way when the page was closed: kept in this browser, each by its name, size and time. */

/** @import { RememberedUpload } from "./types.d.ts" */

const KEPT_MS = 24 * 3_600_000; // the server deletes them then, too

/** @param {Pick<File, "name" | "size" | "lastModified">} file */
export const markOf = ({ name, size, lastModified }) => `${name}\n${size}\n${lastModified}`;

/**
 * Create the list of interrupted uploads. An error or unreadable content of the storage only loses uploads.
 *
 * @param {number | string} userId
 * @param {Pick<Storage, "getItem" | "setItem">} [storage]
 * @param {() => number} [now] [ms]
 */
export function createRememberedUploads(userId, storage = localStorage, now = () => Date.now()) {
  const key = `spanwise.uploads.${userId}`;
  /** @returns {RememberedUpload[]} */
  const read = () => {
    try {
      const entries = JSON.parse(storage.getItem(key) ?? "[]");
      return Array.isArray(entries)
        ? entries.filter((entry) => typeof entry?.mark === "string" && now() - entry.at < KEPT_MS)
        : [];
    } catch {
      return [];
    }
  };
  /** @param {object[]} entries */
  const write = (entries) => {
    try {
      storage.setItem(key, JSON.stringify(entries));
    } catch {
      /* full or forbidden */
    }
  };
  return {
    all: read,
    /** @param {string} mark */
    find: (mark) => read().find((entry) => entry.mark === mark) ?? null,
    /** @param {string} mark @param {object} facts */
    keep(mark, facts) {
      const entries = read();
      const old = entries.find((entry) => entry.mark === mark) ?? {};
      write([...entries.filter((entry) => entry.mark !== mark), { ...old, ...facts, mark, at: now() }]);
    },
    /** @param {string} mark */
    forget: (mark) => write(read().filter((entry) => entry.mark !== mark)),
  };
}
