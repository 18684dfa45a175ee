"""What a request names: an organisation's missions, UAVs and targets, and assets."""

from typing import Any
from uuid import UUID

from django.utils.translation import gettext as _

from inspection.models import Asset
from inspection.views.parameters import invalid
from missions.models import InspectionTarget, Mission, Uav
from missions.selectors import fleet
from results.services.uploads import Subject
from workspace.models import User


def subject_of(user: User, named: dict[str, Any]) -> Subject:
    """Return the rows that a validated body names. Raises ApiProblem 400 for one that is not the organisation's."""
    target = _target(user, named["target"]) if named.get("target") else None
    mission = _mission(user, named["mission"]) if named.get("mission") else target.mission if target is not None else None
    if target is not None and mission is not None and target.mission_id != mission.pk:
        raise invalid("target", _("The target belongs to another mission."))
    return Subject(
        mission=mission,
        uav=_uav(user, named["uav"]) if named.get("uav") else None,
        target=target,
        asset=_asset(named["asset"]) if named.get("asset") else None,
    )


def _mission(user: User, mission_id: UUID) -> Mission:
    found = Mission.objects.filter(organisation=user.organisation_id, deleted_at=None, pk=mission_id).first()
    if found is None:
        raise invalid("mission", _("There is no such mission."))
    return found


def _target(user: User, target_id: int) -> InspectionTarget:
    own = InspectionTarget.objects.filter(mission__organisation=user.organisation_id, mission__deleted_at=None)
    found = own.select_related("mission", "asset").filter(pk=target_id).first()
    if found is None:
        raise invalid("target", _("There is no such target."))
    return found


def _uav(user: User, uav_id: int) -> Uav:
    found = fleet.uavs_of_organisation(user.organisation).filter(pk=uav_id).first()
    if found is None:
        raise invalid("uav", _("There is no such UAV."))
    return found


def _asset(asset_id: int) -> Asset:
    found = Asset.objects.filter(pk=asset_id).first()
    if found is None:
        raise invalid("asset", _("There is no such asset."))
    return found
