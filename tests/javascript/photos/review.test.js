import assert from "node:assert/strict";
import { test } from "node:test";

import { categoriesFor } from "../../../static/js/review/category_search.js";

const CATEGORIES = [
  { code: "tower-corrosion", component_name: "Tower", name: "Corrosion" },
  { code: "insulator-broken", component_name: "Insulator", name: "Disc broken or missing" },
  { code: "conductor-corrosion", component_name: "Conductor", name: "Conductor corroded" },
  { code: "tower-nest", component_name: "Tower", name: "Nest" },
];
const codes = (typed) => categoriesFor(CATEGORIES, typed).map(({ code }) => code);

test("two letters find a category by its name, its component or its initials", () => {
  assert.deepEqual(codes("ne"), ["tower-nest"]);
  assert.equal(codes("co")[0], "tower-corrosion");
  assert.equal(codes("in")[0], "insulator-broken");
  assert.deepEqual(codes("tn"), ["tower-nest"]);
  assert.equal(codes("")[0], "tower-corrosion");
  assert.deepEqual(codes("zz"), []);
});

test("case and accents do not count", () => {
  assert.deepEqual(categoriesFor([{ component_name: "Tour", name: "Dégradation" }], "DEGR").length, 1);
});
