/** The picture in space: the world, the ways, the UAVs, drawn by the graphics of the machine. */

import { createMarks } from "../flight/marks.js";
import { createUavs } from "../flight/uavs.js";
import { createWays } from "../flight/ways.js";
import { makeFrame } from "../frame.js";
import { makeWorld } from "../world/world.js";
import { createView } from "./view.js";

const SAME_SUN_MS = 30_000;
const [HEAD_M, HEAD_PX] = [1.1, 30]; // round a UAV its way is not drawn

/** @import { Marks } from "../flight/marks.js" */
/** @import { Uavs } from "../flight/uavs.js" */
/** @import { Ways } from "../flight/ways.js" */
/** @import { Picture, PictureOptions } from "../types.d.ts" */

/**
 * @param {HTMLElement} container
 * @param {HTMLCanvasElement} canvas in it
 * @param {PictureOptions} options
 * @returns {Picture}
 * @throws {NoWebGL}
 */
export function createPicture(container, canvas, { scene, palette, draw, onLost, onFound }) {
  const view = createView(container, canvas, { draw, onLost, onFound });
  const frame = makeFrame(scene.origin);
  const world = makeWorld({ frame, palette });
  let colours = palette;
  /** @type {{ ways: Ways, uavs: Uavs, marks: Marks } | null} */
  let parts = null;
  /** @type {number | null} */
  let sun_ms = null;

  world.show(scene);
  view.scene.fog = world.fog;
  view.scene.add(world.group);
  view.setBackground(palette.ground);

  const isNight = () => world.light.phase === "night";

  return {
    kind: "3d",
    size: view.size,
    request: view.request,
    project: view.project,
    figures: view.figures,
    copy: view.copy,
    frame,
    groundAt: world.heightAt,
    wires: () => world.wires,
    labels: world.labels,
    isNight,
    showFlight(flight, count, begins_ms) {
      const most = Math.max(1, count);
      const ways = createWays(world.heightAt);
      parts = { ways, uavs: createUavs(most), marks: createMarks(most) };
      for (const { group } of Object.values(parts)) view.scene.add(group);
      ways.setPalette(colours);
      ways.showPlanned(flight.plannedLines());
      ways.showFlown(flight.flownLines(), begins_ms);
      view.request();
    },
    showFlown(flight, begins_ms) {
      parts?.ways.showFlown(flight.flownLines(), begins_ms);
    },
    setPalette(next) {
      colours = next;
      world.setPalette(next);
      parts?.ways.setPalette(next);
      view.setBackground(next.ground);
      view.request();
    },
    setDate(date) {
      if (sun_ms !== null && Math.abs(date.getTime() - sun_ms) < SAME_SUN_MS) return;
      sun_ms = date.getTime();
      world.setSun(date);
    },
    show({ pose, distance_m, room_m, drawn, chosen, looked, hidden, at_ms, wind, dt_s }) {
      view.aim(pose, room_m);
      const { metresPerPixel } = view;
      parts?.uavs.show(drawn, {
        palette: colours,
        metresPerPixel,
        isDark: colours.isDark || isNight(),
        dt_s,
        hidden,
      });
      parts?.marks.show(
        drawn.filter(({ route }) => route !== hidden),
        { wind: hidden === null ? wind : null, chosen, palette: colours, isNight: isNight(), metresPerPixel },
      );
      const heads = drawn.map(({ route, place }) => ({
        route,
        place,
        radius_m: Math.max(HEAD_M, HEAD_PX * metresPerPixel(place)),
      }));
      parts?.ways.frame({ at_ms, heads, looked, viewport: view.viewport() });
      return world.update(view.camera, distance_m) === true;
    },
    dispose() {
      for (const part of [world, ...Object.values(parts ?? {})]) {
        view.scene.remove(part.group);
        part.dispose();
      }
      view.dispose();
    },
  };
}
