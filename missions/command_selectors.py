"""Reads of the outbox, always within one organisation."""

from django.db.models import QuerySet

from missions.models import Mission, Uav, UavCommand
from workspace.models import Organisation


def commands_of_organisation(organisation: Organisation) -> QuerySet[UavCommand]:
    return UavCommand.objects.filter(organisation=organisation).select_related("uav", "created_by")


def commands_of_mission(mission: Mission) -> QuerySet[UavCommand]:
    return mission.commands.select_related("uav", "created_by")


def commands_of_uav(uav: Uav) -> QuerySet[UavCommand]:
    return uav.commands.select_related("uav", "created_by")
