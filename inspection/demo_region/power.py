"""Power lines of the demo region: high voltage along fixed corridors, 20 kV as trees of poles to scattered farms."""

from collections import Counter
from dataclasses import dataclass

import numpy as np
from scipy.sparse.csgraph import depth_first_order, minimum_spanning_tree
from scipy.spatial.distance import cdist

from inspection.demo_region.hills import Hills
from inspection.demo_region.layout import CORRIDORS, SUBSTATIONS, TOWNS, VALLEY_OPERATOR, Corridor, Substation
from inspection.demo_region.osm_file import OsmDrawing
from inspection.demo_region.place import HALF_HEIGHT_M, HALF_WIDTH_M, FloatArray, spans_between

SUPPORTS_WANTED = 3_000
GANTRY_M = 50.0  # from a substation's middle to the ends of its lines: all within the graph's crossing radius of one another
FARM_SPACING_M = 330.0
FARM_CEILING_AMSL_M = 520.0
FARM_CANDIDATES = 9_000
TOWN_REACH_M = 1_300.0  # distance over which farms become e times rarer


@dataclass(frozen=True)
class Construction:
    """Construction of lines of a voltage, and how completely they are mapped."""

    span_m: float
    support: str
    heights_m: tuple[float, float]
    height_share: float  # of the supports whose height is tagged
    untagged_share: float  # of the inner line nodes without a support tag (real data: 11 to 21 %)


CONSTRUCTIONS = {
    400_000: Construction(320.0, "tower", (42.0, 58.0), 0.8, 0.06),
    132_000: Construction(245.0, "tower", (26.0, 36.0), 0.4, 0.09),
    66_000: Construction(185.0, "tower", (19.0, 25.0), 0.2, 0.13),
    20_000: Construction(58.0, "pole", (9.0, 13.0), 0.03, 0.17),
}


def draw_power(drawing: OsmDrawing, hills: Hills, generator: np.random.Generator) -> None:
    """Draw every line. 20 kV trees grow farm by farm until the region has about SUPPORTS_WANTED supports."""
    arrivals: Counter[str] = Counter()
    gantries: dict[str, list[int]] = {code: [] for code in SUBSTATIONS}
    for corridor in CORRIDORS:
        _draw_corridor(drawing, corridor, arrivals, gantries, generator)
    _draw_trees(drawing, hills, gantries, generator)
    for code, substation in SUBSTATIONS.items():
        _draw_substation(drawing, substation, gantries[code])
    _draw_what_is_not_flown(drawing)


def _draw_corridor(
    drawing: OsmDrawing, corridor: Corridor, arrivals: Counter[str], gantries: dict[str, list[int]], generator: np.random.Generator
) -> None:
    construction = CONSTRUCTIONS[corridor.voltages_v[0]]
    corners = [np.array(corner) for corner in corridor.corners]
    if corridor.start is not None:
        corners.insert(0, _gantry(corridor.start, corners[0], arrivals))
    if corridor.end is not None:
        corners.append(_gantry(corridor.end, corners[-1], arrivals))
    points, corner_indices = spans_between(np.array(corners), construction.span_m, generator)
    node_ids = []
    for index, point in enumerate(points):
        is_first, is_last = index == 0, index == len(points) - 1
        if (is_first and corridor.start is not None) or (is_last and corridor.end is not None):
            tags = {"power": "portal"}
        elif not (is_first or is_last) and generator.random() < construction.untagged_share:
            tags = {}
        else:
            tags = {"power": construction.support, "ref": f"{corridor.ref}-{index}"}
            tags["line_attachment"] = "anchor" if index in corner_indices else "suspension"
            if generator.random() < construction.height_share:
                tags["height"] = f"{generator.uniform(*construction.heights_m):.0f}"
        node_ids.append(drawing.add_node(point, tags))
    if corridor.start is not None:
        gantries[corridor.start].append(node_ids[0])
    if corridor.end is not None:
        gantries[corridor.end].append(node_ids[-1])
    ends = [SUBSTATIONS[code].name for code in (corridor.start, corridor.end) if code is not None]
    drawing.add_way(
        node_ids,
        {
            "power": "line",
            "voltage": ";".join(str(voltage) for voltage in corridor.voltages_v),
            "circuits": str(corridor.circuits),
            "cables": str(3 * corridor.circuits),
            "frequency": "50",
            "operator": corridor.operator,
            "ref": corridor.ref,
            "name": " – ".join(ends) if len(ends) == 2 else f"{ends[0]} interconnector",
        },
    )


