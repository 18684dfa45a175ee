/** The list of missions: find, open, delete and bring back. */

import { ApiError, get, post, remove, signInAddress } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { routeLetter, routeNumber } from "../map/palette.js";
import { menuOf, readPage, startChrome, toggleMenu } from "../page/chrome.js";
import { toast } from "../page/toast.js";
import { createStore } from "../store.js";
import { countText, durationText, lengthText, whenText } from "../units.js";
import { sketch } from "./sketch.js";

const STATES = { draft: "Draft", planned: "Planned", approved: "Approved", dispatched: "Dispatched", active: "Active", completed: "Completed", aborted: "Aborted", failed: "Failed" };
const MOST_DOTS = 24;
const STALE_WORDS = "Assets or zones were changed after this was planned. Open it to see whether that touches its routes.";

const page = readPage();
const store = createStore({ missions: null, next: null, text: "", state: "", problem: null });
const filter = byId("filter");

startChrome({ bindings: [{ keys: ["/"], words: "Find a mission", act: () => filter.focus() }] });

function matches(mission, { text, state }) {
  const wanted = text.trim().toLocaleLowerCase();
  return (!state || mission.state === state) && (!wanted || `${mission.name}\n${mission.author ?? ""}`.toLocaleLowerCase().includes(wanted));
}

/** "39 of 46 targets" where a plan leaves some out. */
function reachedWords({ target_count, unassigned_count }) {
  const all = countText(target_count, "target");
  return unassigned_count ? `${target_count - unassigned_count} of ${all}` : all;
}

function row(mission) {
  const address = `/missions/${mission.id}`;
  const more = h("button", { type: "button", class: "icon-button", "aria-label": `More for ${mission.name}`, "aria-haspopup": "true", "aria-expanded": "false" }, icon("ellipsis"));
  more.addEventListener("click", (event) => {
    event.stopPropagation();
    const items = [{ icon: "map", label: "Open", act: () => void (location.href = address) }];
    if (page.canPlan) items.push({ icon: "trash-2", label: "Delete", act: () => deleteMission(mission) });
    toggleMenu(more, () => menuOf(mission.name, items));
  });
  const isPlanned = mission.planned_at !== null && mission.total_length_m !== null;
  return h(
    "tr",
    { onclick: (event) => event.target.closest("a, button") ?? (location.href = address) },
    h("td", {}, sketch(mission.sketch)),
    h(
      "td",
      { class: "name" },
      h("a", { href: address }, mission.name),
      h("span", { class: "caption" }, mission.author ?? "", mission.is_stale && h("span", { class: "stale", title: STALE_WORDS }, icon("info", "small"), "Ground changed since")),
    ),
    h("td", { class: "state" }, h("span", { class: `chip ${mission.state}` }, STATES[mission.state] ?? mission.state)),
    h(
      "td",
      { class: "targets" },
      mission.target_count > 0 && mission.target_count <= MOST_DOTS && h("div", { class: "dots", "aria-hidden": "true" }, Array.from({ length: mission.target_count }, (_, place) => h("i", { class: place < mission.target_count - mission.unassigned_count ? null : "missed" }))),
      h("span", { class: "caption" }, reachedWords(mission)),
    ),
    h(
      "td",
      { class: "uavs" },
      mission.uav_count
        ? h("span", { class: "letters", role: "img", "aria-label": countText(mission.uav_count, "UAV") }, Array.from({ length: mission.uav_count }, (_, sequence) => h("span", { class: `letter route-${routeNumber(sequence)}`, "aria-hidden": "true" }, routeLetter(sequence))))
        : h("span", { class: "caption" }, "none"),
    ),
    h("td", { class: "number distance" }, isPlanned ? lengthText(mission.total_length_m) : "—"),
    h("td", { class: "number time" }, isPlanned ? durationText(mission.duration_s) : "—"),
    h("td", { class: "changed", title: new Date(mission.updated_at).toLocaleString("en-GB", { timeZoneName: "short" }) }, whenText(mission.updated_at)),
    h("td", {}, more),
  );
}

