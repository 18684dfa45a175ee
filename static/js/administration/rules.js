/** What an organisation asks for before a mission is approved. */

import { get, request } from "../api.js";
import { byId } from "../dom.js";
import { t } from "../text.js";

export function mountRules({ tell, settle }) {
  const asks = byId("requires-rehearsal");

  async function load() {
    try {
      asks.checked = (await get("/rehearsal-rule")).data.requires_green;
      asks.disabled = false;
    } catch (error) {
      tell(t("The rules could not be read."), error);
    }
  }

  asks.addEventListener("change", async () => {
    const wanted = asks.checked;
    asks.disabled = true;
    try {
      await request("PUT", "/rehearsal-rule", { body: { requires_green: wanted } });
      settle();
    } catch (error) {
      asks.checked = !wanted;
      tell(t("The rule was not changed."), error);
    } finally {
      asks.disabled = false;
      asks.focus();
    }
  });

  return { load };
}
