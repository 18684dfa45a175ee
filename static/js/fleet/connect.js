/** How a UAV is connected the first time: the gateway's address, steps for three programs, and whether messages arrive. */

import { h, icon, segments } from "../dom.js";
import { copyText } from "../page/clipboard.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";

/** @import { UavConnection } from "../api_types.d.ts" */
/** @import { Child } from "../dom.js" */
/** @import { Uav } from "./types.d.ts" */

/** @typedef {"mission_planner" | "qgroundcontrol" | "companion"} Program */
/** @typedef {Pick<UavConnection, "gateway" | "server">} Places */

/** @type {[Program, string][]} */
const PROGRAMS = [
  ["mission_planner", "Mission Planner"],
  ["qgroundcontrol", "QGroundControl"],
  ["companion", t("Companion computer")],
];

const SIGNING_SCRIPT = `from pymavlink import mavutil

key = bytes.fromhex(input("key: "))
vehicle = mavutil.mavlink_connection("/dev/ttyACM0", baud=115200)
vehicle.wait_heartbeat()
for _ in range(5):  # it is not acknowledged
    vehicle.mav.setup_signing_send(vehicle.target_system, vehicle.target_component, list(key), 0)
`;

const COPTERS = /rotor|copter|coaxial/;
/** @type {Record<string, (vehicle: string) => string>} */
const AUTOPILOTS = {
  ardupilot: (vehicle) => {
    if (COPTERS.test(vehicle)) return "ArduCopter";
    return vehicle === "fixed wing" || vehicle.startsWith("vtol") ? "ArduPlane" : "ArduPilot";
  },
  px4: () => "PX4",
};

/** "ArduCopter 4.6". @param {Pick<UavConnection, "autopilot" | "firmware" | "vehicle_type">} connection */
export function autopilotText({ autopilot, firmware, vehicle_type }) {
  const name = AUTOPILOTS[autopilot]?.(vehicle_type) ?? autopilot;
  return [name, firmware.split(".").slice(0, 2).join(".")].filter(Boolean).join(" ");
}

/** @param {UavConnection} connection */
export function stateText(connection) {
  if (!connection.last_message_at) return t("Waiting for the first message…");
  const who = autopilotText(connection);
  return who ? t("Received: {autopilot}", { autopilot: who }) : t("Received");
}

/** @param {string} words */
async function copy(words) {
  toast((await copyText(words)) ? t("Copied.") : t("This browser does not allow copying: mark the text and copy it."));
}

/** @param {string} label @param {string} words */
const copied = (label, words) => [
  h("dt", {}, label),
  h(
    "dd",
    {},
    h("code", {}, words),
    h(
      "button",
      {
        type: "button",
        class: "icon-button",
        title: t("Copy"),
        "aria-label": t("Copy: {what}", { what: label }),
        onclick: () => copy(words),
      },
      icon("copy", "small"),
    ),
  ),
];

/** @param {Places} places @param {"udp" | "tcp"} protocol */
function addressOf({ gateway }, protocol) {
  const found = gateway.find((one) => one.protocol === protocol);
  return found ? { host: found.host, port: `${found.port}` } : { host: "—", port: "—" };
}

/** @param {Uav} uav */
const keyStep = (uav) =>
  uav.allows_unsigned
    ? t("No key is needed: MAVLink without a signature is allowed for this UAV.")
    : t("Create the MAVLink signing key below. Write it into the autopilot over the cable, with the script.");

/**
 * The steps of a program: texts, and commands to copy.
 *
 * @param {Program} program
 * @param {Uav} uav
 * @param {Places} places
 * @returns {{ words: string, code?: string }[]}
 */
