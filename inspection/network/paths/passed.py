"""Where ways lead over: nodes of the graph, and the bends of legs that go round zones."""

from dataclasses import dataclass

import numpy as np

from inspection.network.legs import NO_BENDS
from inspection.network.paths.contracted_graph import FloatArray
from inspection.network.paths.hub_labels import IntArray
from inspection.network.paths.paths import ALONG_CHAIN, DIRECT, Travel

BEND = -1  # in place of a node


@dataclass(frozen=True, eq=False)
class Passed:
    """What several ways lead over, one way after another: way w has the places first[w] up to but without first[w + 1], (w + 1,).

    position (n, 2) lon, lat [deg]; node (n,), BEND for a bend of a leg.
    """

    position: FloatArray
    node: IntArray
    first: IntArray


def passed_on(travel: Travel, ways: IntArray, position: FloatArray) -> Passed:
    """The places of several ways (k, 2), source and sink; position is that of the graph's nodes. Raises NoWay as `Travel.paths`."""
    node, first = travel.paths(ways)
    if not (travel.leg_bends or travel.direct_bends):
        return Passed(position[node], node, first)
    places: list[FloatArray] = []
    nodes: list[IntArray] = []
    counts = [0]
    for way, (source, sink) in enumerate(ways.tolist()):
        own = node[first[way] : first[way + 1]]
        out, back = _bends(travel, source, sink)
        places += [out, position[own], back[::-1]]
        nodes += [np.full(len(out), BEND, dtype=np.int64), own, np.full(len(back), BEND, dtype=np.int64)]
        counts.append(len(out) + len(own) + len(back))
    return Passed(np.concatenate(places), np.concatenate(nodes), np.cumsum(counts))


def _bends(travel: Travel, source: int, sink: int) -> tuple[FloatArray, FloatArray]:
    """Of the leg from the source, and of the leg to the sink from the sink on."""
    out, back = travel.way[source, sink].tolist()
    if out == DIRECT:
        return travel.direct_bends.get((source, sink), NO_BENDS), NO_BENDS
    if not travel.leg_bends:
        return NO_BENDS, NO_BENDS
    if out <= ALONG_CHAIN:
        return travel.leg_bends[(ALONG_CHAIN - out) // 2], travel.leg_bends[(ALONG_CHAIN - back) // 2]
    return travel.leg_bends[int(travel.entry_leg[out]) // 2], travel.leg_bends[int(travel.entry_leg[back]) // 2]
