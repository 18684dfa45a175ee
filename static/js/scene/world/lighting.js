/** Sun and sky: how bright and of which colour things are at an hour, in a theme. */

import { Color, DirectionalLight, Group, HemisphereLight, Vector3 } from "../three.js";

/** @import { PerspectiveCamera } from "../three.js" */
/** @import { HeightAt, ScenePalette } from "../types.d.ts" */

/** @typedef {ReturnType<typeof mood>} Mood */
/** @typedef {Exclude<keyof ScenePalette, "routes" | "fonts" | "isDark">} ColourName */
/** @typedef {{ altitude_deg: number, azimuth_deg: number }} SunPlace */

const RADIANS = Math.PI / 180;
const SHADOW_PX = 2_048;
const SIZES_M = [90, 160, 280, 500, 900]; // half the side of the area with shadows
const AWAY_M = 2_500;
const NIGHT = { light: "#2b3a4a", dark: "#070b0f" };
const DUSK = { light: "#f2cdaa", dark: "#2b2a32" };
const SUN_SHARE = 0.52; // of the light on level ground in full day
const MOON_DEG = 40;

/** 0 below `low`, 1 above `high`, smooth between. @param {number} value @param {number} low @param {number} high */
function step(value, low, high) {
  const share = Math.min(Math.max((value - low) / (high - low), 0), 1);
  return share * share * (3 - 2 * share);
}

/**
 * The colours and strengths of an hour. night: 0 to 1; ground: its colour before light; line: the graticule's at night; glow: above the
 * horizon, while the sun is low. A level surface in the sun has its own colour at every hour of the day; at night the theme's night lies
 * over the ground, and shapes stay legible.
 *
 * @param {Pick<ScenePalette, "isDark" | "ground" | "water">} palette
 * @param {number} altitude_deg of the sun
 */
export function mood(palette, altitude_deg) {
  const day = step(altitude_deg, -7, 6);
  const low = step(altitude_deg, -8, 0) * (1 - step(altitude_deg, 4, 22));
  const night = new Color(NIGHT[palette.isDark ? "dark" : "light"]);
  const ground = new Color(palette.ground).lerp(night, (1 - day) * (palette.isDark ? 0.5 : 0.955));
  const height = Math.sin(Math.max(altitude_deg, 4) * RADIANS);
  const sunShare = SUN_SHARE * step(altitude_deg, -3, 12);
  const strength = Math.min(sunShare / height, 1.3);
  const sun = { colour: new Color("#ffffff").lerp(new Color("#ffb070"), low * 0.7), strength: Math.PI * strength };
  const moon = 0.14 * (1 - day);
  const fillShare = 0.97 - strength * height - moon * Math.sin(MOON_DEG * RADIANS);
  const fill = {
    sky: new Color("#ffffff").lerp(new Color("#f3ede8"), low),
    ground: new Color(palette.isDark ? "#c6c9cb" : "#d5d0c8"),
    strength: Math.PI * fillShare,
  };
  const lit = ground.clone().multiply(
    fill.sky
      .clone()
      .multiplyScalar(fillShare)
      .add(sun.colour.clone().multiplyScalar(strength * height)),
  );
  const glow = new Color(DUSK[palette.isDark ? "dark" : "light"]);
  return {
    phase: altitude_deg < -6 ? "night" : altitude_deg < 6 ? "dusk" : "day",
    ground,
    night: 1 - day,
    line: ground.clone().lerp(new Color(palette.isDark ? "#7f95a3" : "#8fa3b3"), palette.isDark ? 0.07 : 0.12),
    horizon: lit.lerp(glow, low * 0.3),
    glow: lit.clone().lerp(glow, low * 0.85),
    sky: night.clone().lerp(new Color(palette.water), day),
    sun,
    moon: Math.PI * moon,
    fill,
  };
}

/**
 * The palette of things that are not lit as the ground is: at night, in the light theme, lines and towers become pale and surfaces dark, so
 * that both stay apart from the ground.
 *
 * @param {ScenePalette} palette
 * @param {number} night 0 to 1
 * @returns {ScenePalette}
 */
