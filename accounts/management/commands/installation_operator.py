"""Makes an administrator an installation operator, or revokes that: manage.py installation_operator USER [--remove]."""

from argparse import ArgumentParser
from typing import Any

from django.core.management.base import BaseCommand, CommandError

from accounts.users import set_installation_operator
from workspace.models import Role, User


class Command(BaseCommand):
    help = "Let an administrator see and change the rows of all organisations in the admin, or take that away. It stands in the history."

    def add_arguments(self, parser: ArgumentParser) -> None:
        parser.add_argument("user", help="user name of an administrator")
        parser.add_argument("--remove", action="store_true", help="take it away")

    def handle(self, *args: Any, **options: Any) -> None:
        user = User.objects.filter(username=options["user"], role=Role.ADMINISTRATOR, is_service=False).first()
        if user is None:
            raise CommandError(f"no administrator is called {options['user']}")
        set_installation_operator(user=user, is_operator=not options["remove"])
        self.stdout.write(f"{user} is {'no longer' if options['remove'] else 'now'} an installation operator.")
