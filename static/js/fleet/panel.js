/** The chosen row in full: its facts and acts, a UAV's credentials and missions. */

import { get } from "../api.js";
import { byId, h, icon, setChildren } from "../dom.js";
import { MISSION_STATES } from "../domain/planned_state.js";
import { simulatedMark } from "../simulated.js";
import { t, tn } from "../text.js";
import { whenText } from "../units.js";
import { mountConnect } from "./connect.js";
import { mountConnection } from "./connection.js";
import { mountCredentials } from "./credentials.js";
import { mountTypeAirframe } from "./type_airframe.js";
import { camerasToAdd, mountTypeCameras } from "./type_cameras.js";
import { mountTypeLimits } from "./type_limits.js";
import { missingList, stateChip } from "./words.js";

/** @import { Answer } from "../api.js" */
/** @import { UavConnection, UavMission, UavMissionPage, UavState } from "../api_types.d.ts" */
/** @import { Figures } from "../cameras/camera_form.js" */
/** @import { Child } from "../dom.js" */
/** @import { Body, FleetType, Form, Kind, Row, Tab, Uav } from "./types.d.ts" */

/**
 * @typedef {object} PanelActs
 * @property {() => unknown} back
 * @property {() => unknown} edit
 * @property {(state: UavState) => unknown} put
 * @property {() => unknown} remove
 * @property {() => unknown} refresh
 * @property {(error: unknown) => void} failed
 * @property {(tab: Tab, id: number) => unknown} showUavs
 * @property {(uav: Uav) => FleetType | undefined} typeOf
 * @property {(type: number, camera: Figures) => unknown} addCamera
 */
/** @typedef {{ canPlan: boolean, isAdministrator: boolean, acts: PanelActs }} How */
/** @typedef {ReturnType<typeof mountPanel>} Panel */

/** @param {string} image @param {string} words @param {() => unknown} act */
const button = (image, words, act) =>
  h("button", { type: "button", class: "button", onclick: act }, icon(image, "small"), words);

/** @param {Uav} uav @param {PanelActs} acts */
function stateButtons(uav, acts) {
  if (uav.state === "retired") return [button("archive-restore", t("Bring back"), () => acts.put("active"))];
  return [
    uav.state === "active"
      ? button("wrench", t("Maintenance"), () => acts.put("maintenance"))
      : button("check", t("Back in service"), () => acts.put("active")),
    button("archive", t("Retire"), () => acts.put("retired")),
  ];
}

/** @param {UavMission} mission */
const missionRow = (mission) =>
  h(
    "li",
    {},
    h(
      "div",
      { class: "what" },
      h("a", { href: `/missions/${mission.id}` }, mission.name),
      h("span", { class: "caption" }, whenText(mission.updated_at)),
    ),
    h("span", { class: `chip ${mission.state}` }, MISSION_STATES[mission.state] ?? mission.state),
  );

/**
 * The newest missions first; more on demand.
 *
 * @param {HTMLElement} list
 * @param {HTMLElement} none shown where there are none
 * @param {string} address
 */
async function fillMissions(list, none, address) {
  const { data } = /** @type {Answer<UavMissionPage>} */ (await get(address));
  list.append(...data.results.map(missionRow));
  none.hidden = list.children.length > 0;
  const { next } = data;
  if (!next) return;
  const more = h("li", {});
  const showMore = () => {
    more.remove();
    return fillMissions(list, none, next);
  };
  more.append(h("button", { type: "button", class: "text-button", onclick: showMore }, t("Earlier missions")));
  list.append(more);
}

/**
 * For each camera that the UAV reports in full and its type lacks, a button that adds it to the type; drawn anew where these change.
 *
 * @param {HTMLElement} place
 * @param {Uav} uav
 * @param {PanelActs} acts
 */
function mountNewCameras(place, uav, acts) {
  let shown = "";
  return (/** @type {UavConnection} */ { cameras }) => {
    const type = acts.typeOf(uav);
    const found = type ? camerasToAdd(cameras, type) : [];
    if (!type || JSON.stringify(found) === shown) return;
    shown = JSON.stringify(found);
    const words = (/** @type {string} */ camera) => t("Add {camera} to {type}", { camera, type: type.name });
    setChildren(
      place,
      found.map((camera) => button("camera", words(camera.name), () => acts.addCamera(type.id, camera))),
    );
  };
}

/** What there is below the facts of a UAV; it fills itself. @param {Uav} uav @param {How} how @returns {Child} */
function partsOfUav(uav, { canPlan, isAdministrator, acts }) {
  const connection = h("div", { class: "connection" });
  const connect = h("div", {});
  const cameras = h("div", { class: "reported-cameras" });
  const credentials = h("ul", { class: "plain-list" });
  const missions = h("ul", { class: "plain-list" });
  const none = h("p", { class: "quiet-text", hidden: true }, t("No mission uses it yet."));
  /** @type {ReturnType<typeof mountConnect> | null} */
  let showState = null;
  const showCameras = canPlan ? mountNewCameras(cameras, uav, acts) : () => {};
  mountConnection(connection, uav, (answer) => {
    showState ??= mountConnect(connect, uav, answer);
    showState(answer);
    showCameras(answer);
  }).catch(acts.failed);
  mountCredentials(credentials, uav, { canPlan, isAdministrator, onChange: acts.refresh }).catch(acts.failed);
  fillMissions(missions, none, `/uavs/${uav.id}/missions`).catch(acts.failed);
  return [
    h("h3", {}, t("Link")),
    connection,
    cameras,
    connect,
    credentials,
    h("h3", {}, t("Missions")),
    missions,
    none,
  ];
}

