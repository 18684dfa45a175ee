/** The log of sign-ins: user, address, browser, and outcome. */

import { browserName, OUTCOMES } from "../account/sign_in_row.js";
import { h, icon } from "../dom.js";
import { t, tn } from "../text.js";
import { exactText, whenText } from "../units.js";
import { filteredList } from "./filtered_list.js";

/** @import { SignIn } from "../api_types.d.ts" */
/** @import { Reporter } from "../page/problem.js" */

/** @param {SignIn} entry */
function row(entry) {
  const outcome = OUTCOMES[entry.outcome];
  return h(
    "tr",
    {},
    h("td", {}, h("span", { class: "outcome" }, icon(outcome.icon), outcome.words)),
    h("td", { class: "who" }, entry.username ?? h("span", { class: "unnamed" }, t("a name that nobody has"))),
    h("td", { class: "address" }, entry.address || "—"),
    h("td", { class: "browser", title: entry.user_agent }, browserName(entry.user_agent)),
    h("td", { class: "when", title: exactText(entry.recorded_at) }, whenText(entry.recorded_at)),
  );
}

/** @param {Pick<Reporter, "notify">} reporter */
export function mountSignIns({ notify }) {
  return filteredList({
    list: "sign-ins",
    path: "/sign-ins",
    filters: ["text", "address", "outcome", "days"],
    row,
    countWords: (count) => tn(count, "{count} entry", "{count} entries"),
    none: {
      icon: "history",
      title: t("Nobody has signed in yet"),
      words: t("Each sign-in and each try will stand here."),
    },
    notify,
    titleOfFault: t("Sign-ins could not be loaded."),
  });
}
