/** Texts in the language of the page. The English text in the code is the key; locale/<language>/LC_MESSAGES/djangojs.po has the others. */

/** @typedef {Record<string, string | number | null | undefined>} Values of the places in braces */
/** @typedef {Record<string, string | string[]>} Texts or their forms, under the English text or its singular */

const language = globalThis.document?.documentElement.lang || "en";
/** How Intl writes dates and figures; English is British. */
export const locale = language === "en" ? "en-GB" : language;

/** @type {string | null | undefined} of the compiled catalogue, from {% catalogue %} in the page's template; English has none */
const address = globalThis.document?.querySelector?.('meta[name="catalogue"]')?.getAttribute("content");
/** @type {{ default: Texts, form: (count: number) => number }} */
const catalogue = address ? await import(address) : { default: {}, form: () => 0 };

/** @param {string} text @param {Values} values */
function filled(text, values) {
  return text.replace(/\{(\w+)\}/g, (whole, name) => String(values[name] ?? whole));
}

/**
 * t("Saved as {name}.", { name }); t("Operator|role") where other languages have several words: what follows | is not shown.
 *
 * @param {string} text
 * @param {Values} [values]
 * @returns {string}
 */
export function t(text, values = {}) {
  return filled(String(catalogue.default[text] ?? text.replace(/\|\w+$/, "")), values);
}

/**
 * tn(3, "{count} target", "{count} targets"): in as many forms as the language has.
 *
 * @param {number} count
 * @param {string} one
 * @param {string} other
 * @param {Values} [values]
 * @returns {string}
 */
export function tn(count, one, other, values = {}) {
  const text = catalogue.default[one]?.[catalogue.form(count)] ?? (count === 1 ? one : other);
  return filled(text, { count: count.toLocaleString(locale), ...values });
}
