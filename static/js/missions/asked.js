/** Filters and order of the list: from the page's address to a request and back. Values in, values out. */

/** @typedef {"text" | "state" | "author" | "uav" | "changed" | "from" | "to" | "order"} TextName */
/** @typedef {"stale" | "deleted"} FlagName */
/** @typedef {Record<TextName, string> & Record<FlagName, boolean>} Asked */

/** @type {Readonly<Asked>} */
export const NOTHING = Object.freeze({
  text: "",
  state: "",
  author: "",
  uav: "",
  changed: "",
  from: "",
  to: "",
  stale: false,
  deleted: false,
  order: "-changed",
});
export const PAGE_SIZE = 25;
/** @type {Record<string, number>} */
export const LAST_DAYS = { 1: 1, 7: 7, 30: 30 };
/** @type {FlagName[]} */
const FLAGS = ["stale", "deleted"];
const NAMES = /** @type {(keyof Asked)[]} */ (Object.keys(NOTHING));

/** @param {string} search of the page's address */
export function askedOf(search) {
  const parameters = new URLSearchParams(search);
  return /** @type {Asked} */ ({
    ...Object.fromEntries(NAMES.map((name) => [name, parameters.get(name) ?? NOTHING[name]])),
    ...Object.fromEntries(FLAGS.map((name) => [name, parameters.get(name) === "true"])),
  });
}

/** "?state=draft&order=name": what differs from the defaults. @param {Asked} asked */
export function searchOf(asked) {
  const parameters = new URLSearchParams();
  for (const name of NAMES) if (asked[name] !== NOTHING[name]) parameters.set(name, String(asked[name]));
  const search = parameters.toString();
  return search ? `?${search}` : "";
}

/** @param {string} day "2026-11-30" */
const startOf = (day, plusDays = 0) => {
  const [year, month, date] = day.split("-").map(Number);
  return new Date(year, month - 1, date + plusDays).toISOString();
};

/**
 * The path and query of the API. Days are in the reader's time zone; the last one is included.
 *
 * @param {Asked} asked
 * @param {Date} [now]
 */
export function requestOf(asked, now = new Date()) {
  const parameters = new URLSearchParams({ limit: String(PAGE_SIZE), order: asked.order });
  for (const name of /** @type {const} */ (["state", "author", "uav"]))
    if (asked[name]) parameters.set(name, asked[name]);
  if (asked.text.trim()) parameters.set("text", asked.text.trim());
  for (const name of FLAGS) if (asked[name]) parameters.set(name, "true");
  if (LAST_DAYS[asked.changed]) {
    parameters.set(
      "changed_from",
      new Date(now.getFullYear(), now.getMonth(), now.getDate() - LAST_DAYS[asked.changed] + 1).toISOString(),
    );
  } else if (asked.changed === "between") {
    if (asked.from) parameters.set("changed_from", startOf(asked.from));
    if (asked.to) parameters.set("changed_before", startOf(asked.to, 1));
  }
  return `/missions?${parameters}`;
}

/** Count of filled fields behind "More filters". @param {Asked} asked */
export function countOfFields({ author, uav, changed, stale }) {
  return [author, uav, changed, stale].filter(Boolean).length;
}

/** @param {Asked} asked */
export const isFiltered = (asked) => searchOf({ ...asked, order: NOTHING.order }) !== "";

/**
 * The order after a click on a column: names and users ascending first, figures and times descending first, then reversed.
 *
 * @param {string} order
 * @param {string} column
 */
export function nextOrder(order, column) {
  const first = ["name", "author", "state"].includes(column) ? column : `-${column}`;
  const other = first.startsWith("-") ? column : `-${column}`;
  return order === first ? other : first;
}
