import assert from "node:assert/strict";
import test from "node:test";

import * as flying from "../../../static/js/domain/flying.js";

const route = (uav, more = {}) => ({ uav: `UAV ${uav}`, uav_id: uav, geometry: {}, length_m: 1000, ...more });
const mission = (state, more = {}) => ({
  state,
  is_stale: false,
  stale_causes: [],
  plan: { routes: [route(7), route(8)] },
  approval: {
    id: "a",
    approved_by: "opal",
    approved_at: "2027-05-04T09:00:00Z",
    revoke_requested_at: null,
    revoke_reason: "",
    flights: [
      { uav: 0, flights: 1, flown: 0 },
      { uav: 1, flights: 2, flown: 0 },
    ],
  },
  ...more,
});
const command = (kind, state, more = {}) => ({
  id: `${kind}-${state}`,
  kind,
  state,
  uav: { id: 7, name: "Kite" },
  approval: "a",
  parameters: kind === "upload-mission" || kind === "start" ? { flight: 1 } : {},
  progress: null,
  outcome: "",
  outcome_code: "",
  created_at: "2027-05-04T09:00:00Z",
  sent_at: null,
  acknowledged_at: null,
  finished_at: null,
  ...more,
});
const words = (...commands) => flying.boardWords(flying.boardOf(commands, 7)).words;

test("what is approved and after that is frozen", () => {
  const frozen = ["draft", "planned", "approved", "dispatched", "active", "completed", "aborted", "failed"].filter(
    (state) => flying.isFrozen({ state }),
  );
  assert.deepEqual(frozen, ["approved", "dispatched", "active", "completed", "aborted", "failed"]);
});

test("what would be refused is not offered: nothing moves without a mission on its way", () => {
  const why = (kind, now, commands = []) => flying.whyNotMoved(kind, now, flying.flyersOf(now)[0], commands);
  const flights = [{ uav: 0, flights: 1, flown: 0, has_failed: true }];
  const { approval } = mission("active");
  for (const kind of ["arm", "take-off", "start", "resume"]) {
    assert.equal(why(kind, mission("approved")), "UAV 7 has no mission.");
    assert.equal(
      why(kind, mission("active", { approval: { ...approval, revoke_requested_at: "2027-05-04T10:00:00Z" } })),
      "The approval is being revoked.",
    );
    assert.match(why(kind, mission("active", { approval: { ...approval, flights } })), /has failed/);
  }
  assert.equal(why("arm", mission("dispatched")), "");
  assert.equal(why("take-off", mission("active")), "");
  assert.match(why("resume", mission("active")), /not started/);
  assert.match(
    why("resume", mission("dispatched"), [command("start", "sent", { sent_at: "2027-05-04T09:00:00Z" })]),
    /not started/,
  );
  assert.equal(
    why("resume", mission("active"), [command("start", "applied", { sent_at: "2027-05-04T09:00:00Z" })]),
    "",
  );
  for (const kind of ["hold", "return", "land", "abort", "pause", "change-speed"])
    assert.equal(why(kind, mission("approved")), "");
});

test("what is on board is as old as its reading, and may not be there any more", () => {
  const upload = command("upload-mission", "applied", { finished_at: "2027-05-04T09:00:00Z" });
  const link = {
    loaded_approval: "a",
    loaded_read_at: "2027-05-04T09:00:00Z",
    loaded_doubt: "",
    server_time: "2027-05-04T09:03:10Z",
  };
  const { words: seen, level } = flying.boardWords(upload, link);
  assert.deepEqual([seen, level], ["Uploaded, verified 3 min ago", "good"]);
  const doubted = flying.boardWords(upload, { ...link, loaded_doubt: "other-station" });
  assert.equal(doubted.level, "warning");
  assert.match(doubted.words, /uncertain now: another ground station/);
  const gone = { ...link, loaded_approval: null };
  assert.match(flying.boardWords(upload, gone).words, /Mission on the UAV unknown/);
  const [flyer] = flying.flyersOf(mission("dispatched"));
  assert.deepEqual([flying.flightToSend(flyer, [upload], link), flying.flightToSend(flyer, [upload], gone)], [null, 1]);
  assert.equal(flying.flightToSend(flyer, [upload], { ...gone, server_time: "2027-05-04T08:59:00Z" }), null); // asked before it was there
});

test("a start that waits for the reading says how far that is", () => {
  const start = command("start", "queued", { progress: { done: 34, total: 200 } });
  assert.equal(flying.commandWords(start).words, "Start: verifying the mission on board, 34 of 200 items");
});

test("UAVs that fly no route are not told anything", () => {
  const [first, second] = flying.flyersOf(
    mission("approved", { plan: { routes: [route(7, { geometry: null }), route(8)] } }),
  );
  assert.deepEqual([first.place, first.letter, first.uav, first.flights], [1, "B", 8, 2]);
  assert.equal(second, undefined);
});

