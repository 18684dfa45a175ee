/** Rally points and ways back on the mission's map, as the store has them: quietly, and where they fail not so. */

import { rallyName } from "../../domain/palette.js";
import * as layer from "../../map/layers/lost_link.js";
import { checkStateOf, quietReturnsOf, returnLinesOf, usesRallyPoints, wholeLostLink } from "../options/lost_link.js";
import { isPlanCurrent } from "../plan/plan_view.js";

/** @import { MapLibreMap } from "../../map/types.d.ts" */
/** @import { MissionActions, MissionStore } from "../types.d.ts" */

/**
 * Returns { recolour() }.
 *
 * @param {MapLibreMap} map
 * @param {MissionStore} store
 * @param {Pick<MissionActions, "moveRallyPoint">} actions
 * @param {{ canPlan: boolean }} page
 */
export function mountLostLinkMap(map, store, actions, { canPlan }) {
  const rally = layer.createRallyPoints(map, { onMove: actions.moveRallyPoint });

  store.listen(["selection"], ({ selection: { lost_link } }) => {
    const points = usesRallyPoints(lost_link) ? wholeLostLink(lost_link).rally_points : [];
    rally.update(
      points.map((position, index) => ({ position, name: rallyName(index) })),
      canPlan,
    );
  });
  store.listen(["selection", "plan", "litReturn", "hand"], (state) => {
    const { plan, selection, litReturn, hand } = state;
    const isChecked = !hand && ["home", "lost"].includes(checkStateOf(selection.lost_link, plan, isPlanCurrent(state)));
    if (!plan || !isChecked) {
      layer.showReturns(map, []);
      return;
    }
    const failing = returnLinesOf(plan).map((line) => ({ ...line, fails: true, lit: line.key === litReturn }));
    layer.showReturns(map, [...quietReturnsOf(plan), ...failing]);
  });

  return { recolour: () => layer.recolour(map) };
}
