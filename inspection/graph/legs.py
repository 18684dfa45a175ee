"""Legs that join a place to the graph, or a place to a place."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from inspection.graph.condensed import FloatArray, NumberArray


class NoWay(LookupError):
    """No way leads from the source to the sink."""


@dataclass(frozen=True)
class Attachment:
    """A leg between a place and a node of the graph."""

    node: int
    length_m: float
    cost: float


@dataclass(frozen=True, eq=False)
class Attachments:
    """Legs between one place and nodes of the graph, column by column, each of shape (k,); taken one by one, each is an Attachment."""

    node: NumberArray
    length_m: FloatArray
    cost: FloatArray

    @classmethod
    def of(cls, legs: "Sequence[Attachment] | Attachments") -> "Attachments":
        if isinstance(legs, Attachments):
            return legs
        return cls(
            np.array([leg.node for leg in legs], dtype=np.int32),
            np.array([leg.length_m for leg in legs], dtype=np.float64),
            np.array([leg.cost for leg in legs], dtype=np.float64),
        )

    def __len__(self) -> int:
        return len(self.node)

    def __iter__(self) -> Iterator[Attachment]:
        return map(Attachment, self.node.tolist(), self.length_m.tolist(), self.cost.tolist())

    def __getitem__(self, place: int) -> Attachment:
        return Attachment(int(self.node[place]), float(self.length_m[place]), float(self.cost[place]))


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
    )


NO_LEGS = Attachments.of([])


@dataclass(frozen=True)
class DirectLeg:
    """A leg from a source straight to a sink, without the graph."""

    source: int
    sink: int
    length_m: float
    cost: float
