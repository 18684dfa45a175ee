/** Sessions of the user: each browser can be signed out from here. */

import { get, post, remove } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { exactText, whenText } from "../units.js";
import { proved } from "./reauthentication.js";
import { browserName } from "./sign_in_row.js";

/** @import { Answer } from "../api.js" */
/** @import { BrowserSession, BrowserSessionList } from "../api_types.d.ts" */
/** @import { Reporter } from "../page/problem.js" */

const PLACES = {
  "this-machine": t("the server itself"),
  "private-network": t("private network"),
  internet: t("internet"),
};

/** "203.0.113.7 (internet)". @param {Pick<BrowserSession, "address" | "place">} session */
export const whereText = ({ address, place }) =>
  address ? `${address} (${PLACES[place ?? "internet"]})` : t("address not known");

/** @param {Reporter} reporter */
export function mountSessions({ notify, settle }) {
  /** @param {BrowserSession} session */
  function row(session) {
    const name = browserName(session.user_agent);
    const times = session.is_this_one
      ? t("Signed in {began}", { began: whenText(session.began_at) })
      : t("Signed in {began}, last there {seen}", {
          began: whenText(session.began_at),
          seen: whenText(session.present_at),
        });
    const act = session.is_this_one
      ? h("span", { class: "chip active" }, icon("check"), t("This one"))
      : h(
          "button",
          {
            type: "button",
            class: "button quiet",
            "aria-label": t("Sign out {name}", { name }),
            onclick: () => end(session, name),
          },
          t("Sign out"),
        );
    return h(
      "li",
      { dataset: { session: session.id } },
      icon("monitor"),
      h(
        "div",
        { class: "what" },
        h("strong", { title: session.user_agent }, name),
        h("span", { class: "caption", title: exactText(session.began_at) }, [whereText(session), times].join(" · ")),
      ),
      act,
    );
  }

  async function load() {
    try {
      const { data } = /** @type {Answer<BrowserSessionList>} */ (await get("/account/sessions"));
      byId("sessions").replaceChildren(...data.results.map(row));
    } catch (error) {
      notify(t("Sessions could not be loaded."), error);
    }
  }

  /** @param {() => Promise<unknown>} send @param {string} words */
  async function act(send, words) {
    try {
      if ((await proved(send)) === null) return;
      settle();
      toast(words);
    } catch (error) {
      notify(t("Nobody was signed out."), error);
    }
    await load();
    byId("sessions").querySelector("button")?.focus({ preventScroll: true });
  }

  /** @param {BrowserSession} session @param {string} name */
  const end = (session, name) =>
    act(() => remove(`/account/sessions/${session.id}`), t("{name} is signed out.", { name }));
  byId("sign-out-everywhere").addEventListener("click", () =>
    act(() => post("/account/sign-out-everywhere"), t("Signed out in all other browsers.")),
  );

  return { load };
}
