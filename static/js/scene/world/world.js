/** The world of the 3D view: everything that stands on the ground, with sun and sky. Its interface is told in docs/scene.md. */

import { Fog, Group, HemisphereLight } from "../three.js";

export function makeWorld({ frame, palette }) {
  const group = new Group();
  const light = new HemisphereLight(palette.water, palette.ground, 3);
  group.add(light);
  const fog = new Fog(palette.ground, 2_000, 30_000);
  return {
    group,
    fog,
    frame,
    wires: { points: new Float64Array(0), first: new Uint32Array(1), span: new Uint32Array(0) },
    light: { phase: "day", altitude_deg: 45, azimuth_deg: 180 },
    show() {},
    setSun() {},
    setPalette(next) {
      fog.color.set(next.ground);
    },
    update: () => false,
    heightAt: () => 0,
    labels: () => [],
    dispose() {
      light.dispose();
    },
  };
}
