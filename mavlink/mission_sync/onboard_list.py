"""What a list on a vehicle is made of, in words."""

from collections.abc import Sequence
from enum import StrEnum

from mavlink.autopilot_type import Flavour
from mavlink.mission_sync.compare import differences, is_identical, is_same
from mavlink.mission_sync.wire import Held
from mavlink.vehicle_plan import MissionItem


class Found(StrEnum):
    NOTHING = "nothing"
    APPROVED = "approved"  # the list that is wanted
    KNOWN = "known"  # another whole list that was approved
    MIXED = "mixed"  # of parts of these
    FOREIGN = "foreign"  # with an item of none of these


def found(held: Held, wanted: Sequence[MissionItem], known: Sequence[Sequence[MissionItem]], flavour: Flavour) -> Found:
    """known: other lists that were approved for this vehicle. Lists of one mission often begin alike, so a mix is told only by them."""
    if not differences(wanted, held, flavour):
        return Found.APPROVED
    if not held:
        return Found.NOTHING
    if any(not differences(items, held, flavour) for items in known):
        return Found.KNOWN
    lists = [wanted, *(items for items in known if items)]
    if len(lists) == 1:
        return Found.FOREIGN
    is_of_some = (any(place in _of_list(held, items, flavour) for items in lists) for place in range(len(held)))
    return Found.MIXED if all(is_of_some) else Found.FOREIGN


def mix_in_words(held: Held, wanted: Sequence[MissionItem], before: Held | None, flavour: Flavour) -> str:
    """Which items are whose: "items 0-2 of 7 are new, 3-6 are of the list before"; `before` is None where it is not known."""
    new = _of_list(held, wanted, flavour)
    whose: list[str] = []
    for place, there in enumerate(held):
        is_old = before is not None and place < len(before) and is_identical(before[place], there)
        if place in new and is_old and whose:
            whose.append(whose[-1])  # the lists agree here
        elif place in new:
            whose.append("new")
        elif is_old:
            whose.append("of the list before")
        else:
            whose.append("of neither list" if before is not None else "not approved")
    runs: list[tuple[int, int, str]] = []
    for place, words in enumerate(whose):
        if runs and runs[-1][2] == words:
            runs[-1] = (runs[-1][0], place, words)
        else:
            runs.append((place, place, words))
    parts = [f"{first} is {words}" if first == last else f"{first}-{last} are {words}" for first, last, words in runs]
    return f"{len(held)} items where {len(wanted)} are approved: " + ", ".join(parts) if parts else "no items"


def _of_list(held: Held, items: Sequence[MissionItem], flavour: Flavour) -> set[int]:
    """The places at which it holds the item of this list."""
    return {place for place, (item, there) in enumerate(zip(items, held, strict=False)) if is_same(item, there.item, flavour)}
