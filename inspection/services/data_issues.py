"""Search for data issues after each change of the map data, and curators' decisions."""

import logging
from collections.abc import Sequence
from datetime import datetime
from time import perf_counter

from django.contrib.gis.geos import GEOSGeometry, Point
from django.db import transaction
from django.utils import timezone

from inspection.models import Asset, DataIssue, DataIssueSearch, DataIssueState
from inspection.quality.infrastructure import FoundIssue
from inspection.quality.repair import RECIPE, search
from inspection.selectors.ground import ground_dataset_version
from inspection.selectors.issue_search_data import issue_search_data
from workspace.audit import record_change
from workspace.leases import try_lock_until_end
from workspace.models import User

logger = logging.getLogger(__name__)

SEARCH_LOCK = 5_372_002  # advisory lock
BATCH = 2_000
AT_ONCE_S = 2.0  # a search at most this long runs while the curator waits
_FOUND = ("asset", "other_asset", "position", "geometry", "details", "cut_off_m", "ground_revision")


def issues_are_current() -> bool:
    """Whether the last search used the current map data and rules."""
    revision, changed_at = ground_dataset_version()
    last = DataIssueSearch.objects.filter(pk=DataIssueSearch.SINGLE_ID).first()
    if last is None:
        return revision == 0
    return (last.ground_revision, last.ground_changed_at, last.recipe) == (revision, changed_at, RECIPE)


def find_issues(*, force: bool = False) -> DataIssueSearch | None:
    """Search the map data if they have changed since the last search; None when nothing is to do or another search runs.

    A recurring issue keeps its state and note, a repaired one that is back opens again, and one that is no longer found counts as repaired.
    """
    if issues_are_current() and not force:
        return None
    with transaction.atomic():
        is_ours = try_lock_until_end(SEARCH_LOCK)
        if not is_ours or (issues_are_current() and not force):
            return None
        return _search_and_store()


def find_issues_at_once() -> bool:
    """Search while a user waits, if the last search was short; returns whether the issues are current."""
    last = DataIssueSearch.objects.filter(pk=DataIssueSearch.SINGLE_ID).first()
    if last is not None and last.search_s <= AT_ONCE_S:
        find_issues()
    return issues_are_current()


def dismiss_issue(*, issue: DataIssue, note: str, actor: User) -> DataIssue:
    """Dismiss an issue: it stays out of the open list when it is found again."""
    return _decide(issue, DataIssueState.DISMISSED, note, actor)


def reopen_issue(*, issue: DataIssue, actor: User) -> DataIssue:
    return _decide(issue, DataIssueState.OPEN, "", actor)


def mark_repaired(*, issue: DataIssue, actor: User) -> DataIssue:
    return _decide(issue, DataIssueState.REPAIRED, "", actor)


def _decide(issue: DataIssue, state: DataIssueState, note: str, actor: User) -> DataIssue:
    with transaction.atomic():
        kept = DataIssue.objects.select_for_update(of=["self"]).get(pk=issue.pk)
        before = {"state": kept.state, "note": kept.note}
        kept.state, kept.note = state, note
        kept.decided_by, kept.decided_at = actor, timezone.now()
        kept.save(update_fields=["state", "note", "decided_by", "decided_at"])
        record_change(
            organisation=actor.organisation,
            actor=actor,
            action="changed",
            subject_type="gap",
            subject_id=kept.pk,
            before=before,
            after={"state": state.value, "note": note},
        )
    return kept


def _search_and_store() -> DataIssueSearch:
    started_s, started_at = perf_counter(), timezone.now()
    _, changed_at = ground_dataset_version()
    ground = issue_search_data()
    found = search(ground)
    there = _still_there(found)
    found = [issue for issue in found if issue.asset in there]
    keys = {issue.key for issue in found}
    states = {key: (pk, state, decided_at) for key, pk, state, decided_at in _known()}
    for first in range(0, len(found), BATCH):
        rows = [_row(issue, ground.revision, there) for issue in found[first : first + BATCH]]
        DataIssue.objects.bulk_create(rows, update_conflicts=True, unique_fields=["key"], update_fields=list(_FOUND))
    # Issues repaired during this search are gone: the next one decides.
    back = [
        pk
        for key, (pk, state, decided_at) in states.items()
        if state == DataIssueState.REPAIRED and key in keys and (decided_at is None or decided_at < started_at)
    ]
    gone = [pk for key, (pk, state, _) in states.items() if state == DataIssueState.OPEN and key not in keys]
    for first in range(0, len(back), BATCH):
        rows_back = DataIssue.objects.filter(pk__in=back[first : first + BATCH])
        rows_back.update(state=DataIssueState.OPEN, decided_by=None, decided_at=None, note="")
    for first in range(0, len(gone), BATCH):
        DataIssue.objects.filter(pk__in=gone[first : first + BATCH]).update(
            state=DataIssueState.REPAIRED, decided_by=None, decided_at=started_at
        )
    last, _ = DataIssueSearch.objects.update_or_create(
        pk=DataIssueSearch.SINGLE_ID,
        defaults={
            "ground_revision": ground.revision,
            "ground_changed_at": changed_at,
            "recipe": RECIPE,
            "found": len(found),
            "search_s": perf_counter() - started_s,
            "searched_at": timezone.now(),
        },
    )
    logger.info("issues of ground %d: %d found, %d new or back, %d gone", ground.revision, len(found), len(keys - states.keys()), len(gone))
    return last


def _known() -> Sequence[tuple[str, int, str, datetime | None]]:
    return list(DataIssue.objects.order_by().values_list("key", "pk", "state", "decided_at"))


def _still_there(found: Sequence[FoundIssue]) -> set[int]:
    """Return the assets of the issues that were not deleted during the search."""
    wanted = {issue.asset for issue in found} | {issue.other_asset for issue in found if issue.other_asset is not None}
    return set(Asset.objects.filter(pk__in=wanted).order_by().values_list("pk", flat=True))


def _row(issue: FoundIssue, revision: int, there: set[int]) -> DataIssue:
    return DataIssue(
        kind=issue.kind,
        key=issue.key[:200],
        asset_id=issue.asset,
        other_asset_id=issue.other_asset if issue.other_asset in there else None,
        position=Point(issue.position, srid=4326),
        geometry=GEOSGeometry(memoryview(issue.geometry.wkb), srid=4326),
        details=issue.details,
        cut_off_m=issue.cut_off_m,
        ground_revision=revision,
    )
