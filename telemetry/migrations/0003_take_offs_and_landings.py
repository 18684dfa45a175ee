"""Take-offs and landings of UAVs in missions."""

import django.db.models.deletion
from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [
        ("missions", "0002_return_height_command"),
        ("telemetry", "0002_alerts_that_wait_to_be_seen"),
    ]

    operations = [
        migrations.CreateModel(
            name="FlightEvent",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                ("kind", models.CharField(choices=[("take-off", "Take-off"), ("landing", "Landing")], max_length=10)),
                ("at", models.DateTimeField(help_text="of the first report of it")),
                (
                    "mission",
                    models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name="flight_events", to="missions.mission"),
                ),
                ("uav", models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name="flight_events", to="missions.uav")),
            ],
            options={
                "ordering": ["-at", "-pk"],
                "constraints": [
                    models.UniqueConstraint(fields=("mission", "uav", "kind", "at"), name="flight_event_once"),
                    models.CheckConstraint(
                        condition=models.Q(("kind__in", ["take-off", "landing"])), name="flight_event_kind_known"
                    ),
                ],
            },
        ),
    ]
