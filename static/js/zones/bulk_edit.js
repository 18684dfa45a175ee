/** Facts of zones that can be corrected for many at once. */

import { limitField } from "../domain/zone_heights.js";
import { t, tn } from "../text.js";
import { numberText } from "../units.js";
import { reasonField, restrictionField } from "./form.js";
import { scheduleEditor } from "./schedule_editor.js";

/** @import { ZoneFeature } from "../api_types.d.ts" */
/** @import { BulkEdit, BulkFact } from "../register/types.d.ts" */

/** @type {Record<string, BulkFact>} */
const FACTS = {
  restriction: { words: t("Restriction"), field: () => restrictionField("", "bulk-restriction") },
  reason: { words: t("Reason"), field: () => reasonField("") },
  upper_limit: { words: t("Upper limit"), field: () => limitField("upper", t("Upper limit"), null) },
  lower_limit: { words: t("Lower limit"), field: () => limitField("lower", t("Lower limit"), null) },
  schedule: { words: t("When it applies"), field: () => scheduleEditor(null) },
};

/** @param {() => unknown} reload @returns {BulkEdit<ZoneFeature>} */
export const zoneEdit = (reload) => ({
  path: "/zones/edits",
  facts: FACTS,
  chosen: (rows) => ({ zones: rows.map(({ id, properties: { revision } }) => ({ id, revision })) }),
  note: t(
    "It replaces what these zones state. Later imports leave them alone, and each keeps its history. Plans made before are out of date.",
  ),
  words: {
    change: (count) => tn(count, "Change {count} zone", "Change {count} zones", { count: numberText(count) }),
    changed: (count) => tn(count, "{count} zone changed.", "{count} zones changed.", { count: numberText(count) }),
    undone: (count) =>
      tn(count, "{count} zone is as before.", "{count} zones are as before.", { count: numberText(count) }),
    kept: (count) => tn(count, "{count} was changed since and stays.", "{count} were changed since and stay."),
    tooMany: (most) => t("At most {most} zones at once: narrow the filters.", { most }),
  },
  reload,
});
