/** Campaigns above the list of missions. */

import { get } from "../api.js";
import { byId, h, icon, setChildren } from "../dom.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { whenText } from "../units.js";

/** @import { Answer } from "../api.js" */
/** @import { CampaignPage, CampaignSummary } from "../api_types.d.ts" */

const SHOWN = 5;

/** @param {CampaignSummary} campaign */
function factsOf({ planned_at, day_count, mission_count, target_count, updated_at }) {
  if (!planned_at)
    return [tn(target_count, "{count} target", "{count} targets"), t("not planned yet"), whenText(updated_at)];
  return [
    tn(day_count, "{count} day", "{count} days"),
    tn(mission_count, "{count} mission", "{count} missions"),
    t("planned {when}", { when: whenText(planned_at) }),
  ];
}

/** Show the newest campaigns, `limit` of them; the section stays hidden where there is none. */
export async function showCampaigns(limit = SHOWN) {
  const { data } = /** @type {Answer<CampaignPage>} */ (await get(`/campaigns?limit=${limit}`));
  const section = byId("campaigns");
  section.hidden = data.results.length === 0;
  setChildren(
    section,
    h("h2", { id: "campaigns-title" }, t("Campaigns")),
    h(
      "ul",
      {},
      data.results.map((campaign) =>
        h(
          "li",
          {},
          icon("calendar-clock", "small"),
          h("a", { href: `/campaigns/${campaign.id}` }, campaign.name),
          h("span", { class: "caption" }, factsOf(campaign).join(" · ")),
        ),
      ),
    ),
    data.next !== null &&
      h(
        "button",
        {
          type: "button",
          class: "text-button",
          onclick: () => void showCampaigns(limit * 4).catch(({ message }) => toast(message)),
        },
        t("More campaigns"),
      ),
  );
}
