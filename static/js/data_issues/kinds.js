/** Names of the kinds of issues, and the meaning of their figure. */

import { t } from "../text.js";
import { lengthText } from "../units.js";

/** @import { DataIssueKind } from "../api_types.d.ts" */
/** @import { DataIssue } from "./types.d.ts" */

/** @typedef {DataIssue["properties"]} Properties */

/** @type {Record<DataIssueKind, { name: string, icon: string }>} */
export const KINDS = {
  ends_apart: { name: t("Should join"), icon: "line" },
  dead_end: { name: t("Dead ends"), icon: "line" },
  long_span: { name: t("Long spans"), icon: "tower" },
  line_without_towers: { name: t("Lines without towers"), icon: "line" },
  missing_support: { name: t("Towers missing"), icon: "tower" },
  tower_on_no_line: { name: t("Towers on no line"), icon: "tower" },
  bridge_without_way: { name: t("Bridges without a way"), icon: "bridge" },
  impossible_voltage: { name: t("Voltages"), icon: "line" },
};

/** @type {{ state: Properties["state"], name: string }[]} */
export const STATES = [
  { state: "open", name: t("Open") },
  { state: "dismissed", name: t("Ignored") },
  { state: "repaired", name: t("Repaired") },
];

/**
 * "cuts off 34.2 km", or "" where the issue cuts off no network.
 *
 * @param {Pick<Properties, "kind" | "cut_off_m">} issue
 */
export function cutOffText({ kind, cut_off_m: cutOff_m }) {
  if (!cutOff_m) return "";
  return onlyConcerns(kind)
    ? t("concerns {length}", { length: lengthText(cutOff_m) })
    : t("cuts off {length} of network", { length: lengthText(cutOff_m) });
}

/** @param {DataIssueKind} kind */
const onlyConcerns = (kind) => kind === "line_without_towers" || kind === "tower_on_no_line";

/**
 * Facts for the panel, in addition to the sentence: [term, value].
 *
 * @param {Pick<Properties, "kind" | "details" | "cut_off_m">} issue
 * @returns {[string, string][]}
 */
export function factsOf({ kind, details, cut_off_m: cutOff_m }) {
  /** @type {[string, string][]} */
  const cut = cutOff_m ? [[onlyConcerns(kind) ? t("Concerns") : t("Cuts off"), lengthText(cutOff_m)]] : [];
  switch (kind) {
    case "long_span":
      return [
        ...cut,
        [t("Beyond it"), details.beyond_m ? lengthText(details.beyond_m) : t("also reached another way")],
      ];
    case "missing_support":
      return [
        [t("Line"), lengthText(details.line_m)],
        [t("Without a tower"), lengthText(details.without_tower_m)],
      ];
    case "dead_end":
      return [...cut, [t("Hangs together with it"), lengthText(details.network_m)]];
    case "impossible_voltage":
      return [[t("As tagged"), details.tagged || "—"]];
    default:
      return cut;
  }
}

/** A caution on facts that Spanwise cannot know, where they matter. @param {Pick<Properties, "kind" | "details">} issue */
export function cautionOf({ kind, details }) {
  if (kind === "dead_end") return t("Spanwise keeps no substations: if one stands here, leave the end as it is.");
  if (kind === "missing_support") return t("Vertices inside a substation may hang on its portals.");
  if (kind === "long_span" && !details.is_impossible) return t("A valley or a river may be crossed in one span.");
  return "";
}

/** @param {DataIssueKind} kind */
export function dismissWords(kind) {
  return kind === "dead_end" ? t("It is meant to end here") : t("Leave it as it is");
}
