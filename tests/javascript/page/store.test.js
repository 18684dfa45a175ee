import assert from "node:assert/strict";
import test from "node:test";

import { createHistory, createStore } from "../../../static/js/store.js";

function selectionStore() {
  const store = createStore({ selection: { targets: [] }, canUndo: false, canRedo: false, other: 0 });
  return { store, history: createHistory(store, "selection") };
}

test("a listener hears only the names it asked for", () => {
  const { store } = selectionStore();
  const received = [];
  store.listen(["other"], ({ other }) => received.push(other));
  store.update({ selection: { targets: [1] } });
  store.update({ other: 2 });
  assert.deepEqual(received, [0, 2]);
});

test("a listener that has been ended hears nothing more", () => {
  const { store } = selectionStore();
  const received = [];
  const end = store.listen(["other"], ({ other }) => received.push(other));
  end();
  store.update({ other: 3 });
  assert.deepEqual(received, [0]);
});

test("undo and redo walk through the selections", () => {
  const { store, history } = selectionStore();
  history.changeTo({ targets: ["A"] });
  history.changeTo({ targets: ["A", "B"] });
  history.undo();
  assert.deepEqual(store.state.selection.targets, ["A"]);
  history.undo();
  assert.deepEqual(store.state.selection.targets, []);
  assert.equal(store.state.canUndo, false);
  history.redo();
  history.redo();
  assert.deepEqual(store.state.selection.targets, ["A", "B"]);
  assert.equal(store.state.canRedo, false);
});

test("a new step forgets what was undone", () => {
  const { store, history } = selectionStore();
  history.changeTo({ targets: ["A"] });
  history.undo();
  history.changeTo({ targets: ["B"] });
  assert.equal(history.redo(), false);
  assert.deepEqual(store.state.selection.targets, ["B"]);
});

test("an equal selection is no step", () => {
  const { store, history } = selectionStore();
  assert.equal(history.changeTo({ targets: [] }), false);
  assert.equal(store.state.canUndo, false);
});

test("what was loaded cannot be undone", () => {
  const { store, history } = selectionStore();
  history.changeTo({ targets: ["A"] });
  history.startFrom({ targets: ["stored"] });
  assert.equal(history.undo(), false);
  assert.equal(store.state.canUndo, false);
});

test("what was saved keeps the steps before it", () => {
  const { store, history } = selectionStore();
  history.changeTo({ targets: ["A"] });
  history.changeTo({ targets: ["A", "B"] });
  history.settle({ targets: ["A", "B"], stored: true });
  assert.deepEqual(store.state.selection, { targets: ["A", "B"], stored: true });
  history.undo();
  assert.deepEqual(store.state.selection.targets, ["A"]);
  history.redo();
  assert.equal(store.state.selection.stored, true);
});
