"""The ground's revision: counted up with every change to assets or zones."""

from django.db.models import F
from django.utils import timezone

from inspection.models import Ground
from workspace.leases import lock_until_end

GROUND_LOCK = 0x05A7_0001  # advisory lock: one at a time writes more of the ground than single rows


def hold_ground() -> None:
    """Wait for an import or a curator at work, and keep others waiting until the caller's transaction ends."""
    lock_until_end(GROUND_LOCK)


def mark_ground_changed() -> int:
    """Count one change of assets or zones and return the new revision.

    Call it in the transaction that makes the change: the row stays locked until that ends, so revisions become visible in order.
    """
    Ground.objects.get_or_create(pk=Ground.SINGLE_ID)
    Ground.objects.filter(pk=Ground.SINGLE_ID).update(revision=F("revision") + 1, changed_at=timezone.now())
    return Ground.objects.values_list("revision", flat=True).get(pk=Ground.SINGLE_ID)
