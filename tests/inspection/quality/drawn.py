"""Small grounds in metres east and north of 10 E 56 N."""

from collections.abc import Sequence

import numpy as np

from inspection.geodesy.local_frame import LocalFrame
from inspection.network.infrastructure import NO_OSM_NODE, InfrastructurePlaces, InfrastructureWays
from inspection.quality.infrastructure import NO_OSM_ID, IssueSearchData, PlainBridge, SupportFacts, WayFacts

FRAME = LocalFrame.around(10.0, 56.0)
Metres = tuple[float, float]


def at(*places: Metres) -> np.ndarray:
    return FRAME.to_degrees(np.array(places, dtype=np.float64).reshape(-1, 2))


def row(start_m: float, end_m: float, step_m: float, north_m: float = 0.0) -> list[Metres]:
    return [(float(east), north_m) for east in np.arange(start_m, end_m + 0.5, step_m)]


def ground(
    *lines: Sequence[Metres],
    towers: Sequence[Metres] = (),
    voltages_v: Sequence[tuple[int, ...]] | None = None,
    voltage_text: Sequence[str] | None = None,
    subtypes: Sequence[str] | None = None,
    terminals: Sequence[int] = (),
    off_network: Sequence[Metres] = (),
    bridges: Sequence[Metres] = (),
    railway_volts: Sequence[tuple[int, ...]] = (),
) -> IssueSearchData:
    """Lines have primary keys from 1, towers from 101; nothing has an OSM id. `terminals` are numbers of towers."""
    no_text = [""] * len(lines)
    return IssueSearchData(
        revision=1,
        lines=_ways(lines),
        line_facts=_facts(len(lines), voltages_v or [()] * len(lines), voltage_text or no_text, subtypes or ["line"] * len(lines)),
        railways=_ways([[(0.0, 9_000.0), (100.0, 9_000.0)]] * len(railway_volts)),
        railway_facts=_facts(len(railway_volts), railway_volts, [""] * len(railway_volts), ["rail"] * len(railway_volts)),
        supports=InfrastructurePlaces(
            asset=np.arange(101, 101 + len(towers)),
            osm_node=np.full(len(towers), NO_OSM_NODE),
            position=at(*towers),
            height_m=np.full(len(towers), np.nan),
        ),
        support_facts=SupportFacts(
            osm_id=np.full(len(towers), NO_OSM_ID), is_terminal=np.isin(np.arange(len(towers)), np.array(terminals, dtype=int))
        ),
        bridges_without_way=tuple(
            PlainBridge(201 + index, f"a{201 + index}", tuple(place)) for index, place in enumerate(at(*bridges).tolist())
        ),
        off_network=at(*off_network),
    )


def _ways(lines: Sequence[Sequence[Metres]]) -> InfrastructureWays:
    positions = [at(*line) for line in lines]
    count = [len(line) for line in lines]
    return InfrastructureWays(
        asset=np.arange(1, 1 + len(lines)),
        height_m=np.full(len(lines), np.nan),
        first=np.concatenate([[0], np.cumsum(count)]).astype(np.int64),
        osm_node=np.full(sum(count), NO_OSM_NODE),
        position=np.concatenate([np.zeros((0, 2)), *positions]),
    )


def _facts(number: int, voltages_v: Sequence[tuple[int, ...]], voltage_text: Sequence[str], subtypes: Sequence[str]) -> WayFacts:
    return WayFacts(
        osm_id=np.full(number, NO_OSM_ID),
        subtype=tuple(subtypes),
        voltages_v=tuple(voltages_v),
        voltage_text=tuple(voltage_text),
        is_edited=np.zeros(number, dtype=bool),
    )
