/** How a UAV is connected: by which door, when it was heard last, what it says of itself. Asked again while it is looked at. */

import { get } from "../api.js";
import { h } from "../dom.js";
import { t } from "../text.js";
import { percentText, whenText } from "../units.js";
import { LINKS } from "./words.js";

const ASKED_EVERY_MS = 5_000;
const LOST_AFTER_S = 11; // a UAV reports at least every ten seconds

/** "12 s ago", "4 min ago", then the time. */
export function agoText(seconds, iso) {
  if (seconds < 60) return t("{count} s ago", { count: Math.max(0, Math.round(seconds)) });
  return seconds < 3_600 ? t("{count} min ago", { count: Math.round(seconds / 60) }) : whenText(iso);
}

/** Of an answer of the API: one sentence, and whether it is heard at present. */
export function heardWords({ heard_at, heard_by, server_time }) {
  if (!heard_at) return { words: t("It has never been heard."), isHeard: false };
  const seconds = (Date.parse(server_time) - Date.parse(heard_at)) / 1_000;
  const door = LINKS[heard_by].by;
  return { words: t("Last heard {ago} {door}.", { ago: agoText(seconds, heard_at), door }), isHeard: seconds <= LOST_AFTER_S };
}

const term = (name, value) => (value ? [h("dt", {}, name), h("dd", {}, value)] : []);
const flightWords = ({ is_in_air, is_armed }) => (is_in_air ? t("in the air") : is_armed ? t("armed") : is_armed === false ? t("disarmed") : "");

function drawing(connection) {
  const { words, isHeard } = heardWords(connection);
  const { mode, autopilot, firmware, battery_percent, loaded_approval, loaded_flight } = connection;
  return [
    h("p", { class: isHeard ? "" : "quiet-text" }, words),
    h(
      "dl",
      { class: "facts" },
      term(t("Told by"), LINKS[connection.link].words),
      term(t("Mode"), [mode, flightWords(connection)].filter(Boolean).join(", ")),
      term(t("Charge now"), battery_percent === null ? "" : percentText(battery_percent)),
      term(t("Autopilot"), [autopilot, firmware].filter(Boolean).join(" ")),
      term(t("On it"), loaded_approval ? t("flight {number} of an approved mission", { number: loaded_flight }) : ""),
    ),
  ];
}

/** Draws itself into `place` until that is taken off the page. */
export async function mountConnection(place, uav) {
  const draw = async () => {
    const { data } = await get(`/uavs/${uav.id}/connection`);
    place.replaceChildren(...drawing(data));
  };
  await draw();
  const clock = setInterval(() => {
    if (!place.isConnected) clearInterval(clock);
    else if (document.visibilityState === "visible") draw().catch(() => {}); // what was heard last stays, and grows old
  }, ASKED_EVERY_MS);
}
