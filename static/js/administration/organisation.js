/** Name and time zone of the organisation. */

import { ApiError, get, patch } from "../api.js";
import { byId } from "../dom.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";

/** @import { Answer } from "../api.js" */
/** @import { Organisation } from "../api_types.d.ts" */
/** @import { Reporter } from "../page/problem.js" */

/** @param {Reporter} reporter */
export function mountOrganisation({ notify, settle }) {
  const name = byId("organisation-name", HTMLInputElement);
  const zone = byId("organisation-zone", HTMLSelectElement);
  let revision = 0;

  /** @param {Organisation} organisation */
  function show(organisation) {
    name.value = organisation.name ?? "";
    zone.value = organisation.time_zone ?? "";
    revision = organisation.revision;
  }

  async function load() {
    try {
      show(/** @type {Answer<Organisation>} */ (await get("/organisation")).data);
    } catch (error) {
      notify(t("The organisation could not be read."), error);
    }
  }

  byId("organisation-form").addEventListener("submit", async (event) => {
    event.preventDefault();
    const body = { name: name.value.trim(), time_zone: zone.value };
    try {
      const headers = { "If-Match": `"${revision}"` };
      const { data } = /** @type {Answer<Organisation>} */ (await patch("/organisation", body, { headers }));
      show(data);
      settle();
      toast(t("Saved. Open pages show it after they are loaded again."));
    } catch (error) {
      notify(t("The organisation was not changed."), error);
      if (error instanceof ApiError && error.status === 412) await load();
    }
  });

  return { load };
}
