"""Issues of lines: impossible voltages, ends that should join, and ends with nothing near."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from shapely import LineString, Point

from inspection.network.infrastructure import InfrastructureWays
from inspection.network.nearness import nearest_within
from inspection.quality.infrastructure import FoundIssue, IssueSearchData, WayFacts, asset_key, place_key
from inspection.quality.network import BoolArray, FloatArray, IntArray, NearLegs, SupportNetwork

MAX_V = 1_200_000  # the highest ever in service: 1,150 kV Ekibastuz to Kokshetau, 1,200 kV as tested at Bina
MAX_VALUES = 6
LOW_VOLTAGE_V = 1_000

# Nominal voltages in use [V]: IEC 60038 and ANSI C84.1, railways (EN 50163), and further national ones; above 100 kV also those of direct
# current links.
STANDARD_V = frozenset(
    round(kilovolts * 1_000)
    for kilovolts in (
        0.1, 0.11, 0.12, 0.127, 0.2, 0.208, 0.22, 0.23, 0.24, 0.277, 0.347, 0.38, 0.4, 0.415, 0.44, 0.46, 0.48, 0.5, 0.55, 0.575, 0.6,
        0.63, 0.65, 0.69, 0.75, 0.8, 0.825, 0.85, 0.9, 0.95, 1, 1.2, 1.25, 1.35, 1.5, 1.65, 2, 2.2, 2.3, 2.4, 3, 3.3, 3.6, 4, 4.16, 4.4,
        4.8, 5, 5.2, 5.5, 6, 6.25, 6.3, 6.35, 6.5, 6.6, 6.9, 7.2, 7.6, 7.62, 7.97, 8, 8.32, 8.4, 10, 10.5, 11, 11.4, 11.5, 12, 12.47,
        12.5, 12.7, 13, 13.2, 13.8, 14, 14.4, 15, 15.75, 16, 16.5, 17.3, 17.5, 18, 18.2, 19, 19.05, 19.1, 19.9, 20, 20.6, 20.8, 21, 21.6,
        22, 22.8, 22.86, 22.9, 23, 23.9, 24, 24.9, 24.94, 25, 26, 26.4, 27, 27.5, 27.6, 28, 30, 31.5, 33, 34, 34.4, 34.5, 35, 36, 37.5,
        38, 40, 41.6, 42, 43.8, 44, 45, 46, 47, 48, 49, 49.5, 50, 51, 52, 54, 55, 57, 57.1, 59, 60, 61, 62, 63, 64, 65, 66, 67, 69, 70,
        70.6, 71, 72, 72.5, 75, 77, 80, 82.5, 84, 85, 86, 87, 88, 90, 92, 95, 98, 99, 100, 104, 105, 106, 110, 111, 112, 113, 114, 115,
        117, 118, 119, 120, 121, 123, 125, 127, 128, 130, 132, 135, 138, 140, 143, 144, 145, 150, 154, 155, 158, 160, 161, 162, 163, 164,
        165, 166, 169, 170, 180, 185, 187, 200, 204, 220, 222, 225, 230, 235, 240, 242, 245, 250, 260, 270, 275, 280, 285, 287, 287.5,
        300, 315, 320, 330, 345, 350, 360, 362, 380, 400, 410, 420, 430, 450, 463, 480, 500, 515, 525, 530, 533, 535, 550, 600, 640, 660,
        735, 750, 765, 800, 1_000, 1_050, 1_100, 1_150, 1_200,
    )
)  # fmt: skip


def impossible_voltages(ground: IssueSearchData) -> list[FoundIssue]:
    """Return one issue for each line or railway with a voltage that is too low, too high, not nominal, unreadable, or one of too many."""
    return [
        *_of_ways(ground.lines, ground.line_facts, is_railway=False),
        *_of_ways(ground.railways, ground.railway_facts, is_railway=True),
    ]


def _of_ways(ways: InfrastructureWays, facts: WayFacts, *, is_railway: bool) -> list[FoundIssue]:
    issues = []
    for way, (volts, text) in enumerate(zip(facts.voltages_v, facts.voltage_text, strict=True)):
        fault = voltage_fault(volts, text, subtype=facts.subtype[way], is_railway=is_railway)
        if fault is None:
            continue
        asset, first, last = int(ways.asset[way]), int(ways.first[way]), int(ways.first[way + 1])
        middle = ways.position[(first + last) // 2]
        issues.append(
            FoundIssue(
                kind="impossible_voltage",
                key=f"impossible_voltage {asset_key('w', int(facts.osm_id[way]), asset)}",
                asset=asset,
                position=(float(middle[0]), float(middle[1])),
                geometry=Point(middle),
                details=fault | {"voltages_v": list(volts), "tagged": text[:200]},
            )
        )
    return issues


def voltage_fault(volts: Sequence[int], text: str, *, subtype: str, is_railway: bool) -> dict[str, Any] | None:
    """Return None, or the fault: {"fault": too_low, too_high, too_many, unread or unusual, "is_advisory", "offered_v"}."""
    if not volts:
        return _fault("unread", []) if text.strip() and not _says_unknown(text) and not is_railway else None
    if any(value > MAX_V for value in volts):
        return _fault("too_high", _corrected(volts, lambda value: value > MAX_V, (1_000, 10, 100)))
    if not is_railway and subtype == "line" and (low := [value for value in volts if _is_too_low(value)]):
        return _fault("too_low", sorted({value * 1_000 if value in low else value for value in volts}, reverse=True))
    if len(volts) > MAX_VALUES:
        return _fault("too_many", [])
    if any(value not in STANDARD_V for value in volts):
        return _fault("unusual", [], is_advisory=True)
    return None


def _fault(name: str, offered_v: list[int], *, is_advisory: bool = False) -> dict[str, Any]:
    return {"fault": name, "offered_v": offered_v, "is_advisory": is_advisory}


def _is_too_low(value: int) -> bool:
    """Whether the value is kilovolts without their unit, such as "110" for 110 kV: a line on towers has high voltage."""
    return value < LOW_VOLTAGE_V and value * 1_000 in STANDARD_V


def _corrected(volts: Sequence[int], is_wrong: Any, divisors: Sequence[int]) -> list[int]:
    """Return the voltages with wrong ones divided to nominal ones; empty if that does not work for all."""
    corrected = set()
    for value in volts:
        fitting = [value // by for by in divisors if value % by == 0 and value // by >= LOW_VOLTAGE_V and value // by in STANDARD_V]
        if is_wrong(value) and not fitting:
            return []
        corrected.add(fitting[0] if is_wrong(value) else value)
    return sorted(corrected, reverse=True)


def _says_unknown(text: str) -> bool:
    return text.strip().lower() in {"unknown", "fixme", "?", "yes", "no"}


JOIN_M = 6.0  # "a few metres": a mapping error; gantries of a substation are 10 m and more apart
TERMINAL_M = 150.0  # a substation's reach, as in the graph's rule for crossings
ASKED_AT_ONCE = 2_000_000  # neighbours per query, which limits memory
REACH_M = 2_000.0  # largest distance of an end from the network that it could belong to


def line_ends(network: SupportNetwork) -> list[FoundIssue]:
    """Return ends from which no other leg leaves: a few metres from another line, or with nothing around them.

    Spanwise stores no substations. An end counts as intended where another line, a cable, a busbar, a portal or a tower tagged as terminal
    is within 150 m. A substation with one line and none of these is not recognised, and a curator dismisses the issue.
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


