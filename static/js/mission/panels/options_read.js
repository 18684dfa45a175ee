/** The options of a mission in words, for those who may not change them. */

import { byId } from "../../dom.js";
import { t } from "../../text.js";
import { OBJECTIVES } from "../plan_view.js";

export function mountOptionsRead(store) {
  store.listen(["selection"], ({ selection }) => {
    const best = OBJECTIVES.find(({ value }) => value === selection.objective)?.words ?? "";
    const end = selection.return_to_start ? t("UAVs fly back to where they took off") : t("UAVs do not all fly back");
    byId("options-words").textContent = [best, end].filter(Boolean).join(" · ");
  });
}
