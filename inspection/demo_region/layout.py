"""The fixed layout of the demo region: towns, substations, corridors, roads, rails and waters, in kilometres from its centre."""

from dataclasses import dataclass

from inspection.demo_region.place import Point

GRID_OPERATOR = "Elme Grid"
VALLEY_OPERATOR = "Valley Electric"
RAILWAY_OPERATOR = "Elme Valley Railway"


def km(*points: tuple[float, float]) -> tuple[Point, ...]:
    return tuple((east * 1_000.0, north * 1_000.0) for east, north in points)


@dataclass(frozen=True)
class Town:
    name: str
    at: Point
    size: float  # weight by which it attracts farms


def _town(name: str, east_km: float, north_km: float, size: float) -> Town:
    return Town(name, (east_km * 1_000.0, north_km * 1_000.0), size)


TOWNS = (
    _town("Elmsgard", -6.0, 0.8, 2.0),
    _town("Varneck", 8.0, 0.5, 1.6),
    _town("Lowmarch", -15.0, -2.5, 1.0),
    _town("Tarnfold", -11.0, 7.0, 0.7),
    _town("Ostermoor", 1.5, 6.3, 0.8),
    _town("Wickenfell", 13.0, 7.3, 0.7),
    _town("Brindlow", -2.0, -6.0, 1.0),
    _town("Kelderstead", 9.3, -6.0, 0.9),
    _town("Saltbeck", 17.0, -2.2, 0.8),
    _town("Hollinmark", -10.0, -8.2, 0.6),
)


@dataclass(frozen=True)
class Substation:
    name: str
    at: Point
    voltages_v: tuple[int, ...]


def _substation(name: str, east_km: float, north_km: float, *voltages_v: int) -> Substation:
    return Substation(name, (east_km * 1_000.0, north_km * 1_000.0), voltages_v)


SUBSTATIONS = {
    "ELW": _substation("Elmsgard West", -9.5, 3.0, 400_000, 132_000, 66_000),
    "VAE": _substation("Varneck East", 11.5, 2.6, 400_000, 132_000, 66_000),
    "ELM": _substation("Elmsgard Town", -4.9, 1.9, 132_000, 20_000),
    "VAR": _substation("Varneck Town", 7.1, 1.5, 132_000, 20_000),
    "BRI": _substation("Brindlow", -1.2, -4.6, 132_000, 66_000, 20_000),
    "OST": _substation("Ostermoor", 2.2, 4.9, 132_000, 66_000, 20_000),
    "KEL": _substation("Kelderstead", 8.4, -5.0, 66_000, 20_000),
    "LOW": _substation("Lowmarch", -14.1, -1.9, 66_000, 20_000),
    "TAR": _substation("Tarnfold", -11.2, 6.1, 66_000, 20_000),
    "WIC": _substation("Wickenfell", 13.0, 6.5, 66_000, 20_000),
    "SAL": _substation("Saltbeck", 16.2, -1.5, 66_000, 20_000),
    "HOL": _substation("Hollinmark", -9.5, -7.5, 66_000, 20_000),
    "PLA": _substation("Saltbeck Power Station", 16.9, 2.3, 132_000),
}


@dataclass(frozen=True)
class Corridor:
    """A line between two substations; an end that is no substation is the first or last corner, at the region's edge."""

    ref: str
    start: str | None
    end: str | None
    corners: tuple[Point, ...]
    voltages_v: tuple[int, ...]
    circuits: int
    operator: str = GRID_OPERATOR


CORRIDORS = (
    Corridor("E401", None, "ELW", km((-20, 5.4), (-16.6, 4.5), (-12.6, 4.4)), (400_000,), 2),
    Corridor("E402", "ELW", "VAE", km((-8.3, 4.2), (-4.4, 4.0), (0.2, 3.3), (5.2, 3.7), (8.8, 3.0)), (400_000,), 2),
    Corridor("E403", "VAE", None, km((12.9, 3.6), (16.4, 4.7), (20, 4.4)), (400_000,), 2),
    Corridor("E404", None, "VAE", km((4.6, 13), (5.6, 9.8), (7.9, 6.6), (10.6, 4.2)), (400_000,), 1),
    Corridor("E405", "VAE", None, km((12.2, 0.8), (12.4, -3.2), (13.4, -7.4), (12.3, -10.2), (12.7, -13)), (400_000,), 1),
    Corridor("E406", "ELW", None, km((-11.2, 1.2), (-11.6, -3.6), (-12.9, -6.4), (-12.4, -9.6), (-13.6, -13)), (400_000,), 2),
    Corridor("H131", "ELW", "ELM", km((-8.2, 2.3), (-6.3, 2.5)), (132_000,), 2),
    Corridor("H132", "ELM", "BRI", km((-3.6, 0.4), (-3.9, -1.9), (-2.3, -3.4)), (132_000,), 2),
    Corridor("H133", "BRI", "VAR", km((1.1, -3.3), (3.6, -2.3), (6.2, -0.6)), (132_000,), 1),
    Corridor("H134", "VAR", "VAE", km((8.3, 2.0), (10.1, 2.0)), (132_000,), 2),
    Corridor("H135", "ELW", "OST", km((-8.4, 3.9), (-5.0, 5.4), (-1.3, 5.2)), (132_000, 66_000), 2),
    Corridor("H136", "OST", "VAE", km((4.6, 5.6), (7.9, 4.6), (10.2, 3.6)), (132_000,), 1),
    Corridor("H137", "VAE", "PLA", km((13.3, 1.9), (15.3, 2.1)), (132_000,), 2),
    Corridor("H138", "ELM", "VAR", km((-2.6, 2.2), (1.3, 1.7), (4.4, 2.1)), (132_000,), 1),
    Corridor("V661", "BRI", "HOL", km((-3.1, -5.1), (-5.8, -6.6)), (66_000,), 1, VALLEY_OPERATOR),
    Corridor("V662", "HOL", "LOW", km((-10.4, -5.6), (-12.9, -3.9)), (66_000,), 1, VALLEY_OPERATOR),
    Corridor("V663", "LOW", "ELW", km((-14.3, 0.4), (-12.1, 2.2)), (66_000,), 1, VALLEY_OPERATOR),
    Corridor(
        "V664",
        "ELW",
        "TAR",
        km(
            (-9.9, 4.6),
        ),
        (66_000,),
        1,
        VALLEY_OPERATOR,
    ),
    Corridor("V665", "BRI", "KEL", km((1.6, -5.2), (5.3, -5.9)), (66_000,), 2, VALLEY_OPERATOR),
    Corridor("V666", "KEL", "SAL", km((11.2, -4.7), (13.7, -3.1)), (66_000,), 1, VALLEY_OPERATOR),
    Corridor("V667", "SAL", "VAE", km((14.9, 0.1), (13.1, 1.3)), (66_000,), 1, VALLEY_OPERATOR),
    Corridor(
        "V668",
        "VAE",
        "WIC",
        km(
            (12.7, 4.6),
        ),
        (66_000,),
        1,
        VALLEY_OPERATOR,
    ),
    Corridor("V669", "OST", "WIC", km((5.2, 6.6), (9.4, 7.6)), (66_000,), 1, VALLEY_OPERATOR),
    Corridor("V670", "TAR", "OST", km((-8.1, 7.3), (-3.2, 7.0)), (66_000,), 1, VALLEY_OPERATOR),
)


