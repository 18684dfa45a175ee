import assert from "node:assert/strict";
import { test } from "node:test";

import { createRig } from "../../../static/js/scene/cameras/rig.js";
import { directionOf, lengthOf, minus, towards, turn_deg } from "../../../static/js/scene/cameras/vectors.js";

const near = (found, wanted, slack = 1e-6) => assert.ok(Math.abs(found - wanted) <= slack, `${found} is not ${wanted}`);
const nearAll = (found, wanted, slack) =>
  wanted.forEach((value, axis) => {
    near(found[axis], value, slack);
  });

test("directions go to bearing and elevation and back", () => {
  nearAll(towards(90), [1, 0, 0]);
  nearAll(towards(0), [0, 0, -1]);
  const { bearing_deg, elevation_deg } = directionOf(towards(214, -31));
  near(bearing_deg, 214);
  near(elevation_deg, -31);
  assert.equal(turn_deg(350, 20), 30);
  assert.equal(turn_deg(20, 350), -30);
});

test("the chase camera stands behind the tail and above, and looks at the UAV", () => {
  const rig = createRig({ isCalm: () => true });
  const { eye, look } = rig.pose({ subject: { place: [100, 50, 0], heading_deg: 90 } });
  nearAll(look, [100, 50, 0]);
  assert.ok(eye[0] < 100 && eye[1] > 50, "west of a UAV that flies east");
  near(eye[2], 0);
  near(lengthOf(minus(eye, look)), rig.view().distance_m);
});

test("no camera goes into the ground", () => {
  const rig = createRig({ isCalm: () => true });
  const { eye } = rig.pose({ subject: { place: [0, 0.2, 0], heading_deg: 0 }, groundAt: () => 30 });
  assert.ok(eye[1] > 31);
});

test("the free camera begins where the last one stood, and is moved along what it looks at", () => {
  const rig = createRig({ isCalm: () => true });
  const before = rig.pose({ subject: { place: [0, 50, 0], heading_deg: 0 } });
  rig.setMode("free");
  nearAll(rig.pose({}).eye, before.eye);
  rig.turn(-rig.view().bearing_deg, -rig.view().elevation_deg);
  rig.move(10, 0, 0);
  near(rig.pose({}).eye[2], before.eye[2] - 10);
});

test("from the UAV's camera it looks where that camera looks", () => {
  const rig = createRig({ isCalm: () => true });
  rig.setMode("onboard");
  const { eye, look } = rig.pose({ subject: { place: [0, 60, 0], heading_deg: 0, camera: towards(40, -20) } });
  const seen = directionOf(minus(look, eye));
  near(seen.bearing_deg, 40, 0.1);
  near(seen.elevation_deg, -20, 1);
});

test("from above north is up; moved by hand it leaves the UAV", () => {
  const rig = createRig({ isCalm: () => true });
  rig.setMode("top");
  const subject = { place: [7, 50, 9], heading_deg: 120 };
  const { eye, look, up } = rig.pose({ subject });
  nearAll(look, [7, 50, 9]);
  nearAll(up, [0, 0, -1]);
  assert.ok(eye[1] > 400);
  rig.pan(0.5, 0);
  assert.ok(rig.pose({ subject }).look[0] > 100);
});

test("a camera that is sent elsewhere glides there, and is there at once where movement is unwanted", () => {
  const rig = createRig();
  const subject = { place: [0, 50, 0], heading_deg: 0 };
  rig.pose({ subject, dt_s: 0.016 });
  rig.setMode("orbit");
  const focus = [500, 20, 0];
  assert.ok(lengthOf(minus(rig.pose({ subject, focus, dt_s: 0.016 }).look, focus)) > 300);
  assert.ok(rig.isMoving(subject));
  for (let frame = 0; frame < 200; frame += 1) rig.pose({ subject, focus, dt_s: 0.016 });
  assert.equal(rig.isGliding, false);
  rig.setMode("top");
  rig.settle();
  nearAll(rig.pose({ subject, focus, dt_s: 0.016 }).look, subject.place);
});
