"""Heights of routes over real terrain: how far legs come below and above the planned height, and how many waypoints that takes.

    python -m benchmarks.planning.height_floor --terrain FILE.hgt … --lines FILE.osm.pbf … [--write]

Along the power lines of each OSM file, moved onto a terrain tile (SRTM, one degree), one route per line: past every tower, over tall
ones higher, with a target at every seventh. Legs are checked every metre against the
tile's own posts, with scipy's bilinear interpolation. Beside it the method of before: bends of the ground under samples every 50 m that
leave a straight line by more than the tolerance (Douglas-Peucker). With --write the table goes to docs/performance.md.
Exits with 1 where a leg is lower than planned by over 0.5 m, higher by over the tolerance, or where there are over 15 % more waypoints.
"""

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.ndimage import distance_transform_edt

from benchmarks.report import machine, table, write_section
from inspection.geodesy import LonLat, distance_m
from planning.rules import FlightRules
from planning.trajectory.heights import FloatArray, with_heights
from planning.trajectory.route_points import with_short_legs
from planning.trajectory.waypoints import RoutePoint, RoutePoints, WaypointKind
from tests.planning.trajectory.posted_ground import PostedGround
from tests.telemetry.estimation.routes import lines_of

RULES = FlightRules()
TITLE = "Heights over terrain"
SAMPLE_M = 50.0
ROUNDING_M = 0.01
WRAPPED_DEG = 0.35


class Flown(NamedTuple):
    """Of all legs of a region: their number, how many come lower than planned by over 0.5 m, extremes, waypoints, seconds."""

    legs: int
    too_low: int
    lowest_m: float
    highest_m: float
    waypoints: int
    seconds: float


def tile_of(path: Path) -> tuple[PostedGround, FloatArray]:
    """The tile and its middle, from its name (N42E001.hgt); voids have the height of the nearest post, so that none is met."""
    posts = np.fromfile(path, ">i2").astype("f4")
    side = int(np.sqrt(len(posts)))
    posts = posts.reshape(side, side)
    row, column = distance_transform_edt(posts == -32_768, return_distances=False, return_indices=True)
    posts = posts[row, column]
    south = int(path.stem[1:3]) * (1 if path.stem[0] == "N" else -1)
    west = int(path.stem[4:7]) * (1 if path.stem[3] == "E" else -1)
    return PostedGround(posts, west, south + 1, 1.0 / (side - 1), 257), np.array([west + 0.5, south + 0.5])


def routes(lines: Sequence[Sequence[LonLat]], middle: FloatArray) -> Iterator[RoutePoints]:
    for number, line in enumerate(lines):
        centre = np.mean(line, axis=0)
        places = np.array(line) - centre + middle + (centre + WRAPPED_DEG) % (2 * WRAPPED_DEG) - WRAPPED_DEG
        if (np.abs(places - middle) > 0.499).any():
            continue
        yield RoutePoints.of(
            [
                RoutePoint(LonLat(*place), kind_of(at, len(places)), 75.0 if (at + number) % 5 == 0 else 60.0)
                for at, place in enumerate(places.tolist())
            ]
        )


def kind_of(place: int, count: int) -> WaypointKind:
    if place in {0, count - 1}:
        return WaypointKind.END if place else WaypointKind.START
    return WaypointKind.TARGET if place % 7 == 3 else WaypointKind.PASS


def strays(points: RoutePoints, positions: FloatArray, amsl_m: FloatArray, tile: PostedGround) -> Iterator[FloatArray]:
    """For each leg of the points how far the flight is above the planned height, every metre."""
    place = 0
    for leg, (start, end) in enumerate(pairwise(points.position)):
        first = place
        while (positions[place] != end).any():
            place += 1
        along = end - start
        shares = np.linspace(0.0, 1.0, max(2, int(distance_m(start, end)[0])))
        flown = np.interp(shares, (positions[first : place + 1] - start) @ along / (along @ along), amsl_m[first : place + 1])
        planned = points.agl_m[leg] + shares * (points.agl_m[leg + 1] - points.agl_m[leg])
        yield flown - planned - tile.metres(start + shares[:, None] * along)


