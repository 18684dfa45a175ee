/** Towers, poles and portals: outlines of all, and bracing, insulators and foundations of those near the camera. */

import { voltageColour } from "../../map/look/voltages.js";
import { FOUNDATION, INSULATOR, supportMembers } from "../geometry/towers.js";
import { Color, Group } from "../three.js";
import { memberMesh } from "./members.js";

const MOST_A_FRAME = 6; // supports that get their bracing
const LOOK_AGAIN_M = 40; // the camera has moved so far since the near ones were chosen

const MAST = { isMast: true };

/** bracing: of supports within near_m, at most so many. Gives { group, show(supports, frame, masts, groundAt), apply(palette), update(camera), shadowPixel(metres), dispose() }. */
export function makeSupports({ bracing = { near_m: 900, most: 50 } } = {}) {
  const group = new Group();
  const [outline, fine] = [memberMesh(), memberMesh({ leastPx: 0.55 })];
  group.add(outline.mesh, fine.mesh);
  let supports = [];
  let frame = null;
  let ground = () => Infinity;
  let masts = [];
  let outlines = [];
  let feet = new Float32Array(0);
  let near = new Map(); // place in supports → its fine members
  let colours = null;
  let lookedFrom = null;
  let wanted = [];
  let isStale = false;

  function outlineColours() {
    return coloursOf([
      ...supports.map((support, place) => [support, outlines[place]]),
      ...masts.map((own) => [MAST, own]),
    ]);
  }

  function coloursOf(pairs) {
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

  function paintNear() {
    const pairs = [...near].filter(([, members]) => members).map(([place, members]) => [supports[place], members]);
    fine.set(joined(pairs.map(([, members]) => members)), coloursOf(pairs));
  }

  /** The nearest supports within reach become wanted; what is already worked out stays, what is far is let go. */
  function choose({ x, y, z }) {
    const found = [];
    for (let place = 0; place < supports.length; place += 1) {
      const far = Math.hypot(feet[place * 3] - x, feet[place * 3 + 1] - y, feet[place * 3 + 2] - z);
      if (far < bracing.near_m) found.push([far, place]);
    }
    found.sort((one, other) => one[0] - other[0]);
    const chosen = found.slice(0, bracing.most).map(([, place]) => place);
    if (chosen.length === near.size && chosen.every((place) => near.has(place))) return;
    near = new Map(chosen.map((place) => [place, near.get(place) ?? null]));
    wanted = chosen.filter((place) => near.get(place) === null);
    isStale = true;
  }

  function belowFoot({ position, ground_amsl_m }) {
    const [x, y, z] = frame.toLocal(...position, ground_amsl_m);
    return y - ground(x, z);
  }

  /** A few a frame, so that no frame is late; drawn once all are there. */
  function workOut() {
    for (const place of wanted.splice(0, MOST_A_FRAME))
      near.set(place, supportMembers(supports[place], frame, belowFoot(supports[place])).fine);
    if (wanted.length) return;
    isStale = false;
    paintNear();
  }

  return {
    group,
    /** along: masts of railways, as members; groundAt(x, z): of the drawn ground. */
    show(next, ownFrame, along = [], groundAt = () => Infinity) {
      ground = groundAt;
      [supports, frame, masts, near, lookedFrom, wanted, isStale] = [next, ownFrame, along, new Map(), null, [], false];
      feet = Float32Array.from(
        supports.flatMap(({ position, ground_amsl_m, height_m }) =>
          ownFrame.toLocal(...position, ground_amsl_m + height_m / 2),
        ),
      );
      group.visible = supports.length + masts.length > 0;
      outlines = supports.map((support) => supportMembers(support, frame).outline);
      outline.set(joined([...outlines, ...masts]), colours ? outlineColours() : new Float32Array(0));
      paintNear();
    },
    apply(palette) {
      const body = new Map();
      const mast = new Color(palette.tower);
      colours = {
        insulator: new Color(palette.tower).lerp(new Color(palette.raised), palette.isDark ? 0.1 : 0.45),
        foundation: new Color(palette.pressed).lerp(new Color(palette.inkSecond), 0.25),
        of({ voltage_v, isMast }) {
          if (isMast) return mast;
          if (!body.has(voltage_v))
            body.set(
              voltage_v,
              new Color(voltage_v === null ? palette.tower : voltageColour(palette, voltage_v / 1_000)),
            );
          return body.get(voltage_v);
        },
      };
      outline.recolour(outlineColours());
      paintNear();
    },
    update(camera) {
      if (!supports.length) return false;
      if (!lookedFrom || lookedFrom.distanceTo(camera.position) >= LOOK_AGAIN_M) {
        lookedFrom = camera.position.clone();
        choose(camera.position);
      }
      if (!isStale) return false;
      workOut();
      return true;
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
