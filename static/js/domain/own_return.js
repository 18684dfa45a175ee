/** What is in the way when a UAV is told to return or abort: its autopilot flies home by itself, as high as its own parameters say. */

import { t } from "../text.js";
import { clockText, heightText } from "../units.js";

/** Of answers of the API; undefined while they are not there. */
export const returnOf = (returns, place) => returns?.find((check) => check.place === place);

/** Sentences for a question before Return or Abort: never none. */
export function returnLines(check) {
  if (!check) return [t("Its way home has not been checked: it flies straight, at a height of its own.")];
  return check.state === "clear" ? [clearText(check)] : check.warnings;
}

/** Under its name on the panel: { words, image, level }; null while nothing is known. */
export function returnSaid(check) {
  if (!check) return null;
  if (check.state === "clear") return { words: clearText(check), image: "rotate-ccw", level: null };
  return {
    words: check.warnings.join(" "),
    image: check.state === "in_the_way" ? "triangle-alert" : "info",
    level: check.state === "in_the_way" ? "warning" : null,
  };
}

function clearText({ height_m, read_at }) {
  const values = { height: heightText(height_m), time: clockText(read_at) };
  return t("Return and Abort: nothing in the way home, {height} above its take-off (read {time}).", values);
}
