/** One sign-in as a row: what happened, when, from where, with which browser. */

import { h, icon } from "../dom.js";
import { t } from "../text.js";
import { exactText, whenText } from "../units.js";

/** @import { SignIn } from "../api_types.d.ts" */

/** @type {Record<SignIn["outcome"], { icon: string, words: string }>} */
export const OUTCOMES = {
  "signed-in": { icon: "check", words: t("Signed in") },
  wrong: { icon: "circle-x", words: t("Wrong name or password") },
  "wrong-code": { icon: "circle-x", words: t("Wrong code") },
  "held-back": { icon: "octagon-alert", words: t("Held back, too many tries") },
  refused: { icon: "octagon-alert", words: t("Refused after single sign-on") },
  "signed-out": { icon: "log-out", words: t("Signed out") },
};

/** @type {[RegExp, string][]} */
const BROWSERS = [
  [/Edg\//, "Edge"],
  [/OPR\//, "Opera"],
  [/Firefox\//, "Firefox"],
  [/Chrome\/|Chromium\/|CriOS\//, "Chrome"],
  [/Safari\//, "Safari"],
];
/** @type {[RegExp, string][]} */
const SYSTEMS = [
  [/Android/, "Android"],
  [/iPhone|iPad/, "iOS"],
  [/Windows/, "Windows"],
  [/Mac OS X|Macintosh/, "macOS"],
  [/Linux|X11/, "Linux"],
];

/** @param {[RegExp, string][]} names @param {string} agent */
const firstOf = (names, agent) => names.find(([sign]) => sign.test(agent))?.[1];

/** "Firefox, Windows"; an unusual browser's user agent is shown as it is. @param {string} agent */
export function browserName(agent) {
  const names = [firstOf(BROWSERS, agent), firstOf(SYSTEMS, agent)].filter(Boolean);
  return names.length ? names.join(", ") : agent.slice(0, 40) || "—";
}

/** @param {SignIn} entry */
export function signInRow(entry) {
  const outcome = OUTCOMES[entry.outcome];
  return h(
    "li",
    {},
    icon(outcome.icon),
    h(
      "div",
      { class: "what" },
      h("strong", {}, outcome.words),
      h(
        "span",
        { class: "caption", title: entry.user_agent },
        [browserName(entry.user_agent), entry.address].filter(Boolean).join(" · "),
      ),
    ),
    h(
      "time",
      { class: "caption when", datetime: entry.recorded_at, title: exactText(entry.recorded_at) },
      whenText(entry.recorded_at),
    ),
  );
}
