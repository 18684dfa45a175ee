"""What a plan stands on, read at once: the newest graph, and the edition of the ground."""

from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache

from inspection.graph.inspection_graph import InspectionGraph
from inspection.graph.zone_index import ZoneIndex
from inspection.selectors.graph import graph_of_row, zones_of_edition
from inspection.selectors.terrain import has_terrain
from workspace.prepared import prepared_rows

_GROUND = "(SELECT revision, changed_at FROM inspection_ground ORDER BY id LIMIT 1)"
_EDITION = f"SELECT revision, changed_at FROM {_GROUND} AS ground"  # noqa: S608 - no value of anybody's
_SNAPSHOT = "(SELECT version, ground_revision, arrays_sha256 FROM inspection_graphsnapshot ORDER BY version DESC LIMIT 1)"
_BOTH = f"""
    SELECT snapshot.version, snapshot.ground_revision, snapshot.arrays_sha256, ground.revision, ground.changed_at
    FROM (SELECT 1) AS one LEFT JOIN {_SNAPSHOT} AS snapshot ON true LEFT JOIN {_GROUND} AS ground ON true"""  # noqa: S608

Edition = tuple[int, datetime | None]


@dataclass(frozen=True, eq=False)
class PlanningGround:
    """The newest graph, the zones in force, and the edition of the ground that they were read with: they are at least as new as it."""

    graph: InspectionGraph
    zones: ZoneIndex
    edition: Edition


def planning_ground() -> PlanningGround:
    """Costs one small query until the graph or the ground change. Raises NoGraph."""
    version, ground_revision, digest, revision, changed_at = prepared_rows(_BOTH)[0]
    edition = revision or 0, changed_at
    graph = graph_of_row(None if version is None else (version, ground_revision, digest))
    return PlanningGround(graph, zones_of_edition(edition), edition)


def edition_now() -> Edition:
    return next(((revision, changed_at) for revision, changed_at in prepared_rows(_EDITION)), (0, None))


def has_terrain_at(edition: Edition) -> bool:
    """Whether there is any terrain model. What brings one in, or takes it out, makes a new edition."""
    return has_terrain() if edition[1] is None else _had_terrain(edition)  # a ground never marked as changed has no edition


@lru_cache(maxsize=4)
def _had_terrain(edition: Edition) -> bool:
    return has_terrain()
