"""Spans far longer than their line's others: towers that are not mapped."""

import numpy as np
from shapely import LineString

from inspection.quality.infrastructure import asset_key, place_key
from inspection.quality.issue import Gap
from inspection.quality.network import FloatArray, Network
from inspection.quality.spans import CLASSES, LONGER_THAN_OTHERS, LONGEST_IN_THE_WORLD_M, usual_span_m, way_classes


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
                    "is_impossible": span_m > LONGEST_IN_THE_WORLD_M,
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
