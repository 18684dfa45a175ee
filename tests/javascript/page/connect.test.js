import assert from "node:assert/strict";
import { test } from "node:test";
import { autopilotText, stateText, stepsOf } from "../../../static/js/fleet/connect.js";

const places = {
  server: "https://grid.example",
  gateway: [
    { protocol: "udp", host: "uavs.example", port: 14550, is_local: false },
    { protocol: "tcp", host: "uavs.example", port: 5760, is_local: false },
  ],
};
const uav = { link: "mavlink", mavlink_system_id: 7, allows_unsigned: false, position: [9.52, 47.14] };
const silent = { last_message_at: null, last_message_link: null, autopilot: "", firmware: "", vehicle_type: "" };
const PROGRAMS = ["mission_planner", "qgroundcontrol", "companion"];

test("an autopilot has the name of its firmware, with the version that its users know", () => {
  assert.equal(
    autopilotText({ autopilot: "ardupilot", firmware: "4.6.0", vehicle_type: "quadrotor" }),
    "ArduCopter 4.6",
  );
  assert.equal(
    autopilotText({ autopilot: "ardupilot", firmware: "4.5.7", vehicle_type: "fixed wing" }),
    "ArduPlane 4.5",
  );
  assert.equal(autopilotText({ autopilot: "px4", firmware: "1.15.2", vehicle_type: "hexarotor" }), "PX4 1.15");
  assert.equal(autopilotText({ autopilot: "ardupilot", firmware: "", vehicle_type: "" }), "ArduPilot");
});

test("a link waits for the first message, then names who is there", () => {
  assert.equal(stateText(silent), "Waiting for the first message…");
  const received = { ...silent, last_message_at: "2026-01-01T00:00:00Z", autopilot: "ardupilot", firmware: "4.6.1" };
  assert.equal(stateText({ ...received, vehicle_type: "quadrotor" }), "Received: ArduCopter 4.6");
});

test("each program has three steps, with this gateway's address and this UAV's id", () => {
  for (const program of PROGRAMS) {
    const steps = stepsOf(program, uav, places);
    assert.equal(steps.length, 3, program);
    const words = steps.map((step) => `${step.words} ${step.code ?? ""}`).join(" ");
    assert.match(words, /uavs\.example/, program);
    assert.match(words, /\b7\b/, program);
    assert.match(words, /setup_signing_send/, program);
  }
});

test("a UAV that needs no signature is told so instead of a key", () => {
  for (const program of PROGRAMS) {
    const words = JSON.stringify(stepsOf(program, { ...uav, allows_unsigned: true }, places));
    assert.match(words, /No key is needed/, program);
    assert.ok(!words.includes("setup_signing_send"), program);
  }
});

test("a companion over HTTP is started with this server and the UAV's place", () => {
  const [, start] = stepsOf("companion", { ...uav, link: "http" }, places);
  assert.match(start.code, /--server https:\/\/grid\.example --at 9\.52,47\.14$/);
});
