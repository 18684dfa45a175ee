"""manage.py load_demo: the demo region's UAVs, their types and bases, and the first administrator of an empty installation."""

from pathlib import Path
from typing import Any

from django.core.management.base import BaseCommand, CommandError, CommandParser
from django.db import transaction

from inspection.demo_region import BASES
from missions.services.fleet.demo_uavs import create_demo_uavs
from workspace.models import DEFAULT_ORGANISATION_ID, Organisation, Role, User


class Command(BaseCommand):
    help = "Create the demo region's UAVs; with --user and --password-file also an administrator, if nobody has an account yet."

    def add_arguments(self, parser: CommandParser) -> None:
        parser.add_argument("--user", metavar="NAME", help="name of the administrator to make")
        parser.add_argument("--password-file", metavar="FILE", type=Path, help="its first line is the administrator's password")

        parser.add_argument("--no-uavs", action="store_true", help="leave the UAVs out: the data are not the demo region's")

    def handle(self, *args: Any, user: str | None, password_file: Path | None, no_uavs: bool, **options: Any) -> None:
        if (user is None) != (password_file is None):
            raise CommandError("--user and --password-file go together.")
        with transaction.atomic():
            if not no_uavs:
                created = create_demo_uavs(organisation=Organisation.objects.get(pk=DEFAULT_ORGANISATION_ID))
                self.stdout.write(f"{created} UAVs created at {len(BASES)} bases.")
            if user is not None and password_file is not None:
                self.stdout.write(_create_first_administrator(user, _first_line(password_file)))


def _create_first_administrator(name: str, password: str) -> str:
    if User.objects.exists():
        return "There are accounts already; no administrator made."
    User.objects.create_superuser(username=name, password=password, role=Role.ADMINISTRATOR)
    return f"Administrator {name} made."


def _first_line(path: Path) -> str:
    try:
        password = path.read_text().partition("\n")[0].strip()
    except OSError as error:
        raise CommandError(f"The password file cannot be read: {error.strerror}.") from error
    if not password:
        raise CommandError("The password file is empty.")
    return password
