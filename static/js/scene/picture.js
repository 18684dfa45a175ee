/** The picture in space: the world, the ways, the UAVs, drawn by the graphics of the machine. */

import { createMarks } from "./flight/marks.js";
import { createUavs } from "./flight/uavs.js";
import { createWays } from "./flight/ways.js";
import { makeFrame } from "./frame.js";
import { createView } from "./view.js";
import { makeWorld } from "./world/world.js";

const SAME_SUN_MS = 30_000;
const [HEAD_M, HEAD_PX] = [1.1, 30]; // round a UAV its way is not drawn

/** canvas in its container; draw, onLost, onFound: as of createView. Throws NoWebGL. */
export function createPicture(container, canvas, { palette, draw, onLost, onFound, quality = "high" }) {
  const view = createView(container, canvas, { draw, onLost, onFound });
  let colours = palette;
  let world = null;
  let parts = null; // { ways, uavs, marks }
  let sun_ms = null;

  function clear() {
    for (const part of [world, ...Object.values(parts ?? {})].filter(Boolean)) {
      view.scene.remove(part.group);
      part.dispose();
    }
    world = parts = sun_ms = null;
  }

  const picture = {
    kind: "3d",
    size: view.size,
    request: view.request,
    project: view.project,
    figures: view.figures,
    copy: view.copy,
    frame: null,
    groundAt: (x, z) => world?.heightAt(x, z) ?? 0,
    wires: () => world.wires,
    labels: () => world.labels(),
    isNight: () => world.light.phase === "night",
    /** scene: of GET /api/v1/scene. */
    showGround(scene) {
      clear();
      picture.frame = makeFrame(scene.origin);
      world = makeWorld({ frame: picture.frame, palette: colours, quality });
      world.show(scene);
      view.scene.fog = world.fog;
      view.scene.add(world.group);
      view.setBackground(colours.ground);
    },
    /** flight: of drawFlight; count: of routes. */
    showFlight(flight, count, begins_ms) {
      parts = {
        ways: createWays(picture.groundAt),
        uavs: createUavs(Math.max(1, count)),
        marks: createMarks(Math.max(1, count)),
      };
      for (const { group } of Object.values(parts)) view.scene.add(group);
      parts.ways.setPalette(colours);
      parts.ways.showPlanned(flight.plannedLines());
      parts.ways.showFlown(flight.flownLines(), begins_ms);
      view.request();
    },
    showFlown(flight, begins_ms) {
      parts.ways.showFlown(flight.flownLines(), begins_ms);
    },
    setPalette(next) {
      colours = next;
      world?.setPalette(next);
      parts?.ways.setPalette(next);
      view.setBackground(next.ground);
      view.request();
    },
    setDate(date) {
      if (sun_ms !== null && Math.abs(date.getTime() - sun_ms) < SAME_SUN_MS) return;
      sun_ms = date.getTime();
      world.setSun(date);
    },
    /** pose: of the rig; distance_m: to what is looked at; room_m: round the camera; drawn: moments with { colour, report }; chosen, looked: places of routes; hidden: the one that looks. */
    show({ pose, distance_m, room_m, drawn, chosen, looked, hidden, at_ms, wind, dt_s }) {
      view.aim(pose, room_m);
      parts.uavs.show(drawn, {
        palette: colours,
        metresPerPixel: view.metresPerPixel,
        isDark: colours.isDark || picture.isNight(),
        dt_s,
        hidden,
      });
      parts.marks.show(
        drawn.filter(({ route }) => route !== hidden),
        {
          wind: hidden === null ? wind : null,
          chosen,
          palette: colours,
          isNight: picture.isNight(),
          metresPerPixel: view.metresPerPixel,
        },
      );
      const heads = drawn.map(({ route, place }) => ({
        route,
        place,
        radius_m: Math.max(HEAD_M, HEAD_PX * view.metresPerPixel(place)),
      }));
      parts.ways.frame({ at_ms, heads, looked, viewport: view.viewport() });
      return world.update(view.camera, distance_m) === true;
    },
    dispose() {
      clear();
      view.dispose();
    },
  };
  return picture;
}
