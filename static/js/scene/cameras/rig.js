/** Where the camera stands and looks: five ways to look at a flight, turned, zoomed and moved by hand. No picture is drawn here. */

import { between, directionOf, lengthOf, minus, plus, towards, turn_deg, within } from "./vectors.js";

export const CAMERAS = ["chase", "orbit", "free", "top", "onboard"];

const BEGINNINGS = {
  chase: { bearing_deg: 0, elevation_deg: 14, distance_m: 11 }, // bearing: of the camera behind the UAV's tail
  orbit: { bearing_deg: 215, elevation_deg: 14, distance_m: 110 }, // bearing: from the target to the camera
  top: { bearing_deg: 0, elevation_deg: 90, distance_m: 420 },
  free: { bearing_deg: 0, elevation_deg: -12, distance_m: 0 }, // bearing, elevation: of what is looked at
  onboard: { bearing_deg: 0, elevation_deg: -18, distance_m: 0 }, // bearing: beside the nose
};
const FIELDS_DEG = { chase: 50, orbit: 45, top: 40, free: 55, onboard: 65 };
const NEAREST_M = { chase: 3, orbit: 5, top: 25 };
const FARTHEST_M = 60_000;
const FIT_MARGIN = 1.2; // bars stand over the picture's edges
const ABOVE_GROUND_M = 1.6; // a camera is never lower
const FOLLOWS_S = 0.35; // time constant of a heading that is followed
const GLIDES_S = 0.22; // of a camera that is sent elsewhere

/**
 * const rig = createRig(); rig.pose({ subject, focus, dt_s, groundAt }) → { eye, look, up, field_deg }, each frame.
 *
 * subject: { place: [x, y, z], heading_deg, camera: [x, y, z] unit direction of its camera } of the UAV that is followed, or null; focus: the
 * target that is orbited. groundAt(x, z): height of the ground. isCalm(): whether movement is unwanted, then the camera is there at once.
 */
