"""Within which bounds a difference is applied without anybody looking at it."""

from collections.abc import Mapping
from typing import Any

from inspection.auto_apply_hooks import HeldBack
from inspection.models import ImportKind

KINDS = (ImportKind.OSM, ImportKind.ZONES, ImportKind.ASSETS)  # terrain lies under everything: somebody looks at it
_KNOWN = ("changed", "vanished", "kept", "unchanged")  # rows that the source has had before


def reasons_against(numbers: Mapping[str, int], content: Mapping[str, Any], max_removed_percent: float) -> list[HeldBack]:
    """What in a difference asks for somebody to look at it.

    numbers are of all changes by action; content is what was read, with the records that were not.
    """
    reasons = []
    if content.get("needs_mapping"):
        reasons.append(HeldBack("needs_mapping", "The columns of the file are not explained yet."))
    not_read = len(content.get("not_read", ())) + content.get("faulty_rows_left_out", 0)
    if not_read:
        reasons.append(HeldBack("not_read", f"Records of the file that have a fault and are left out: {not_read}."))
    if unread_values := sum(content.get("unread_values", {}).values()):
        reasons.append(HeldBack("not_read", f"Values of the file that cannot be read and would be empty: {unread_values}."))
    removed, known = numbers.get("vanished", 0), sum(numbers.get(action, 0) for action in _KNOWN)
    if removed * 100.0 > max_removed_percent * known:
        percent = f"{removed * 100.0 / known:.3g}"
        message = f"It removes {removed} of {known} rows of its source, {percent} %; at most {max_removed_percent:g} % may be removed."
        reasons.append(HeldBack("removed", message))
    return reasons
