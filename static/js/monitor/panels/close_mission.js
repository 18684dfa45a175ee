/** "Close mission" on the page of a mission whose UAVs are down. */

import { get } from "../../api.js";
import { inAir } from "../../domain/in_air.js";
import { askToClose, canBeClosed } from "../../page/close_mission.js";
import { t } from "../../text.js";

/** @import { Answer } from "../../api.js" */
/** @import { LiveUav, Mission, MissionState, TargetState } from "../../api_types.d.ts" */
/** @import { MonitorPage, MonitorStore } from "../types.d.ts" */

/** @typedef {{ state: MissionState, targets: readonly { state: TargetState }[] }} Closable */

/** @param {MonitorStore} store @param {MonitorPage} page */
export function mountCloseMission(store, page) {
  const button = document.getElementById("close-mission");
  const id = page.mission;
  if (!(button instanceof HTMLButtonElement) || id === null) return;
  button.onclick = () => askToClose({ mission: id, opener: button });
  /** @type {Closable | null} of a mission that is not live any more */
  let ended = null;
  let isAsked = false;

  store.listen(["missions", "uavs", "isWhole"], ({ missions, uavs, isWhole }) => {
    const live = missions.find((mission) => mission.id === id) ?? null;
    draw(button, live ?? ended, uavs);
    if (live || !isWhole || isAsked) return;
    isAsked = true;
    void get(`/missions/${id}`).then(
      (answer) => {
        ended = /** @type {Answer<Mission>} */ (answer).data;
        draw(button, ended, uavs);
      },
      () => {}, // the rest of the page reports that the server is unavailable
    );
  });
}

/** @param {HTMLButtonElement} button @param {Closable | null} mission @param {readonly LiveUav[]} uavs of the mission */
function draw(button, mission, uavs) {
  const flying = uavs.filter((uav) => inAir(uav) === true).map(({ name }) => name);
  const isStarted = mission !== null && mission.state !== "dispatched";
  button.hidden = !(isStarted && canBeClosed({ mission, targets: mission.targets }));
  button.disabled = flying.length > 0;
  button.title = flying.length
    ? t("In the air: {names}. The mission can be closed once all UAVs are down.", { names: flying.join(", ") })
    : "";
}
