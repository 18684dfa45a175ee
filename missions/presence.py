"""Who has a mission open: each page says so every few seconds, and is forgotten soon after it falls silent.

It stands in the cache alone. Of two pages that report at the same moment one may be missed; its next report puts it back.
"""

import contextlib
import time
from uuid import UUID

from django.core.cache import cache

from workspace.cache_absence import CACHE_AWAY
from workspace.models import User

FORGOTTEN_AFTER_S = 25  # a page reports every 6 s while it is looked at
MOST_PAGES = 20  # of one user, the last that reported


def _key(mission_id: UUID) -> str:
    return f"mission-open:{mission_id}"


def report_presence(*, mission_id: UUID, user: User, editor: str, is_here: bool) -> list[tuple[int, str]]:
    """Note that this page is there, or leaves. Returns user and name of the others, each user once, oneself in another window last."""
    now_s = time.time()
    try:
        known = cache.get(_key(mission_id), {})
    except CACHE_AWAY:
        return []
    present = {page: row for page, row in known.items() if now_s - row["at_s"] < FORGOTTEN_AFTER_S}
    mine = f"{user.pk}/{editor}"
    present.pop(mine, None)
    others = {row["user"]: row["name"] for row in present.values()}
    if is_here:
        own = sorted((row["at_s"], page) for page, row in present.items() if row["user"] == user.pk)
        for _, page in own[: -(MOST_PAGES - 1)]:
            del present[page]
        present[mine] = {"user": user.pk, "name": user.get_full_name() or user.username, "at_s": now_s}
    with contextlib.suppress(*CACHE_AWAY):
        cache.set(_key(mission_id), present, FORGOTTEN_AFTER_S)
    return sorted(others.items(), key=lambda row: (row[0] == user.pk, row[1].casefold()))
