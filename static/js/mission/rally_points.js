/** Rally points put on the map and moved there; each is one step of the history. */

import { say } from "../page/toast.js";
import { t } from "../text.js";
import * as link from "./lost_link.js";

/** context: see actions.js. */
export function createRallyPoints({ store, selection, change }) {
  const set = (lost_link) => change({ ...selection(), lost_link });
  const points = () => link.wholeLostLink(selection().lost_link).rally_points;

  function addRallyPoint(position) {
    if (!set(link.withRallyPoint(selection().lost_link, position))) return;
    const count = points().length;
    say(t("Rally point {name} is placed.", { name: link.rallyName(count - 1) }));
    if (count >= link.MOST_RALLY_POINTS) store.update({ tool: "point" });
  }

  return {
    addRallyPoint,
    moveRallyPoint: (index, position) => set(link.withRallyPointAt(selection().lost_link, index, position)),
  };
}
