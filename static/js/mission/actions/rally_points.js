/** Rally points put on the map and moved there; each is one step of the history. */

import { rallyName } from "../../domain/palette.js";
import { announce } from "../../page/toast.js";
import { t } from "../../text.js";
import * as link from "../options/lost_link.js";

/** @import { LostLink, MissionContext } from "../types.d.ts" */

/** context: see actions.js. @param {MissionContext} context */
export function createRallyPoints({ store, selection, change }) {
  /** @param {LostLink | null} lost_link */
  const set = (lost_link) => change({ ...selection(), lost_link });
  const points = () => link.wholeLostLink(selection().lost_link).rally_points;

  /** @param {number[]} position */
  function addRallyPoint(position) {
    if (!set(link.withRallyPoint(selection().lost_link, position))) return;
    const count = points().length;
    announce(t("Rally point {name} is placed.", { name: rallyName(count - 1) }));
    if (count >= link.MAX_RALLY_POINTS) store.update({ tool: "point" });
  }

  return {
    addRallyPoint,
    /** @param {number} index @param {number[]} position */
    moveRallyPoint: (index, position) => set(link.withRallyPointAt(selection().lost_link, index, position)),
  };
}
