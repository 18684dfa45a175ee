import assert from "node:assert/strict";
import { test } from "node:test";

import { loadedText, receivedWords } from "../../../static/js/fleet/connection.js";
import { aboutVehicle } from "../../../static/js/fleet/unknown_vehicles.js";
import { agoText } from "../../../static/js/units.js";

const received = (last_message_at, last_message_link = "mavlink") =>
  receivedWords({ last_message_at, last_message_link, server_time: "2026-11-22T12:00:12Z" });

test("when a UAV was heard is told by the server's clock, with the door", () => {
  assert.deepEqual(received("2026-11-22T12:00:00Z"), { words: "Last contact 12 s ago by MAVLink.", isReceived: false });
  assert.deepEqual(received("2026-11-22T12:00:07Z", "http"), {
    words: "Last contact 5 s ago over HTTP.",
    isReceived: true,
  });
  assert.deepEqual(received(null, null), { words: "Never connected.", isReceived: false });
});

test("what was heard a moment ahead of the clock was heard now", () => {
  assert.equal(received("2026-11-22T12:00:13Z").words, "Last contact 0 s ago by MAVLink.");
});

test("an age is told in seconds, then in minutes", () => {
  assert.equal(agoText(59.4, ""), "59 s ago");
  assert.equal(agoText(61, ""), "1 min ago");
  assert.equal(agoText(3_500, ""), "58 min ago");
});

test("of a vehicle that nobody knows only what is known is told", () => {
  const vehicle = {
    autopilot: "px4",
    vehicle_type: "",
    address: "udp 10.0.0.7:14550",
    is_signed: false,
    last_message_at: "2026-11-22T12:00:00Z",
  };
  assert.equal(
    aboutVehicle(vehicle, Date.parse("2026-11-22T12:00:03Z")),
    "px4 · udp 10.0.0.7:14550 · not signed · last contact 3 s ago",
  );
});

test("what is on a UAV is as old as its last reading, and doubted once something else may be there", () => {
  const link = {
    loaded_flight: 2,
    loaded_read_at: "2027-05-04T09:00:00Z",
    loaded_doubt: "",
    server_time: "2027-05-04T09:03:10Z",
  };
  assert.equal(loadedText(link), "flight 2 of an approved mission, verified 3 min ago");
  assert.equal(
    loadedText({ ...link, loaded_doubt: "rebooted" }),
    "flight 2 of an approved mission, verified 3 min ago; not known since it has booted",
  );
});
