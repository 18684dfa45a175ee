import django.contrib.gis.db.models.fields
import django.contrib.postgres.fields
import django.db.models.deletion
import django.db.models.functions.datetime
from django.conf import settings
from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [
        ("missions", "0005_even_routes"),
        ("workspace", "0004_people"),
        migrations.swappable_dependency(settings.AUTH_USER_MODEL),
    ]

    operations = [
        migrations.AddField(
            model_name="mission",
            name="last_plan",
            field=models.JSONField(blank=True, help_text="summary of the plan before the present one, to compare with", null=True),
        ),
        migrations.AddField(
            model_name="uav",
            name="mavlink_system_id",
            field=models.PositiveSmallIntegerField(blank=True, help_text="1 to 254; one vehicle each", null=True, unique=True),
        ),
        migrations.AddField(
            model_name="uav",
            name="revision",
            field=models.PositiveIntegerField(default=1, help_text="counts the changes; the ETag"),
        ),
        migrations.AddField(
            model_name="uav",
            name="serial_number",
            field=models.CharField(blank=True, max_length=100),
        ),
        migrations.AddField(
            model_name="uav",
            name="state",
            field=models.CharField(
                choices=[("active", "Active"), ("maintenance", "In maintenance"), ("retired", "Retired")], default="active", max_length=12
            ),
        ),
        migrations.AlterField(
            model_name="uav",
            name="base_name",
            field=models.CharField(
                blank=True, help_text="the base's name where it is one of the list; else as it was typed", max_length=100
            ),
        ),
        migrations.CreateModel(
            name="Base",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                ("name", models.CharField(max_length=100)),
                ("location", django.contrib.gis.db.models.fields.PointField(srid=4326)),
                ("note", models.CharField(blank=True, max_length=300)),
                ("revision", models.PositiveIntegerField(default=1, help_text="counts the changes; the ETag")),
                ("created_at", models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ("updated_at", models.DateTimeField(auto_now=True)),
                (
                    "organisation",
                    models.ForeignKey(
                        default=1, on_delete=django.db.models.deletion.CASCADE, related_name="bases", to="workspace.organisation"
                    ),
                ),
            ],
            options={
                "ordering": ["name"],
            },
        ),
        migrations.AddField(
            model_name="uav",
            name="base",
            field=models.ForeignKey(
                blank=True, null=True, on_delete=django.db.models.deletion.PROTECT, related_name="uavs", to="missions.base"
            ),
        ),
        migrations.CreateModel(
            name="SavedSelection",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                ("name", models.CharField(max_length=100)),
                ("targets", models.JSONField(help_text="as in a mission's request, each with the label it had")),
                ("revision", models.PositiveIntegerField(default=1, help_text="counts the changes; the ETag")),
                ("created_at", models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ("updated_at", models.DateTimeField(auto_now=True)),
                (
                    "author",
                    models.ForeignKey(
                        blank=True,
                        null=True,
                        on_delete=django.db.models.deletion.SET_NULL,
                        related_name="saved_selections",
                        to=settings.AUTH_USER_MODEL,
                    ),
                ),
                (
                    "organisation",
                    models.ForeignKey(
                        default=1, on_delete=django.db.models.deletion.CASCADE, related_name="saved_selections", to="workspace.organisation"
                    ),
                ),
            ],
            options={
                "ordering": ["name"],
            },
        ),
        migrations.CreateModel(
            name="UavCredential",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                (
                    "kind",
                    models.CharField(
                        choices=[("link-token", "Token of the HTTP link"), ("mavlink-key", "MAVLink signing key")], max_length=12
                    ),
                ),
                ("token_sha256", models.CharField(blank=True, editable=False, max_length=64, null=True, unique=True)),
                ("key_salt", models.CharField(blank=True, editable=False, max_length=64)),
                ("created_at", models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ("last_used_at", models.DateTimeField(blank=True, null=True)),
                ("revoked_at", models.DateTimeField(blank=True, null=True)),
                (
                    "created_by",
                    models.ForeignKey(
                        blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name="+", to=settings.AUTH_USER_MODEL
                    ),
                ),
                ("uav", models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name="credentials", to="missions.uav")),
            ],
            options={
                "verbose_name": "UAV credential",
                "ordering": ["-created_at"],
            },
        ),
        migrations.CreateModel(
            name="UavType",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                ("name", models.CharField(max_length=100)),
                ("max_range_m", models.FloatField(blank=True, help_text="metres on one battery; empty = not limited", null=True)),
                ("cruise_speed_mps", models.FloatField(default=12.0)),
                ("battery_wh", models.FloatField(blank=True, help_text="watt-hours of a full battery", null=True)),
                ("mass_kg", models.FloatField(blank=True, help_text="kilograms at take-off", null=True)),
                (
                    "sensors",
                    django.contrib.postgres.fields.ArrayField(
                        base_field=models.CharField(max_length=50), blank=True, default=list, size=None
                    ),
                ),
                ("revision", models.PositiveIntegerField(default=1, help_text="counts the changes; the ETag")),
                ("created_at", models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ("updated_at", models.DateTimeField(auto_now=True)),
                (
                    "organisation",
                    models.ForeignKey(
                        default=1, on_delete=django.db.models.deletion.CASCADE, related_name="uav_types", to="workspace.organisation"
                    ),
                ),
            ],
            options={
                "verbose_name": "UAV type",
                "ordering": ["name"],
            },
        ),
        migrations.AddField(
            model_name="uav",
            name="uav_type",
            field=models.ForeignKey(
                blank=True, null=True, on_delete=django.db.models.deletion.PROTECT, related_name="uavs", to="missions.uavtype"
            ),
        ),
        migrations.AddConstraint(
            model_name="uav",
            constraint=models.CheckConstraint(
                condition=models.Q(("state__in", ["active", "maintenance", "retired"])), name="uav_state_known"
            ),
        ),
        migrations.AddConstraint(
            model_name="uav",
            constraint=models.CheckConstraint(
                condition=models.Q(("mavlink_system_id", None), ("mavlink_system_id__range", (1, 254)), _connector="OR"),
                name="uav_system_id_range",
            ),
        ),
        migrations.AddConstraint(
            model_name="base",
            constraint=models.UniqueConstraint(fields=("organisation", "name"), name="base_name_unique"),
        ),
        migrations.AddConstraint(
            model_name="savedselection",
            constraint=models.UniqueConstraint(fields=("organisation", "name"), name="saved_selection_name_unique"),
        ),
        migrations.AddConstraint(
            model_name="uavcredential",
            constraint=models.UniqueConstraint(
                condition=models.Q(("revoked_at", None)), fields=("uav", "kind"), name="uav_credential_one_in_force"
            ),
        ),
        migrations.AddConstraint(
            model_name="uavcredential",
            constraint=models.CheckConstraint(
                condition=models.Q(("kind__in", ["link-token", "mavlink-key"])), name="uav_credential_kind_known"
            ),
        ),
        migrations.AddConstraint(
            model_name="uavtype",
            constraint=models.UniqueConstraint(fields=("organisation", "name"), name="uav_type_name_unique"),
        ),
        migrations.AddConstraint(
            model_name="uavtype",
            constraint=models.CheckConstraint(
                condition=models.Q(("max_range_m", None), ("max_range_m__gt", 0), _connector="OR"), name="uav_type_range_positive"
            ),
        ),
        migrations.AddConstraint(
            model_name="uavtype",
            constraint=models.CheckConstraint(condition=models.Q(("cruise_speed_mps__gt", 0)), name="uav_type_speed_positive"),
        ),
        migrations.AddConstraint(
            model_name="uavtype",
            constraint=models.CheckConstraint(
                condition=models.Q(("battery_wh", None), ("battery_wh__gt", 0), _connector="OR"), name="uav_type_battery_positive"
            ),
        ),
        migrations.AddConstraint(
            model_name="uavtype",
            constraint=models.CheckConstraint(
                condition=models.Q(("mass_kg", None), ("mass_kg__gt", 0), _connector="OR"), name="uav_type_mass_positive"
            ),
        ),
    ]
