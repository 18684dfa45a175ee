/** Report of a failed request, in the page's element for it (#problem). */

import { ApiError, signInAddress } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { t } from "../text.js";

/** How a part of a page reports the outcome of a request: notify(title, error) shows a fault, settle() removes it. */
/** @typedef {{ notify: (title: string, error: unknown) => void, settle: () => void }} Reporter */

/** Shows an error of the API; throws any other. @param {string} title @param {unknown} error */
export function notify(title, error) {
  if (!(error instanceof ApiError)) throw error;
  const way = error.isSignedOut ? h("a", { class: "text-button", href: signInAddress() }, t("Sign in")) : null;
  byId("problem").replaceChildren(
    h(
      "div",
      { class: "notice critical", role: "alert" },
      icon("circle-alert"),
      h("p", {}, h("strong", {}, title), ` ${error.message} `, way),
    ),
  );
  byId("problem").scrollIntoView({ block: "nearest" });
}

export function settle() {
  byId("problem").replaceChildren();
}
