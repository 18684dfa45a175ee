/** Towers, poles and portals: outlines of all, and bracing, insulators and foundations of those near the camera. */

import { voltageColour } from "../../map/look/voltages.js";
import { FOUNDATION, INSULATOR, supportMembers } from "../geometry/towers.js";
import { Color, Group } from "../three.js";
import { memberMesh } from "./members.js";

const MAX_A_FRAME = 6; // supports that get their bracing
const LOOK_AGAIN_M = 40; // movement of the camera after which the near ones are chosen again

/** @import { Support } from "../../api_types.d.ts" */
/** @import { PerspectiveCamera, Vector3 } from "../three.js" */
/** @import { Frame, HeightAt, Members, ScenePalette } from "../types.d.ts" */

/** @typedef {{ isMast: true }} Mast of a railway */
/** @typedef {[of: Support | Mast, members: Members][]} OwnedMembers */
/** @typedef {ReturnType<typeof coloursFor>} SupportColours */
/** @typedef {{ near_m: number, most: number }} Bracing of supports so near, at most so many */

/** @type {Mast} */
const MAST = { isMast: true };

/** @param {ScenePalette} palette */
function coloursFor(palette) {
  const mast = new Color(palette.tower);
  /** @type {Map<number | null, Color>} by voltage */
  const body = new Map();
  return {
    insulator: new Color(palette.tower).lerp(new Color(palette.raised), palette.isDark ? 0.1 : 0.45),
    foundation: new Color(palette.pressed).lerp(new Color(palette.inkSecond), 0.25),
    /** @param {Support | Mast} own */
    of(own) {
      if ("isMast" in own) return mast;
      const { voltage_v } = own;
      const known = body.get(voltage_v);
      if (known) return known;
      const colour = new Color(voltage_v === null ? palette.tower : voltageColour(palette, voltage_v / 1_000));
      body.set(voltage_v, colour);
      return colour;
    },
  };
}

/** Three figures for each member. @param {OwnedMembers} pairs @param {SupportColours} colours */
function colourValues(pairs, colours) {
  const values = new Float32Array(pairs.reduce((sum, [, members]) => sum + members.tone.length * 3, 0));
  let at = 0;
  for (const [support, { tone }] of pairs) {
    const own = colours.of(support);
    for (let member = 0; member < tone.length; member += 1) {
      const colour =
        tone[member] === INSULATOR ? colours.insulator : tone[member] === FOUNDATION ? colours.foundation : own;
      values[at] = colour.r;
      values[at + 1] = colour.g;
      values[at + 2] = colour.b;
      at += 3;
    }
  }
  return values;
}

/** @typedef {{ supports: readonly Support[], frame: Frame, groundAt: HeightAt }} Standing supports with their frame and terrain */

/**
 * The fine members of the supports near the camera, computed a few a frame.
 *
 * @param {Bracing} bracing
 */
