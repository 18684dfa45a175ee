/** What the kinds of gaps are called, and what their figure means. */

import { t } from "../text.js";
import { lengthText } from "../units.js";

export const KINDS = {
  ends_apart: { name: "Should join", icon: "line" },
  dead_end: { name: "Dead ends", icon: "line" },
  long_span: { name: "Long spans", icon: "tower" },
  line_without_towers: { name: "Lines without towers", icon: "line" },
  missing_support: { name: "Towers missing", icon: "tower" },
  tower_on_no_line: { name: "Towers on no line", icon: "tower" },
  bridge_without_way: { name: "Bridges without a way", icon: "bridge" },
  impossible_voltage: { name: "Voltages", icon: "line" },
};

export const STATES = [
  { state: "open", name: "Open" },
  { state: "dismissed", name: "Left as it is" },
  { state: "repaired", name: "Repaired" },
];

/** "cuts off 34.2 km", or nothing where the gap cuts off nothing. */
export function cutOffText({ kind, cut_off_m: cutOff_m }) {
  if (!cutOff_m) return "";
  if (kind === "line_without_towers" || kind === "tower_on_no_line") return `concerns ${lengthText(cutOff_m)}`;
  return `cuts off ${lengthText(cutOff_m)}`;
}

/** Facts for the panel, beside what the sentence says: [term, value]. */
export function factsOf({ kind, details, cut_off_m: cutOff_m }) {
  const cut = cutOff_m ? [[cutOffText({ kind, cut_off_m: cutOff_m }).startsWith("cuts") ? t("Cuts off") : t("Concerns"), lengthText(cutOff_m)]] : [];
  switch (kind) {
    case "long_span":
      return [...cut, [t("Beyond it"), details.beyond_m ? lengthText(details.beyond_m) : t("also reached another way")]];
    case "missing_support":
      return [[t("Line"), lengthText(details.line_m)], [t("Without a tower"), lengthText(details.without_tower_m)]];
    case "dead_end":
      return [...cut, [t("Hangs together with it"), lengthText(details.network_m)]];
    case "impossible_voltage":
      return [[t("As tagged"), details.tagged || "—"]];
    default:
      return cut;
  }
}

/** What Spanwise cannot know, where that matters. */
export function cautionOf({ kind, details }) {
  if (kind === "dead_end") return t("Spanwise keeps no substations: if one stands here, leave the end as it is.");
  if (kind === "missing_support") return t("Vertices inside a substation may hang on its portals.");
  if (kind === "long_span" && !details.is_impossible) return t("A valley or a river may be crossed in one span.");
  return "";
}

export function dismissWords(kind) {
  return kind === "dead_end" ? t("It is meant to end here") : t("Leave it as it is");
}
