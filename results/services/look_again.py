"""From findings back to flight: a mission that takes the same photos of what they are on."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from missions.models import InspectionTarget, Mission
from missions.models.missions import MAX_NAME_LENGTH
from missions.services.mission_copies import request_again
from missions.services.missions import create_mission
from planning.problem import Objective
from planning.request import PlanRequest, TargetRequest
from planning.task import DEFAULT_HOLD_S, Task, TaskKind
from results.models import Finding
from results.services.findings import FindingRefused
from workspace.models import User

PHOTO = Task(TaskKind.PHOTO, DEFAULT_HOLD_S[TaskKind.PHOTO])


def draft_look_again(*, findings: Sequence[Finding], actor: User, name: str = "") -> Mission:
    """Create a draft of the targets on which the findings were made, each once, with the tasks and photos of then.

    A finding without a target is looked at where its asset was last a target, else with a stop for photos over the asset or where the
    photo was taken. UAVs and constraints are those of the newest of these missions. Raises FindingRefused where nothing is left on the
    map, and InvalidRequest.
    """
    targets = {finding.pk: _target_of(finding) for finding in findings}
    missions = {target.mission for target in targets.values() if target is not None}
    newest = max(missions, key=lambda mission: mission.created_at, default=None)
    base = PlanRequest(uavs=(), targets=(), objective=Objective.TOTAL, return_to_start=True)
    if newest is not None:
        base = request_again(newest, ())
    again = {mission.pk: _wishes(mission, targets.values()) for mission in missions}
    known = {uav.name for uav in base.uavs}
    wishes: list[TargetRequest] = []
    for finding in findings:
        target = targets[finding.pk]
        wish = _without_target(finding) if target is None else again[target.mission_id][target.sequence]
        if wish is None or (wish.asset is None and wish.position is None):
            continue
        wish = replace(wish, uav=wish.uav if wish.uav in known else "")
        if not any(_is_same(wish, other) for other in wishes):
            wishes.append(wish)
    if not wishes:
        raise FindingRefused("findings", _("Nothing of these findings is on the map any more."))
    return create_mission(
        organisation=actor.organisation,
        author=actor,
        name=(name or _name(findings))[:MAX_NAME_LENGTH],
        request=replace(base, targets=tuple(wishes)),
    )


def _target_of(finding: Finding) -> InspectionTarget | None:
    """The target on which it was made; else the newest of its asset, photos of planned poses first."""
    own = InspectionTarget.objects.filter(mission__organisation=finding.organisation_id, mission__deleted_at=None).select_related(
        "mission__simulates"
    )
    if finding.target_id is not None:
        return own.filter(pk=finding.target_id).first()
    if finding.asset_id is None:
        return None
    of_asset = own.filter(asset=finding.asset_id).order_by("-mission__created_at", "sequence")
    return of_asset.filter(task__has_key="views").first() or of_asset.filter(stretch=None).first()


def _wishes(mission: Mission, targets: Collection[InspectionTarget | None]) -> dict[int, TargetRequest]:
    """The requests of those of the targets that are of a mission, by their places."""
    places = sorted({target.sequence for target in targets if target is not None and target.mission_id == mission.pk})
    return dict(zip(places, request_again(mission, places).targets, strict=True))


def _without_target(finding: Finding) -> TargetRequest | None:
    if finding.asset_id is not None:
        return TargetRequest(asset=finding.asset_id, task=PHOTO)
    position = finding.position
    return None if position is None else TargetRequest(position=LonLat(position.x, position.y), task=PHOTO)


def _is_same(one: TargetRequest, other: TargetRequest) -> bool:
    return (one.asset, one.position, one.stretch, one.task) == (other.asset, other.position, other.stretch, other.task)


def _name(findings: Sequence[Finding]) -> str:
    first = findings[0].asset_label or f"#{findings[0].number}"
    if len({finding.asset_label for finding in findings}) == 1:
        return _("Look again: %(asset)s") % {"asset": first}
    return _("Look again: %(asset)s and others") % {"asset": first}
