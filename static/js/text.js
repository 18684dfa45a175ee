/** Texts in the language of the page. The English text in the code is the key; other languages are catalogues beside it. */

/** @typedef {Record<string, string | number | null | undefined>} Values of the places in braces */

/** @type {Record<string, () => Promise<{ default: Record<string, string | string[]> }>>} */
const CATALOGUES = { de: () => import("./locale/de.js") };

export const language = globalThis.document?.documentElement.lang?.split("-")[0] || "en";
/** @type {Record<string, any>} a text, or its two forms under the English singular */
const catalogue = CATALOGUES[language] ? (await CATALOGUES[language]()).default : {};
const plural = new Intl.PluralRules(language);

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
  return filled(catalogue[text] ?? text.replace(/\|\w+$/, ""), values);
}

/**
 * tn(3, "{count} target", "{count} targets"): the catalogue holds [one, other] under the English singular.
 *
 * @param {number} count
 * @param {string} one
 * @param {string} other
 * @param {Values} [values]
 * @returns {string}
 */
export function tn(count, one, other, values = {}) {
  const forms = catalogue[one] ?? [one, other];
  return filled(plural.select(count) === "one" ? forms[0] : forms[1], {
    count: count.toLocaleString(localeOf(language)),
    ...values,
  });
}

/** How dates and figures are written. @param {string} name of a language */
export function localeOf(name) {
  return name === "de" ? "de-DE" : "en-GB";
}
