import assert from "node:assert/strict";
import test from "node:test";

import { targetOf, EMPTY, withTargets } from "../../static/js/mission/selection.js";
import { createHistory, createStore } from "../../static/js/store.js";

globalThis.document ??= { cookie: "", querySelector: () => null, documentElement: { lang: "en", dataset: {} } };
const { createSaving } = await import("../../static/js/mission/saving.js");

const tower = targetOf({ id: 7, kind: "tower", properties: { label: "18" }, centre: [10, 50] });

test("a save that the server took, but whose answer was lost, is known as one's own when the next one is refused", async (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const refusal = new Response(JSON.stringify({ error: { code: "mission_changed", message: "" } }), { status: 412 });
  const answers = [() => Promise.reject(new TypeError("no network")), () => Promise.resolve(refusal)];
  context.mock.method(globalThis, "fetch", () => answers.shift()());

  const store = createStore({ selection: EMPTY, name: "North", mission: { id: "m", name: "North", revision: 4 }, stored: { name: "North", selection: EMPTY }, plan: null, planIsStored: false, savedBasis: "", fleet: [], saving: false, planning: null, conflict: null, isAway: false, problem: null });
  const history = createHistory(store, "selection");
  const met = [];
  const saving = createSaving(
    { store, history, selection: () => store.state.selection, change: (value) => history.changeTo(value), problem() {}, failed() {}, running: {}, page: { canPlan: true }, drafts: { dropOwn() {}, keep: () => true } },
    () => {},
    { meet: async (lost) => void met.push(lost) },
  );

  const sent = withTargets(EMPTY, [tower]);
  history.changeTo(sent);
  await saving.save();
  assert.deepEqual([store.state.isAway, met], [true, []]);
  await saving.save();
  assert.deepEqual(met, [{ selection: sent, name: "North" }]);
});
