"""Legs that join a place to the graph, or a place to a place."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, repeat

import numpy as np

from inspection.network.paths.contracted_graph import FloatArray, NumberArray

Bends = tuple[tuple[float, float], ...]  # lon, lat [deg]

NO_BENDS: FloatArray = np.zeros((0, 2))
NO_BENDS.setflags(write=False)


def bends_of(bends: Bends) -> FloatArray:
    return np.array(bends, dtype=np.float64).reshape(-1, 2)


class NoPath(LookupError):
    """No way leads from the source to the sink."""


@dataclass(frozen=True)
class Attachment:
    """A leg between a place and a node of the graph; its bends from the place on, where it goes round zones."""

    node: int
    length_m: float
    cost: float
    bends: Bends = ()


@dataclass(frozen=True, eq=False)
class Attachments:
    """Legs between one place and nodes of the graph, column by column, each of shape (k,); taken one by one, each is an Attachment.

    bends holds those of each leg, (b, 2) lon, lat [deg] from the place on, and nothing at all where every leg is straight.
    """

    node: NumberArray
    length_m: FloatArray
    cost: FloatArray
    bends: tuple[FloatArray, ...] = ()

    @classmethod
    def of(cls, legs: "Sequence[Attachment] | Attachments") -> "Attachments":
        if isinstance(legs, Attachments):
            return legs
        return cls(
            np.array([leg.node for leg in legs], dtype=np.int32),
            np.array([leg.length_m for leg in legs], dtype=np.float64),
            np.array([leg.cost for leg in legs], dtype=np.float64),
            tuple(bends_of(leg.bends) for leg in legs) if any(leg.bends for leg in legs) else (),
        )

    def __len__(self) -> int:
        return len(self.node)

    def __iter__(self) -> Iterator[Attachment]:
        return (self[place] for place in range(len(self)))

    def __getitem__(self, place: int) -> Attachment:
        bends: Bends = tuple(map(tuple, self.bends[place].tolist())) if self.bends else ()
        return Attachment(int(self.node[place]), float(self.length_m[place]), float(self.cost[place]), bends)


def joined(legs: Sequence[Attachments]) -> Attachments:
    """One after another."""
    if not legs:
        return NO_LEGS
    if len(legs) == 1:
        return legs[0]
    return Attachments(
        np.concatenate([some.node for some in legs]),
        np.concatenate([some.length_m for some in legs]),
        np.concatenate([some.cost for some in legs]),
        tuple(chain.from_iterable(some.bends or repeat(NO_BENDS, len(some)) for some in legs)) if any(some.bends for some in legs) else (),
    )


NO_LEGS = Attachments.of([])


@dataclass(frozen=True)
class DirectLeg:
    """A leg from a source to a sink without the graph, straight or by bends."""

    source: int
    sink: int
    length_m: float
    cost: float
    bends: Bends = ()
