"""The constraint names the field as the model does; its column and its SQL are the same."""

from django.db import migrations, models
from django.db.models import Q

NAME = "simulated_vehicle_flavour_known"


class Migration(migrations.Migration):
    dependencies = [("simulation", "0003_standard_names")]

    operations = [
        migrations.SeparateDatabaseAndState(
            state_operations=[
                migrations.RemoveConstraint("simulatedvehicle", NAME),
                migrations.AddConstraint(
                    "simulatedvehicle", models.CheckConstraint(condition=Q(autopilot_type__in=["px4", "ardupilot"]), name=NAME)
                ),
            ]
        )
    ]
