"""A planned mission on a sane world, rehearsed in this process."""

from typing import Any

from missions.models import Mission
from missions.selectors.missions import mission_of_organisation
from planning.energy.conditions import conditions_from_json
from simulation.models import Rehearsal
from simulation.rehearsing.weather_scenario import Named, WeatherScenario, named_scenario
from simulation.services.rehearsals import start_rehearsal
from simulation.tasks import rehearse_mission
from workspace.models import User


def scenarios(mission: Mission, *names: str) -> list[WeatherScenario]:
    planned = conditions_from_json(loaded(mission).conditions or None)
    return [named_scenario(Named(name), planned) for name in names or ("calm",)]


def loaded(mission: Mission) -> Mission:
    return mission_of_organisation(mission.organisation, mission.pk)


def asked(mission: Mission, actor: User, *names: str, **more: Any) -> Rehearsal:
    """It waits for a worker."""
    return start_rehearsal(mission=loaded(mission), actor=actor, scenarios=scenarios(mission, *names), **more)


def rehearsed(mission: Mission, actor: User, *names: str, **more: Any) -> Rehearsal:
    rehearsal = asked(mission, actor, *names, **more)
    rehearse_mission(str(rehearsal.job_id))
    return Rehearsal.objects.select_related("job").get(pk=rehearsal.pk)
