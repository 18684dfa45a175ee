"""Spans far longer than their line's others: towers that are not mapped."""

import numpy as np
from numpy.typing import NDArray
from shapely import LineString

from inspection.quality.infrastructure import asset_key, place_key
from inspection.quality.issue import Gap
from inspection.quality.network import FloatArray, Network

# Volts from which a class begins, the usual span where the data has none to learn from, and the bound: what is shorter is no gap,
# whatever the line's other spans are. Usual: wooden and concrete poles stand about 80 m apart, towers 300 to 550 m (Darley Power Fight,
# "dimensions of the towers", 450 to 550 m at 220 and 500 kV; in the OSM data of Nepal at 132 kV the median is 0.32 km and 95 % are below
# 0.64 km). The bound is about twice the longest usual span: valleys and rivers are crossed in one leap.
CLASSES = ((100_000, 320.0, 1_000.0), (50_000, 250.0, 800.0), (1, 100.0, 450.0), (0, 250.0, 800.0))
LONGER_THAN_OTHERS = 3.0
OWN_SPANS = 8  # a line with fewer is judged by all lines of its class: a median of three spans says little
MAX_IN_THE_WORLD_M = 5_376.0  # Ameralik, Greenland


def voltage_class(voltage_v: FloatArray) -> NDArray[np.int64]:
    """Index into CLASSES; 0 V is "not stated"."""
    found = np.full(len(voltage_v), len(CLASSES) - 1, dtype=np.int64)
    for index in range(len(CLASSES) - 2, -1, -1):
        found[voltage_v >= CLASSES[index][0]] = index
    return found


def way_classes(network: Network) -> NDArray[np.int64]:
    return voltage_class(np.array([max(volts, default=0) for volts in network.ground.line_facts.voltages_v], dtype=np.float64))


def usual_span_m(network: Network) -> FloatArray:
    """Of each line: the median of its own spans, or where it has few the median of all spans of its voltage class."""
    classes = way_classes(network)
    usual = np.array([CLASSES[index][1] for index in classes])
    leg_class = classes[network.leg_way]
    for index in range(len(CLASSES)):
        spans = network.leg_m[leg_class == index]
        if len(spans) >= OWN_SPANS:
            usual[classes == index] = np.median(spans)
    order = np.lexsort((network.leg_m, network.leg_way))
    count = np.bincount(network.leg_way, minlength=len(usual))
    first = np.concatenate([[0], np.cumsum(count)[:-1]]).astype(np.int64)
    own = np.flatnonzero(count >= OWN_SPANS)
    metres = network.leg_m[order]
    usual[own] = (metres[first[own] + (count[own] - 1) // 2] + metres[first[own] + count[own] // 2]) / 2
    return usual


def long_spans(network: Network) -> list[Gap]:
    """Legs longer than three times the usual span of their line and than the bound of its voltage."""
    lines, facts = network.ground.lines, network.ground.line_facts
    usual = usual_span_m(network)[network.leg_way]
    bound = np.array([CLASSES[index][2] for index in way_classes(network)])[network.leg_way]
    found = np.flatnonzero((network.leg_m > LONGER_THAN_OTHERS * usual) & (network.leg_m > bound))
    pair_of_leg = network.pairs[2]
    gaps = []
    for leg in found.tolist():
        way, vertex = int(network.leg_way[leg]), int(network.leg_start[leg])
        ends = lines.position[vertex : vertex + 2]
        if abs(ends[0, 0] - ends[1, 0]) > 180.0:
            continue
        span_m = float(network.leg_m[leg])
        beyond_m = float(network.smaller_side_m[pair_of_leg[leg]]) if pair_of_leg[leg] >= 0 else 0.0
        missing = max(round(span_m / float(usual[leg])) - 1, 1)
        gaps.append(
            Gap(
                kind="long_span",
                key=f"long_span {asset_key('w', int(facts.osm_id[way]), int(lines.asset[way]))} {place_key(ends[0])} {place_key(ends[1])}",
                asset=int(lines.asset[way]),
                position=_middle(ends),
                geometry=LineString(ends),
                details={
                    "span_m": round(span_m, 1),
                    "usual_span_m": round(float(usual[leg]), 1),
                    "missing_towers": missing,
                    "beyond_m": round(beyond_m, 1),
                    "is_impossible": span_m > MAX_IN_THE_WORLD_M,
                    "start": ends[0].tolist(),
                    "end": ends[1].tolist(),
                },
                cut_off_m=span_m + beyond_m,
            )
        )
    return gaps


def _middle(ends: FloatArray) -> tuple[float, float]:
    lon, lat = ends.mean(axis=0)
    return float(lon), float(lat)
