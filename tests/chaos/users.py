"""A program: makes operators with tokens where the environment leads to, and tells what an experiment asks with, as JSON.

python -m tests.chaos.users [ORGANISATION]
"""

import json
import os
import sys
from datetime import timedelta

import django

OPERATORS = 12
TARGETS = 200


def main(organisation: int) -> None:
    django.setup()
    from django.utils import timezone  # noqa: PLC0415 - Django is set up by now

    from inspection.models import Asset, AssetKind  # noqa: PLC0415
    from missions.models import Uav  # noqa: PLC0415
    from workspace.api_tokens import create_api_token  # noqa: PLC0415
    from workspace.models import Role, User  # noqa: PLC0415

    ends_at = timezone.now() + timedelta(days=1)
    tokens = []
    for number in range(OPERATORS):
        user = User.objects.create_user(f"chaos-{number}", role=Role.OPERATOR, organisation_id=organisation)
        tokens.append(create_api_token(user=user, name="chaos", expires_at=ends_at))
    uavs = Uav.objects.filter(organisation=organisation).exclude(location=None).order_by("pk")
    towers = Asset.objects.filter(kind=AssetKind.TOWER, vanished_at=None).order_by("pk")[:TARGETS]
    print(
        json.dumps(
            {
                "operators": tokens,
                "towers": [tower.pk for tower in towers],
                "uavs": [{"name": uav.name, "position": list(uav.location.coords)} for uav in uavs],
            }
        )
    )


if __name__ == "__main__":
    os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