def _gantry(code: str, towards: FloatArray, arrivals: Counter[str]) -> FloatArray:
    """Return where a line ends in a substation: on the side that it comes from, beside earlier lines."""
    middle = np.array(SUBSTATIONS[code].at)
    direction = (towards - middle) / np.hypot(*(towards - middle))
    beside = np.array([-direction[1], direction[0]]) * 14.0 * (arrivals[code] % 3 - 1)
    arrivals[code] += 1
    return np.asarray(middle + GANTRY_M * direction + beside, dtype=np.float64)


def _draw_trees(drawing: OsmDrawing, hills: Hills, gantries: dict[str, list[int]], generator: np.random.Generator) -> None:
    farms = _scatter_farms(hills, generator)
    sources = [code for code, substation in SUBSTATIONS.items() if 20_000 in substation.voltages_v]
    middles = np.array([SUBSTATIONS[code].at for code in sources])
    nearest = cdist(farms, middles).argmin(axis=1)
    construction = CONSTRUCTIONS[20_000]
    present = sum("power" in node.tags for node in drawing.nodes)
    wanted_m = (SUPPORTS_WANTED - present) / (1.0 - construction.untagged_share) * construction.span_m
    count = 30
    while (
        count < len(farms) and sum(_tree_length_m(middles[i], farms[:count][nearest[:count] == i]) for i in range(len(sources))) < wanted_m
    ):
        count += 2
    for index, code in enumerate(sources):
        _draw_tree(drawing, code, farms[:count][nearest[:count] == index], gantries[code], generator)


def _scatter_farms(hills: Hills, generator: np.random.Generator) -> FloatArray:
    """Return spaced places in random order, denser near towns, none high on the ridges."""
    reach = np.array([HALF_WIDTH_M - 800.0, HALF_HEIGHT_M - 1_500.0])
    places = generator.uniform(-reach, reach, (FARM_CANDIDATES, 2))
    sizes = np.array([town.size for town in TOWNS])
    likelihood = (sizes * np.exp(-cdist(places, [town.at for town in TOWNS]) / TOWN_REACH_M)).max(axis=1)
    is_likely = generator.random(FARM_CANDIDATES) < likelihood
    is_low = hills.height_amsl_m(places[:, 0], places[:, 1]) < FARM_CEILING_AMSL_M
    farms: list[FloatArray] = []
    for place in places[is_likely & is_low]:
        if not farms or float(np.min(np.hypot(*(np.array(farms) - place).T))) >= FARM_SPACING_M:
            farms.append(place)
    return np.array(farms)


def _tree_length_m(root: FloatArray, farms: FloatArray) -> float:
    places = np.vstack([root, farms])
    return float(minimum_spanning_tree(cdist(places, places)).sum())


def _draw_tree(drawing: OsmDrawing, code: str, farms: FloatArray, gantries: list[int], generator: np.random.Generator) -> None:
    """Draw the shortest tree from the substation to its farms, with ways as long as possible: a branch starts on a pole of its trunk."""
    middle = np.array(SUBSTATIONS[code].at)
    places = np.vstack([middle, farms])
    tree = minimum_spanning_tree(cdist(places, places))
    order, parents = depth_first_order(tree + tree.T, 0, directed=False)
    reach_m = np.zeros(len(places))  # length of line that a place supplies
    for place in order[:0:-1].tolist():
        reach_m[parents[place]] += reach_m[place] + np.hypot(*(places[place] - places[parents[place]]))
    children: dict[int, list[int]] = {place: [] for place in range(len(places))}
    for place in order[1:]:
        children[int(parents[place])].append(int(place))
    starts = [(0, child) for child in sorted(children[0])]
    pole_of: dict[int, int] = {}
    feeder = 0
    while starts:
        fork, child = starts.pop(0)
        stops = [fork, child]
        while children[stops[-1]]:
            onward = max(children[stops[-1]], key=lambda place: (reach_m[place], place))
            starts.extend((stops[-1], place) for place in children[stops[-1]] if place != onward)
            stops.append(onward)
        feeder += 1
        _draw_feeder(drawing, f"{code}-{feeder:02d}", places, stops, pole_of, gantries, generator)


