/** Texts in the language of the page. English is written in the code and is the key; other languages are catalogues beside it. */

const CATALOGUES = { de: () => import("./locale/de.js") };

export const language = globalThis.document?.documentElement.lang?.split("-")[0] || "en";
const catalogue = CATALOGUES[language] ? (await CATALOGUES[language]()).default : {};
const plural = new Intl.PluralRules(language);

function filled(text, values) {
  return text.replace(/\{(\w+)\}/g, (whole, name) => values[name] ?? whole);
}

/** t("Saved as {name}.", { name }); t("Operator|role") where other languages have several words: what follows | is not shown. */
export function t(text, values = {}) {
  return filled(catalogue[text] ?? text.replace(/\|\w+$/, ""), values);
}

/** tn(3, "{count} target", "{count} targets"): the catalogue holds [one, other] under the English singular. */
export function tn(count, one, other, values = {}) {
  const forms = catalogue[one] ?? [one, other];
  return filled(plural.select(count) === "one" ? forms[0] : forms[1], {
    count: count.toLocaleString(localeOf(language)),
    ...values,
  });
}

/** How dates and figures are written. */
export function localeOf(name) {
  return { en: "en-GB", de: "de-DE" }[name] ?? "en-GB";
}
