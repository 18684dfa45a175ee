import assert from "node:assert/strict";
import { test } from "node:test";
import { reasonsOf } from "../../static/js/record/sentence.js";

const target = (place, result, reason = null) => ({
  place,
  label: `E402-${place}`,
  flown_place: 10 - place,
  result,
  reason,
});
const crash = { code: "crashed-cause", message: "Sim 2 crashed, motor", at: "2026-09-10T09:34:00Z" };
const time = new Date(crash.at).toLocaleTimeString("en", { hour: "2-digit", minute: "2-digit", hourCycle: "h23" });

test("targets that one thing kept from being inspected are told together, in flown order", () => {
  const targets = [
    target(1, "inspected"),
    target(2, "not-inspected", crash),
    target(3, "not-inspected", crash),
    target(4, "not-confirmed", { code: "nearest-report", message: "nearest report 94 m away", at: null }),
  ];
  const told = reasonsOf({ targets, incidents: [] });
  assert.deepEqual(
    told.map(({ targets: of, words }) => [of.map(({ place }) => place), words]),
    [
      [[4], "{targets} not confirmed: nearest report 94 m away."],
      [[3, 2], `{targets} not inspected: Sim 2 crashed, motor (${time}).`],
    ],
  );
});

test("a crash after the last target and an abort are told too, each once", () => {
  const incidents = [
    { kind: "crashed", message: crash.message, at: crash.at },
    { kind: "link-lost", message: "Sim 1 lost its link", at: crash.at },
    { kind: "aborted", message: "mission aborted by Ada: rain", at: crash.at },
  ];
  const words = (targets) => reasonsOf({ targets, incidents }).map((one) => one.words);
  assert.deepEqual(words([target(1, "inspected")]), [
    `Sim 2 crashed, motor (${time}).`,
    `Mission aborted by Ada: rain (${time}).`,
  ]);
  assert.deepEqual(words([target(1, "not-inspected", crash)]), [
    `{targets} not inspected: Sim 2 crashed, motor (${time}).`,
    `Mission aborted by Ada: rain (${time}).`,
  ]);
});
