import assert from "node:assert/strict";
import test from "node:test";

import { positionIn } from "../../../static/js/map/coordinates_read.js";

const near = (text, [longitude, latitude], order) => {
  const found = positionIn(text);
  assert.ok(found, `${text} is not understood`);
  assert.ok(
    Math.abs(found.position[0] - longitude) < 1e-6 && Math.abs(found.position[1] - latitude) < 1e-6,
    `${text}: ${found.position}`,
  );
  assert.equal(found.order, order);
};

test("decimal degrees have the latitude first", () => {
  for (const text of [
    "39.96, -82.99",
    "39.96 -82.99",
    "39.96,-82.99",
    "39.96;−82.99",
    " 39.96 / -82.99 ",
    "geo:39.96,-82.99",
    "39,96 -82,99",
    "39,96; -82,99",
  ])
    near(text, [-82.99, 39.96], "latitude first");
});

test("a first figure that can be no latitude is the longitude, and that is said", () =>
  near("-122.4, 37.8", [-122.4, 37.8], "longitude first"));

test("letters say which is which, in any order", () => {
  near("39.96 N, 82.99 W", [-82.99, 39.96], "letters");
  near("W82.99 N39.96", [-82.99, 39.96], "letters");
  near("39.96N82.99W", [-82.99, 39.96], "letters");
  near("47,5° N 8,25° O", [8.25, 47.5], "letters");
});

test("degrees, minutes and seconds, with signs of any keyboard or none", () => {
  const place = [-82.999167, 39.96];
  for (const text of [
    `39°57'36"N 82°59'57"W`,
    "39° 57′ 36″ N, 82° 59′ 57″ W",
    "39°57’36”N, 82°59’57”W",
    "N39 57 36 W82 59 57",
  ])
    near(text, place, "letters");
  near("39°57.6'N 82°59.95'W", place, "letters");
  near("39 57.6 S, 82 59.95 E", [82.999167, -39.96], "letters");
});

test("what is no pair of coordinates is a name", () => {
  for (const text of [
    "",
    "39.96",
    "138 kV",
    "AEP 138",
    "12, 13, 14",
    "95, 195",
    "91, 200",
    "39.96 N, 40 N",
    "39°61'N 82°W",
    "Tower 18 of 41",
    "39.96 N 82.99",
    "-39 N 82 W",
    "line 12",
  ])
    assert.equal(positionIn(text), null, text);
});