/** @param {FleetType} type @param {How} how @returns {Child} */
function partsOfType(type, { canPlan, acts: { failed } }) {
  const limits = h("div", { class: "type-limits" });
  const airframe = h("div", { class: "type-airframe" });
  const cameras = h("div", { class: "type-cameras" });
  mountTypeCameras(cameras, type);
  mountTypeLimits(limits, type, { canPlan, failed }).catch(failed);
  mountTypeAirframe(airframe, type, { canPlan, failed }).catch(failed);
  return [h("h3", {}, t("Cameras")), cameras, h("h3", {}, t("Alerts")), limits, h("h3", {}, t("Simulation")), airframe];
}

/** @param {Row} row @param {Uav | null} uav the same, where it is one @param {PanelActs} acts */
const actsOf = (row, uav, acts) =>
  h(
    "div",
    { class: "panel-acts" },
    button("pencil", t("Edit"), acts.edit),
    uav && stateButtons(uav, acts),
    h(
      "button",
      {
        type: "button",
        class: "icon-button",
        "aria-label": t("Delete {name}", { name: row.name }),
        title: t("Delete"),
        onclick: acts.remove,
      },
      icon("trash-2"),
    ),
  );

/**
 * The way to the UAVs of a type or a base.
 *
 * @param {Tab} tab
 * @param {number} id
 * @param {number} count
 * @param {PanelActs} acts
 */
const uavsLink = (tab, id, count, acts) =>
  h(
    "p",
    {},
    h(
      "button",
      { type: "button", class: "text-button", onclick: () => acts.showUavs(tab, id) },
      tn(count, "Show the UAV", "Show the {count} UAVs"),
    ),
  );

/** @param {How} how */
export function mountPanel(how) {
  const { canPlan, acts } = how;
  const panel = byId("fleet-panel");
  const back = () =>
    h(
      "button",
      { type: "button", class: "text-button back", onclick: acts.back },
      icon("arrow-left", "small"),
      t("All of them"),
    );

  /** Shows all of a row. Returns its title, to be focused. @param {Kind} kind @param {Row} row */
  function show(kind, row) {
    const uav = kind.tab === "uavs" ? /** @type {Uav} */ (row) : null;
    const title = h("h2", { tabindex: -1 }, row.name);
    panel.hidden = false;
    setChildren(
      panel,
      back(),
      h("div", { class: "panel-head" }, title, uav?.is_simulated && simulatedMark(), uav && stateChip(uav)),
      uav && missingList(uav),
      uav?.state === "retired" &&
        h("p", { class: "quiet-text" }, t("It is not offered for new missions and does not connect.")),
      canPlan && actsOf(row, uav, acts),
      h("dl", { class: "facts" }, kind.facts(row)),
      "uav_count" in row && row.uav_count > 0 && uavsLink(kind.tab, row.id, row.uav_count, acts),
      kind.tab === "types" && partsOfType(/** @type {FleetType} */ (row), how),
      uav && partsOfUav(uav, how),
    );
    return title;
  }

  return {
    show,
    /** @param {string} title @param {Form} form */
    edit(title, form) {
      panel.hidden = false;
      panel.replaceChildren(back(), h("div", { class: "panel-head" }, h("h2", { tabindex: -1 }, title)), form.element);
      panel.scrollTop = 0;
    },
    close() {
      panel.hidden = true;
      panel.replaceChildren();
    },
  };
}

/**
 * Notice that another user was faster: their changes, and the possible acts.
 *
 * @param {object} conflict
 * @param {string} conflict.who
 * @param {Body} conflict.seen
 * @param {Body} conflict.theirs
 * @param {Form} conflict.form
 * @param {() => unknown} conflict.onTheirs
 * @param {() => unknown} conflict.onMine
 */
export function conflictNotice({ who, seen, theirs, form, onTheirs, onMine }) {
  /** @type {Map<string, unknown>} */
  const before = new Map(Object.entries(seen));
  const changed = Object.entries(theirs).filter(
    ([name, value]) => JSON.stringify(value) !== JSON.stringify(before.get(name)),
  );
  return h(
    "div",
    { class: "notice critical", role: "alert" },
    icon("circle-alert"),
    h(
      "div",
      {},
      h(
        "p",
        {},
        h("strong", {}, t("Changed by {who} in the meantime.", { who })),
        ` ${t("Nothing of yours is stored yet.")}`,
      ),
      h(
        "dl",
        { class: "differences" },
        changed.map(([name, value]) => [
          h("dt", {}, form.label(name)),
          h("dd", {}, form.words(name, before.get(name))),
          h("dd", {}, `→ ${form.words(name, value)}`),
        ]),
      ),
      h(
        "p",
        {},
        h("button", { type: "button", class: "text-button", onclick: onTheirs }, t("Use theirs")),
        h("button", { type: "button", class: "text-button", onclick: onMine }, t("Overwrite")),
      ),
    ),
  );
}
