"""Ends of lines: those that should join, and those that end in nothing."""

import numpy as np
from shapely import LineString, Point

from inspection.network.nearness import nearest_within
from inspection.quality.infrastructure import asset_key, place_key
from inspection.quality.issue import Gap
from inspection.quality.network import BoolArray, FloatArray, IntArray, NearLegs, Network

JOIN_M = 6.0  # "a few metres": a mapper's slip; gantries of a substation stand 10 m and more apart
TERMINAL_M = 150.0  # a substation's reach, as in the graph's rule for crossings
ASKED_AT_ONCE = 2_000_000  # neighbours, so that memory stays bounded
REACH_M = 2_000.0  # how far an end may be from the network that it could belong to


def line_ends(network: Network) -> list[Gap]:
    """Ends that no other leg leaves from: apart from another line by a few metres, or with nothing around them.

    Spanwise keeps no substations. An end counts as meant where another line, a cable, a busbar, a portal or a tower tagged as terminal is
    within 150 m; a substation with one line and none of these looks like nothing, and a curator says that it is meant.
    """
    vertex = _loose_ends(network)
    position = network.node_position[network.node_of_vertex[vertex]]
    near = _of_other_lines(network, vertex, network.legs_near(position, TERMINAL_M))
    nearest = np.full(len(vertex), -1, dtype=np.int64)
    place, first = np.unique(near.place, return_index=True)
    nearest[place] = first
    is_apart = nearest >= 0
    is_apart[is_apart] = near.metres[nearest[is_apart]] <= JOIN_M
    is_dead = (nearest < 0) & ~is_at_terminal(network, position, network.way_of_vertex[vertex])
    return _ends_apart(network, vertex[is_apart], near, nearest[is_apart]) + _dead_ends(network, vertex[is_dead])


def is_at_terminal(network: Network, position: FloatArray, way: IntArray) -> BoolArray:
    """Whether something at the place says that lines end there: a terminal support, what is not flown, or another line."""
    ground = network.ground
    terminals = np.concatenate([ground.off_network, ground.supports.position[ground.support_facts.is_terminal]])
    at_terminal = np.zeros(len(position), dtype=bool)
    at_terminal[nearest_within(position, terminals, TERMINAL_M)[0]] = True
    near = network.legs_near(position, TERMINAL_M)
    at_terminal[near.place[network.leg_way[near.leg] != way[near.place]]] = True
    return at_terminal


def _loose_ends(network: Network) -> IntArray:
    """Vertex numbers of first and last vertices from whose node one leg leaves only."""
    lines = network.ground.lines
    has = np.diff(lines.first) > 1
    ends = np.concatenate([lines.first[:-1][has], lines.first[1:][has] - 1])
    loose = np.sort(ends[network.degree[network.node_of_vertex[ends]] == 1])
    _, first = np.unique(network.node_of_vertex[loose], return_index=True)  # two lines along one pair of nodes have one end
    chosen: IntArray = loose[np.sort(first)]
    return chosen


def _of_other_lines(network: Network, vertex: IntArray, near: NearLegs) -> NearLegs:
    keep = network.leg_way[near.leg] != network.way_of_vertex[vertex[near.place]]
    keep &= (network.leg_node[near.leg] != network.node_of_vertex[vertex[near.place]][:, None]).all(axis=1)
    return NearLegs(near.place[keep], near.leg[keep], near.metres[keep], near.fraction[keep], near.position[keep])