function nearMembers({ near_m, most }) {
  /** @type {Standing | null} */
  let standing = null;
  let feet = new Float32Array(0);
  /** @type {Map<number, Members | null>} by place in supports; null: not computed */
  let near = new Map();
  /** @type {number[]} */
  let wanted = [];
  let isStale = false;
  /** @type {Vector3 | null} */
  let lookedFrom = null;

  /**
   * Request the nearest supports within reach; computed ones are kept, far ones are released.
   *
   * @param {Vector3} eye
   */
  function choose({ x, y, z }) {
    /** @type {[far_m: number, place: number][]} */
    const found = [];
    for (let place = 0; place < feet.length / 3; place += 1) {
      const far = Math.hypot(feet[place * 3] - x, feet[place * 3 + 1] - y, feet[place * 3 + 2] - z);
      if (far < near_m) found.push([far, place]);
    }
    found.sort((one, other) => one[0] - other[0]);
    const chosen = found.slice(0, most).map(([, place]) => place);
    if (chosen.length === near.size && chosen.every((place) => near.has(place))) return;
    near = new Map(chosen.map((place) => [place, near.get(place) ?? null]));
    wanted = chosen.filter((place) => near.get(place) === null);
    isStale = true;
  }

  /** @param {Standing} standing @param {number} place */
  function fineMembers({ supports, frame, groundAt }, place) {
    const { position, ground_amsl_m } = supports[place];
    const [x, y, z] = frame.toLocal(position[0], position[1], ground_amsl_m);
    return supportMembers(supports[place], frame, y - groundAt(x, z)).fine;
  }

  return {
    /** @param {Standing} next */
    show(next) {
      [standing, near, wanted, isStale, lookedFrom] = [next, new Map(), [], false, null];
      feet = Float32Array.from(
        next.supports.flatMap(({ position, ground_amsl_m, height_m }) =>
          next.frame.toLocal(position[0], position[1], ground_amsl_m + height_m / 2),
        ),
      );
    },
    /**
     * A few a frame, so that no frame is late; "new" once all are there.
     *
     * @param {Vector3} eye
     * @returns {"same" | "working" | "new"}
     */
    follow(eye) {
      if (!lookedFrom || lookedFrom.distanceTo(eye) >= LOOK_AGAIN_M) {
        lookedFrom = eye.clone();
        choose(eye);
      }
      if (!isStale || !standing) return "same";
      for (const place of wanted.splice(0, MAX_A_FRAME)) near.set(place, fineMembers(standing, place));
      if (wanted.length) return "working";
      isStale = false;
      return "new";
    },
    /** @returns {OwnedMembers} */
    worked: () =>
      [...near].flatMap(([place, members]) => (members && standing ? [[standing.supports[place], members]] : [])),
  };
}

/** @param {{ bracing?: Bracing }} [how] */
export function makeSupports({ bracing = { near_m: 900, most: 50 } } = {}) {
  const group = new Group();
  const [outline, fine] = [memberMesh(), memberMesh({ leastPx: 0.55 })];
  group.add(outline.mesh, fine.mesh);
  const near = nearMembers(bracing);
  /** @type {OwnedMembers} */
  let outlines = [];
  let count = 0;
  /** @type {SupportColours | null} */
  let colours = null;

  /** @param {OwnedMembers} pairs */
  const coloursOf = (pairs) => (colours ? colourValues(pairs, colours) : new Float32Array(0));
  function paintNear() {
    const pairs = near.worked();
    fine.set(joined(pairs.map(([, members]) => members)), coloursOf(pairs));
  }

  return {
    group,
    /**
     * @param {readonly Support[]} supports
     * @param {Frame} frame
     * @param {readonly Members[]} [masts] of railways
     * @param {HeightAt} [groundAt] of the drawn ground
     */
    show(supports, frame, masts = [], groundAt = () => Infinity) {
      near.show({ supports, frame, groundAt });
      count = supports.length;
      group.visible = count + masts.length > 0;
      outlines = [];
      for (const support of supports) outlines.push([support, supportMembers(support, frame).outline]);
      for (const own of masts) outlines.push([MAST, own]);
      outline.set(joined(outlines.map(([, members]) => members)), coloursOf(outlines));
      paintNear();
    },
    /** @param {ScenePalette} palette */
    apply(palette) {
      colours = coloursFor(palette);
      outline.recolour(coloursOf(outlines));
      paintNear();
    },
    /** Update for a camera. Returns whether the next picture differs. @param {Pick<PerspectiveCamera, "position">} camera */
    update({ position }) {
      const state = count ? near.follow(position) : "same";
      if (state === "new") paintNear();
      return state !== "same";
    },
    /** @param {number} metres */
    shadowPixel(metres) {
      outline.shadowPixel(metres);
      fine.shadowPixel(metres);
    },
    dispose() {
      outline.dispose();
      fine.dispose();
    },
  };
}

/** @param {readonly Members[]} lists @returns {Members} */
function joined(lists) {
  const count = lists.reduce((sum, { tone }) => sum + tone.length, 0);
  const whole = { ends: new Float32Array(count * 6), width_m: new Float32Array(count), tone: new Uint8Array(count) };
  let at = 0;
  for (const { ends, width_m, tone } of lists) {
    whole.ends.set(ends, at * 6);
    whole.width_m.set(width_m, at);
    whole.tone.set(tone, at);
    at += tone.length;
  }
  return whole;
}
