"""The regions that the browser tests run on, and the places in them that the tests name.

The tests run on the project's own generated regions: Elme Valley, and Quillmoor, 60 km west of it, for what a region has that is mapped
as real ones are. With SPANWISE_TEST_REGION=columbus they run on a real extract of OpenStreetMap instead, which stands beside the
checkout and not in it.
"""

import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from math import cos, pi, radians, sin
from pathlib import Path
from typing import Any

from inspection.demo_region import make_quillmoor, make_region, write_osm_file

Position = list[float]  # longitude, latitude [deg], as in GeoJSON
HELIPORT, RESERVE = "Meadow heliport", "Creek reserve"  # the two zones of each region
HELIPORT_RADIUS_M = 840.0
METRES_PER_DEG = 111_195.0  # of latitude


@dataclass(frozen=True)
class Region:
    """A region, with boxes as the API reads them: west, south, east, north [deg]."""

    name: str
    real_file: str | None  # of the shared real data; None: the generated region
    centre: Position  # of the infrastructure; nothing of it is nearer than 10 m
    everything: str  # box around the region
    towers: str  # box with a row of towers that stand alone, outside the zones
    all_towers: str  # box with towers around both start positions; plans of a few of them are proven
    spread_towers: str  # box with towers whose routes go a long way
    bridges: str  # box with bridges that stand alone
    railways: str  # box with railways
    lines: str  # box with a flyable power line
    short_row: str  # box a few kilometres wide with towers around `row_starts`
    row_starts: tuple[Position, Position]  # at its west and east end
    row_west: str  # box with towers near the first of them
    report_towers: str  # box of the towers of the flown mission
    west: Position  # where one UAV starts
    east: Position  # where the other starts, 8 to 10 km away
    beside_tower: Position  # within 1 km of a tower
    empty: Position  # no infrastructure within 3 km
    clear: Position  # outside the zones, away from the routes from `west` and `east`
    far_away: Position  # more than 10 km outside
    reserve: tuple[Position, ...]  # outline of the zone
    in_reserve: Position
    heliport: Position  # centre of the zone; it covers bridges
    in_heliport: Position  # nothing else is there
    heliport_bridges: str  # box with bridges inside the zone
    voltage_kv: int  # of several lines
    missing_towers: tuple[int, int, int]  # lines with untagged vertices; how many has the first of them, of how many vertices
    tower_label: str  # pattern of the labels of the towers in `towers`
    picture_line: str  # pattern of the labels of one line's towers, at least 12, with their numbers
    picture_towers: str  # box with them
    sortie_battery_wh: float  # too little for four of `spread_towers` in one flight from `east`, enough for several flights
    afternoon_utc: str
    night_utc: str  # an hour after sunset

    def at(self, east_deg: float, north_deg: float) -> Position:
        """Return a position relative to the centre."""
        return [round(self.centre[0] + east_deg, 6), round(self.centre[1] + north_deg, 6)]

    def zones(self) -> dict[str, Any]:
        """Return the two zones as a GeoJSON FeatureCollection."""
        outlines = {RESERVE: [*self.reserve, self.reserve[0]], HELIPORT: _circle(self.heliport, HELIPORT_RADIUS_M)}
        features = [
            {"type": "Feature", "properties": {"name": name}, "geometry": {"type": "Polygon", "coordinates": [outline]}}
            for name, outline in outlines.items()
        ]
        return {"type": "FeatureCollection", "features": features}

    def write_files(self, folder: Path, shared_data: Callable[[str], Path]) -> tuple[list[Path], Path]:
        """Return the files of infrastructure and the file of zones; the test is skipped where a real file is absent."""
        zones_path = folder / "zones.geojson"
        zones_path.write_text(json.dumps(self.zones()))
        if self.real_file:
            return [shared_data(self.real_file)], zones_path
        drawings = {folder / "demo.osm.pbf": make_region().osm, folder / "quillmoor.osm.pbf": make_quillmoor()}
        for path, drawing in drawings.items():
            write_osm_file(path, drawing)
        return list(drawings), zones_path


