"""Standard names of three fields; their columns keep the names that the version before writes."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("simulation", "0002_reported_state")]

    operations = [
        migrations.SeparateDatabaseAndState(
            state_operations=[
                migrations.RenameField("simulatedvehicle", "flavour", "autopilot_type"),
                migrations.AlterField(
                    "simulatedvehicle",
                    "autopilot_type",
                    models.CharField(
                        choices=[("px4", "PX4"), ("ardupilot", "ArduPilot")], db_column="flavour", default="px4", max_length=10
                    ),
                ),
                migrations.RenameField("simulation", "pace", "step_timing"),
                migrations.AlterField(
                    "simulation",
                    "step_timing",
                    models.JSONField(db_column="pace", default=dict, help_text="how the clock was kept: steps, late ones, what has slipped"),
                ),
                migrations.RenameField("rehearsalrun", "verdict", "assessment"),
                migrations.AlterField(
                    "rehearsalrun",
                    "assessment",
                    models.JSONField(blank=True, db_column="verdict", help_text="see assessment/stored.py", null=True),
                ),
            ]
        )
    ]
