/** Files that were on their way when the page was closed: kept in this browser, each by its name, size and time. */

const KEPT_MS = 24 * 3_600_000; // the server forgets them then, too

export const markOf = ({ name, size, lastModified }) => `${name}\n${size}\n${lastModified}`;

/** storage: like localStorage; whatever it refuses or garbles is no more than a forgotten upload. */
export function createRememberedUploads(userId, storage = localStorage, now = () => Date.now()) {
  const key = `spanwise.uploads.${userId}`;
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
  const write = (entries) => {
    try {
      storage.setItem(key, JSON.stringify(entries));
    } catch {
      /* full or forbidden */
    }
  };
  return {
    all: read,
    find: (mark) => read().find((entry) => entry.mark === mark) ?? null,
    keep(mark, facts) {
      const entries = read();
      const old = entries.find((entry) => entry.mark === mark) ?? {};
      write([...entries.filter((entry) => entry.mark !== mark), { ...old, ...facts, mark, at: now() }]);
    },
    forget: (mark) => write(read().filter((entry) => entry.mark !== mark)),
  };
}
