"""Inspections of assets: targets that an aircraft has completed."""

from django.db.models import Exists, OuterRef, QuerySet
from django.db.models.functions import Coalesce

from missions.models import InspectionTarget, MissionUav, TargetState


def inspections_of_assets(organisation_id: int) -> QuerySet[InspectionTarget]:
    """Return an organisation's completed targets with `inspected_at`; missions with simulated UAVs inspect nothing."""
    simulated = MissionUav.objects.filter(mission=OuterRef("mission"), uav__is_simulated=True)
    done = InspectionTarget.objects.filter(
        mission__organisation=organisation_id, mission__deleted_at=None, state=TargetState.COMPLETE, asset__isnull=False
    )
    return done.filter(~Exists(simulated)).annotate(inspected_at=Coalesce("reached_at", "state_at"))
