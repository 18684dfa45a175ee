/** Shapes of the page of a campaign. */

import type { GroundPage } from "../ground/types.d.ts";

/** What the server writes into the page. */
export interface CampaignPageData extends GroundPage {
  campaign: string;
}
