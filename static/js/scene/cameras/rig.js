/** Position and direction of the camera: five modes, each turned, zoomed and moved by the user. Draws nothing. */

import { between, directionOf, lengthOf, minus, plus, towards, turn_deg, within } from "./vectors.js";

/** @import { HeightAt, Vector } from "../types.d.ts" */

/** @typedef {"chase" | "orbit" | "free" | "top" | "onboard"} CameraMode */
/** @typedef {{ bearing_deg: number, elevation_deg: number, distance_m: number }} CameraView */
/** @typedef {{ eye: Vector, look: Vector, up?: Vector }} Aim */
/** @typedef {{ eye: Vector, look: Vector, up: Vector, field_deg: number }} Pose */
/** @typedef {{ place: Vector, heading_deg: number, camera?: Vector }} Subject the UAV that is followed; camera: unit direction of its own one */
/** @typedef {ReturnType<typeof createRig>} Rig */

/** @type {CameraMode[]} */
export const CAMERAS = ["chase", "orbit", "free", "top", "onboard"];

/** @type {Record<CameraMode, CameraView>} */
const BEGINNINGS = {
  chase: { bearing_deg: 0, elevation_deg: 14, distance_m: 11 }, // bearing: of the camera behind the UAV's tail
  orbit: { bearing_deg: 215, elevation_deg: 14, distance_m: 110 }, // bearing: from the target to the camera
  top: { bearing_deg: 0, elevation_deg: 90, distance_m: 420 },
  free: { bearing_deg: 0, elevation_deg: -12, distance_m: 0 }, // bearing, elevation: of the camera's target
  onboard: { bearing_deg: 0, elevation_deg: -18, distance_m: 0 }, // bearing: to the side of the nose
};
const FIELDS_DEG = { chase: 50, orbit: 45, top: 40, free: 55, onboard: 65 };
/** @type {Partial<Record<CameraMode, number>>} */
const MIN_DISTANCE_M = { chase: 3, orbit: 5, top: 25 };
const MAX_DISTANCE_M = 60_000;
const FIT_MARGIN = 1.2; // bars cover the picture's edges
const ABOVE_GROUND_M = 1.6; // minimum height of a camera
const FOLLOWS_S = 0.35; // time constant of a heading that is followed
const GLIDES_S = 0.22; // time constant of a camera's move to another place

/**
 * @param {Vector} centre
 * @param {number} bearing_deg
 * @param {number} elevation_deg
 * @param {number} distance_m
 * @returns {Aim}
 */
const around = (centre, bearing_deg, elevation_deg, distance_m) => ({
  eye: plus(centre, towards(bearing_deg, elevation_deg), distance_m),
  look: centre,
});

/**
 * Along a UAV's own camera, or its nose.
 *
 * @param {Subject | null} subject
 * @param {Vector} eye
 * @param {number} heading_deg
 * @param {CameraView} view
 * @returns {Aim}
 */
function onboard(subject, eye, heading_deg, { bearing_deg, elevation_deg }) {
  const seen = directionOf(subject?.camera ?? towards(heading_deg, elevation_deg));
  const up_deg = within(seen.elevation_deg + elevation_deg - BEGINNINGS.onboard.elevation_deg, -88, 60);
  return { eye: plus(eye, [0, -0.12, 0]), look: plus(eye, towards(seen.bearing_deg + bearing_deg, up_deg), 10) };
}

/** @param {Aim} aim @param {HeightAt} groundAt @returns {Aim} */
function aboveGround({ eye, look, ...rest }, groundAt) {
  const least = groundAt(eye[0], eye[2]) + ABOVE_GROUND_M;
  return { eye: eye[1] < least ? [eye[0], least, eye[2]] : eye, look, ...rest };
}

/** The rig's state. offset: the user's shift of the target; eye: position of the free camera. */
const beginning = () => ({
  mode: /** @type {CameraMode} */ ("chase"),
  offset: /** @type {Vector} */ ([0, 0, 0]),
  eye: /** @type {Vector} */ ([0, 60, 200]),
  isGliding: false,
});
/** @typedef {ReturnType<typeof beginning>} RigState */

/**
 * Create a camera rig; pose() returns the pose in each frame.
 *
 * @param {{ isCalm?: () => boolean }} [how] isCalm: whether movement is unwanted, then the camera is there at once
 */
