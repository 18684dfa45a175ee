/** Towers, poles and portals: outlines of all, and bracing, insulators and foundations of those near the camera. */

import { voltageColour } from "../../map/style.js";
import { FOUNDATION, INSULATOR, supportMembers } from "../geometry/towers.js";
import { Color, Group } from "../three.js";
import { memberMesh } from "./members.js";

const NEAR_M = 900;
const MOST_NEAR = 60; // supports with bracing
const LOOK_AGAIN_M = 40; // the camera has moved so far since the near ones were chosen

/** Gives { group, show(supports, frame), apply(palette), update(camera), shadowPixel(metres), dispose() }. */
export function makeSupports({ hasBracing = true } = {}) {
  const group = new Group();
  const [outline, fine] = [memberMesh(), memberMesh({ leastPx: 0.55 })];
  group.add(outline.mesh, fine.mesh);
  let supports = [];
  let frame = null;
  let feet = new Float32Array(0);
  let near = new Map(); // place in supports → its fine members
  let colours = null;
  let lookedFrom = null;

  function paintOutlines() {
    const all = supports.map((support) => supportMembers(support, frame).outline);
    outline.set(joined(all), coloursOf(supports.map((support, place) => [support, all[place]])));
  }

  function coloursOf(pairs) {
    const values = new Float32Array(pairs.reduce((sum, [, members]) => sum + members.tone.length * 3, 0));
    let at = 0;
    for (const [support, { tone }] of pairs) {
      const own = colours.of(support);
      for (const kind of tone) {
        const { r, g, b } = kind === INSULATOR ? colours.insulator : kind === FOUNDATION ? colours.foundation : own;
        values.set([r, g, b], at);
        at += 3;
      }
    }
    return values;
  }

  function paintNear() {
    const pairs = [...near].map(([place, members]) => [supports[place], members]);
    fine.set(joined(pairs.map(([, members]) => members)), coloursOf(pairs));
  }

  /** The nearest supports within reach. What is already worked out stays, what is far is let go. */
  function choose({ x, y, z }) {
    const found = [];
    for (let place = 0; place < supports.length; place += 1) {
      const far = Math.hypot(feet[place * 3] - x, feet[place * 3 + 1] - y, feet[place * 3 + 2] - z);
      if (far < NEAR_M) found.push([far, place]);
    }
    found.sort((one, other) => one[0] - other[0]);
    const chosen = found.slice(0, MOST_NEAR).map(([, place]) => place);
    if (chosen.length === near.size && chosen.every((place) => near.has(place))) return false;
    near = new Map(chosen.map((place) => [place, near.get(place) ?? supportMembers(supports[place], frame).fine]));
    paintNear();
    return true;
  }

  return {
    group,
    show(next, ownFrame) {
      [supports, frame, near, lookedFrom] = [next, ownFrame, new Map(), null];
      feet = Float32Array.from(supports.flatMap(({ position, ground_amsl_m, height_m }) => ownFrame.toLocal(...position, ground_amsl_m + height_m / 2)));
      group.visible = supports.length > 0;
    },
    apply(palette) {
      const body = new Map();
      colours = {
        insulator: new Color(palette.tower).lerp(new Color(palette.raised), palette.isDark ? 0.1 : 0.45),
        foundation: new Color(palette.pressed).lerp(new Color(palette.inkSecond), 0.25),
        of({ voltage_v }) {
          if (!body.has(voltage_v)) body.set(voltage_v, new Color(voltage_v === null ? palette.tower : voltageColour(palette, voltage_v / 1_000)));
          return body.get(voltage_v);
        },
      };
      paintOutlines();
      paintNear();
    },
    update(camera) {
      if (!hasBracing || !supports.length || (lookedFrom && lookedFrom.distanceTo(camera.position) < LOOK_AGAIN_M)) return false;
      lookedFrom = camera.position.clone();
      return choose(camera.position);
    },
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
