"""What a search says of itself while it goes on."""

from collections.abc import Callable
from dataclasses import dataclass

from planning.problem import Routes


@dataclass(frozen=True)
class Progress:
    """How far a search is. `best_routes` are the best so far, visits by UAV; `bound` is in the unit of the problem's objective."""

    share: float
    message: str
    best_routes: Routes | None = None
    bound: float | None = None


OnProgress = Callable[[Progress], None]