@dataclass(frozen=True)
class DemoCourse:
    """A road, railway or water: control points of a smooth curve, and how wide it is."""

    name: str
    kind: str  # the value of the OSM tag: primary, rail, river
    points: tuple[Point, ...]
    width_m: float


RIVER = DemoCourse(
    "Elme",
    "river",
    km(
        (-21.5, -1.5), (-17, -0.6), (-13, -1.4), (-9.5, -0.4), (-6, -0.9), (-2.5, -0.2), (1, -1.2),
        (4.5, -0.5), (8, -0.9), (11, -0.1), (14.5, -1.2), (18, -0.7), (21.5, -1.1),
    ),
    46.0,
)  # fmt: skip

ROADS = (
    DemoCourse(
        "North Bank Road", "primary",
        km((-20, 1.6), (-15, 0.6), (-10, 1.4), (-6, 0.8), (-1, 1.3),
            (3, 0.9), (8, 0.6), (13, 0.9), (20, 1.2)), 11.0,
    ),
    DemoCourse(
        "South Bank Road", "secondary",
        km((-20, -4.3), (-15, -2.8), (-9, -4.1), (-5, -4.5), (-2, -5.8),
            (4, -4.9), (9.3, -5.8), (13, -4.0), (17, -2.9), (20, -3.4)), 9.0,
    ),
    DemoCourse("Tarnfold Road", "secondary", km((-11, 7.2), (-10, 5.2), (-7.4, 3.3), (-6.1, 0.9), (-5.6, -1.6), (-5.9, -4.4)), 9.0),
    DemoCourse("Ostermoor Road", "secondary", km((1.4, 6.5), (0.4, 4.2), (-0.4, 1.4), (-0.1, -1.9), (-1.6, -5.6)), 9.0),
    DemoCourse("Wickenfell Road", "secondary", km((13, 7.5), (11.2, 5.2), (8.8, 2.4), (8.1, 0.5), (8.6, -2.4), (9.3, -5.7)), 9.0),
    DemoCourse("Lowmarch Lane", "tertiary", km((-15.1, -2.7), (-15.9, 0.2), (-14.2, 3.4), (-11.3, 6.8)), 7.0),
    DemoCourse("Power Station Road", "tertiary", km((17, -2.7), (16.2, -0.4), (15.9, 1.1), (16.6, 2.6)), 7.0),
    DemoCourse("Airfield Road", "tertiary", km((4.7, 0.9), (5.6, -0.9), (5.1, -2.9), (5.6, -5.0)), 7.0),
    DemoCourse(
        "North Moor Road", "tertiary", km((-11, 7.1), (-6.2, 6.2), (-2.4, 6.6), (1.4, 6.4), (6.8, 5.9), (10.3, 7.1), (13, 7.4)), 7.0
    ),
    DemoCourse(
        "South Moor Road", "tertiary",
        km((-15.2, -3.0), (-13.4, -7.2), (-10, -8.2), (-6.1, -7.4), (-2, -6.1),
            (2.9, -7.3), (9.3, -6.0), (14.7, -6.6), (17, -2.9)), 7.0,
    ),
)  # fmt: skip

MAIN_RAILWAY = DemoCourse(
    "Elme Valley Line",
    "rail",
    km(
        (-20, -2.5), (-15.6, -2.0), (-11, -1.9), (-8, -0.6), (-5.6, 0.25), (-2, 0.75),
        (3.4, 0.25), (8, -0.1), (11.4, -0.7), (14.2, -2.0), (17, -2.4), (20, -2.4),
    ),
    9.0,
)  # fmt: skip
BRANCH_RAILWAY = DemoCourse(
    "Brindlow Branch", "rail", km((-3.9, -0.9), (-3.3, -3.2), (-3.2, -6.0), (-1.2, -9.0), (0.6, -13)), 6.0
)  # from the main line
BRANCH_JUNCTION_SHARE = 0.365  # of the main line's length, where the branch leaves it

STREAMS_PER_BANK = 9
