/** Picking targets: every change is one step of the history. */

import { get, post } from "../../api.js";
import { say, toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import * as picks from "../selection.js";

export const MOST_TARGETS = 500; // of a mission: missions/routing/rules.py

/** context: see actions.js. */
export function createPicking({ store, history, selection, change, problem, failed }) {
  const undoOf = (count) => (count ? { label: t("Undo"), act: () => history.undo() } : null);
  const addedWords = (count) =>
    count ? tn(count, "{count} target added", "{count} targets added") : t("No target added");

  /** Adds what is not picked yet; says where a mission would not take as many. Returns how many were added. */
  function addTargets(targets, { sayWhat = true } = {}) {
    const before = selection().targets.length;
    const next = picks.withTargets(selection(), targets);
    if (next.targets.length > MOST_TARGETS && next.targets.length > before) {
      const words = t("{count} would come to {now} that are picked. Take fewer, or plan several missions.", {
        count: next.targets.length - before,
        now: before,
      });
      problem(t("A mission takes {most} targets.", { most: MOST_TARGETS }), words, [], { untilChanged: true });
      return 0;
    }
    change(next);
    const added = selection().targets.length - before;
    if (sayWhat)
      say(
        added
          ? t("{added}, {all} in all.", { added: addedWords(added), all: selection().targets.length })
          : t("Already picked."),
      );
    return added;
  }

  /** Adds many at once and tells it with a way back. */
  function addMany(targets, words) {
    const added = addTargets(targets, { sayWhat: false });
    if (added || !store.state.problem) toast(words(addedWords(added)), undoOf(added));
    return added;
  }

  /** Other targets in place of those that are picked. */
  function replaceTargets(targets, words) {
    if (
      targets.length > MOST_TARGETS ||
      !change({ ...selection(), targets: picks.withTargets(picks.EMPTY, targets).targets })
    )
      return;
    store.update({ chosenTarget: null, chosenTargets: [], litTarget: null });
    toast(words, undoOf(1));
  }

  function removeTargets(keys) {
    if (!change(picks.withoutTargets(selection(), keys))) return;
    store.update({ chosenTarget: null, chosenTargets: [], litTarget: null });
    toast(tn(keys.length, "{count} target removed.", "{count} targets removed."), undoOf(1));
  }

  /** task: { kind, hold_s? } */
  function setTask(keys, task) {
    if (!change(picks.withTask(selection(), keys, task))) return;
    toast(tn(keys.length, "The task of {count} target is set.", "The task of {count} targets is set."), undoOf(1));
  }

  /** wishes: { priority } or { sensor } */
  function setWish(keys, wishes) {
    if (!change(picks.withWishes(selection(), keys, wishes))) return;
    const words =
      "priority" in wishes
        ? tn(keys.length, "The priority of {count} target is set.", "The priority of {count} targets is set.")
        : tn(keys.length, "The sensor of {count} target is set.", "The sensor of {count} targets is set.");
    toast(words, undoOf(1));
  }

  const rowsToTargets = (rows) => rows.map(picks.targetOfRow);

  /** What stands inside a ring of lon lat. */
  async function addArea(ring, { from = t("the area") } = {}) {
    try {
      const { data } = await post("/assets/within", { polygon: { type: "Polygon", coordinates: [ring] } });
      if (data.count > data.assets.length) {
        problem(
          t("{count} assets stand there.", { count: data.count }),
          t("A mission takes {most}. Take a smaller area, or pick whole lines.", { most: MOST_TARGETS }),
          [],
          { untilChanged: true },
        );
      } else if (!data.count) toast(t("No tower and no bridge stands in {area}.", { area: from }));
      else addMany(rowsToTargets(data.assets), (added) => t("{added} from {area}.", { added, area: from }));
    } catch (error) {
      failed(t("The area could not be read."), error);
    }
  }

  const addBox = ([west, south, east, north]) =>
    addArea(
      [
        [west, south],
        [east, south],
        [east, north],
        [west, north],
      ],
      { from: t("the box") },
    );

  /** What lies between two supports: { supports, parts, length_m }; null where that failed, which is said. */
  async function stretchBetween(from, to) {
    try {
      return (await get(`/assets/stretch?from=${from}&to=${to}`)).data;
    } catch (error) {
      failed(t("There is no stretch between the two."), error, [], { untilChanged: true });
      return null;
    }
  }

  const addSupports = (rows) => addMany(rowsToTargets(rows), (added) => t("{added} along the line.", { added }));

  /** Flown along: one target for each line that the way follows. */
  function addStretch(parts) {
    const targets = parts.map(({ line, stretch, length_m }) => {
      const [[west, south], [east, north]] = stretch;
      const centre = [(west + east) / 2, (south + north) / 2];
      return picks.targetOf({ id: line.id, kind: line.kind, properties: { ...line, length_m }, centre, stretch });
    });
    addMany(targets, (added) => t("{added} to fly along.", { added }));
  }

  async function addTowersOf(line) {
    try {
      const { data } = await get(`/assets/${line}/supports`);
      if (data.supports.length) addSupports(data.supports);
      else toast(t("This line has no towers in the data."));
    } catch (error) {
      failed(t("The towers could not be read."), error);
    }
  }

  /** Every bridge that carries the railway: of this section, or of all that are joined to it under the same name. */
  async function addBridgesOf(railway, { allSections = true } = {}) {
    try {
      const { data } = await get(`/assets/${railway}/bridges?sections=${allSections ? "all" : "own"}`);
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

  const targetOfFeature = (feature) =>
    picks.targetOf({
      id: feature.id,
      kind: feature.properties.kind,
      properties: feature.properties,
      centre: feature.properties.centre,
    });

  return {
    tell: (title, text) => problem(title, text, [], { untilChanged: true }),
    addTargets,
    addMany,
    replaceTargets,
    addArea,
    addBox,
    addSupports,
    addStretch,
    addTowersOf,
    addBridgesOf,
    stretchBetween,
    removeTargets,
    setTask,
    setWish,
    targetOfFeature,
    undo: () => history.undo() && say(t("Undone.")),
    redo: () => history.redo() && say(t("Done again.")),
    setOption: (name, value) => change({ ...selection(), [name]: value }),
  };
}
