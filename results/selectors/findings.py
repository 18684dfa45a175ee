"""Reads of findings."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from datetime import date
from typing import Any
from uuid import UUID

from django.db.models import Prefetch, QuerySet

from inspection.models import Asset
from results.models import Evidence, Finding
from results.selectors.media import keys_of_asset
from workspace.models import AuditEntry


@dataclass(frozen=True, kw_only=True)
class FindingFilter:
    """Conditions of a list; None or empty for any."""

    states: Collection[str] = ()
    severities: Collection[int] = ()
    category: str = ""
    asset: Asset | None = None
    mission: UUID | None = None
    medium: UUID | None = None
    due_before: date | None = None


def findings_of_organisation(organisation_id: int) -> QuerySet[Finding]:
    return Finding.objects.filter(organisation=organisation_id)


def findings_that_match(organisation_id: int, wanted: FindingFilter) -> QuerySet[Finding]:
    """Return findings; those of a line include its supports'."""
    findings = findings_of_organisation(organisation_id)
    if wanted.states:
        findings = findings.filter(state__in=wanted.states)
    if wanted.severities:
        findings = findings.filter(severity__in=wanted.severities)
    if wanted.category:
        findings = findings.filter(category=wanted.category)
    if wanted.asset is not None:
        findings = findings.filter(asset__in=keys_of_asset(wanted.asset))
    if wanted.mission is not None:
        findings = findings.filter(mission=wanted.mission)
    if wanted.medium is not None:
        findings = findings.filter(pk__in=Finding.objects.filter(evidence__medium=wanted.medium).values("pk"))
    if wanted.due_before is not None:
        findings = findings.filter(due_on__lt=wanted.due_before)
    return findings.select_related("created_by").prefetch_related(Prefetch("evidence", Evidence.objects.select_related("author")))


def history_of_finding(finding: Finding) -> QuerySet[AuditEntry]:
    entries = AuditEntry.objects.filter(organisation=finding.organisation_id, subject_type="finding", subject_id=str(finding.pk))
    return entries.select_related("actor")


def exported(findings: QuerySet[Finding]) -> Iterator[Finding]:
    """Yield findings in a stable order, some hundred in memory at a time."""
    found: Any = findings.order_by("number").iterator(chunk_size=500)
    yield from found
