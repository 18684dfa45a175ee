"""Write the current planning context of a mission to a file, for replay_plan."""

from pathlib import Path
from typing import Any

from django.core.exceptions import ValidationError
from django.core.management import BaseCommand, CommandError, CommandParser

from inspection.selectors import NoGraph
from missions.models import Mission
from missions.selectors.planning_context import planning_context, read_targets
from missions.services import InvalidRequest, NothingToPlan, plannable_request
from planning.context_file import write_context


class Command(BaseCommand):
    help = "Writes the request of a mission with the network, zones, terrain and other flights of now to FILE; see replay_plan."

    def add_arguments(self, parser: CommandParser) -> None:
        parser.add_argument("mission", help="the mission's id")
        parser.add_argument("file", type=Path)

    def handle(self, *args: Any, **options: Any) -> None:
        try:
            request = plannable_request(mission=Mission.objects.get(pk=options["mission"]))
            context = planning_context(request, *read_targets(request))
            write_context(options["file"], context, request)
        except (Mission.DoesNotExist, ValidationError) as error:
            raise CommandError(f"There is no mission {options['mission']}.") from error
        except NothingToPlan as error:
            raise CommandError("The mission has no UAVs or no targets.") from error
        except NoGraph as error:
            raise CommandError("There is no network yet. Import infrastructure first.") from error
        except (InvalidRequest, OSError) as error:
            raise CommandError(str(error)) from error
        self.stdout.write(f"{options['file']}: {len(request.targets)} targets, {len(request.uavs)} UAVs, {len(context.zones)} zones")
