"""The no-fly zones of the demo region as an ED-269 document."""

from collections.abc import Sequence
from math import cos, pi, sin
from typing import Any

from inspection.demo_region.place import REGION_NAME, Point, lon_lat

COUNTRY = "ZZZ"  # ISO 3166 leaves ZZA to ZZZ to users: no country has it
AUTHORITY = {"name": "Elme Valley Demo Authority", "service": "Synthetic data, for demonstration", "purpose": "AUTHORIZATION"}
ALWAYS = [{"permanent": "YES"}]
FAIR_TIMES = [
    {
        "startDateTime": "2026-01-01T00:00:00.00Z",
        "endDateTime": "2035-12-31T23:59:59.00Z",
        "permanent": "NO",
        "schedule": [{"day": ["SAT", "SUN"], "startTime": "08:00:00.00Z", "endTime": "21:00:00.00Z"}],
    }
]


def _circle(centre: Point, radius_m: float) -> dict[str, Any]:
    return {"type": "Circle", "center": list(lon_lat(*centre)), "radius": radius_m}


def _polygon(points: Sequence[Point]) -> dict[str, Any]:
    """Return a closed polygon; the points are counter-clockwise."""
    ring = [list(lon_lat(*point)) for point in points]
    return {"type": "Polygon", "coordinates": [[*ring, ring[0]]]}


def _airfield(centre: Point, length_m: float, width_m: float, heading_rad: float) -> list[Point]:
    """Return a strip with cut corners along a runway; heading counter-clockwise from east."""
    half_length, half_width, cut = length_m / 2, width_m / 2, width_m / 3
    corners = [
        (half_length - cut, -half_width), (half_length, -half_width + cut),
        (half_length, half_width - cut), (half_length - cut, half_width),
        (-half_length + cut, half_width), (-half_length, half_width - cut),
        (-half_length, -half_width + cut), (-half_length + cut, -half_width),
    ]  # fmt: skip
    turn, lean = cos(heading_rad), sin(heading_rad)
    return [(centre[0] + east * turn - north * lean, centre[1] + east * lean + north * turn) for east, north in corners]


def _moor(centre: Point, reach_m: Sequence[float]) -> list[Point]:
    """Return an irregular outline: one distance from the centre per direction, counter-clockwise from east."""
    steps = [2 * pi * index / len(reach_m) for index in range(len(reach_m))]
    return [(centre[0] + reach * cos(angle), centre[1] + reach * sin(angle)) for reach, angle in zip(reach_m, steps, strict=True)]


def _layer(
    shape: dict[str, Any], lower: float | None, upper: float | None, upper_reference: str = "AGL", unit: str = "M"
) -> dict[str, Any]:
    """Return one volume; an unstated limit is omitted, which differs from 0."""
    layer: dict[str, Any] = {"uomDimensions": unit, "lowerVerticalReference": "AGL", "upperVerticalReference": upper_reference}
    if lower is not None:
        layer["lowerLimit"] = lower
    if upper is not None:
        layer["upperLimit"] = upper
    return {**layer, "horizontalProjection": shape}


def _zone(
    number: int,
    name: str,
    reason: str,
    message: str,
    layer: dict[str, Any],
    applicability: list[dict[str, Any]] = ALWAYS,
    restriction: str = "PROHIBITED",
) -> dict[str, Any]:
    return {
        "identifier": f"ELME{number:03d}",
        "country": COUNTRY,
        "name": name,
        "type": "COMMON",
        "restriction": restriction,
        "reason": [reason],
        "message": message,
        "applicability": applicability,
        "zoneAuthority": [AUTHORITY],
        "geometry": [layer],
    }


def zones_document() -> dict[str, Any]:
    """Return eight zones: each covers a line or two but no base, and each can be bypassed along several lines."""
    airfield = _polygon(_airfield((3_700.0, -2_450.0), 3_900.0, 1_500.0, 0.21))
    reserve = _polygon(
        _moor((-14_900.0, 4_900.0), (1_350.0, 1_500.0, 1_050.0, 1_250.0, 1_600.0, 1_300.0, 950.0, 1_150.0, 1_700.0, 1_400.0))
    )
    training = _polygon(_moor((8_200.0, 8_200.0), (1_500.0, 1_250.0, 1_700.0, 1_450.0, 1_150.0, 1_500.0)))
    prison = _polygon([(-13_250.0, -4_150.0), (-12_450.0, -4_250.0), (-12_350.0, -3_550.0), (-13_150.0, -3_450.0)])
    plant = _polygon([(16_500.0, 1_950.0), (17_450.0, 1_900.0), (17_500.0, 2_750.0), (16_550.0, 2_800.0)])
    return {
        "title": f"{REGION_NAME}: synthetic demo zones",
        "description": "Made for the Spanwise demo region. Not real airspace; not for navigation.",
        "features": [
            _zone(1, "Varneck Airfield", "AIR_TRAFFIC", "Control zone of the airfield.", _layer(airfield, 0, 2_500, "AMSL", "FT")),
            _zone(
                2,
                "Elmsgard Heliport",
                "AIR_TRAFFIC",
                "Rescue helicopters at any hour.",
                _layer(_circle((-6_900.0, 1_750.0), 450.0), 0, 500, unit="FT"),
            ),
            _zone(3, "Tarnfold Moor Reserve", "NATURE", "Breeding birds.", _layer(reserve, 0, 150), restriction="REQ_AUTHORISATION"),
            _zone(4, "Lowmarch Prison", "SENSITIVE", "No flights over the grounds.", _layer(prison, 0, 120)),
            _zone(5, "Saltbeck Power Station", "SENSITIVE", "No flights over the plant.", _layer(plant, 0, 300, "AMSL")),
            _zone(
                6,
                "Brindlow Showground",
                "POPULATION",
                "Fair on Saturdays and Sundays.",
                _layer(_circle((-2_850.0, -6_900.0), 520.0), 0, 120),
                FAIR_TIMES,
            ),
            _zone(7, "Wickenfell Training Area", "OTHER", "Military training; upper limit not stated.", _layer(training, 0, None)),
            _zone(
                8,
                "Varneck Hospital",
                "PRIVACY",
                "Hospital grounds.",
                _layer(_circle((8_950.0, 620.0), 260.0), 0, 60),
                restriction="CONDITIONAL",
            ),
        ],
    }
