"""Legs that join a place to the graph, or a place to a place."""

from dataclasses import dataclass


class NoWay(LookupError):
    """No way leads from the source to the sink."""


@dataclass(frozen=True)
class Attachment:
    """A leg between a place and a node of the graph."""

    node: int
    length_m: float
    cost: float


@dataclass(frozen=True)
class DirectLeg:
    """A leg from a source straight to a sink, without the graph."""

    source: int
    sink: int
    length_m: float
    cost: float
