"""Uploads, proposals and their changes."""

from typing import TYPE_CHECKING
from uuid import UUID

from django.contrib.gis.db.models.functions import AsGeoJSON
from django.db.models import QuerySet

from inspection.models import ImportProposal, ProposedChange, Upload
from inspection.selectors.assets import AsDrawn

if TYPE_CHECKING:
    from django_stubs_ext import WithAnnotations

    DrawnChange = WithAnnotations[ProposedChange, AsDrawn]
else:
    DrawnChange = ProposedChange
COORDINATE_DIGITS = 7
NEWEST_FIRST = ("-created_at", "-pk")


def proposals(*, kind: str = "", states: list[str] | None = None) -> QuerySet[ImportProposal]:
    found = ImportProposal.objects.select_related("job", "created_by", "decided_by", "upload")
    if kind:
        found = found.filter(kind=kind)
    return found.filter(state__in=states) if states else found


def proposal_of_id(proposal_id: UUID) -> ImportProposal:
    """Return a proposal. Raises ImportProposal.DoesNotExist."""
    return proposals().get(pk=proposal_id)


def changes_of_proposal(proposal: ImportProposal, *, action: str = "") -> QuerySet[DrawnChange]:
    changes = proposal.changes.defer("geometry").annotate(geometry_json=AsGeoJSON("geometry", precision=COORDINATE_DIGITS))
    return changes.filter(action=action) if action else changes


def upload_of_id(upload_id: UUID) -> Upload:
    """Return an upload. Raises Upload.DoesNotExist."""
    return Upload.objects.get(pk=upload_id)
