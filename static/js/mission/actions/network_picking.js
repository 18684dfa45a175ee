/** Picking of assets in an area or along a line, as the server finds them. */

import { get, post } from "../../api.js";
import { toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import * as picks from "../selection.js";
import { notPickedYet } from "../targets/caught.js";

/** @import { Answer } from "../../api.js" */
/** @import { BridgesOutput, PickedAsset, StretchPart, SupportsOutput, WithinOutput } from "../../api_types.d.ts" */
/** @import { MissionContext, PickedTarget } from "../types.d.ts" */

/** @typedef {(targets: PickedTarget[], words: (added: string) => string) => number} AddMany adds many at once and announces it */

/** @param {PickedAsset[]} rows */
const rowsToTargets = (rows) => rows.map(picks.targetOfRow);

/** @param {MissionContext} context @param {AddMany} addMany */
export function createNetworkPicking(context, addMany) {
  return { ...createAreaPicking(context, addMany), ...createLinePicking(context, addMany) };
}

/** @param {MissionContext} context @param {AddMany} addMany */
function createAreaPicking({ store, problem, failed, selection }, addMany) {
  /** Find the assets inside a ring; they are added once they were looked at. @param {number[][]} ring @param {{ from?: string }} [how] */
  async function catchArea(ring, { from = t("the area") } = {}) {
    try {
      const { data } = /** @type {Answer<WithinOutput>} */ (
        await post("/assets/within", { polygon: { type: "Polygon", coordinates: [ring] } })
      );
      const { rows, covered } = notPickedYet(data.assets, selection().targets);
      if (data.count > data.assets.length) {
        problem(
          t("{count} assets stand there.", { count: data.count }),
          t("A mission takes {most}. Take a smaller area, or pick whole lines.", { most: picks.MAX_TARGETS }),
          [],
          { untilChanged: true },
        );
      } else if (!data.count) toast(t("No tower and no bridge stands in {area}.", { area: from }));
      else if (!rows.length) toast(t("Already picked."));
      else store.update({ caught: { rows, chosen: rows, covered } });
    } catch (error) {
      failed(t("The area could not be read."), error);
    }
  }

  /** @param {[number, number, number, number]} box */
  const catchBox = ([west, south, east, north]) =>
    catchArea(
      [
        [west, south],
        [east, south],
        [east, north],
        [west, north],
      ],
      { from: t("the box") },
    );

  return {
    catchArea,
    catchBox,
    /** Add what was found and is chosen; the tool ends with it. */
    addCaught() {
      const { caught } = store.state;
      store.update({ caught: null, tool: "point" });
      if (caught)
        addMany(rowsToTargets(caught.chosen), (added) => t("{added} from {area}.", { added, area: t("the area") }));
    },
    dropCaught: () => store.update({ caught: null, tool: "point" }),
  };
}

/** @param {MissionContext} context @param {AddMany} addMany */
function createLinePicking({ failed }, addMany) {
  /** The stretch between two supports; null after a failure, which is shown. @param {number} from @param {number} to */
  async function stretchBetween(from, to) {
    try {
      return /** @type {Answer<SupportsOutput>} */ (await get(`/assets/stretch?from=${from}&to=${to}`)).data;
    } catch (error) {
      failed(t("No connection between the two towers."), error, [], { untilChanged: true });
      return null;
    }
  }

  /** @param {PickedAsset[]} rows */
  const addSupports = (rows) => addMany(rowsToTargets(rows), (added) => t("{added} along the line.", { added }));

  /** Flown along: one target for each line that the path follows. @param {StretchPart[]} parts */
  function addStretch(parts) {
    const targets = parts.map(({ line, stretch, length_m }) => {
      const [[west, south], [east, north]] = stretch;
      const centre = [(west + east) / 2, (south + north) / 2];
      return picks.targetOf({ id: line.id, kind: line.kind, properties: { ...line, length_m }, centre, stretch });
    });
    addMany(targets, (added) => t("{added} to fly along.", { added }));
  }

  /** @param {number} line */
  async function addTowersOf(line) {
    try {
      const { data } = /** @type {Answer<SupportsOutput>} */ (await get(`/assets/${line}/supports`));
      if (data.supports.length) addSupports(data.supports);
      else toast(t("This line has no towers in the data."));
    } catch (error) {
      failed(t("The towers could not be read."), error);
    }
  }

  /**
   * Every bridge that carries the railway: of this section, or of all that are joined to it under the same name.
   *
   * @param {number} railway
   * @param {{ allSections?: boolean }} [how]
   */
  async function addBridgesOf(railway, { allSections = true } = {}) {
    try {
      const { data } = /** @type {Answer<BridgesOutput>} */ (
        await get(`/assets/${railway}/bridges?sections=${allSections ? "all" : "own"}`)
      );
      const sections = tn(data.sections, "{count} section", "{count} sections");
      if (data.bridges.length)
        addMany(rowsToTargets(data.bridges), (added) =>
          t("{added}: every bridge of {sections} of the railway.", { added, sections }),
        );
      else
        toast(
          tn(
            data.sections,
            "No bridge carries this section of the railway.",
            "No bridge carries one of the {count} sections of this railway.",
          ),
        );
    } catch (error) {
      failed(t("The bridges could not be read."), error);
    }
  }

  return { stretchBetween, addSupports, addStretch, addTowersOf, addBridgesOf };
}
