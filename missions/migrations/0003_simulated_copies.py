"""Copies of missions that are flown in simulation, and the simulated twins that fly them."""

import django.db.models.deletion
from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("missions", "0002_return_height_command")]

    operations = [
        migrations.AddField(
            model_name="mission",
            name="simulates",
            field=models.ForeignKey(
                blank=True,
                help_text="the mission of which this is a copy with simulated twins of its UAVs",
                null=True,
                on_delete=django.db.models.deletion.CASCADE,
                related_name="simulated_copies",
                to="missions.mission",
            ),
        ),
        migrations.AddField(
            model_name="uav",
            name="twin_of",
            field=models.OneToOneField(
                blank=True,
                help_text="the UAV that it is the simulated twin of: it flies copies of that one's missions",
                null=True,
                on_delete=django.db.models.deletion.CASCADE,
                related_name="twin",
                to="missions.uav",
            ),
        ),
        migrations.AddConstraint(
            model_name="uav",
            constraint=models.CheckConstraint(
                condition=models.Q(("twin_of", None), ("is_simulated", True), _connector="OR"), name="uav_twin_is_simulated"
            ),
        ),
    ]