export function createRig({ isCalm = () => false } = {}) {
  const views = /** @type {Record<CameraMode, CameraView>} */ (structuredClone(BEGINNINGS));
  const state = beginning();
  const eyes = createEyes(state, views, isCalm);
  const view = () => views[state.mode];

  const rig = Object.assign(state, {
    pose: eyes.pose,
    isMoving: eyes.isMoving,
    settle: eyes.settle,
    view,
    /** Set the mode; the camera glides there from its present place, and free begins at the last camera. @param {CameraMode} mode */
    setMode(mode) {
      if (!CAMERAS.includes(mode) || mode === rig.mode) return;
      const shown = eyes.shown();
      if (mode === "free" && shown) {
        rig.eye = shown.eye;
        const { bearing_deg, elevation_deg } = directionOf(minus(shown.look, shown.eye));
        Object.assign(views.free, { bearing_deg, elevation_deg: within(elevation_deg, -85, 60) });
      }
      rig.mode = mode;
      rig.glide();
    },
    /** Move to the present target, another UAV or target. */
    glide() {
      rig.offset = [0, 0, 0];
      rig.isGliding = eyes.shown() !== null;
    },
    /** As a link keeps it. */
    state: () => ({ mode: rig.mode, ...view(), eye: rig.eye, offset: rig.offset }),
    /** @param {{ mode: CameraMode, view?: Vector | null, eye?: Vector | null, offset?: Vector | null }} kept */
    restore({ mode, view: kept = null, eye = null, offset = null }) {
      rig.mode = mode;
      if (kept) [views[mode].bearing_deg, views[mode].elevation_deg, views[mode].distance_m] = kept;
      if (eye) rig.eye = eye;
      rig.offset = offset ?? [0, 0, 0];
      eyes.settle();
    },
    /**
     * Move top and orbit so far away that the whole sphere is in the picture.
     *
     * @param {number} radius_m
     * @param {number} [field_deg]
     */
    fit(radius_m, field_deg = FIELDS_DEG[rig.mode]) {
      if (rig.mode === "free" || rig.mode === "onboard" || rig.mode === "chase") rig.setMode("orbit");
      const reach_m = (FIT_MARGIN * radius_m) / Math.sin((field_deg / 2) * (Math.PI / 180));
      view().distance_m = within(reach_m, MIN_DISTANCE_M[rig.mode] ?? 0, MAX_DISTANCE_M);
      rig.offset = [0, 0, 0];
      rig.isGliding = true;
    },
    ...handled(state, view, eyes.followed_deg, () => rig.setMode("free")),
  });
  return rig;
}

/**
 * The camera's pose in each frame: it follows a heading, and glides to a new place.
 *
 * @param {RigState} rig
 * @param {Record<CameraMode, CameraView>} views
 * @param {() => boolean} isCalm
 */
