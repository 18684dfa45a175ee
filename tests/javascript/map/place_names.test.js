/** Towns by name: without case and accents, the largest first, in the reader's language. */

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";
import { matching, nameIn } from "../../../static/js/map/place_names.js";

const known = JSON.parse(await readFile(new URL("../../../static/data/places.json", import.meta.url), "utf8"));
const names = (text, most = 5) => matching(known, text, most).map(([name]) => name);

test("a name is found without case and accents, in each language of the pages", () => {
  for (const text of ["munich", "München", "MUNCH", "Múnich"])
    assert.equal(names(text, 3).includes("Munich"), true, text);
  assert.equal(names("zurich")[0], "Zürich");
  assert.equal(names("sao paulo")[0], "São Paulo");
  assert.equal(names("Ginebra")[0], "Geneva");
});

test("the largest comes first, and a later word counts less than the first one", () => {
  assert.equal(names("paris")[0], "Paris");
  assert.equal(names("york").at(-1), "New York");
  assert.equal(names("col").length, 5);
});

test("one letter, blanks and unknown names find nothing", () => {
  for (const text of ["", " ", "a", "  b ", "zzzzqq"]) assert.deepEqual(names(text), []);
});

test("a town has its name in the reader's language, else its own", () => {
  const [munich] = matching(known, "Munich", 1);
  assert.deepEqual(
    ["en-GB", "de", "es", "fr"].map((language) => nameIn(munich, language)),
    ["Munich", "München", "Múnich", "Munich"],
  );
});

test("every place is on the map", () => {
  assert.equal(known.length > 7000, true);
  for (const [name, , x, y, country] of known) {
    assert.equal(Math.abs(x) <= 18000 && Math.abs(y) <= 9000, true, name);
    assert.match(country, /^([A-Z]{2})?$/);
  }
});