def is_at_terminal(network: SupportNetwork, position: FloatArray, way: IntArray) -> BoolArray:
    """Whether something at the place indicates that lines end there: a terminal support, unflown infrastructure, or another line."""
    ground = network.ground
    terminals = np.concatenate([ground.off_network, ground.supports.position[ground.support_facts.is_terminal]])
    at_terminal = np.zeros(len(position), dtype=bool)
    at_terminal[nearest_within(position, terminals, TERMINAL_M)[0]] = True
    near = network.legs_near(position, TERMINAL_M)
    at_terminal[near.place[network.leg_way[near.leg] != way[near.place]]] = True
    return at_terminal


def _loose_ends(network: SupportNetwork) -> IntArray:
    """Return vertex numbers of first and last vertices whose node has a single leg."""
    lines = network.ground.lines
    has = np.diff(lines.first) > 1
    ends = np.concatenate([lines.first[:-1][has], lines.first[1:][has] - 1])
    loose = np.sort(ends[network.degree[network.node_of_vertex[ends]] == 1])
    _, first = np.unique(network.node_of_vertex[loose], return_index=True)  # two lines between one pair of nodes share an end
    chosen: IntArray = loose[np.sort(first)]
    return chosen


def _of_other_lines(network: SupportNetwork, vertex: IntArray, near: NearLegs) -> NearLegs:
    keep = network.leg_way[near.leg] != network.way_of_vertex[vertex[near.place]]
    keep &= (network.leg_node[near.leg] != network.node_of_vertex[vertex[near.place]][:, None]).all(axis=1)
    return NearLegs(near.place[keep], near.leg[keep], near.metres[keep], near.fraction[keep], near.position[keep])


