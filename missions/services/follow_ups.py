"""A mission after the mission: a draft with the targets that were missed."""

from dataclasses import replace
from typing import Any

from django.utils.translation import gettext as _

from missions.models import ENDED_STATES, InspectionTarget, Mission, TargetState
from missions.models.missions import LONGEST_NAME
from missions.services.missions import create_mission, request_of_mission
from missions.services.refused import refuse
from workspace.models import User


def draft_follow_up(*, mission: Mission, author: User, name: str = "") -> Mission:
    """With the same UAVs and wishes, and no departure yet. What another mission that continues this one took over is left to that one.

    UAVs begin where they return to. Raises Refused where the mission is not over, or nothing was missed, and InvalidRequest where its
    targets cannot be asked for any more.
    """
    if mission.state not in ENDED_STATES:
        raise refuse("not_over", _("A follow-up is planned once the mission is over."))
    asked = request_of_mission(mission=mission)
    taken_over = {_what(target) for target in InspectionTarget.objects.filter(mission__continues=mission, mission__deleted_at=None)}
    missed = tuple(
        wish
        for wish, target in zip(asked.targets, mission.targets.all(), strict=True)
        if target.state != TargetState.COMPLETE and _what(target) not in taken_over
    )
    if not missed:
        raise refuse("nothing_missed", _("No target of this mission was missed."))
    uavs = tuple(replace(uav, position=uav.returns_to, home=None) for uav in asked.uavs)
    return create_mission(
        organisation=mission.organisation,
        author=author,
        name=(name or _("{name} – follow-up").format(name=mission.name[: LONGEST_NAME - 20]))[:LONGEST_NAME],
        request=replace(asked, uavs=uavs, targets=missed, locks=(), departs_at=None),
        external_id=mission.external_id,
        attributes=mission.attributes,
    )


def _what(target: InspectionTarget) -> tuple[Any, ...]:
    """Names what is inspected, in whichever mission."""
    return (target.asset_id, *(None if shape is None else shape.wkb for shape in (target.position, target.stretch)))