def before(points: RoutePoints, tile: PostedGround) -> tuple[FloatArray, FloatArray]:
    """Positions and heights above sea level by the method of before."""
    positions, heights = [points.position[:1]], [tile.metres(points.position[:1]) + points.agl_m[:1]]
    for leg, (start, end) in enumerate(pairwise(points.position)):
        count = max(1, int(np.ceil(distance_m(start, end)[0] / SAMPLE_M)))
        shares = np.arange(count + 1) / count
        at = start + shares[:, None] * (end - start)
        ground = tile.metres(at)
        kept, stack = {0, count}, [(0, count)]
        while stack:
            low, high = stack.pop()
            off = np.abs(ground[low : high + 1] - np.linspace(ground[low], ground[high], high - low + 1))
            if off.max() > RULES.terrain_tolerance_m:
                bend = low + int(off.argmax())
                kept.add(bend)
                stack += [(low, bend), (bend, high)]
        chosen = sorted(kept)[1:]
        positions.append(np.vstack([at[chosen[:-1]], end]))
        heights.append(ground[chosen] + points.agl_m[leg] + shares[chosen] * (points.agl_m[leg + 1] - points.agl_m[leg]))
    return np.concatenate(positions), np.concatenate(heights)


def measured(lines: Sequence[Sequence[LonLat]], tile: PostedGround, middle: FloatArray) -> tuple[Flown, Flown]:
    """By the method of before and by the planner's."""
    both = []
    for method in (0, 1):
        legs = too_low = waypoints = 0
        lowest = highest = seconds = 0.0
        for route in routes(lines, middle):
            points, _length_m = with_short_legs(route, RULES.longest_leg_m)
            begin = time.process_time()
            if method:
                flown, _is_flat = with_heights(points, tile.ground, RULES)
                positions, amsl_m = flown.points.position, flown.points.agl_m if flown.amsl_m is None else flown.amsl_m
            else:
                positions, amsl_m = before(points, tile)
            seconds += time.process_time() - begin
            waypoints += len(positions)
            for over_m in strays(points, positions, amsl_m, tile):
                legs += 1
                too_low += bool(over_m.min() < -0.5 - ROUNDING_M)
                lowest, highest = min(lowest, float(over_m.min())), max(highest, float(over_m.max()))
        both.append(Flown(legs, too_low, lowest, highest, waypoints, seconds))
    return both[0], both[1]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--terrain", nargs="+", type=Path, required=True, metavar="FILE.hgt")
    parser.add_argument("--lines", nargs="+", type=Path, required=True, metavar="FILE.osm.pbf")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    rows, is_kept = [], True
    for terrain in options.terrain:
        tile, middle = tile_of(terrain)
        for path in options.lines:
            lines = lines_of(path)
            measured(lines[:1], tile, middle)
            old, new = measured(lines, tile, middle)
            more = new.waypoints / old.waypoints
            is_kept &= new.too_low == 0 and new.highest_m <= RULES.terrain_tolerance_m + ROUNDING_M and more <= 1.15
            rows.append([
                f"{path.name.split('.')[0]} on {terrain.stem}", f"{old.legs:,}", f"{old.too_low:,}", f"{new.too_low:,}",
                f"{old.lowest_m:+.1f} to {old.highest_m:+.1f} m", f"{new.lowest_m:+.2f} to {new.highest_m:+.2f} m",
                f"{old.waypoints:,}", f"{new.waypoints:,}", f"{100 * (more - 1):+.1f} %", f"{1e6 * new.seconds / new.legs:.0f} µs",
            ])  # fmt: skip
            print(*rows[-1], sep=" | ", flush=True)
    head = ["lines on terrain", "legs", "too low before", "now", "off the plan before", "now", "waypoints before", "now", "more", "a leg"]
    text = f"`python -m benchmarks.planning.height_floor`. {machine('numba', 'numpy')}\n\n{table(head, rows)}"
    if options.write:
        write_section(TITLE, text)
    sys.exit(0 if is_kept else 1)


if __name__ == "__main__":
    main()
