/** The page "Terrain": composes the list of models, the map and the dock; a click tells the height, several points the profile. */

import { get, post, remove } from "../api.js";
import { byId, h } from "../dom.js";
import { distance_m } from "../domain/geodesy.js";
import { mountGroundPage } from "../ground/ground_page.js";
import { boxAround } from "../map/map_view.js";
import { say, toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { countText } from "../units.js";
import { mountGroundPanel } from "./ground_panel.js";
import { askToRemove, mountModelList } from "./model_list.js";
import { profileSentence, towersAlong } from "./profile_chart.js";
import * as layer from "./terrain_layer.js";

const HINTS = {
  height: t("Click the map: the height of the ground there."),
  profile: t("Click two or more points, or a power line."),
};
const KEYS_OF_PROFILE = ` ${t("Backspace takes the last point back, Esc ends.")}`;
const MOST_SAMPLES = 1_500; // more than a drawing has pixels
const REACH_PX = 24; // of the pointer from the profile's line, for the cursor
const MOST_TOWER_PAGES = 10;

let models = [];
let tool = "height";
let points = [];
let along = null; // what the profile is of: { profile, towers }
let cursor = null;
let asked = 0;

const { page, map, open } = mountGroundPage({
  click: (thing, position) => (tool === "profile" ? clickInProfile(thing, position) : tellHeight(position)),
  hover: (thing, point) => pointAlong(point),
  kinds: () => (tool === "profile" ? (points.length ? [] : ["line"]) : null),
});
const showList = mountModelList(page.canCurate, {
  show: ({ geometry }) =>
    map.fit(boxAround(geometry.type === "Polygon" ? geometry.coordinates.flat() : geometry.coordinates.flat(2))),
  point: (model) => layer.showModels(map.map, models, model?.id),
  remove: takeAway,
});
const panel = mountGroundPanel({ cursor: showCursor, back: takePointBack, close: end });

async function load() {
  try {
    models = (await get("/terrain")).data.features;
    showList(models);
    layer.showModels(map.map, models);
    byId("page-facts").textContent = models.length
      ? tn(models.length, "{count} model, newest on top", "{count} models, newest on top")
      : t("No models");
  } catch (error) {
    toast(error.message, { label: t("Try again"), act: load });
  }
}

function choose(next) {
  end();
  tool = next;
  document.querySelector(`#terrain-tools input[value=${tool}]`).checked = true;
  byId("terrain-hint").replaceChildren(
    HINTS[tool],
    ...(tool === "profile" ? [h("span", { class: "with-keys" }, KEYS_OF_PROFILE)] : []),
  );
  map.map.getCanvas().style.cursor = tool === "profile" ? "crosshair" : "";
}

/** Closes the dock and forgets the points; whatever is still being asked comes too late. */
function end() {
  asked += 1;
  [points, along] = [[], null];
  panel.close();
  layer.showLine(map.map, [], []);
  showCursor(null);
}

const rounded = (position) => position.map((degrees) => Number(degrees.toFixed(7)));

/** What `question` answers, or null where somebody has gone on to something else in the meantime, or it failed, which is said. */
async function ask(question) {
  const turn = ++asked;
  try {
    const answer = await question();
    return turn === asked ? answer : null;
  } catch (error) {
    if (turn === asked) toast(error.message);
    return null;
  }
}

async function tellHeight(clicked) {
  const position = rounded(clicked);
  layer.showLine(map.map, [], [position]);
  const told = await ask(async () => (await get(`/terrain/height?position=${position.join(",")}`)).data);
  if (told) panel.height(position, told);
}

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
  if (found) show(found, [], { title: countText(points.length, "point"), canStepBack: true });
}

async function profileOfLine(id) {
  const found = await ask(async () => {
    const { data: line } = await get(`/assets/${id}`);
    const positions =
      line.geometry.type === "MultiLineString" ? line.geometry.coordinates[0] : line.geometry.coordinates;
    const [profile, towers] = await Promise.all([askProfile(positions), towersIn(boxAround(positions))]);
    return { line, positions, profile, towers: towersAlong(profile, towers) };
  });
  if (!found) return;
  layer.showLine(map.map, found.positions, []);
  show(found.profile, found.towers, { title: found.line.properties.label, canStepBack: false });
  map.fit(boxAround(found.positions));
}

async function askProfile(line) {
  const length_m = line.slice(1).reduce((sum, position, index) => sum + distance_m(line[index], position), 0);
  const finest_m = models.reduce((finest, { properties }) => Math.min(finest, properties.resolution_m), Infinity);
  const step_m = Math.max(1, length_m / MOST_SAMPLES, Number.isFinite(finest_m) ? finest_m / 2 : 0);
  return (await post("/terrain/profile", { line, step_m: Math.min(step_m, 100_000) })).data;
}

async function towersIn(box) {
  const found = [];
  let next = `/assets?kind=tower&limit=500&bbox=${box.map((degrees, index) => (degrees + (index < 2 ? -1e-6 : 1e-6)).toFixed(7)).join(",")}`;
  for (let number = 0; next && number < MOST_TOWER_PAGES; number += 1) {
    const { data } = await get(next);
    found.push(...data.features);
    next = data.next;
  }
  return found;
}

function show(profile, towers, words) {
  along = { profile, towers };
  panel.profile(profile, towers, words);
  say(profileSentence(profile, towers));
}

function takePointBack() {
  if (tool !== "profile" || !points.length) return false;
  points.pop();
  profileOfPoints();
  return true;
}

function showCursor(index) {
  cursor = index;
  panel.point(index);
  if (map.map.getSource("terrain-cursor"))
    layer.showCursor(map.map, index === null || !along ? null : along.profile.positions[index]);
}

/** The pointer on the map near the profile's line moves the cursor of the chart. */
function pointAlong(point) {
  if (!along) return;
  let nearest = null;
  let reach = REACH_PX;
  if (point) {
    along.profile.positions.forEach((position, index) => {
      const place = map.map.project(position);
      const away = Math.hypot(place.x - point.x, place.y - point.y);
      if (away < reach) [nearest, reach] = [index, away];
    });
  }
  if (nearest !== cursor) showCursor(nearest);
}

/** Along the profile by key; a step is a hundredth of it. */
const step = (direction) => () => {
  if (!along) return false;
  const last = along.profile.positions.length - 1;
  const by = direction * Math.max(1, Math.round(last / 100));
  showCursor(cursor === null ? (direction > 0 ? 0 : last) : Math.min(last, Math.max(0, cursor + by)));
  return true;
};

async function takeAway(model) {
  if (!(await askToRemove(model.properties))) return;
  try {
    await remove(`/terrain/${model.id}`);
    toast(t("{name} removed.", { name: model.properties.file_name }));
  } catch (error) {
    toast(error.status === 404 ? t("It has been removed already.") : error.message);
  }
  end();
  await load();
  byId("terrain-list").querySelector("button")?.focus();
}

for (const input of document.querySelectorAll("#terrain-tools input"))
  input.addEventListener("change", () => choose(input.value));

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