async function deleteMission(mission) {
  try {
    await remove(`/missions/${mission.id}`);
    store.update({ missions: store.state.missions.filter((known) => known.id !== mission.id), problem: null });
    offerUndo(mission.id, mission.name);
  } catch (error) {
    tell(error, "Not deleted.");
  }
}

function offerUndo(id, name) {
  toast(`“${name}” is deleted.`, {
    label: "Undo",
    async act() {
      try {
        await post(`/missions/${id}/restore`, {});
        await load();
      } catch (error) {
        tell(error, "Not brought back.");
      }
    },
  });
}

function tell(error, title) {
  if (!(error instanceof ApiError)) throw error;
  const isOut = error.isSignedOut;
  store.update({ problem: isOut ? { title: "You are signed out.", text: "Sign in to go on.", isOut } : { title, text: error.message } });
}

async function load(address = "/missions?limit=50") {
  try {
    const { data } = await get(address);
    const before = address.includes("cursor") ? store.state.missions : [];
    store.update({ missions: [...before, ...data.results], next: data.next, problem: null });
  } catch (error) {
    tell(error, "Not loaded.");
  }
}

function empty(words, action) {
  byId("missions-empty").replaceChildren(icon("clipboard-list", "large"), ...words, action ?? "");
}

function draw(state) {
  const { missions, next, problem } = state;
  byId("problem").replaceChildren(
    ...(problem ? [h("div", { class: "notice critical", role: "alert" }, icon("circle-alert"), h("p", {}, h("strong", {}, problem.title), ` ${problem.text} `, problem.isOut && h("a", { class: "text-button", href: signInAddress() }, "Sign in")))] : []),
  );
  if (missions === null) return;
  const shown = missions.filter((mission) => matches(mission, state));
  byId("missions").hidden = shown.length === 0;
  byId("missions-empty").hidden = shown.length > 0;
  document.querySelector(".filters").hidden = missions.length === 0;
  if (!missions.length) {
    empty([h("strong", {}, "No missions yet"), h("span", {}, "Pick what to inspect and plan the first one.")], page.canPlan ? h("a", { class: "button", href: "/missions/new" }, "New mission") : null);
  } else if (!shown.length) {
    const what = state.text.trim() ? `No mission matches “${state.text.trim()}”` : "No mission is in this state";
    empty([h("strong", {}, what)], h("button", { type: "button", class: "button", onclick: clearFilter }, "Clear the filter"));
  }
  byId("rows").replaceChildren(...shown.map(row));
  byId("pager").hidden = shown.length === 0;
  byId("how-many").textContent = shown.length === missions.length ? countText(shown.length, "mission") : `${shown.length} of ${countText(missions.length, "mission")}`;
  byId("more-missions").hidden = next === null;
}

/** All, then each state that occurs, with how many. */
function drawStates({ missions, state }) {
  if (missions === null) return;
  const choices = [["", "All", missions.length], ...Object.entries(STATES).map(([value, words]) => [value, words, missions.filter((mission) => mission.state === value).length])];
  const fieldset = byId("states");
  fieldset.replaceChildren(
    fieldset.querySelector("legend"),
    ...choices
      .filter(([value, , count]) => count > 0 || value === "" || value === state)
      .map(([value, words, count]) =>
        h("label", {}, h("input", { type: "radio", name: "state", value, checked: state === value, onchange: () => store.update({ state: value }) }), h("span", { class: "segment" }, words, h("span", { class: "count" }, `${count}`))),
      ),
  );
}

function clearFilter() {
  filter.value = "";
  store.update({ text: "", state: "" });
  filter.focus();
}

filter.addEventListener("input", () => store.update({ text: filter.value }));
filter.addEventListener("keydown", (event) => {
  if (event.key === "Escape") clearFilter();
});
byId("more-missions").addEventListener("click", () => load(store.state.next));
store.listen(["missions", "next", "text", "state", "problem"], draw);
store.listen(["missions"], drawStates);

const parameters = new URLSearchParams(location.search);
load().then(() => {
  document.documentElement.dataset.loaded = "true";
  if (!parameters.has("deleted")) return;
  offerUndo(parameters.get("deleted"), parameters.get("name") ?? "The mission");
  history.replaceState(null, "", "/");
});