test("what is on board is what was said last of it", () => {
  assert.equal(words(), "Not uploaded yet");
  assert.equal(words(command("hold", "applied"), command("upload-mission", "queued")), "Waiting for the UAV");
  assert.equal(
    words(command("upload-mission", "sent", { progress: { done: 12, total: 40 } })),
    "Uploading, 12 of 40 items",
  );
  assert.equal(words(command("upload-mission", "applied"), command("upload-mission", "failed")), "Uploaded");
  assert.equal(words(command("upload-mission", "applied", { parameters: { flight: 2 } })), "Flight 2 uploaded");
  assert.equal(
    words(command("upload-mission", "expired", { outcome: "It could not be delivered in time." })),
    "Not uploaded: It could not be delivered in time.",
  );
  assert.equal(
    words(command("clear-mission", "applied"), command("upload-mission", "applied")),
    "Removed from the UAV",
  );
  assert.equal(words(command("clear-mission", "failed", { outcome: "It flies." })), "Still on the UAV: It flies.");
  const beware = flying.boardWords(command("upload-mission", "applied", { outcome: "The mission has 501 items." }));
  assert.deepEqual([beware.words, beware.level], ["Uploaded – The mission has 501 items.", "warning"]);
});

test("a mixed mission is said loudest", () => {
  const mixed = command("upload-mission", "failed", {
    outcome_code: "mixed",
    outcome: "items 0 to 3 of the new one, the rest of the old",
  });
  assert.equal(words(mixed), "Mixed mission on the UAV – items 0 to 3 of the new one, the rest of the old");
  assert.equal(flying.boardWords(mixed).level, "critical");
  assert.equal(flying.isMixed(command("upload-mission", "failed", { outcome_code: "denied" })), false);
});

test("commands to other UAVs say nothing of this one", () => {
  assert.equal(flying.boardOf([command("upload-mission", "applied", { uav: { id: 8 } })], 7), null);
  assert.equal(flying.flightOf([command("hold", "applied", { uav: { id: 8 } })], 7), null);
});

test("what became of a command is said with its time and its reason", () => {
  const failed = command("hold", "failed", { finished_at: "2027-05-04T09:00:03Z", outcome: "The UAV refused it." });
  assert.match(flying.commandWords(failed).words, /^Hold: failed \d\d:\d\d – The UAV refused it\.$/);
  assert.equal(flying.commandWords(failed).level, "critical");
  const times = flying.timesOf(
    command("hold", "applied", { sent_at: "b", finished_at: "c", created_at: "a" }),
    (at) => at,
  );
  assert.equal(times, "given a, sent b, done c");
});

test("a UAV is started once it has what was approved, and once only", () => {
  const [kite] = flying.flyersOf(mission("dispatched"));
  const loaded = command("upload-mission", "applied");
  assert.match(flying.whyNoStart(mission("dispatched"), kite, []), /does not have its mission yet/);
  assert.equal(flying.whyNoStart(mission("dispatched"), kite, [loaded]), "");
  assert.equal(flying.whyNoStart(mission("active"), kite, [command("start", "failed"), loaded]), "");
  assert.match(
    flying.whyNoStart(mission("active"), kite, [command("start", "applied"), loaded]),
    /has already been started/,
  );
  assert.match(flying.whyNoStart(mission("active"), { ...kite, flown: 1 }, [loaded]), /has flown this flight/);
  const revoked = mission("dispatched");
  revoked.approval.revoke_requested_at = "2027-05-04T09:00:00Z";
  assert.match(flying.whyNoStart(revoked, kite, [loaded]), /being revoked/);
});

test("flights are sent one after the other", () => {
  const kite = { uav: 7, flights: 2, flown: 0 };
  assert.equal(flying.flightToSend(kite, []), 1);
  assert.equal(flying.flightToSend(kite, [command("upload-mission", "sent")]), null);
  assert.equal(flying.flightToSend(kite, [command("upload-mission", "failed")]), 1);
  assert.equal(flying.flightToSend({ ...kite, flown: 1 }, [command("upload-mission", "applied")]), 2);
  assert.equal(flying.flightToSend({ ...kite, flown: 2 }, []), null);
});

test("a mission is revoked before it is flown, and aborted while it is", () => {
  const states = ["planned", "approved", "dispatched", "active", "failed", "aborted"];
  const which = (may) => states.filter((state) => may({ state }));
  assert.deepEqual(which(flying.canBeRevoked), ["approved", "dispatched"]);
  assert.deepEqual(which(flying.canBeAborted), ["dispatched", "active", "failed"]);
  assert.deepEqual(which(flying.isFlown), ["approved", "dispatched", "active"]);
});

test("a change of the map data that touches nothing of the mission is not told", () => {
  const causes = (...what) =>
    flying.groundCauses({ is_stale: what.length > 0, stale_causes: what.map((one) => ({ what: one })) });
  assert.deepEqual(causes(), []);
  assert.deepEqual(causes("elsewhere"), []);
  assert.deepEqual(causes("uav"), []);
  assert.deepEqual(causes("zone", "uav"), [{ what: "zone" }]);
});

test("the stage is said in a sentence", () => {
  assert.match(
    flying.stageWords(mission("approved")),
    /^Approved by opal \d\d:\d\d\. Nothing of it can be changed until that is revoked\.$/,
  );
  assert.match(flying.stageWords(mission("active")), /It is being flown/);
  const waiting = mission("dispatched");
  waiting.approval = { ...waiting.approval, revoke_requested_at: "2027-05-04T09:00:00Z", revoke_reason: "Wrong day" };
  assert.match(flying.stageWords(waiting), /being revoked: Wrong day\./);
});

test("what is on board is not said before it was read", () => {
  assert.equal(flying.boardWords(undefined).words, "Reading the mission on the UAV…");
  assert.equal(flying.boardWords(null).words, "Not uploaded yet");
});
