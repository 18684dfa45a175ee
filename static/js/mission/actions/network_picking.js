/** Picking of assets in an area or along a line, as the server finds them. */

import { get, post } from "../../api.js";
import { toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import * as picks from "../selection.js";
import { linesOf, notPickedYet } from "../targets/caught.js";
import { isWholeLine, targetOfPart, withJoinedParts, withParts } from "../targets/line_parts.js";

/** @import { Answer } from "../../api.js" */
/** @import { AssetDetailFeature, BridgesOutput, LinePartsOutput, PickedAsset, StretchPart, SupportsOutput, WithinOutput } from "../../api_types.d.ts" */
/** @import { MissionContext, PickedTarget } from "../types.d.ts" */

/** @typedef {(targets: PickedTarget[], words: (added: string) => string) => number} AddMany adds many at once and announces it */
/** @typedef {{ addMany: AddMany, addTargets: (targets: PickedTarget[]) => number }} Adds */

const SHARED_FROM_M = 2_000; // shorter lines are one target

/** @param {PickedAsset[]} rows */
const rowsToTargets = (rows) => rows.map(picks.targetOfRow);

/** @param {MissionContext} context @param {Adds} adds */
export function createNetworkPicking(context, adds) {
  return {
    ...createAreaPicking(context, adds.addMany),
    ...createLinePicking(context, adds.addMany),
    ...createSharing(context, adds),
  };
}

/** @param {MissionContext} context @param {AddMany} addMany */
function createAreaPicking({ store, problem, failed, selection }, addMany) {
  /**
   * What stands inside a ring; the lines that meet it where more stands there than the server names.
   *
   * @param {number[][]} ring
   */
  async function foundWithin(ring) {
    const polygon = { type: "Polygon", coordinates: [ring] };
    const { data } = /** @type {Answer<WithinOutput>} */ (await post("/assets/within", { polygon }));
    if (data.count === data.assets.length) return data;
    const { data: lines } = /** @type {Answer<WithinOutput>} */ (
      await post("/assets/within", { polygon, kinds: ["line"] })
    );
    return lines.count > 0 && lines.count === lines.assets.length ? lines : data;
  }

  /** Find the assets inside a ring; they are added once they were looked at. @param {number[][]} ring @param {{ from?: string }} [how] */
  async function catchArea(ring, { from = t("the area") } = {}) {
    try {
      const data = await foundWithin(ring);
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
      else store.update({ caught: { rows, chosen: rows, covered, ring } });
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
    /** Instead of the towers, add the parts inside the area of the lines that they carry. */
    async addCaughtLines() {
      const { caught } = store.state;
      if (!caught) return;
      const polygon = { type: "Polygon", coordinates: [caught.ring] };
      const most = picks.MAX_TARGETS - selection().targets.length;
      try {
        const { data } = /** @type {Answer<LinePartsOutput>} */ (
          await post("/assets/parts", { assets: linesOf(caught.chosen), most, polygon })
        );
        if (store.state.caught?.rows !== caught.rows) return;
        if (addMany(data.parts.map(targetOfPart), (added) => t("{added} to fly along.", { added })))
          store.update({ caught: null, tool: "point" });
      } catch (error) {
        failed(t("The line could not be read."), error);
      }
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

  return { stretchBetween, addSupports, addTowersOf, addBridgesOf };
}

/**
 * Lines and railways in parts, which UAVs share; or whole, for one UAV.
 *
 * @param {MissionContext} context
 * @param {Adds} adds
 */
function createSharing({ failed, selection, change, history }, { addMany, addTargets }) {
  const undo = () => ({ label: t("Undo"), act: () => history.undo() });

  /** @param {number} line @param {number[][]} [ends] */
  async function partsOf(line, ends) {
    const asked = ends ? `?ends=${ends.flat().join(",")}` : "";
    const { data } = /** @type {Answer<LinePartsOutput>} */ (await get(`/assets/${line}/parts${asked}`));
    return data.parts;
  }

  /** @param {PickedTarget} target a line or railway from end to end; any other is added as it is */
  async function addWhole(target) {
    const { asset } = target;
    const isPicked = selection().targets.some(({ key }) => key === target.key);
    if (asset === null || isPicked || !isWholeLine(target)) {
      addTargets([target]);
      return;
    }
    /** @type {PickedTarget[] | null} */
    let parts = null;
    try {
      parts = sharedParts(await partsOf(asset));
    } catch {
      toast(t("{name} is picked whole: its parts could not be read.", { name: target.label }));
    }
    if (addTargets(parts ?? [target]) && parts)
      toast(sharedWords(target.label, parts.length), {
        label: t("One UAV flies it whole"),
        act: () => void flyWhole(asset),
      });
  }

  /** What a search has found: its lines in parts, as far as a mission takes them. @param {PickedTarget[]} targets */
  async function addFound(targets) {
    const lines = targets.filter((target) => target.asset !== null && isWholeLine(target));
    const others = targets.filter((target) => !lines.includes(target));
    const most = picks.MAX_TARGETS - selection().targets.length - others.length;
    const words = (/** @type {string} */ added) => t("{added} from the search.", { added });
    if (!lines.length || most < lines.length) {
      addMany(targets, words);
      return;
    }
    try {
      const assets = lines.map(({ asset }) => asset);
      const { data } = /** @type {Answer<LinePartsOutput>} */ (await post("/assets/parts", { assets, most }));
      const shared = lines.flatMap(
        (target) => sharedParts(data.parts.filter(({ line }) => line.id === target.asset)) ?? [target],
      );
      addMany([...others, ...shared], words);
    } catch {
      addMany(targets, words); // whole
    }
  }

  /** Flown along: the lines that the path follows, the long ones in parts. @param {StretchPart[]} followed */
  async function addStretch(followed) {
    try {
      const divided = await Promise.all(
        followed.map(async (part) =>
          part.length_m < SHARED_FROM_M
            ? [targetOfPart(part)]
            : (await partsOf(part.line.id, part.stretch)).map(targetOfPart),
        ),
      );
      addMany(divided.flat(), (added) => t("{added} to fly along.", { added }));
    } catch (error) {
      failed(t("The line could not be read."), error);
    }
  }

  /** Divide a line that is picked whole. @param {PickedTarget} target */
  async function share({ asset, key, label }) {
    if (asset === null) return;
    try {
      const parts = sharedParts(await partsOf(asset));
      const count = selection().targets.length - 1 + (parts?.length ?? 0);
      if (!parts) toast(t("{name} is too short to share.", { name: label }));
      else if (count > picks.MAX_TARGETS) toast(t("A mission takes {most} targets.", { most: picks.MAX_TARGETS }));
      else if (change(withParts(selection(), key, parts))) toast(sharedWords(label, parts.length), undo());
    } catch (error) {
      failed(t("The line could not be read."), error);
    }
  }

  /** One target in place of the parts of a line that follow one another. @param {number} line */
  async function flyWhole(line) {
    try {
      const { data } = /** @type {Answer<AssetDetailFeature>} */ (await get(`/assets/${line}`));
      const { kind, centre } = data.properties;
      const whole = picks.targetOf({ id: line, kind, properties: data.properties, centre });
      if (change(withJoinedParts(selection(), whole)))
        toast(t("One UAV flies {name} from end to end.", { name: whole.label }), undo());
    } catch (error) {
      failed(t("The line could not be read."), error);
    }
  }

  return { addWhole, addFound, addStretch, share, flyWhole };
}

/** The targets of a line's parts; null where it is too short to share. @param {StretchPart[]} parts */
function sharedParts(parts) {
  const length_m = parts.reduce((sum, part) => sum + part.length_m, 0);
  return parts.length < 2 || length_m < SHARED_FROM_M ? null : parts.map(targetOfPart);
}

/** @param {string} name @param {number} count */
const sharedWords = (name, count) =>
  tn(count, "{name} is one part.", "{name} is divided into {count} parts that UAVs share.", { name });
