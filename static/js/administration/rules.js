/** Rules of an organisation: for a mission before approval, and for the login of all users. */

import { get, request } from "../api.js";
import { byId } from "../dom.js";
import { t } from "../text.js";

/** @import { Answer } from "../api.js" */
/** @import { Reporter } from "../page/problem.js" */

const RULES = [
  { id: "requires-rehearsal", path: "/rehearsal-rule", name: "requires_green" },
  { id: "requires-second-factor", path: "/second-factor-rule", name: "required" },
];

/** @typedef {typeof RULES[number]} Rule */

/** @param {Reporter} reporter */
export function mountRules({ notify, settle }) {
  /** @param {Rule} rule */
  async function show({ id, path, name }) {
    const { data } = /** @type {Answer<Record<string, boolean>>} */ (await get(path));
    const control = byId(id, HTMLInputElement);
    control.checked = data[name];
    control.disabled = Boolean(data.is_of_the_installation);
    control.title = data.is_of_the_installation ? t("Whoever runs this installation asks for it.") : "";
  }

  async function load() {
    try {
      await Promise.all(RULES.map(show));
    } catch (error) {
      notify(t("The rules could not be read."), error);
    }
  }

  for (const { id, path, name } of RULES) {
    const rule = byId(id, HTMLInputElement);
    rule.addEventListener("change", async () => {
      const wanted = rule.checked;
      rule.disabled = true;
      try {
        await request("PUT", path, { body: { [name]: wanted } });
        settle();
      } catch (error) {
        rule.checked = !wanted;
        notify(t("The rule was not changed."), error);
      } finally {
        rule.disabled = false;
        rule.focus();
      }
    });
  }

  return { load };
}