def _ends_apart(network: SupportNetwork, vertex: IntArray, near: NearLegs, row: IntArray) -> list[FoundIssue]:
    """Return one issue for each pair of an end and the line that it should join; two ends that miss each other are one issue."""
    leg = near.leg[row]
    start, other_end = network.leg_start[leg], network.leg_start[leg] + 1
    target = np.where(near.fraction[row] <= 0.5, start, other_end)
    lines = network.ground.lines
    cut_off = network.joining_m(network.node_of_vertex[vertex], network.node_of_vertex[target])
    issues: dict[str, FoundIssue] = {}
    for index, (end, entry) in enumerate(zip(vertex.tolist(), row.tolist(), strict=True)):
        way, other = int(network.way_of_vertex[end]), int(network.leg_way[near.leg[entry]])
        place = lines.position[end]
        is_at_end = near.fraction[entry] in (0.0, 1.0) and target[index] in (lines.first[other], lines.first[other + 1] - 1)
        there = lines.position[target[index]] if near.fraction[entry] in (0.0, 1.0) else near.position[entry]
        named_after = min(place.tolist(), there.tolist()) if is_at_end else place
        issue = FoundIssue(
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
        issues.setdefault(issue.key, issue)
    return list(issues.values())


def _dead_ends(network: SupportNetwork, vertex: IntArray) -> list[FoundIssue]:
    node = network.node_of_vertex[vertex]
    position = network.node_position[node]
    lines = network.ground.lines
    partner, metres = _nearest_other_component(network, node)
    cut_off = np.where(partner >= 0, network.joining_m(node, np.maximum(partner, 0)), 0.0)
    issues = []
    for index, end in enumerate(vertex.tolist()):
        way = int(network.way_of_vertex[end])
        place = position[index]
        issues.append(
            FoundIssue(
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
    return issues


def _nearest_other_component(network: SupportNetwork, node: IntArray) -> tuple[IntArray, FloatArray]:
    """Return for each node the nearest one of an unconnected line with its voltage within reach, or -1.

    Lines of two voltages are connected by transformers, not directly; an unstated voltage matches any.
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
        waiting, count = np.concatenate(still), count * 4  # only where all found ones are connected to the node
    return partner, best


def _node_volts(network: SupportNetwork) -> IntArray:
    """Return for each node the highest voltage of its lines, 0 where none is stated."""
    of_way = np.array([max(volts, default=0) for volts in network.ground.line_facts.voltages_v], dtype=np.int64)
    highest = np.zeros(network.node_count, dtype=np.int64)
    np.maximum.at(highest, network.node_of_vertex, of_way[network.way_of_vertex])
    return highest


def _way_key(network: SupportNetwork, way: int) -> str:
    return asset_key("w", int(network.ground.line_facts.osm_id[way]), int(network.ground.lines.asset[way]))
