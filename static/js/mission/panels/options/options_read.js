/** The options of a mission as text, for users who may not change them. */

import { byId } from "../../../dom.js";
import { t } from "../../../text.js";
import { powerText, zoneText } from "../../../units.js";
import { conditionsText, departureText } from "../../options/flight_options.js";
import { lostLinkText } from "../../options/lost_link.js";
import { OBJECTIVES } from "../../plan/plan_view.js";

/** @import { MissionStore } from "../../types.d.ts" */

/** @param {MissionStore} store */
export function mountOptionsRead(store) {
  store.listen(["selection"], ({ selection }) => {
    const best = OBJECTIVES.find(({ value }) => value === selection.objective)?.words ?? "";
    const end = selection.return_to_start ? t("UAVs fly back to where they took off") : t("UAVs do not all fly back");
    const { departs_at, conditions, charging_w, lost_link } = selection;
    const departure = departs_at
      ? t("Departure {moment} ({zone})", { moment: departureText(departs_at), zone: zoneText(departs_at) })
      : t("Departure at any time");
    byId("options-words").textContent = [
      best,
      departure,
      conditionsText(conditions),
      charging_w && t("charging on towers with {power}", { power: powerText(charging_w) }),
      end,
      t("without a link each UAV {does}", { does: lostLinkText(lost_link) }),
    ]
      .filter(Boolean)
      .join(" · ");
  });
}
