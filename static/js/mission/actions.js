/** What an operator does with a mission: pick, plan, stop, save, open. Each changes the store; the panels listen. */

import { ApiError, follow, get, patch, post, remove } from "../api.js";
import { say, toast } from "../page/toast.js";
import { clockText, countText } from "../units.js";
import { dropDraft, keepDraft, readDraft } from "./draft.js";
import { sentenceOf, unreachedOf } from "./plan_view.js";
import * as picks from "./selection.js";

const MOST_IN_A_BOX = 300;
const RETRY_S = 8;

const wordsOf = (error) => (error instanceof ApiError ? error.message : "Something failed on this page. Reload it; your selection is kept in this browser.");

/** The plan of a result, with the selection that it was made for: its indices point into that. */
function planOf(result, selection) {
  return { result, basis: picks.basisOf(selection), targets: selection.targets, uavs: selection.uavs };
}

export function createActions(store, history, missionId) {
  let stopping = null;
  let retry = 0;

  const selection = () => store.state.selection;
  const change = (next) => history.changeTo(next);

  function problem(title, text, actions = []) {
    store.update({ problem: { title, text, actions } });
  }

  // picking

  function addTargets(targets, { sayWhat = true } = {}) {
    const before = selection().targets.length;
    change(picks.withTargets(selection(), targets));
    const added = selection().targets.length - before;
    if (sayWhat) say(added ? `${countText(added, "target")} added, ${selection().targets.length} in all.` : "Already picked.");
    return added;
  }

  function removeTargets(keys) {
    if (!change(picks.withoutTargets(selection(), keys))) return;
    store.update({ chosenTarget: null, litTarget: null });
    toast(`${countText(keys.length, "target")} removed.`, { label: "Undo", act: () => history.undo() });
  }

  async function addBox(box) {
    try {
      const found = [];
      let next = `/assets?bbox=${box.map((degrees) => degrees.toFixed(6)).join(",")}&kind=tower,bridge&limit=100`;
      while (next && found.length <= MOST_IN_A_BOX) {
        const { data } = await get(next);
        found.push(...data.features);
        next = data.next;
      }
      if (found.length > MOST_IN_A_BOX) {
        problem(`More than ${MOST_IN_A_BOX} assets stand in the box.`, "Take a smaller one, or pick whole lines.");
        return;
      }
      const added = addTargets(found.filter((feature) => feature.properties.is_flyable !== false).map(targetOfFeature));
      toast(
        found.length ? `${countText(added, "target")} added from the box.` : "No tower and no bridge stands in the box.",
        added ? { label: "Undo", act: () => history.undo() } : null,
      );
    } catch (error) {
      problem("The box could not be read.", wordsOf(error));
    }
  }

  const targetOfFeature = (feature) => picks.targetOf({ id: feature.id, kind: feature.properties.kind, properties: feature.properties, centre: feature.properties.centre });

  // planning

  async function waitForJob(jobId, what) {
    const job = await follow(jobId, {
      signal: stopping?.signal,
      onProgress: (at) => store.update({ planning: { what: at.message || what, share: at.progress, job: jobId } }),
    });
    if (job.state === "cancelled" && !job.result) throw new DOMException("stopped", "AbortError");
    return job;
  }

  function missing() {
    if (!selection().targets.length) return ["Nothing picked yet.", "Click a tower, bridge or track on the map, then plan."];
    if (!selection().uavs.length) return ["No UAV is chosen.", "Tick one in the list, or add the first one."];
    return null;
  }

  async function plan() {
    if (store.state.planning || store.state.saving) return;
    const lacking = missing();
    if (lacking) {
      problem(...lacking);
      return;
    }
    const asked = selection();
    const what = `Planning ${countText(asked.targets.length, "target")}`;
    stopping = new AbortController();
    store.update({ planning: { what, share: null, job: null }, problem: null });
    try {
      const answer = await post("/plans", picks.requestOf(asked), { signal: stopping.signal });
      const result = answer.status === 202 ? (await waitForJob(answer.data.job, what)).result : answer.data;
      const made = planOf(result, asked);
      store.update({ plan: made, figures: { ...store.state.figures, [made.basis]: result }, planIsStored: false, chosenRoute: null });
      const { sentence, facts } = sentenceOf(made);
      const unreached = unreachedOf(made).length;
      say(`${sentence}. ${facts}.${unreached ? ` ${countText(unreached, "target is", "targets are")} not reached.` : ""}`);
    } catch (error) {
      if (error.name === "AbortError") toast("Planning stopped. Nothing was changed.");
      else problem("Not planned.", wordsOf(error), [{ label: "Plan again", act: plan }]);
    } finally {
      stopping = null;
      store.update({ planning: null });
    }
  }

  async function stop() {
    const job = store.state.planning?.job;
    try {
      if (job) await post(`/jobs/${job}/cancel`, {});
    } catch (error) {
      if (error.status !== 409) problem("Not stopped.", wordsOf(error)); // 409: it ended by itself
    }
    if (!job) stopping?.abort();
  }

  // saving and opening

  function openStored(mission) {
    const stored = picks.selectionOf(mission, store.state.fleet);
    const plan = mission.plan ? planOf(mission.plan, stored) : null;
    history.startFrom(stored);
    store.update({
      mission,
      name: mission.name,
      plan,
      planIsStored: Boolean(plan),
      savedBasis: picks.basisOf(stored),
      figures: plan ? { ...store.state.figures, [plan.basis]: plan.result } : store.state.figures,
      problem: null,
    });
  }

  function addressNow(mission) {
    globalThis.history.replaceState(null, "", `/missions/${mission.id}`);
  }

  async function save({ asCopy = false } = {}) {
    if (store.state.saving || store.state.planning) return;
    clearTimeout(retry);
    const { mission, plan, name } = store.state;
    const isNew = !mission || asCopy;
    const basis = picks.basisOf(selection());
    const withPlan = plan !== null && plan.basis === basis;
    const body = { ...picks.requestOf(selection()), name: name.trim() || `Mission of ${new Date().toLocaleDateString("en-GB", { day: "numeric", month: "short" })}, ${clockText(new Date())}` };
    if (asCopy) body.name = `${body.name} (copy)`;
    if (withPlan && (isNew || !store.state.planIsStored || basis !== store.state.savedBasis)) body.plan = true;
    store.update({ saving: true, problem: null });
    let draftId = null; // stored already, its plan not yet
    try {
      const headers = isNew ? { "Idempotency-Key": crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}` } : { "If-Match": `"${mission.revision}"` };
      const answer = isNew ? await post("/missions", body, { headers }) : await patch(`/missions/${mission.id}`, body, { headers });
      let stored = answer.data;
      if (answer.status === 202) {
        draftId = answer.data.mission;
        dropDraft(isNew ? missionId() : mission.id);
        if (isNew) addressNow({ id: draftId });
        stopping = new AbortController();
        await waitForJob(answer.data.job, "Planning what is saved");
        stored = (await get(`/missions/${draftId}`)).data;
      }
      dropDraft(isNew ? missionId() : mission.id);
      openStored(stored);
      if (isNew) addressNow(stored);
      toast(`“${stored.name}” is saved.`);
    } catch (error) {
      if (draftId) await get(`/missions/${draftId}`).then(({ data }) => openStored(data), () => {});
      saveFailed(error);
    } finally {
      stopping = null;
      store.update({ saving: false, planning: null });
    }
  }

  function saveFailed(error) {
    if (error.name === "AbortError") {
      problem("Saved as a draft.", "Planning was stopped before it was done.");
    } else if (error.status === 412) {
      problem("Changed by another operator.", "Your selection is kept in this browser.", [
        { label: "See theirs", act: () => (dropDraft(store.state.mission.id), location.reload()) },
        { label: "Keep mine as a copy", act: () => save({ asCopy: true }) },
      ]);
    } else if (error.isAway) {
      problem("Not saved: the server cannot be reached.", `Your selection is kept in this browser. Next try in ${RETRY_S} s.`, [{ label: "Try now", act: () => save() }]);
      retry = setTimeout(save, RETRY_S * 1000);
    } else {
      problem("Not saved.", wordsOf(error), [{ label: "Try again", act: () => save() }]);
    }
  }

  async function open(id) {
    const { data } = await get(`/missions/${id}`);
    openStored(data);
    const draft = readDraft(id);
    if (draft && draft.revision === data.revision && picks.basisOf(draft.selection) !== store.state.savedBasis) {
      change(draft.selection);
      store.update({ name: draft.name || data.name });
      toast("Your unsaved changes are back.", { label: "Drop them", act: () => (dropDraft(id), openStored(data)) });
    }
  }

  function openDraft() {
    const draft = readDraft(null);
    if (!draft || (!draft.selection.targets.length && !draft.name)) return;
    history.startFrom(draft.selection);
    store.update({ name: draft.name });
    toast("Your unsaved mission is back.", { label: "Start empty", act: startEmpty });
  }

  function startEmpty() {
    dropDraft(missionId());
    history.startFrom({ ...picks.EMPTY });
    store.update({ name: "", plan: null, problem: null });
  }

  function keep() {
    const { mission, name } = store.state;
    return keepDraft(mission?.id ?? null, { name, selection: selection(), revision: mission?.revision ?? 0 });
  }

  async function deleteMission() {
    try {
      await remove(`/missions/${store.state.mission.id}`);
      dropDraft(store.state.mission.id);
      location.href = `/?deleted=${store.state.mission.id}&name=${encodeURIComponent(store.state.mission.name)}`;
    } catch (error) {
      problem("Not deleted.", wordsOf(error));
    }
  }

  // UAVs

  async function addUav(body) {
    const { data } = await post("/uavs", body);
    const uav = picks.uavOf(data);
    store.update({ fleet: [...store.state.fleet, uav] });
    change(picks.withUav(selection(), uav));
    say(`${uav.name} is added and chosen.`);
  }

  function toggleUav(id, isChosen) {
    const uav = store.state.fleet.find((known) => known.id === id);
    change(isChosen && uav ? picks.withUav(selection(), uav) : picks.withoutUav(selection(), id));
  }

  return {
    plan, stop, save, open, openDraft, startEmpty, keep, deleteMission, problem,
    addTargets, addBox, removeTargets, targetOfFeature, addUav, toggleUav,
    undo: () => history.undo() && say("Undone."),
    redo: () => history.redo() && say("Done again."),
    moveUav: (sequence, position) => change(picks.withUavAt(selection(), sequence, position)),
    setOption: (name, value) => change({ ...selection(), [name]: value }),
    rename: (name) => store.update({ name }),
  };
}
