"""Makes a bearer token for a user: manage.py api_token USER [--days 90] [--name api] [--scope read]."""

from argparse import ArgumentParser
from datetime import timedelta
from typing import Any

from django.core.management.base import BaseCommand, CommandError
from django.utils import timezone

from workspace.api_tokens import create_api_token
from workspace.models import TokenScope, User

MAX_DAYS = 365


class Command(BaseCommand):
    help = "Make a bearer token for the API. The token is the last line of the output and is not shown again."

    def add_arguments(self, parser: ArgumentParser) -> None:
        parser.add_argument("user", help="user name")
        parser.add_argument("--days", type=int, default=90, help="how long it is valid (90)")
        parser.add_argument("--name", default="api", help="what it is for, shown in the admin")
        parser.add_argument("--scope", action="append", choices=TokenScope.values, help="may be repeated; all of the role unless told")

    def handle(self, *args: Any, **options: Any) -> None:
        if not 1 <= options["days"] <= MAX_DAYS:
            raise CommandError(f"--days: 1 to {MAX_DAYS}")
        try:
            user = User.objects.get(username=options["user"], is_active=True)
        except User.DoesNotExist as error:
            raise CommandError(f"no active user is called {options['user']}") from error
        expires_at = timezone.now() + timedelta(days=options["days"])
        token = create_api_token(user=user, name=options["name"][:100], expires_at=expires_at, scopes=options["scope"])
        self.stdout.write(f"Token of {user} ({user.get_role_display()}), valid until {expires_at:%Y-%m-%d %H:%M} UTC:")
        self.stdout.write(token)