def _circle(centre: Position, radius_m: float, corners: int = 16) -> list[Position]:
    lon_per_m, lat_per_m = 1 / (METRES_PER_DEG * cos(radians(centre[1]))), 1 / METRES_PER_DEG
    angles = [2 * pi * number / corners for number in range(corners)]
    ring = [[centre[0] + radius_m * cos(angle) * lon_per_m, centre[1] + radius_m * sin(angle) * lat_per_m] for angle in angles]
    return [*ring, ring[0]]


ELME_VALLEY = Region(
    name="elme-valley",
    real_file=None,
    centre=[26.6, 25.7],
    everything="26.39,25.57,26.81,25.83",
    towers="26.59,25.62,26.665,25.70",
    all_towers="26.53,25.62,26.70,25.70",
    spread_towers="26.49,25.62,26.72,25.76",
    bridges="26.63,25.705,26.73,25.725",
    railways="26.43,25.67,26.51,25.70",
    lines="26.40,25.63,26.50,25.72",
    short_row="26.60,25.66,26.65,25.69",
    row_starts=([26.605, 25.665], [26.645, 25.678]),
    row_west="26.60,25.66,26.62,25.68",
    report_towers="26.58,25.63,26.65,25.69",
    west=[26.555, 25.685],
    east=[26.655, 25.695],
    beside_tower=[26.6245, 25.6725],
    empty=[26.525, 25.595],
    clear=[26.63, 25.615],
    far_away=[27.1, 25.35],
    reserve=([26.635, 25.660], [26.655, 25.655], [26.662, 25.668], [26.645, 25.674]),
    in_reserve=[26.65, 25.664],
    heliport=[26.5978, 25.6935],
    in_heliport=[26.5960, 25.6960],
    heliport_bridges="26.593,25.690,26.602,25.697",
    voltage_kv=132,
    missing_towers=(75, 24, 77),
    tower_label=r"[EHV]\d{3}-\d+",
    picture_line=r"H133-(\d+)",
    picture_towers="26.58,25.65,26.67,25.72",
    sortie_battery_wh=200.0,
    afternoon_utc="13:00",
    night_utc="16:10",
)
COLUMBUS = Region(
    name="columbus",
    real_file="osm/columbus-ohio.osm.pbf",
    centre=[-83.0, 39.95],
    everything="-83.15,39.8,-82.85,40.1",
    towers="-82.98,39.87,-82.93,39.94",
    all_towers="-83.12,39.83,-82.86,40.0",
    spread_towers="-83.12,39.83,-82.86,40.0",
    bridges="-82.97,39.96,-82.92,39.99",
    railways="-83.08,39.95,-83.03,39.99",
    lines="-83.1,39.85,-83.0,39.94",
    short_row="-83.0,39.90,-82.94,39.92",
    row_starts=([-82.995, 39.905], [-82.945, 39.905]),
    row_west="-83.0,39.90,-82.98,39.91",
    report_towers="-83.02,39.87,-82.93,39.94",
    west=[-83.045, 39.935],
    east=[-82.945, 39.945],
    beside_tower=[-82.9655, 39.9125],
    empty=[-83.06, 39.9],
    clear=[-82.99, 39.86],
    far_away=[-82.5, 39.6],
    reserve=([-82.925, 39.9], [-82.9, 39.895], [-82.89, 39.915], [-82.91, 39.925]),
    in_reserve=[-82.91, 39.91],
    heliport=[-83.02, 39.947],
    in_heliport=[-83.02, 39.9495],
    heliport_bridges="-83.025,39.943,-83.015,39.951",
    voltage_kv=138,
    missing_towers=(14, 86, 88),
    tower_label=r"Tower \d+ of \d+",
    picture_line=r"Tower (\d+) of 40",
    picture_towers="-83.0,39.90,-82.94,39.925",
    sortie_battery_wh=235.0,
    afternoon_utc="19:30",
    night_utc="23:10",
)
region = {known.name: known for known in (ELME_VALLEY, COLUMBUS)}[os.environ.get("SPANWISE_TEST_REGION") or ELME_VALLEY.name]
