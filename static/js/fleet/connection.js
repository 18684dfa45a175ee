/** How a UAV is connected: its link, its last message, its own report. Polled while it is shown. */

import { get } from "../api.js";
import { focalText, pixelsText } from "../cameras/words.js";
import { h, term } from "../dom.js";
import { t } from "../text.js";
import { agoText, percentText } from "../units.js";
import { LINKS } from "./words.js";

/** @import { Answer } from "../api.js" */
/** @import { ReportedCamera, UavConnection } from "../api_types.d.ts" */

const ASKED_EVERY_MS = 5_000;
const WAITING_MS = 2_000; // before the first message, which a technician waits for beside the UAV
const LOST_AFTER_S = 11; // a UAV reports at least every ten seconds

/**
 * One sentence, and whether messages arrive at present.
 *
 * @param {Pick<UavConnection, "last_message_at" | "last_message_link" | "server_time">} connection
 */
export function receivedWords({ last_message_at, last_message_link, server_time }) {
  if (!last_message_at) return { words: t("Never connected."), isReceived: false };
  const seconds = (Date.parse(server_time) - Date.parse(last_message_at)) / 1_000;
  const endpoint = last_message_link ? LINKS[last_message_link].by : "";
  return {
    words: t("Last contact {ago} {link}.", { ago: agoText(seconds, last_message_at), link: endpoint }),
    isReceived: seconds <= LOST_AFTER_S,
  };
}

/** @param {UavConnection} connection */
const flightWords = ({ is_in_air, is_armed }) =>
  is_in_air ? t("in the air") : is_armed ? t("armed") : is_armed === false ? t("disarmed") : "";

const DOUBTS = {
  rebooted: t("not known since it has booted"),
  "other-station": t("not known since another ground station has changed its lists"),
  "other-length": t("not known since its list has another length"),
};

/**
 * "flight 1 of an approved mission, read back 3 min ago".
 *
 * @param {Pick<UavConnection, "loaded_flight" | "loaded_read_at" | "loaded_doubt" | "server_time">} loaded
 */
export function loadedText({ loaded_flight, loaded_read_at, loaded_doubt, server_time }) {
  const what = t("flight {number} of an approved mission", { number: loaded_flight });
  if (!loaded_read_at) return what;
  const ago = agoText((Date.parse(server_time) - Date.parse(loaded_read_at)) / 1_000, loaded_read_at);
  const summary = t("{what}, verified {ago}", { what, ago });
  return loaded_doubt ? `${summary}; ${DOUBTS[loaded_doubt]}` : summary;
}

/** "DJI M30T, 4,000 × 3,000, 24 mm". @param {ReportedCamera} camera */
export function reportedCameraText({ name, pixels_wide, pixels_high, focal_length_mm }) {
  const pixels = pixels_wide && pixels_high ? pixelsText({ pixels_wide, pixels_high }) : "";
  return [name, pixels, focal_length_mm && focalText([focal_length_mm])].filter(Boolean).join(", ");
}

/** @param {UavConnection} connection */
function drawing(connection) {
  const { words, isReceived } = receivedWords(connection);
  const { mode, autopilot, firmware, vehicle_type, warnings, battery_percent, loaded_approval } = connection;
  const { received_bytes_s, received_messages_s } = connection;
  return [
    h("p", { class: isReceived ? "" : "quiet-text" }, words),
    ...warnings.map((warning) => h("p", { class: "notice warning" }, warning)),
    h(
      "dl",
      { class: "facts" },
      term(t("Command link"), LINKS[connection.link].words),
      term(t("Mode"), [mode, flightWords(connection)].filter(Boolean).join(", ")),
      term(t("Charge now"), battery_percent === null ? "" : percentText(battery_percent)),
      term(t("Autopilot"), [[autopilot, firmware].filter(Boolean).join(" "), vehicle_type].filter(Boolean).join(", ")),
      term(
        t("Received"),
        received_bytes_s === null
          ? ""
          : t("{bytes} bytes/s in {messages} messages/s", {
              bytes: Math.round(received_bytes_s),
              messages: Math.round(received_messages_s ?? 0),
            }),
      ),
      term(t("On it"), loaded_approval ? loadedText(connection) : ""),
      connection.cameras.map((camera) => term(t("Camera"), reportedCameraText(camera))),
    ),
  ];
}

/**
 * Draw into `place` until it is removed from the page, and call `onAnswer` with each answer.
 *
 * @param {HTMLElement} place
 * @param {{ id: number }} uav
 * @param {(connection: UavConnection) => void} [onAnswer]
 */
export async function mountConnection(place, uav, onAnswer = () => {}) {
  const draw = async () => {
    const { data } = /** @type {Answer<UavConnection>} */ (await get(`/uavs/${uav.id}/connection`));
    place.replaceChildren(...drawing(data));
    onAnswer(data);
    return data;
  };
  /** @param {UavConnection | null} last */
  const again = (last) =>
    setTimeout(
      async () => {
        if (!place.isConnected) return;
        const isSeen = document.visibilityState === "visible";
        again(isSeen ? await draw().catch(() => last) : last); // the last message stays, with its age
      },
      last?.last_message_at ? ASKED_EVERY_MS : WAITING_MS,
    );
  again(await draw());
}
