"""Removes a user's authenticator app and passkeys, also of the last administrator: manage.py reset_second_factor USER."""

from argparse import ArgumentParser
from typing import Any

from django.core.management.base import BaseCommand, CommandError

from accounts.second_factors import reset_second_factors
from workspace.models import User


class Command(BaseCommand):
    help = "Take the second factor away from somebody who has lost it, and end their sessions. It stands in the history."

    def add_arguments(self, parser: ArgumentParser) -> None:
        parser.add_argument("user", help="user name")

    def handle(self, *args: Any, **options: Any) -> None:
        try:
            user = User.objects.get(username=options["user"])
        except User.DoesNotExist as error:
            raise CommandError(f"nobody is called {options['user']}") from error
        if not reset_second_factors(user=user, actor=None):
            raise CommandError(f"{user} has no second factor")
        self.stdout.write(f"{user} signs in with the password alone, or sets up another second factor where the organisation asks for one.")
