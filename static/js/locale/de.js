/** German, put together from one catalogue for each room of the program. */

import account from "./de/account.js";
import admin from "./de/admin.js";
import administration from "./de/administration.js";
import alertLimits from "./de/alert_limits.js";
import assets from "./de/assets.js";
import dataIssues from "./de/data_issues.js";
import draw from "./de/draw.js";
import eventLog from "./de/event_log.js";
import fleet from "./de/fleet.js";
import flight from "./de/flight.js";
import flying from "./de/flying.js";
import general from "./de/general.js";
import ground from "./de/ground.js";
import imports from "./de/imports.js";
import map from "./de/map.js";
import mission from "./de/mission.js";
import missionPanels from "./de/mission_panels.js";
import missions from "./de/missions.js";
import monitor from "./de/monitor.js";
import offline from "./de/offline.js";
import planning from "./de/planning.js";
import rehearsal from "./de/rehearsal.js";
import report from "./de/report.js";
import scene from "./de/scene.js";
import simulation from "./de/simulation.js";
import terrain from "./de/terrain.js";
import uavChanges from "./de/uav_changes.js";
import zones from "./de/zones.js";

export default {
  ...account,
  ...admin,
  ...administration,
  ...alertLimits,
  ...assets,
  ...draw,
  ...eventLog,
  ...fleet,
  ...flight,
  ...flying,
  ...dataIssues,
  ...general,
  ...ground,
  ...imports,
  ...map,
  ...mission,
  ...missionPanels,
  ...missions,
  ...monitor,
  ...offline,
  ...planning,
  ...rehearsal,
  ...report,
  ...scene,
  ...simulation,
  ...terrain,
  ...uavChanges,
  ...zones,
};
