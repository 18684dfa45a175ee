/** Turn the targets and UAVs of the page into a campaign: missions from several launch sites over several days. */

import { post } from "../../api.js";
import { openRules } from "../../campaign/rules_form.js";
import { t } from "../../text.js";
import { requestOf } from "../selection.js";
import { proposedName } from "../targets/proposed_name.js";

/** @import { Answer } from "../../api.js" */
/** @import { Campaign, CampaignInputRequest } from "../../api_types.d.ts" */
/** @import { MissionPageState } from "../types.d.ts" */

const MAX_NAME_LENGTH = 150;
const MAX_PLACE_LENGTH = 100;

/**
 * The body of /campaigns without its rules: UAVs start at launch sites, so departure, locks and ends of routes do not count.
 *
 * @param {Pick<MissionPageState, "name" | "selection">} state
 * @returns {Omit<CampaignInputRequest, "rules">}
 */
export function campaignOf({ name, selection }) {
  const { locks: _locks, departs_at: _departs, return_to_start: _returns, ...request } = requestOf(selection);
  const words = name.trim() || proposedName(selection.targets) || t("Campaign");
  return { ...request, name: words.slice(0, MAX_NAME_LENGTH) };
}

/** Why there can be no campaign yet; "" where there can. @param {Pick<MissionPageState, "selection">} state */
export function whyNoCampaign({ selection }) {
  if (selection.targets.length === 0) return t("Add targets first.");
  return selection.uavs.length === 0 ? t("Add a UAV first.") : "";
}

/** Ask for crews and reach, and open the page of the campaign. @param {MissionPageState} state */
export async function planFromLaunchSites(state) {
  const asked = campaignOf(state);
  await openRules({
    title: t("Plan from launch sites over several days"),
    act: t("Plan the campaign"),
    name: asked.name,
    starts: state.selection.uavs.map(({ name, position }) => ({
      name: t("Start of {uav}", { uav: name }).slice(0, MAX_PLACE_LENGTH),
      position,
    })),
    async send({ name, rules, key }) {
      const headers = { "Idempotency-Key": key };
      const { data } = /** @type {Answer<Campaign>} */ (
        await post("/campaigns", { ...asked, name, rules }, { headers })
      );
      location.assign(`/campaigns/${data.id}`);
    },
  });
}
