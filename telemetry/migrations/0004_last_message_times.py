"""Standard names of the times of messages; their columns keep the names that the version before writes."""

import django.db.models.functions.datetime
from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("telemetry", "0003_take_offs_and_landings")]

    operations = [
        migrations.SeparateDatabaseAndState(
            state_operations=[
                migrations.RenameField("uavlink", "heard_at", "last_message_at"),
                migrations.AlterField(
                    "uavlink",
                    "last_message_at",
                    models.DateTimeField(
                        blank=True, db_column="heard_at", help_text="when anything was last received, by the server's clock", null=True
                    ),
                ),
                migrations.AlterModelOptions("unknownvehicle", {"ordering": ["-last_message_at"]}),
                migrations.RenameField("unknownvehicle", "first_heard_at", "first_message_at"),
                migrations.AlterField(
                    "unknownvehicle",
                    "first_message_at",
                    models.DateTimeField(
                        db_column="first_heard_at", db_default=django.db.models.functions.datetime.Now(), editable=False
                    ),
                ),
                migrations.RenameField("unknownvehicle", "heard_at", "last_message_at"),
                migrations.AlterField("unknownvehicle", "last_message_at", models.DateTimeField(db_column="heard_at")),
            ]
        )
    ]
