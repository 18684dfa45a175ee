"""Which users have a mission open: each page reports every few seconds and expires soon after its last report.

The state is kept in the cache only. Of two pages that report at the same moment one may be lost until its next report.
"""

import contextlib
import time
from typing import NamedTuple
from uuid import UUID

from django.core.cache import cache

from workspace.cache_unavailable import CACHE_UNAVAILABLE
from workspace.models import User

FORGOTTEN_AFTER_S = 25  # a page reports every 6 s while it is visible
MAX_PAGES = 20  # of one user, the last that reported


class PresentUser(NamedTuple):
    """A user who has the mission open in another page."""

    user: int
    name: str
    is_planning: bool


def _key(mission_id: UUID) -> str:
    return f"mission-open:{mission_id}"


def report_presence(*, mission_id: UUID, user: User, editor: str, is_here: bool, is_planning: bool = False) -> list[PresentUser]:
    """Record that this page is open, and whether it plans the mission, or that it leaves.

    Returns the other users, each once, and the same user in another window last. A user plans if one of their pages does.
    """
    now_s = time.time()
    try:
        known = cache.get(_key(mission_id), {})
    except CACHE_UNAVAILABLE:
        return []
    present = {page: row for page, row in known.items() if now_s - row["at_s"] < FORGOTTEN_AFTER_S}
    mine = f"{user.pk}/{editor}"
    present.pop(mine, None)
    planners = {row["user"] for row in present.values() if row.get("is_planning")}
    others = {row["user"]: PresentUser(row["user"], row["name"], row["user"] in planners) for row in present.values()}
    if is_here:
        own = sorted((row["at_s"], page) for page, row in present.items() if row["user"] == user.pk)
        for _, page in own[: -(MAX_PAGES - 1)]:
            del present[page]
        present[mine] = {"user": user.pk, "name": user.display_name, "at_s": now_s, "is_planning": is_planning}
    with contextlib.suppress(*CACHE_UNAVAILABLE):
        cache.set(_key(mission_id), present, FORGOTTEN_AFTER_S)
    return sorted(others.values(), key=lambda other: (other.user == user.pk, other.name.casefold()))
