"""Power lines of Quillmoor as volunteers map them: towers left out, several lines on one row, ends that nothing marks."""

import numpy as np

from inspection.demo_region.curves import spans_between
from inspection.demo_region.osm_objects import OsmDrawing
from inspection.demo_region.place import FloatArray

GRID_OPERATOR = "Quillmoor Grid"
RUN = 4  # consecutive vertices that are tagged or not together: mappers leave out whole stretches
NORTH_SUBSTATION = (-2_000.0, 3_500.0)
SOUTH_SUBSTATION = (-1_800.0, -3_400.0)
LONG_SPAN_M = 2_400.0  # its towers are not mapped
FORK = (4_300.0, 4_000.0)  # where three lines leave their common row


def _line(voltage_v: int, ref: str, **tags: str) -> dict[str, str]:
    return {"power": "line", "voltage": str(voltage_v), "ref": ref, "name": f"Line {ref}", "operator": GRID_OPERATOR} | tags


class _Mapper:
    """Draws rows of supports with the same generator."""

    def __init__(self, drawing: OsmDrawing, generator: np.random.Generator) -> None:
        self.drawing = drawing
        self.generator = generator
        self.place_of: dict[int, FloatArray] = {}  # east and north [m] of the vertices

    def row(self, *corners: tuple[float, float], span_m: float, untagged_share: float = 0.2, support: str = "tower") -> list[int]:
        """Return the node ids of a row; the share of untagged vertices is in runs, and numbers start at 1 on each row.

        No support states its height.
        """
        points, _ = spans_between(np.array(corners), span_m, self.generator)
        runs = self.generator.random(len(points) // RUN + 1) < untagged_share
        node_ids = []
        for number, point in enumerate(points):
            tags = {} if runs[number // RUN] else {"power": support, "ref": str(number + 1)}
            node_ids.append(self.drawing.add_node(point, tags))
        self.place_of |= dict(zip(node_ids, points, strict=True))
        return node_ids

    def line(self, tags: dict[str, str], *corners: tuple[float, float], span_m: float = 270.0, untagged_share: float = 0.2) -> list[int]:
        node_ids = self.row(*corners, span_m=span_m, untagged_share=untagged_share)
        self.drawing.add_way(node_ids, tags)
        return node_ids


def draw_power(drawing: OsmDrawing, generator: np.random.Generator) -> None:
    mapper = _Mapper(drawing, generator)
    north, south = _draw_substations(drawing)
    _draw_lines_into_substations(mapper, north, south)
    _draw_common_row(mapper, north)
    _draw_parallel_rows(mapper)
    _draw_long_span(mapper)
    _draw_gaps(mapper)
    _draw_poles(mapper, south)
    _draw_what_is_not_flown(drawing)


def _draw_substations(drawing: OsmDrawing) -> tuple[list[int], list[int]]:
    """Draw two fences, the second with the older tag, and return their corner nodes; a third substation is one node."""
    fences = []
    for (east, north), tags in (
        (NORTH_SUBSTATION, {"power": "substation", "substation": "transmission", "voltage": "220000;110000"}),
        (SOUTH_SUBSTATION, {"power": "sub_station", "voltage": "110000"}),
    ):
        ring = [np.array([east + x * 70.0, north + y * 55.0]) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        drawing.add_area(ring, tags | {"name": "Quillmoor"})
        fences.append([node.id for node in drawing.nodes[-4:]])
    drawing.add_node((7_900.0, -2_300.0), {"power": "substation", "name": "Quillmoor"})
    return fences[0], fences[1]


def _draw_lines_into_substations(mapper: _Mapper, north: list[int], south: list[int]) -> None:
    """Line 7 is three ways of one name and ends inside the fence; Line 11 ends on the fence, at a corner of its outline."""
    drawing = mapper.drawing
    east, up = NORTH_SUBSTATION
    row = mapper.row((-13_500.0, 4_400.0), (-7_400.0, 4_900.0), (east - 400.0, up + 60.0), span_m=300.0)
    inside = drawing.add_node((east - 30.0, up + 10.0))
    thirds = [row[: len(row) // 3 + 1], row[len(row) // 3 : 2 * len(row) // 3 + 1], [*row[2 * len(row) // 3 :], inside]]
    for part in thirds:
        drawing.add_way(part, _line(220_000, "7", circuits="2", cables="6"))
    corner_to_corner = mapper.row((east + 40.0, up - 330.0), (-1_300.0, 600.0), (-1_500.0, -2_900.0), span_m=250.0)
    drawing.add_way([north[1], *corner_to_corner, south[3]], _line(110_000, "11"))
    portals = [drawing.add_node((east - 40.0 + 40.0 * number, up - 20.0), {"power": "portal"}) for number in range(3)]
    drawing.add_way([inside, *portals], {"power": "line", "line": "busbar", "voltage": "220000"})


def _draw_common_row(mapper: _Mapper, north: list[int]) -> None:
    """Three lines share the towers from the substation to the fork: one goes on beyond the box, one turns south, one north."""
    east, up = NORTH_SUBSTATION
    common = [north[2], *mapper.row((east + 350.0, up + 80.0), (1_200.0, 4_300.0), FORK, span_m=290.0, untagged_share=0.1)]
    onward = mapper.row((4_600.0, 4_020.0), (9_000.0, 4_700.0), (13_800.0, 4_100.0), span_m=300.0)
    southward = mapper.row((4_480.0, 3_700.0), (6_900.0, 1_700.0), (7_800.0, -2_260.0), span_m=240.0)
    northward = mapper.row((4_500.0, 4_250.0), (6_200.0, 6_100.0), (6_300.0, 9_200.0), span_m=240.0)
    mapper.drawing.add_way([*common, *onward], _line(220_000, "8", circuits="2"))
    mapper.drawing.add_way([*common, *southward], _line(110_000, "9"))
    mapper.drawing.add_way([*common, *northward], _line(110_000, "10"))


def _draw_parallel_rows(mapper: _Mapper) -> None:
    """Two rows of towers 45 m apart from one edge of the box to the other, both named Line 7 like the line in the north."""
    for side_m in (0.0, 45.0):
        mapper.line(_line(110_000, "7"), (8_900.0 + side_m, 9_000.0), (8_600.0 + side_m, 1_000.0), (9_500.0 + side_m, -9_000.0))


def _draw_long_span(mapper: _Mapper) -> None:
    """Line 12 leaves the box in the west and comes back, and crosses a marsh without a mapped tower."""
    west = mapper.row((-9_000.0, -7_300.0), (-12_700.0, -5_800.0), (-9_600.0, -4_200.0), (-7_000.0, -4_100.0), span_m=260.0)
    east = mapper.row((-7_000.0 + LONG_SPAN_M, -4_100.0), (SOUTH_SUBSTATION[0] - 300.0, -3_500.0), span_m=260.0)
    mapper.drawing.add_way([*west, *east, mapper.drawing.add_node(SOUTH_SUBSTATION)], _line(110_000, "12"))


def _draw_gaps(mapper: _Mapper) -> None:
    """What the search for data issues is for: no towers, an end 4 m beside the line it belongs to, lone towers, a voltage in kV."""
    drawing = mapper.drawing
    mapper.line(_line(110_000, "13"), (-10_500.0, -1_800.0), (-8_300.0, -2_500.0), (-5_200.0, -2_200.0), untagged_share=1.0)
    through = mapper.line(_line(110_000, "14"), (-10_000.0, 7_000.0), (-6_000.0, 6_300.0), (-2_600.0, 6_600.0), untagged_share=0.0)
    east, up = mapper.place_of[through[8]]
    mapper.line(_line(110_000, "14"), (east, up - 4.0), (east - 300.0, 5_100.0), untagged_share=0.0)
    for number in range(4):
        drawing.add_node((-6_200.0 + 260.0 * number, 1_900.0), {"power": "tower"})
    mapper.line(_line(110, "15"), (1_800.0, -6_900.0), (4_600.0, -6_200.0), span_m=230.0)
    border = [drawing.add_node(point, {"power": "tower"}) for point in ((11_900.0, 6_500.0), (12_150.0, 6_550.0), (12_400.0, 6_600.0))]
    drawing.add_way(border, _line(110_000, "16"))  # one node of it is left


def _draw_poles(mapper: _Mapper, south: list[int]) -> None:
    """Minor lines on poles, of which many are not mapped, and a power=line on poles."""
    east, up = SOUTH_SUBSTATION
    tags = {"power": "minor_line", "voltage": "20000"}
    trunk = mapper.row((east + 200.0, up - 60.0), (1_200.0, -4_400.0), (3_900.0, -4_000.0), span_m=75.0, untagged_share=0.4, support="pole")
    mapper.drawing.add_way([south[1], *trunk], tags)
    for place, to in ((18, (-300.0, -6_800.0)), (40, (1_500.0, -2_600.0))):
        start = mapper.place_of[trunk[place]]
        first = start + 70.0 * (to - start) / np.hypot(*(to - start))
        branch = mapper.row((first[0], first[1]), to, span_m=70.0, untagged_share=0.4, support="pole")
        mapper.drawing.add_way([trunk[place], *branch], tags)
    poles = mapper.row((8_050.0, -2_400.0), (11_000.0, -4_600.0), span_m=110.0, support="pole")
    mapper.drawing.add_way(poles, _line(34_500, "17"))


def _draw_what_is_not_flown(drawing: OsmDrawing) -> None:
    east, up = SOUTH_SUBSTATION
    cable = {"power": "cable", "location": "underground", "voltage": "20000"}
    drawing.add_path([np.array([east, up]), np.array([east - 900.0, up - 700.0])], cable)
    old = [np.array([-4_000.0 + 250.0 * number, 7_400.0]) for number in range(8)]
    drawing.add_path(old, {"power": "line", "disused": "yes", "name": "Line 7", "voltage": "110000"})
