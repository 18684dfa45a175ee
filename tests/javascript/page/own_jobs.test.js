import assert from "node:assert/strict";
import test from "node:test";

/** An element that holds what it is given. */
function element(tag) {
  const made = { tag, children: [], dataset: {}, attributes: {} };
  made.append = (...children) => made.children.push(...children);
  made.setAttribute = (name, value) => Object.assign(made.attributes, { [name]: value });
  made.addEventListener = (name, received) => Object.assign(made, { [name]: received });
  return made;
}
globalThis.document = {
  cookie: "",
  createElement: element,
  querySelector: () => null,
  documentElement: { lang: "en", dataset: {} },
};
const { jobRow } = await import("../../../static/js/account/jobs.js");

const buttonsOf = (row) => row.children.filter(({ tag }) => tag === "button");
const job = (state) => ({ id: "j", task: "x", state, progress: 0, message: "", error: null, created_at: "2026-01-01" });

test("an open job has a button that stops it, for whoever may", () => {
  let stopped = 0;
  for (const state of ["queued", "running"]) {
    const [button] = buttonsOf(jobRow(job(state), () => stopped++));
    button.click();
    assert.deepEqual(buttonsOf(jobRow(job(state), null)), []);
  }
  assert.equal(stopped, 2);
  assert.deepEqual(buttonsOf(jobRow(job("done"), () => {})), []);
});
