/** The page "Terrain": composes the list of models, the map and the dock; a click shows the height, several points the profile. */

import { get, post, remove } from "../api.js";
import { byId, find, h } from "../dom.js";
import { boxAround, pathLength_m } from "../domain/geodesy.js";
import { mountGroundPage } from "../ground/ground_page.js";
import { loadMapLibrary } from "../map/maplibre.js";
import { announce, toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { mountGroundPanel } from "./ground_panel.js";
import { askToRemove, mountModelList } from "./model_list.js";
import { profileSentence, towersAlong } from "./profile_chart.js";
import * as layer from "./terrain_layer.js";

/** @import { Answer, ApiError } from "../api.js" */
/** @import { AssetCollection, AssetDetailFeature, AssetFeature, GroundHeight, ModelCollection, ModelFeature, Profile } from "../api_types.d.ts" */
/** @import { Box, MapThing, ScreenPoint } from "../map/types.d.ts" */
/** @import { TowerAlong } from "./profile_chart.js" */

const HINTS = {
  height: t("Click the map: the height of the ground there."),
  profile: t("Click two or more points, or a power line."),
};
const KEYS_OF_PROFILE = ` ${t("Backspace takes the last point back, Esc ends.")}`;
const MAX_SAMPLES = 1_500; // more than a drawing has pixels
const REACH_PX = 24; // distance of the pointer from the profile's line, for the cursor
const MAX_TOWER_PAGES = 10;

/** @type {ModelFeature[]} */
let models = [];
/** @type {keyof typeof HINTS} */
let tool = "height";
/** @type {number[][]} */
let points = [];
/** What the profile is of. @type {{ profile: Profile, towers: TowerAlong[] } | null} */
let along = null;
/** @type {number | null} */
let cursor = null;
let asked = 0;

await loadMapLibrary();
const { page, map, open } = mountGroundPage({
  click: (thing, position) => (tool === "profile" ? clickInProfile(thing, position) : showHeight(position)),
  hover: (_thing, point) => pointAlong(point),
  kinds: () => (tool === "profile" ? (points.length ? [] : ["line"]) : null),
});
const showList = mountModelList(page.canCurate, {
  show: ({ geometry }) =>
    map.fit(boxAround(/** @type {number[][]} */ (geometry.coordinates.flat(geometry.type === "Polygon" ? 1 : 2)))),
  point: (model) => layer.showModels(map.map, models, model?.id),
  remove: takeAway,
});
const panel = mountGroundPanel({ cursor: showCursor, back: takePointBack, close: end });

/** @param {unknown} error */
const messageOf = (error) => /** @type {Error} */ (error).message;

async function load() {
  try {
    const { data } = /** @type {Answer<ModelCollection>} */ (await get("/terrain"));
    models = data.features;
    showList(models);
    layer.showModels(map.map, models);
    byId("page-facts").textContent = models.length
      ? tn(models.length, "{count} model, newest on top", "{count} models, newest on top")
      : t("No models");
  } catch (error) {
    toast(messageOf(error), { label: t("Try again"), act: load });
  }
}

/** @param {keyof typeof HINTS} next */
function choose(next) {
  end();
  tool = next;
  find(document, `#terrain-tools input[value=${tool}]`, HTMLInputElement).checked = true;
  byId("terrain-hint").replaceChildren(
    HINTS[tool],
    ...(tool === "profile" ? [h("span", { class: "with-keys" }, KEYS_OF_PROFILE)] : []),
  );
  map.map.getCanvas().style.cursor = tool === "profile" ? "crosshair" : "";
}

/** Close the dock and clear the points; answers of running requests are dropped. */
function end() {
  asked += 1;
  points = [];
  along = null;
  panel.close();
  layer.showLine(map.map, [], []);
  showCursor(null);
}

/** @param {readonly number[]} position */
const rounded = (position) => position.map((degrees) => Number(degrees.toFixed(7)));

/**
 * The answer of `question`; null where the user has gone on meanwhile, or after a failure, which is shown.
 *
 * @template Result
 * @param {() => Promise<Result>} question
 */
async function ask(question) {
  asked += 1;
  const turn = asked;
  try {
    const answer = await question();
    return turn === asked ? answer : null;
  } catch (error) {
    if (turn === asked) toast(messageOf(error));
    return null;
  }
}

/** @param {readonly number[]} clicked */
async function showHeight(clicked) {
  const position = rounded(clicked);
  layer.showLine(map.map, [], [position]);
  const answer = await ask(() => get(`/terrain/height?position=${position.join(",")}`));
  if (answer) panel.height(position, /** @type {GroundHeight} */ (answer.data));
}

/** @param {MapThing | null} thing @param {readonly number[]} position */
function clickInProfile(thing, position) {
  if (!points.length && thing?.kind === "line") return profileOfLine(thing.id);
  points.push(rounded(position));
  return profileOfPoints();
}

async function profileOfPoints() {
  along = null;
  showCursor(null);
  layer.showLine(map.map, points, points);
  if (points.length < 2) {
    asked += 1;
    if (points.length) panel.words(t("One point. Click the next."));
    else panel.close();
    return;
  }
  const found = await ask(() => askProfile(points));
  if (found) show(found, [], { title: tn(points.length, "{count} point", "{count} points"), canStepBack: true });
}

/** @param {number} id */
async function profileOfLine(id) {
  const found = await ask(async () => {
    const { data: line } = /** @type {Answer<AssetDetailFeature>} */ (await get(`/assets/${id}`));
    const { type, coordinates } = line.geometry;
    const positions = /** @type {number[][]} */ (type === "MultiLineString" ? coordinates[0] : coordinates);
    const box = /** @type {Box} */ (boxAround(positions));
    const [profile, towers] = await Promise.all([askProfile(positions), towersIn(box)]);
    return { line, positions, profile, towers: towersAlong(profile, towers) };
  });
  if (!found) return;
  layer.showLine(map.map, found.positions, []);
  show(found.profile, found.towers, { title: found.line.properties.label, canStepBack: false });
  map.fit(boxAround(found.positions));
}

/** @param {number[][]} line */
async function askProfile(line) {
  const length_m = pathLength_m(line);
  const finest_m = models.reduce((finest, { properties }) => Math.min(finest, properties.resolution_m), Infinity);
  const step_m = Math.max(1, length_m / MAX_SAMPLES, Number.isFinite(finest_m) ? finest_m / 2 : 0);
  const body = { line, step_m: Math.min(step_m, 100_000) };
  return /** @type {Answer<Profile>} */ (await post("/terrain/profile", body)).data;
}

/** @param {Box} box */
async function towersIn(box) {
  /** @type {AssetFeature[]} */
  const found = [];
  /** @type {string | null} */
  let next = `/assets?kind=tower&limit=500&bbox=${box.map((degrees, index) => (degrees + (index < 2 ? -1e-6 : 1e-6)).toFixed(7)).join(",")}`;
  for (let number = 0; next && number < MAX_TOWER_PAGES; number += 1) {
    const { data } = /** @type {Answer<AssetCollection>} */ (await get(next));
    found.push(...data.features);
    next = data.next;
  }
  return found;
}

/** @param {Profile} profile @param {TowerAlong[]} towers @param {{ title: string, canStepBack: boolean }} words */
function show(profile, towers, words) {
  along = { profile, towers };
  panel.profile(profile, towers, words);
  announce(profileSentence(profile, towers));
}

function takePointBack() {
  if (tool !== "profile" || !points.length) return false;
  points.pop();
  profileOfPoints();
  return true;
}

/** @param {number | null} index */
function showCursor(index) {
  cursor = index;
  panel.point(index);
  if (map.map.getSource("terrain-cursor"))
    layer.showCursor(map.map, index === null || !along ? null : along.profile.positions[index]);
}

/** The pointer on the map near the profile's line moves the cursor of the chart. @param {ScreenPoint | null} point */
function pointAlong(point) {
  if (!along) return;
  /** @type {number | null} */
  let nearest = null;
  let reach = REACH_PX;
  if (point) {
    for (const [index, [longitude, latitude]] of along.profile.positions.entries()) {
      const place = map.map.project([longitude, latitude]);
      const away = Math.hypot(place.x - point.x, place.y - point.y);
      if (away < reach) {
        nearest = index;
        reach = away;
      }
    }
  }
  if (nearest !== cursor) showCursor(nearest);
}

/** Along the profile by key; a step is a hundredth of it. @param {1 | -1} direction */
const step = (direction) => () => {
  if (!along) return false;
  const last = along.profile.positions.length - 1;
  const by = direction * Math.max(1, Math.round(last / 100));
  showCursor(cursor === null ? (direction > 0 ? 0 : last) : Math.min(last, Math.max(0, cursor + by)));
  return true;
};

/** @param {ModelFeature} model */
async function takeAway(model) {
  if (!(await askToRemove(model.properties))) return;
  try {
    await remove(`/terrain/${model.id}`);
    toast(t("{name} removed.", { name: model.properties.file_name }));
  } catch (error) {
    const { status, message } = /** @type {ApiError} */ (error);
    toast(status === 404 ? t("It has been removed already.") : message);
  }
  end();
  await load();
  byId("terrain-list").querySelector("button")?.focus();
}

/** @type {NodeListOf<HTMLInputElement>} */
const tools = document.querySelectorAll("#terrain-tools input");
for (const input of tools)
  input.addEventListener("change", () => choose(input.value === "profile" ? "profile" : "height"));

open({
  bindings: [
    { keys: ["h"], words: t("Height at a place"), act: () => choose("height") },
    { keys: ["p"], words: t("Profile along a line"), act: () => choose("profile") },
    { keys: ["."], words: t("On along the profile"), act: step(1) },
    { keys: [","], words: t("Back along the profile"), act: step(-1) },
    { keys: ["backspace", "delete"], words: t("Take the last point back"), act: takePointBack },
    {
      keys: ["escape"],
      words: t("End"),
      act: () => (!byId("dock").hidden || points.length ? end() : tool === "profile" ? choose("height") : false),
    },
  ],
  async load() {
    layer.addTo(map.map);
    map.onRecolour(() => layer.recolour(map.map));
    choose("height");
    await load();
  },
});
