"""What an organisation may ask for before a mission is approved: a rehearsal of this plan, in the air it is planned for, without a fail."""

from django.db import transaction
from django.utils.translation import gettext as _

from inspection.selectors.planning import planning_read
from missions.models import Mission
from missions.services.commands.refused import Reason, Refused
from simulation.models import Rehearsal, RehearsalRule, VerdictLevel
from simulation.rehearsing.weather_scenario import Named, named_sky, sky_to_json
from simulation.selectors import newest_finished, rehearsals_of_mission, requires_green
from simulation.services.plan_to_fly import PlanToFly, plan_to_fly
from simulation.services.surroundings import ground_of_plan
from workspace.audit import record_change
from workspace.models import Organisation, User


def reasons_without_rehearsal(mission: Mission) -> list[Reason]:
    """Why a mission may not be approved yet, and what to do; none where nobody asks for a rehearsal."""
    if not requires_green(mission.organisation_id):
        return []
    try:
        plan = plan_to_fly(mission)
    except Refused as refused:
        return list(refused.reasons)
    newest = newest_finished(mission.pk, plan.content_sha256)
    if newest is None:
        if rehearsals_of_mission(mission.organisation, mission.pk).exclude(level="").exists():
            words = _("The plan has changed since it was rehearsed. Rehearse it again: your organisation approves only what has passed.")
            return [Reason("rehearsal_outdated", words)]
        return [Reason("not_rehearsed", _("Rehearse the mission first: your organisation approves only what has passed."))]
    if newest.level == VerdictLevel.FAIL:
        words = _("The rehearsal failed. Change the plan for what its verdict says, plan and rehearse it again.")
        return [Reason("rehearsal_failed", words)]
    if not newest.runs.filter(conditions__code=str(Named.AS_PLANNED)).exists():
        words = _("The rehearsal left out the conditions that the mission is planned for. Rehearse it again with them.")
        return [Reason("rehearsal_without_planned_conditions", words)]
    if not newest.runs.filter(conditions=sky_to_json(named_sky(Named.AS_PLANNED, plan.conditions))).exists():
        words = _("The mission is planned for other wind or temperature than it was rehearsed in. Rehearse it again.")
        return [Reason("rehearsal_in_other_air", words)]
    if not _is_on_this_ground(newest, plan):
        words = _("Zones, terrain, towers or wires about the routes have changed since the mission was rehearsed. Rehearse it again.")
        return [Reason("rehearsal_on_other_ground", words)]
    return []


def _is_on_this_ground(rehearsal: Rehearsal, plan: PlanToFly) -> bool:
    """Whatever has changed elsewhere since. The revision does not tell: a newer network of the same ground has other towers and wires."""
    return rehearsal.ground_sha256 == ground_of_plan(plan, planning_read().ground())


def set_rule(*, organisation: Organisation, actor: User, requires: bool) -> RehearsalRule:
    with transaction.atomic():
        before = requires_green(organisation.pk)
        rule, _made = RehearsalRule.objects.update_or_create(organisation=organisation, defaults={"requires_green": requires})
        if before != requires:
            record_change(
                organisation=organisation, actor=actor, action="changed", subject_type="rehearsal rule", subject_id=organisation.pk,
                before={"requires_green": before}, after={"requires_green": requires},
            )  # fmt: skip
    return rule