export function nightPalette(palette, night) {
  if (palette.isDark || night < 0.02) return palette;
  /** @param {ColourName[]} names @param {string} colour @param {number} share */
  const towards = (names, colour, share) =>
    names.map((name) => [name, `#${new Color(palette[name]).lerp(new Color(colour), share).getHexString()}`]);
  const pale = step(night, 0.68, 0.82); // all at once, when the ground is as far from dark lines as from pale ones
  return {
    ...palette,
    ...Object.fromEntries([
      ...towards(["volt400", "volt220", "volt132", "volt66", "volt20", "voltUnknown", "tower"], "#d3dfe8", 0.62 * pale),
      ...towards(["railway", "bridge", "ground", "pressed", "raised", "inkSecond"], NIGHT.light, 0.86 * night),
      ...towards(["zone"], "#f285b6", 0.7 * pale),
    ]),
  };
}

/** pixel_m: of the shadow map. @param {{ shadows: boolean }} how */
export function makeLights({ shadows }) {
  const group = new Group();
  const fill = new HemisphereLight();
  const sun = new DirectionalLight();
  group.add(fill, sun, sun.target);
  sun.castShadow = shadows;
  sun.shadow.mapSize.set(SHADOW_PX, SHADOW_PX);
  sun.shadow.bias = -0.0002;
  sun.shadow.normalBias = 0.35;
  sun.shadow.radius = 1.4;
  sun.shadow.intensity = 0.85;
  const towards = new Vector3(0, 1, 0);
  const focus = new Vector3();
  const look = new Vector3();
  let size_m = 0;

  return {
    group,
    get pixel_m() {
      return (2 * size_m) / SHADOW_PX;
    },
    /** @param {Mood} now @param {SunPlace} sun */
    apply(now, { altitude_deg, azimuth_deg }) {
      const isUp = altitude_deg > -4;
      const altitude = (isUp ? Math.max(altitude_deg, 4) : MOON_DEG) * RADIANS;
      const azimuth = (isUp ? azimuth_deg : azimuth_deg + 150) * RADIANS;
      towards.set(Math.sin(azimuth) * Math.cos(altitude), Math.sin(altitude), -Math.cos(azimuth) * Math.cos(altitude));
      sun.color.copy(isUp ? now.sun.colour : now.fill.sky);
      sun.intensity = isUp ? now.sun.strength + now.moon : now.moon;
      fill.color.copy(now.fill.sky);
      fill.groundColor.copy(now.fill.ground);
      fill.intensity = now.fill.strength;
      size_m = 0;
    },
    /**
     * Move the shadows' box to the camera's target, by whole pixels of the shadow map, so that edges stand still.
     *
     * @param {PerspectiveCamera} camera
     * @param {HeightAt} heightAt
     */
    follow(camera, heightAt) {
      camera.getWorldDirection(look);
      const above_m = Math.max(camera.position.y - heightAt(camera.position.x, camera.position.z), 5);
      const far_m = Math.min(look.y < -0.05 ? above_m / -look.y : above_m * 6, 700, Math.max(above_m * 6, 120));
      focus.copy(camera.position).addScaledVector(look, far_m);
      const wanted_m = SIZES_M.find((size) => size >= far_m * 0.8) ?? SIZES_M[SIZES_M.length - 1];
      const pixel_m = (2 * wanted_m) / SHADOW_PX;
      const grain = pixel_m * 32;
      focus.set(Math.round(focus.x / grain) * grain, heightAt(focus.x, focus.z), Math.round(focus.z / grain) * grain);
      if (size_m === wanted_m && sun.target.position.distanceTo(focus) < grain * 4) return false;
      sun.target.position.copy(focus);
      sun.position.copy(focus).addScaledVector(towards, AWAY_M);
      if (size_m !== wanted_m) {
        size_m = wanted_m;
        const box = sun.shadow.camera;
        [box.left, box.right, box.top, box.bottom, box.near, box.far] = [
          -size_m,
          size_m,
          size_m,
          -size_m,
          AWAY_M - 1_500,
          AWAY_M + 1_500,
        ];
        box.updateProjectionMatrix();
      }
      sun.target.updateMatrixWorld();
      sun.updateMatrixWorld();
      return true;
    },
    dispose() {
      sun.dispose();
      fill.dispose();
    },
  };
}