export function createRig({ isCalm = () => false } = {}) {
  const views = Object.fromEntries(CAMERAS.map((name) => [name, { ...BEGINNINGS[name] }]));
  const rig = { mode: "chase", offset: [0, 0, 0], eye: [0, 60, 200], isGliding: false };
  let heading_deg = null; // as it is followed
  let shown = null; // the last pose
  let wanted = null;
  let mustSettle = true;

  const view = () => views[rig.mode];

  function around(centre, bearing_deg, elevation_deg, distance_m) {
    return { eye: plus(centre, towards(bearing_deg, elevation_deg), distance_m), look: centre };
  }

  function wantedPose(subject, focus) {
    const { bearing_deg, elevation_deg, distance_m } = view();
    const middle = subject?.place ?? focus ?? [0, 0, 0];
    switch (rig.mode) {
      case "chase":
        return around(plus(middle, rig.offset), heading_deg + 180 + bearing_deg, elevation_deg, distance_m);
      case "orbit":
        return around(plus(focus ?? middle, rig.offset), bearing_deg, elevation_deg, distance_m);
      case "top":
        return { ...around(plus(middle, rig.offset), bearing_deg + 180, 89.9, distance_m), up: towards(bearing_deg) };
      case "onboard": {
        const away = subject?.camera ?? towards(heading_deg, elevation_deg);
        const seen = directionOf(away);
        return {
          eye: plus(middle, [0, -0.12, 0]),
          look: plus(
            middle,
            towards(
              seen.bearing_deg + bearing_deg,
              within(seen.elevation_deg + elevation_deg - BEGINNINGS.onboard.elevation_deg, -88, 60),
            ),
            10,
          ),
        };
      }
      default:
        return { eye: rig.eye, look: plus(rig.eye, towards(bearing_deg, elevation_deg), 10) };
    }
  }

  function aboveGround({ eye, look, ...rest }, groundAt) {
    const least = groundAt(eye[0], eye[2]) + ABOVE_GROUND_M;
    return { eye: eye[1] < least ? [eye[0], least, eye[2]] : eye, look, ...rest };
  }

  function pose({ subject, focus, dt_s = 0, groundAt = () => -Infinity }) {
    const now_deg = subject?.heading_deg ?? 0;
    const isSettled = mustSettle || isCalm();
    const share = (constant_s) => (isSettled ? 1 : 1 - Math.exp(-dt_s / constant_s));
    heading_deg = heading_deg === null ? now_deg : heading_deg + turn_deg(heading_deg, now_deg) * share(FOLLOWS_S);
    wanted = aboveGround(wantedPose(subject, focus), groundAt);
    if (rig.isGliding && shown && !isSettled) {
      const part = share(GLIDES_S);
      shown = { ...wanted, eye: between(shown.eye, wanted.eye, part), look: between(shown.look, wanted.look, part) };
      rig.isGliding = lengthOf(minus(shown.eye, wanted.eye)) > 0.05 + 0.001 * lengthOf(minus(wanted.eye, wanted.look));
    } else {
      shown = wanted;
      rig.isGliding = false;
    }
    mustSettle = false;
    return { up: [0, 1, 0], ...shown, field_deg: FIELDS_DEG[rig.mode] };
  }

  /** Whether the next frame would be another one though nothing flies. */
  const isMoving = (subject) =>
    rig.isGliding ||
    (rig.mode === "chase" && heading_deg !== null && Math.abs(turn_deg(heading_deg, subject?.heading_deg ?? 0)) > 0.2);

  return Object.assign(rig, {
    pose,
    isMoving,
    view,
    /** From where it stands it glides there; free begins where the last camera was. */
    setMode(mode) {
      if (!CAMERAS.includes(mode) || mode === rig.mode) return;
      if (mode === "free" && shown) {
        rig.eye = shown.eye;
        const seen = directionOf(minus(shown.look, shown.eye));
        Object.assign(views.free, {
          bearing_deg: seen.bearing_deg,
          elevation_deg: within(seen.elevation_deg, -85, 60),
        });
      }
      rig.mode = mode;
      rig.offset = [0, 0, 0];
      rig.isGliding = shown !== null;
    },
    /** Towards what is followed now, another UAV or target. */
    glide() {
      rig.offset = [0, 0, 0];
      rig.isGliding = shown !== null;
    },
    /** The next pose at once: after a jump in time, or as a link says. */
    settle() {
      mustSettle = true;
    },
    turn(right_deg, up_deg) {
      const own = view();
      own.bearing_deg = (own.bearing_deg + right_deg + 720) % 360;
      if (rig.mode === "top") return;
      const [least, most] = rig.mode === "free" || rig.mode === "onboard" ? [-85, 60] : [-12, 88];
      own.elevation_deg = within(own.elevation_deg + up_deg, least, most);
    },
    /** factor above 1: farther away; the free camera goes back and forth. */
    zoom(factor) {
      if (rig.mode === "free") return rig.move(Math.log(factor) * -60, 0, 0);
      if (rig.mode !== "onboard")
        view().distance_m = within(view().distance_m * factor, NEAREST_M[rig.mode], FARTHEST_M);
      return undefined;
    },
    /** Along the picture's plane, in shares of its height. */
    pan(right, up) {
      const { bearing_deg, distance_m } = view();
      if (rig.mode === "onboard") return rig.turn(right * 40, up * 40);
      if (rig.mode === "free") return rig.move(0, right * 40, up * 40);
      const facing_deg =
        rig.mode === "top" ? bearing_deg : rig.mode === "chase" ? heading_deg + bearing_deg : bearing_deg + 180;
      const size_m = distance_m * 0.85;
      const [across, ahead] = [towards(facing_deg + 90), rig.mode === "top" ? towards(facing_deg) : [0, 1, 0]];
      rig.offset = plus(plus(rig.offset, across, right * size_m), ahead, up * size_m);
      return undefined;
    },
    /** The free camera: metres ahead, to the right and up. */
    move(ahead_m, right_m, up_m) {
      if (rig.mode !== "free") rig.setMode("free");
      rig.isGliding = false;
      const { bearing_deg, elevation_deg } = view();
      rig.eye = plus(
        plus(plus(rig.eye, towards(bearing_deg, elevation_deg), ahead_m), towards(bearing_deg + 90), right_m),
        [0, 1, 0],
        up_m,
      );
    },
    /** As a link keeps it. */
    state: () => ({ mode: rig.mode, ...view(), eye: rig.eye, offset: rig.offset }),
    restore({ mode, view: kept = null, eye = null, offset = null }) {
      rig.mode = mode;
      if (kept) [views[mode].bearing_deg, views[mode].elevation_deg, views[mode].distance_m] = kept;
      if (eye) rig.eye = eye;
      rig.offset = offset ?? [0, 0, 0];
      mustSettle = true;
    },
    /** So far away that all of a sphere is in the picture, from where top and orbit look. */
    fit(radius_m, field_deg = FIELDS_DEG[rig.mode]) {
      if (rig.mode === "free" || rig.mode === "onboard" || rig.mode === "chase") rig.setMode("orbit");
      const reach_m = (FIT_MARGIN * radius_m) / Math.sin((field_deg / 2) * (Math.PI / 180));
      view().distance_m = within(reach_m, NEAREST_M[rig.mode], FARTHEST_M);
      rig.offset = [0, 0, 0];
      rig.isGliding = true;
    },
  });
}