def _ends_apart(network: Network, vertex: IntArray, near: NearLegs, row: IntArray) -> list[Gap]:
    """One gap for each pair of an end and the line that it should join; two ends that miss each other are one gap."""
    leg = near.leg[row]
    start, other_end = network.leg_start[leg], network.leg_start[leg] + 1
    target = np.where(near.fraction[row] <= 0.5, start, other_end)
    lines = network.ground.lines
    cut_off = network.joining_m(network.node_of_vertex[vertex], network.node_of_vertex[target])
    gaps: dict[str, Gap] = {}
    for index, (end, entry) in enumerate(zip(vertex.tolist(), row.tolist(), strict=True)):
        way, other = int(network.way_of_vertex[end]), int(network.leg_way[near.leg[entry]])
        place = lines.position[end]
        is_at_end = near.fraction[entry] in (0.0, 1.0) and target[index] in (lines.first[other], lines.first[other + 1] - 1)
        there = lines.position[target[index]] if near.fraction[entry] in (0.0, 1.0) else near.position[entry]
        named_after = min(place.tolist(), there.tolist()) if is_at_end else place
        gap = Gap(
            kind="ends_apart",
            key=f"ends_apart {' '.join(sorted([_way_key(network, way), _way_key(network, other)]))} {place_key(np.asarray(named_after))}",
            asset=int(lines.asset[way]),
            other_asset=int(lines.asset[other]),
            position=(float(place[0]), float(place[1])),
            geometry=LineString([place, there]),
            details={
                "apart_m": round(float(near.metres[entry]), 2),
                "end": place.tolist(),
                "there": there.tolist(),
                "is_at_end": bool(is_at_end),
            },
            cut_off_m=float(cut_off[index]),
        )
        gaps.setdefault(gap.key, gap)
    return list(gaps.values())


def _dead_ends(network: Network, vertex: IntArray) -> list[Gap]:
    node = network.node_of_vertex[vertex]
    position = network.node_position[node]
    lines = network.ground.lines
    partner, metres = _nearest_other_component(network, node)
    cut_off = np.where(partner >= 0, network.joining_m(node, np.maximum(partner, 0)), 0.0)
    gaps = []
    for index, end in enumerate(vertex.tolist()):
        way = int(network.way_of_vertex[end])
        place = position[index]
        gaps.append(
            Gap(
                kind="dead_end",
                key=f"dead_end {_way_key(network, way)} {place_key(place)}",
                asset=int(lines.asset[way]),
                position=(float(place[0]), float(place[1])),
                geometry=Point(place),
                details={
                    "end": lines.position[end].tolist(),
                    "has_tower": bool(node[index] < network.support_count),
                    "nearest_m": round(float(metres[index]), 1) if partner[index] >= 0 else None,
                    "nearest": network.node_position[partner[index]].tolist() if partner[index] >= 0 else None,
                    "network_m": round(float(network.component_m[network.component[node[index]]]), 1),
                },
                cut_off_m=float(cut_off[index]),
            )
        )
    return gaps


def _nearest_other_component(network: Network, node: IntArray) -> tuple[IntArray, FloatArray]:
    """For each node the nearest one within reach of lines of its voltage that do not hang together with it, or -1.

    Lines of two voltages meet in a transformer, not in each other; a voltage that is not stated may be any.
    """
    volts = _node_volts(network)
    on_lines = np.flatnonzero(network.degree > 0)
    partner, best = np.full(len(node), -1, dtype=np.int64), np.full(len(node), np.nan)
    waiting, count = np.arange(len(node)), 16
    while len(waiting):
        still = []
        for part in np.array_split(waiting, 1 + len(waiting) * count // ASKED_AT_ONCE):
            row, other, metres = nearest_within(network.node_position[node[part]], network.node_position[on_lines], REACH_M, count=count)
            found, asking = on_lines[other], node[part[row]]
            apart = network.component[found] != network.component[asking]
            apart &= (volts[found] == volts[asking]) | (volts[found] == 0) | (volts[asking] == 0)
            settled, first = np.unique(row[apart], return_index=True)
            partner[part[settled]] = found[apart][first]
            best[part[settled]] = metres[apart][first]
            is_full = np.bincount(row, minlength=len(part)) >= count
            is_full[settled] = False
            still.append(part[is_full])
        waiting, count = np.concatenate(still), count * 4  # only where all that were asked for hang together with the node
    return partner, best


def _node_volts(network: Network) -> IntArray:
    """Of each node the highest voltage of its lines, 0 where none is stated."""
    of_way = np.array([max(volts, default=0) for volts in network.ground.line_facts.voltages_v], dtype=np.int64)
    highest = np.zeros(network.node_count, dtype=np.int64)
    np.maximum.at(highest, network.node_of_vertex, of_way[network.way_of_vertex])
    return highest


def _way_key(network: Network, way: int) -> str:
    return asset_key("w", int(network.ground.line_facts.osm_id[way]), int(network.ground.lines.asset[way]))
