/** What inspections found at an asset: photos through time, and findings. */

import { h, icon } from "../dom.js";
import { t } from "../text.js";
import { mountFindings } from "./findings_list.js";
import { mountPhotos } from "./section.js";

/** @import { AssetDetailFeature } from "../api_types.d.ts" */

/** @param {AssetDetailFeature} feature @param {{ canPlan: boolean }} page */
export function resultsPart({ id }, { canPlan }) {
  const findings = h("div", {}, h("div", { class: "skeleton" }));
  const photos = h("div", {});
  mountFindings(findings, `asset=${id}`);
  mountPhotos(photos, { query: `asset=${id}`, stated: { asset: id }, canUpload: canPlan });
  return h(
    "div",
    {},
    h("h3", {}, icon("triangle-alert", "small"), t("Findings")),
    findings,
    h("h3", {}, icon("camera", "small"), t("Photos")),
    photos,
  );
}
