"""Gathers the faults of a file, so that its author sees them together and not one a time."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from inspection.geodesy.geometry_validator import GeometryFault

MAX_FAULTS = 50


class TooManyFaults(Exception):
    pass


@dataclass
class FaultList:
    faults: list[GeometryFault] = field(default_factory=list)

    @contextmanager
    def gathering(self) -> Iterator[None]:
        """Keep a fault of the block and go on after it; stop reading when there are too many."""
        try:
            yield
        except GeometryFault as fault:
            self.faults.append(fault)
            if len(self.faults) >= MAX_FAULTS:
                raise TooManyFaults from fault
