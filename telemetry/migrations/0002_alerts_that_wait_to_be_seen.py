"""An index of critical alerts that have ended and that nobody has acknowledged."""

from django.contrib.postgres.operations import AddIndexConcurrently
from django.db import migrations, models


class Migration(migrations.Migration):
    atomic = False
    dependencies = [("telemetry", "0001_squashed_0015_vehicle_type_of_a_link")]

    operations = [
        AddIndexConcurrently(
            model_name="alert",
            index=models.Index(
                condition=models.Q(("acknowledged_at", None), ("closed_at__isnull", False), ("level", "critical")),
                fields=["organisation", "closed_at"],
                name="alert_waits_to_be_seen_idx",
            ),
        ),
    ]