export function stepsOf(program, uav, places) {
  const id = { id: uav.mavlink_system_id ?? "—" };
  const [udp, tcp] = [addressOf(places, "udp"), addressOf(places, "tcp")];
  const key = { words: keyStep(uav), ...(uav.allows_unsigned ? {} : { code: SIGNING_SCRIPT }) };
  if (program === "mission_planner")
    return [
      {
        words: t(
          "By USB, under Config, Full Parameter List: set MAV_SYSID (before ArduPilot 4.7 SYSID_THISMAV) to {id}, write it and restart the autopilot.",
          id,
        ),
      },
      key,
      {
        words: t(
          "Connected by radio, under Setup, Advanced, MAVLink Mirror: choose TCP Client, tick Write access, and connect to {host}, port {port}.",
          tcp,
        ),
      },
    ];
  if (program === "qgroundcontrol")
    return [
      {
        words: t(
          "By USB, under Vehicle Configuration, Parameters: set MAV_SYS_ID (ArduPilot: MAV_SYSID or SYSID_THISMAV) to {id} and restart the autopilot.",
          id,
        ),
      },
      key,
      {
        words: t(
          "Under Application Settings, MAVLink: switch on MAVLink forwarding to {host}:{port}. It forwards to Spanwise only: missions and commands need a link of the vehicle itself.",
          udp,
        ),
      },
    ];
  if (uav.link === "mavlink")
    return [
      { words: t("Set the system id {id} in the autopilot's parameters.", id) },
      key,
      {
        words: t("Run MAVLink Router on the companion, with the autopilot's serial port:"),
        code: `mavlink-routerd -e ${udp.host}:${udp.port} /dev/ttyACM0:115200`,
      },
    ];
  const [lon, lat] = uav.position;
  return [
    { words: t("Create the token of the HTTP link below.") },
    {
      words: t("Run the reference companion, first with its simulated autopilot:"),
      code: `SPANWISE_UAV_TOKEN=spu_… python -m examples.companion --server ${places.server} --at ${lon},${lat}`,
    },
    { words: t("Put your autopilot in the place of the simulated one, as examples/companion/README.md describes.") },
  ];
}

/** @param {{ words: string, code?: string }} step */
const stepRow = ({ words, code }) =>
  h(
    "li",
    {},
    words,
    code && [
      h("pre", { tabindex: 0 }, code),
      h(
        "button",
        { type: "button", class: "text-button", onclick: () => copy(code) },
        icon("copy", "small"),
        t("Copy"),
      ),
    ],
  );

/** @param {Uav} uav @param {Places} places @returns {Child} */
function addressRows(uav, { gateway, server }) {
  if (uav.link === "http") return copied(t("Server"), server);
  if (!gateway.length) return [h("dt", {}, t("Gateway")), h("dd", {}, t("This installation has no MAVLink gateway."))];
  const systemId = uav.mavlink_system_id;
  return [
    gateway.map(({ protocol, host, port }) => copied(`MAVLink, ${protocol.toUpperCase()}`, `${host}:${port}`)),
    systemId === null
      ? [h("dt", {}, t("System id")), h("dd", {}, t("Not set: state it under Edit."))]
      : copied(t("System id"), `${systemId}`),
  ];
}

/**
 * Draws itself into `place` once, so that focus stays; returns what shows the present state of the link.
 *
 * @param {HTMLElement} place
 * @param {Uav} uav
 * @param {UavConnection} connection
 */
export function mountConnect(place, uav, connection) {
  const state = h("p", { class: "connect-state", role: "status" });
  const steps = h("ol", { class: "connect-steps" });
  /** @param {Program} program */
  const choose = (program) => steps.replaceChildren(...stepsOf(program, uav, connection).map(stepRow));
  /** @type {Program} */
  const first = uav.link === "http" ? "companion" : "mission_planner";
  const isLocal = uav.link === "mavlink" && connection.gateway.some(({ is_local }) => is_local);
  place.replaceChildren(
    h(
      "details",
      { class: "connect", open: connection.last_message_at === null && uav.state !== "retired" },
      h("summary", {}, t("Connect")),
      state,
      h("dl", { class: "facts" }, addressRows(uav, connection)),
      isLocal &&
        h(
          "p",
          { class: "caption" },
          t("The gateway listens on its own machine only: see SPANWISE_GATEWAY_UDP and SPANWISE_GATEWAY_TCP."),
        ),
      uav.link === "mavlink" &&
        h(
          "fieldset",
          { class: "segments line" },
          h("legend", { class: "unseen" }, t("Program")),
          segments("connect-program", PROGRAMS, first, (program) => choose(/** @type {Program} */ (program))),
        ),
      steps,
    ),
  );
  choose(first);
  /** @param {UavConnection} now */
  return (now) => {
    const words = stateText(now);
    if (state.textContent === words) return;
    state.classList.toggle("received", now.last_message_at !== null);
    state.replaceChildren(icon(now.last_message_at ? "check" : "radio", "small"), words);
  };
}