def _draw_feeder(
    drawing: OsmDrawing,
    ref: str,
    places: FloatArray,
    stops: list[int],
    pole_of: dict[int, int],
    gantries: list[int],
    generator: np.random.Generator,
) -> None:
    construction = CONSTRUCTIONS[20_000]
    starts_in_substation = stops[0] == 0
    first = places[stops[0]]
    if starts_in_substation:
        direction = places[stops[1]] - first
        first = first + 0.8 * GANTRY_M * direction / np.hypot(*direction)
    corners = [first]
    stop_corner = {stops[0]: 0}
    for stop in stops[1:]:
        leg = places[stop] - corners[-1]
        sideways = np.array([-leg[1], leg[0]]) * generator.uniform(-0.11, 0.11)
        corners.append(corners[-1] + generator.uniform(0.35, 0.65) * leg + sideways)
        corners.append(places[stop])
        stop_corner[stop] = len(corners) - 1
    points, corner_indices = spans_between(np.array(corners), construction.span_m * generator.uniform(0.85, 1.15), generator)
    point_of_corner = sorted(corner_indices)
    stop_at = {point_of_corner[corner]: stop for stop, corner in stop_corner.items()}  # farm, or 0 for the substation
    node_ids = []
    for index, point in enumerate(points):
        stop = stop_at.get(index, -1)
        if stop in pole_of:
            node_ids.append(pole_of[stop])
            continue
        if stop == -1 and generator.random() < construction.untagged_share:
            tags = {}
        else:
            tags = {"power": construction.support, "material": "wood"}
            if generator.random() < construction.height_share:
                tags["height"] = f"{generator.uniform(*construction.heights_m):.0f}"
            if stop > 0:
                tags["transformer"] = "distribution"
        node_id = drawing.add_node(point, tags)
        node_ids.append(node_id)
        if stop > 0:
            pole_of[stop] = node_id
    if starts_in_substation:
        gantries.append(node_ids[0])
    drawing.add_way(
        node_ids, {"power": "minor_line", "voltage": "20000", "circuits": "1", "cables": "3", "operator": VALLEY_OPERATOR, "ref": ref}
    )


def _draw_substation(drawing: OsmDrawing, substation: Substation, gantries: list[int]) -> None:
    """The fence, and a busbar through its gantries: real files have both, and the graph must leave the busbar out."""
    east, north = substation.at
    half = GANTRY_M + 25.0
    fence = [np.array([east + x * half, north + y * half]) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    voltages = ";".join(str(voltage) for voltage in substation.voltages_v)
    drawing.add_area(fence, {"power": "substation", "name": f"{substation.name} Substation", "voltage": voltages})
    if len(gantries) > 1:
        drawing.add_way(gantries, {"power": "line", "line": "busbar", "voltage": str(substation.voltages_v[0])})


def _draw_what_is_not_flown(drawing: OsmDrawing) -> None:
    """One underground cable and one line out of use, as every real file has them."""
    town, substation = np.array(TOWNS[0].at), np.array(SUBSTATIONS["ELM"].at)
    cable = {"power": "cable", "location": "underground", "voltage": "20000", "operator": VALLEY_OPERATOR}
    drawing.add_path([substation, (substation + town) / 2 + 60.0, town], cable)
    start, end = np.array(SUBSTATIONS["LOW"].at) + np.array([-300.0, 400.0]), np.array([-18_200.0, 900.0])
    old_line = [start + share * (end - start) for share in np.linspace(0.0, 1.0, 20)]
    drawing.add_path(old_line, {"disused:power": "line", "voltage": "66000", "ref": "V600"})
