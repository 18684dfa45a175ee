"""Starts of a mission's UAVs in planned order."""

import uuid

import django.db.models.deletion
from django.conf import settings
from django.db import migrations, models
from django.db.models import Q
from django.db.models.functions import Now


class Migration(migrations.Migration):
    dependencies = [("missions", "0032_index_of_results"), migrations.swappable_dependency(settings.AUTH_USER_MODEL)]

    operations = [
        migrations.CreateModel(
            name="PlannedStarts",
            fields=[
                ("id", models.UUIDField(default=uuid.uuid4, editable=False, primary_key=True, serialize=False)),
                ("created_at", models.DateTimeField(db_default=Now(), editable=False)),
                ("looked_at", models.DateTimeField(db_default=Now(), help_text="when its times were last compared with the clock")),
                ("ended_at", models.DateTimeField(blank=True, null=True)),
                (
                    "end",
                    models.CharField(
                        blank=True,
                        choices=[
                            ("done", "Every UAV was started or refused"),
                            ("stopped", "Stopped by a user"),
                            ("commanded", "A UAV of the mission was told to stop, hold, return or land"),
                            ("mission-over", "The mission is not on its way any more"),
                            ("interrupted", "Nobody could look after it for too long"),
                        ],
                        help_text="why it ended; empty: it goes on",
                        max_length=15,
                    ),
                ),
                ("uavs", models.JSONField(default=list, help_text="UAV, place, due time, state, command, reason")),
                (
                    "created_by",
                    models.ForeignKey(
                        null=True, on_delete=django.db.models.deletion.SET_NULL, related_name="+", to=settings.AUTH_USER_MODEL
                    ),
                ),
                (
                    "ended_by",
                    models.ForeignKey(
                        blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name="+", to=settings.AUTH_USER_MODEL
                    ),
                ),
                (
                    "mission",
                    models.ForeignKey(
                        on_delete=django.db.models.deletion.CASCADE, related_name="planned_starts", to="missions.mission"
                    ),
                ),
            ],
            options={
                "ordering": ["-created_at"],
                "verbose_name_plural": "planned starts",
                "constraints": [
                    models.UniqueConstraint(condition=Q(ended_at=None), fields=("mission",), name="planned_starts_one_open"),
                    models.CheckConstraint(
                        condition=Q(end__in=["", "done", "stopped", "commanded", "mission-over", "interrupted"]),
                        name="planned_starts_end_known",
                    ),
                ],
            },
        ),
    ]
