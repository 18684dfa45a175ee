import assert from "node:assert/strict";
import test from "node:test";

import { missingText, proofsByKind, shownOf } from "../../../static/js/view_plan/proof.js";

const row = (component, area_m2, shown, reachable, gsd_mm = 1.5) => ({
  component,
  number: 0,
  area_m2,
  shown,
  reachable,
  gsd_mm: shown ? gsd_mm : null,
  angle_deg: null,
  limit: null,
});
const proof = (shown, components) => ({ photos: 3, not_counted: [], coverage: { shown, reachable: 0.8, components } });
const promised = proof(0.72, [row("body", 90, 0.72, 0.8), row("clamp", 10, 0.5, 0.5), row("plate", 1, 0, 0)]);

test("proofs are compared of what the plan can show, by kind", () => {
  const flown = proof(0.36, [row("body", 90, 0.36, 0.8, 1.9), row("clamp", 10, 0, 0.5), row("plate", 1, 0, 0)]);
  const [body, clamp, plate] = proofsByKind(promised, [promised, flown]);
  assert.deepEqual(
    body.cells.map(({ share, gsd_mm }) => [Math.round(share * 100), gsd_mm]),
    [
      [90, 1.5],
      [45, 1.9],
    ],
  );
  assert.deepEqual(
    clamp.cells.map(({ share }) => share),
    [1, 0],
  );
  assert.deepEqual(
    plate.cells.map(({ share }) => share),
    [null, null],
  );
  assert.equal(Math.round(shownOf(promised, flown) * 100), 45);
});

test("more than the plan can show is all of it", () => {
  assert.equal(shownOf(promised, proof(0.9, [])), 1);
});

test("missing components are named by kind, each once", () => {
  const missing = [
    { component: "clamp", number: 0 },
    { component: "clamp", number: 2 },
    { component: "plate", number: 0 },
  ];
  const components = [row("clamp", 1, 1, 1), row("clamp", 1, 1, 1), row("clamp", 1, 1, 1), row("plate", 1, 1, 1)];
  assert.equal(missingText({ missing, promised: proof(1, components) }), "Clamps (2 of 3), Number plate");
});
