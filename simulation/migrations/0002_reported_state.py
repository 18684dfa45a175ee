"""The last report of a simulated vehicle by its new name; its columns keep the names that the version before writes."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("simulation", "0001_squashed_0004_one_vehicle_can_be_ended")]

    operations = [
        migrations.SeparateDatabaseAndState(
            state_operations=[
                migrations.RenameField("simulatedvehicle", "told", "reported"),
                migrations.RenameField("simulatedvehicle", "told_at", "reported_at"),
                migrations.AlterField(
                    "simulatedvehicle",
                    "reported",
                    models.JSONField(db_column="told", default=dict, help_text="how it does, as its simulator said last"),
                ),
                migrations.AlterField(
                    "simulatedvehicle", "reported_at", models.DateTimeField(blank=True, db_column="told_at", null=True)
                ),
            ]
        )
    ]
