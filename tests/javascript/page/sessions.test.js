import assert from "node:assert/strict";
import { test } from "node:test";
import { whereText } from "../../../static/js/account/sessions.js";

test("a session says its address and where that lies", () => {
  assert.equal(whereText({ address: "10.1.2.3", place: "private-network" }), "10.1.2.3 (private network)");
  assert.equal(whereText({ address: "8.8.8.8", place: "internet" }), "8.8.8.8 (internet)");
  assert.equal(whereText({ address: null, place: null }), "address not known");
});