function createEyes(rig, views, isCalm) {
  /** @type {number | null} as it is followed */
  let heading_deg = null;
  /** @type {Aim | null} of the last frame */
  let shown = null;
  let mustSettle = true;

  /** @param {Subject | null} subject @param {Vector | null} focus @param {number} followed_deg @returns {Aim} */
  function wantedAim(subject, focus, followed_deg) {
    const view = views[rig.mode];
    const { bearing_deg, elevation_deg, distance_m } = view;
    const middle = subject?.place ?? focus ?? [0, 0, 0];
    switch (rig.mode) {
      case "chase":
        return around(plus(middle, rig.offset), followed_deg + 180 + bearing_deg, elevation_deg, distance_m);
      case "orbit":
        return around(plus(focus ?? middle, rig.offset), bearing_deg, elevation_deg, distance_m);
      case "top":
        return { ...around(plus(middle, rig.offset), bearing_deg + 180, 89.9, distance_m), up: towards(bearing_deg) };
      case "onboard":
        return onboard(subject, middle, followed_deg, view);
      default:
        return { eye: rig.eye, look: plus(rig.eye, towards(bearing_deg, elevation_deg), 10) };
    }
  }

  return {
    shown: () => shown,
    followed_deg: () => heading_deg ?? 0,
    /** Apply the next pose without a transition: after a jump in time, or as a link sets it. */
    settle() {
      mustSettle = true;
    },
    /**
     * @param {{ subject: Subject | null, focus: Vector | null, dt_s?: number, groundAt?: HeightAt }} scene focus: the target that is orbited
     * @returns {Pose}
     */
    pose({ subject, focus, dt_s = 0, groundAt = () => -Infinity }) {
      const now_deg = subject?.heading_deg ?? 0;
      const isSettled = mustSettle || isCalm();
      /** @param {number} constant_s */
      const share = (constant_s) => (isSettled ? 1 : 1 - Math.exp(-dt_s / constant_s));
      heading_deg = heading_deg === null ? now_deg : heading_deg + turn_deg(heading_deg, now_deg) * share(FOLLOWS_S);
      const wanted = aboveGround(wantedAim(subject, focus, heading_deg), groundAt);
      if (rig.isGliding && shown && !isSettled) {
        const part = share(GLIDES_S);
        shown = { ...wanted, eye: between(shown.eye, wanted.eye, part), look: between(shown.look, wanted.look, part) };
        const left_m = lengthOf(minus(shown.eye, wanted.eye));
        rig.isGliding = left_m > 0.05 + 0.001 * lengthOf(minus(wanted.eye, wanted.look));
      } else {
        shown = wanted;
        rig.isGliding = false;
      }
      mustSettle = false;
      return { up: [0, 1, 0], ...shown, field_deg: FIELDS_DEG[rig.mode] };
    },
    /** Whether the next frame would differ although no UAV moves. @param {Subject | null} subject */
    isMoving: (subject) =>
      rig.isGliding ||
      (rig.mode === "chase" &&
        heading_deg !== null &&
        Math.abs(turn_deg(heading_deg, subject?.heading_deg ?? 0)) > 0.2),
  };
}

/**
 * Return the rig turned, zoomed and moved by the user.
 *
 * @param {RigState} rig
 * @param {() => CameraView} view
 * @param {() => number} followed_deg heading of the UAV that is chased
 * @param {() => void} goFree
 */
function handled(rig, view, followed_deg, goFree) {
  const hand = {
    /** @param {number} right_deg @param {number} up_deg */
    turn(right_deg, up_deg) {
      const own = view();
      own.bearing_deg = (own.bearing_deg + right_deg + 720) % 360;
      if (rig.mode === "top") return;
      const [least, most] = rig.mode === "free" || rig.mode === "onboard" ? [-85, 60] : [-12, 88];
      own.elevation_deg = within(own.elevation_deg + up_deg, least, most);
    },
    /** Above 1: farther away; the free camera moves back and forth. @param {number} factor */
    zoom(factor) {
      if (rig.mode === "free") hand.move(Math.log(factor) * -60, 0, 0);
      else if (rig.mode !== "onboard")
        view().distance_m = within(view().distance_m * factor, MIN_DISTANCE_M[rig.mode] ?? 0, MAX_DISTANCE_M);
    },
    /** Along the picture's plane, in shares of its height. @param {number} right @param {number} up */
    pan(right, up) {
      if (rig.mode === "onboard") hand.turn(right * 40, up * 40);
      else if (rig.mode === "free") hand.move(0, right * 40, up * 40);
      else {
        const { bearing_deg, distance_m } = view();
        const facing_deg =
          rig.mode === "top" ? bearing_deg : rig.mode === "chase" ? followed_deg() + bearing_deg : bearing_deg + 180;
        const size_m = distance_m * 0.85;
        /** @type {Vector} */
        const ahead = rig.mode === "top" ? towards(facing_deg) : [0, 1, 0];
        rig.offset = plus(plus(rig.offset, towards(facing_deg + 90), right * size_m), ahead, up * size_m);
      }
    },
    /**
     * The free camera: metres ahead, to the right and up.
     *
     * @param {number} ahead_m
     * @param {number} right_m
     * @param {number} up_m
     */
    move(ahead_m, right_m, up_m) {
      if (rig.mode !== "free") goFree();
      rig.isGliding = false;
      const { bearing_deg, elevation_deg } = view();
      const along = plus(rig.eye, towards(bearing_deg, elevation_deg), ahead_m);
      rig.eye = plus(plus(along, towards(bearing_deg + 90), right_m), [0, 1, 0], up_m);
    },
  };
  return hand;
}
