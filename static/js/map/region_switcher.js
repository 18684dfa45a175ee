/** The choice of the region in the bar, and the search for a town; curators rename regions and remove the demo there. */

import { ApiError, follow, patch, post } from "../api.js";
import { byId, find, h, icon, setChildren } from "../dom.js";
import { boxAround } from "../domain/geodesy.js";
import { regionAt } from "../domain/regions.js";
import { closeMenu, toggleMenu } from "../page/chrome.js";
import { confirmAct } from "../page/confirm.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { percentText } from "../units.js";
import { countsText } from "./look/region_words.js";
import { townsFound } from "./place_names.js";

/** @import { Answer } from "../api.js" */
/** @import { Box, FoundPlace, MapLibreMap, MapPage, Position, Region } from "./types.d.ts" */

const MAX_TOWNS = 6;

/**
 * @param {MapLibreMap} map
 * @param {MapPage} page
 * @param {(box: Box) => void} show
 */
export function mountRegionSwitcher(map, page, show) {
  const regions = page.regions ?? [];
  const button = document.getElementById("open-regions");
  if (!button) return;
  const here = () => regionAt(regions, /** @type {Position} */ (map.getCenter().toArray()));
  function label() {
    const region = here();
    const words = region?.name ?? (regions.length ? t("All regions") : t("Find a town"));
    const shown = find(byId("open-regions"), "span");
    shown.textContent = words;
    shown.translate = !region; // a name stays as it is
    byId("open-regions").setAttribute("aria-label", t("Region: {name}", { name: words }));
    byId("open-regions").title = t("Region: {name}", { name: words });
  }
  button.hidden = false;
  button.addEventListener("click", () =>
    toggleMenu(button, () => menu(regions, here(), page.canCurate ?? false, show)),
  );
  map.on("moveend", label);
  label();
}

/**
 * @param {Region[]} regions
 * @param {Region | null} here
 * @param {boolean} canCurate
 * @param {(box: Box) => void} show
 */
function menu(regions, here, canCurate, show) {
  /** @param {Box} box */
  const go = (box) => () => {
    closeMenu();
    show(box);
  };
  /** @param {string} name @param {string} label @param {() => unknown} act */
  const entry = (name, label, act) => h("button", { type: "button", onclick: act }, icon(name), label);
  const acts = canCurate
    ? [
        ...(here ? [entry("pencil", t("Rename {name}", { name: here.name }), () => rename(here))] : []),
        ...regions
          .filter((region) => region.is_synthetic)
          .map((region) => entry("trash-2", t("Remove the demo data"), () => removeDemo(region))),
      ]
    : [];
  return h(
    "div",
    { class: "menu float region-menu", role: "group", "aria-label": t("Regions") },
    regions.map((region) =>
      h(
        "button",
        { type: "button", "aria-current": region === here ? "true" : null, onclick: go(region.extent) },
        icon("map"),
        h(
          "span",
          { title: region.name },
          h("strong", { translate: "no" }, region.name),
          h("span", { class: "caption" }, countsText(region.counts)),
        ),
      ),
    ),
    regions.length > 1 && entry("maximize-2", t("All regions"), go(around(regions))),
    townSearch(show),
    acts.length > 0 && h("hr", {}),
    acts,
  );
}

/** @param {Region[]} regions */
const around = (regions) =>
  /** @type {Box} */ (
    boxAround(
      regions.flatMap(({ extent: [west, south, east, north] }) => [
        [west, south],
        [east, north],
      ]),
    )
  );

/** A field that finds towns by name, without a service. @param {(box: Box) => void} show */
function townSearch(show) {
  const results = h("div", { role: "status" });
  const input = h("input", {
    class: "input",
    type: "search",
    maxlength: 100,
    autocomplete: "off",
    placeholder: t("Find a town"),
    "aria-label": t("Find a town"),
  });
  let asked = 0;
  input.addEventListener("input", async () => {
    asked += 1;
    const turn = asked;
    const text = input.value.trim();
    const towns = await townsFound(text, MAX_TOWNS);
    if (turn !== asked) return;
    const go =
      (/** @type {FoundPlace} */ { box }) =>
      () => {
        closeMenu();
        if (box) show(box);
      };
    setChildren(
      results,
      towns.map((place) =>
        h(
          "button",
          { type: "button", onclick: go(place) },
          icon("map-pin"),
          h("span", {}, h("strong", {}, place.label), h("span", { class: "caption" }, place.detail)),
        ),
      ),
      !towns.length && text.length > 1 && h("p", { class: "caption" }, t("No town has this name.")),
    );
  });
  return h("div", { class: "town-search" }, input, results);
}

/** @param {Region} region */
async function rename({ id, name }) {
  closeMenu();
  const field = { name: "name", label: t("Name"), value: name, isNeeded: true };
  const answer = await confirmAct({ title: t("Rename the region"), lines: [], act: t("Rename"), field });
  if (answer?.name?.trim()) await change(() => patch(`/regions/${id}`, { name: answer.name.trim() }));
}

/** @param {Region} region */
async function removeDemo({ id, name }) {
  closeMenu();
  await change(async () => {
    const body = { region_id: id };
    const { data } = /** @type {Answer<{ counts: Record<string, number> }>} */ (
      await post("/regions/delete", { ...body, dry_run: true })
    );
    const answer = await confirmAct({
      title: t("Remove the demo data?"),
      lines: [
        t("Removes {counts} of {name}, and the demo's UAVs, types and bases that no mission uses.", {
          counts: countsText(data.counts),
          name,
        }),
        t("Missions stay. This cannot be undone here: importing the demo's files again brings the data back."),
      ],
      act: t("Remove the demo data"),
    });
    if (!answer) return false;
    const { data: started } = /** @type {Answer<{ job: string }>} */ (
      await post("/regions/delete", { ...body, as_job: true })
    );
    const shown = find(byId("open-regions"), "span");
    const job = await follow(started.job, {
      onProgress: ({ message, progress }) => {
        shown.textContent = `${message}, ${percentText(progress * 100)}`;
      },
    });
    return job.state === "done";
  });
}

/** Carries out a change of the regions, then loads the page again. @param {() => Promise<unknown>} act */
async function change(act) {
  try {
    if ((await act()) !== false) location.reload();
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    toast(error.message);
  }
}
