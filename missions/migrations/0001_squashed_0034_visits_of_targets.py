"""The tables as they were after 0034_visits_of_targets: one migration instead of 34.

An installation that has applied all of them counts this one as applied. An older one is first updated
to the last version that has them.
"""

import uuid

import django.contrib.gis.db.models.fields
import django.contrib.postgres.fields
import django.db.models.constraints
import django.db.models.deletion
import django.db.models.functions.datetime
from django.conf import settings
from django.db import migrations, models


class Migration(migrations.Migration):
    replaces = [
        ("missions", "0001_initial"),
        ("missions", "0002_initial"),
        ("missions", "0003_mission_plan_warnings"),
        ("missions", "0004_names_in_the_admin"),
        ("missions", "0005_even_routes"),
        ("missions", "0006_fleet"),
        ("missions", "0007_uav_places_and_speeds"),
        ("missions", "0008_uav_heading"),
        ("missions", "0009_plan_wishes"),
        ("missions", "0010_route_base"),
        ("missions", "0011_safe_routes"),
        ("missions", "0012_hand_sorties_lost_link"),
        ("missions", "0013_speeds_by_hand"),
        ("missions", "0014_uav_own_performance"),
        ("missions", "0015_airspeed_not_stated"),
        ("missions", "0016_commands_and_approvals"),
        ("missions", "0017_command_axes"),
        ("missions", "0018_approvals_taken_back"),
        ("missions", "0019_figures_of_this_mission"),
        ("missions", "0020_routes_that_failed"),
        ("missions", "0021_live_monitoring"),
        ("missions", "0022_autopilots_own_return"),
        ("missions", "0023_fleet_figures_beside_own_ones"),
        ("missions", "0024_continuations"),
        ("missions", "0025_looks_of_live_pages"),
        ("missions", "0026_what_is_missing_of_a_refused_target"),
        ("missions", "0027_demo_data"),
        ("missions", "0028_credentials_overlap"),
        ("missions", "0029_retired_uavs_give_back_system_ids"),
        ("missions", "0030_external_ids"),
        ("missions", "0031_external_id_indexes"),
        ("missions", "0032_index_of_results"),
        ("missions", "0033_planned_starts"),
        ("missions", "0034_visits_of_targets"),
    ]

    initial = True

    dependencies = [
        ("inspection", "0001_squashed_0011_asset_references"),
        ("workspace", "0001_squashed_0010_service_accounts"),
        ("workspace", "__first__"),
    ]

    operations = [
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
                "constraints": [models.UniqueConstraint(fields=("organisation", "name"), name="base_name_unique")],
            },
        ),
        migrations.CreateModel(
            name="Mission",
            fields=[
                ("id", models.UUIDField(default=uuid.uuid4, editable=False, primary_key=True, serialize=False)),
                ("name", models.CharField(max_length=200)),
                (
                    "state",
                    models.CharField(
                        choices=[
                            ("draft", "Draft"),
                            ("planned", "Planned"),
                            ("approved", "Approved"),
                            ("dispatched", "Dispatched"),
                            ("active", "Active"),
                            ("completed", "Completed"),
                            ("aborted", "Aborted"),
                            ("failed", "Failed"),
                        ],
                        default="draft",
                        max_length=20,
                    ),
                ),
                (
                    "objective",
                    models.CharField(
                        choices=[
                            ("total", "Fly least"),
                            ("makespan", "Even routes"),
                            ("time", "Least flying time"),
                            ("energy", "Least energy"),
                        ],
                        default="total",
                        max_length=10,
                    ),
                ),
                ("return_to_start", models.BooleanField(default=False)),
                ("departs_at", models.DateTimeField(blank=True, help_text="planned take-off; empty = at any time", null=True)),
                (
                    "conditions",
                    models.JSONField(blank=True, default=dict, help_text="wind by height and temperature; see planning/energy/conditions.py"),
                ),
                ("charging_w", models.FloatField(blank=True, help_text="watts of charging at towers on the way; empty = none", null=True)),
                (
                    "lost_link",
                    models.JSONField(blank=True, default=dict, help_text="what UAVs do without a link; see services/planning/requests.py"),
                ),
                ("revision", models.PositiveIntegerField(default=1, help_text="counts the changes; the ETag")),
                ("planned_at", models.DateTimeField(blank=True, null=True)),
                ("graph_version", models.BigIntegerField(blank=True, help_text="the graph that the routes were planned on", null=True)),
                (
                    "ground_revision",
                    models.PositiveBigIntegerField(blank=True, help_text="the ground that the routes were checked against", null=True),
                ),
                ("flat_ground_assumed", models.BooleanField(blank=True, null=True)),
                ("total_length_m", models.FloatField(blank=True, null=True)),
                ("longest_route_m", models.FloatField(blank=True, null=True)),
                (
                    "total_energy_wh",
                    models.FloatField(blank=True, help_text="of the routes of UAVs with a battery; empty = none has one", null=True),
                ),
                ("lost_link_check", models.JSONField(blank=True, help_text="from where UAVs cannot do so", null=True)),
                ("separation", models.JSONField(blank=True, help_text="how the routes are kept apart, and what could not be", null=True)),
                (
                    "last_plan",
                    models.JSONField(blank=True, help_text="summary of the plan before the present one, to compare with", null=True),
                ),
                (
                    "locks",
                    models.JSONField(
                        blank=True, default=list, help_text="runs of targets that one UAV flies in this order; targets by sequence"
                    ),
                ),
                (
                    "plan_quality",
                    models.JSONField(blank=True, help_text="bound, gap and method of the plan, and what its locks cost", null=True),
                ),
                ("plan_warnings", models.JSONField(blank=True, default=list, help_text="what the plan says about UAVs that cannot start")),
                ("created_at", models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ("updated_at", models.DateTimeField(auto_now=True)),
                ("deleted_at", models.DateTimeField(blank=True, help_text="deleted missions can be brought back", null=True)),
                ("is_demo", models.BooleanField(db_default=False, default=False, help_text="made with the demo data, and goes with them")),
                (
                    "external_id",
                    models.CharField(
                        blank=True,
                        db_default="",
                        default="",
                        help_text="another system's id, such as a work order's; several missions may have one",
                        max_length=200,
                    ),
                ),
                ("attributes", models.JSONField(blank=True, db_default={}, default=dict, help_text="names and values of other systems")),
                ("started_at", models.DateTimeField(blank=True, help_text="when its first UAV began to fly", null=True)),
                ("ended_at", models.DateTimeField(blank=True, help_text="when it was completed, aborted, or had failed", null=True)),
                (
                    "alert_limits",
                    models.JSONField(
                        blank=True,
                        db_default={},
                        default=dict,
                        help_text="limits of alerts that differ from the UAVs' types; see telemetry/alerting/limits.py",
                    ),
                ),
                (
                    "author",
                    models.ForeignKey(
                        blank=True,
                        null=True,
                        on_delete=django.db.models.deletion.SET_NULL,
                        related_name="missions",
                        to=settings.AUTH_USER_MODEL,
                    ),
                ),
                (
                    "continues",
                    models.ForeignKey(
                        blank=True,
                        help_text="the mission whose rest this one flies",
                        null=True,
                        on_delete=django.db.models.deletion.SET_NULL,
                        related_name="continued_by",
                        to="missions.mission",
                    ),
                ),
                (
                    "organisation",
                    models.ForeignKey(
                        default=1, on_delete=django.db.models.deletion.CASCADE, related_name="missions", to="workspace.organisation"
                    ),
                ),
            ],
            options={
                "ordering": ["-updated_at"],
                "indexes": [
                    models.Index(
                        condition=models.Q(("state__in", ["dispatched", "active"])), fields=["organisation"], name="mission_on_its_way_idx"
                    ),
                    models.Index(
                        condition=models.Q(("ended_at__isnull", False)), fields=["organisation", "ended_at"], name="mission_just_ended_idx"
                    ),
                    models.Index(
                        condition=models.Q(("external_id", ""), _negated=True),
                        fields=["organisation", "external_id"],
                        name="mission_external_id_idx",
                    ),
                ],
                "constraints": [
                    models.CheckConstraint(
                        condition=models.Q(
                            ("state__in", ["draft", "planned", "approved", "dispatched", "active", "completed", "aborted", "failed"])
                        ),
                        name="mission_state_known",
                    ),
                    models.CheckConstraint(
                        condition=models.Q(
                            ("state", "draft"), models.Q(("graph_version__isnull", False), ("planned_at__isnull", False)), _connector="OR"
                        ),
                        name="mission_plan_stated",
                    ),
                ],
            },
        ),
        migrations.CreateModel(
            name="InspectionTarget",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                ("sequence", models.PositiveIntegerField(help_text="place in the operator's list, from 0")),
                ("label", models.CharField(help_text="the asset's name when it was picked", max_length=255)),
                (
                    "position",
                    django.contrib.gis.db.models.fields.PointField(
                        blank=True, help_text="empty: the asset's centre, or the whole line", null=True, srid=4326
                    ),
                ),
                (
                    "stretch",
                    django.contrib.gis.db.models.fields.LineStringField(
                        blank=True, help_text="two points on the asset; empty = not a stretch", null=True, srid=4326
                    ),
                ),
                ("task", models.JSONField(default=dict, help_text="see planning/problem.py, Task")),
                (
                    "priority",
                    models.CharField(choices=[("low", "Low"), ("normal", "Normal"), ("high", "High")], default="normal", max_length=6),
                ),
                ("uav_name", models.CharField(blank=True, help_text="the only UAV that may do it; empty = any", max_length=100)),
                ("sensor", models.CharField(blank=True, help_text="that its UAV must have; empty = any", max_length=100)),
                (
                    "external_id",
                    models.CharField(
                        blank=True, db_default="", default="", help_text="another system's id, such as a work item's", max_length=200
                    ),
                ),
                ("attributes", models.JSONField(blank=True, db_default={}, default=dict, help_text="names and values of other systems")),
                (
                    "state",
                    models.CharField(
                        choices=[
                            ("pending", "Pending"),
                            ("in-progress", "In progress"),
                            ("complete", "Complete"),
                            ("skipped", "Skipped"),
                            ("failed", "Failed"),
                        ],
                        default="pending",
                        max_length=20,
                    ),
                ),
                ("state_at", models.DateTimeField(blank=True, help_text="since when, while the mission flies", null=True)),
                (
                    "state_reason",
                    models.CharField(blank=True, db_default="", default="", help_text="why it was skipped or failed", max_length=300),
                ),
                (
                    "reached_at",
                    models.DateTimeField(blank=True, help_text="by the log; empty: not known, or it was not reached", null=True),
                ),
                (
                    "held_s",
                    models.FloatField(blank=True, help_text="the longest that its UAV can have stayed; empty: not known", null=True),
                ),
                (
                    "visit_stored_at",
                    models.DateTimeField(blank=True, help_text="when reached_at and held_s were stored or changed", null=True),
                ),
                ("unassigned_reason", models.CharField(blank=True, max_length=40)),
                ("unassigned_message", models.CharField(blank=True, max_length=500)),
                (
                    "unassigned_missing",
                    models.JSONField(blank=True, db_default={}, default=dict, help_text="what the message tells to be missing"),
                ),
                (
                    "asset",
                    models.ForeignKey(
                        blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name="targets", to="inspection.asset"
                    ),
                ),
                ("mission", models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name="targets", to="missions.mission")),
            ],
            options={
                "ordering": ["sequence"],
                "indexes": [
                    models.Index(
                        condition=models.Q(("external_id", ""), _negated=True), fields=["external_id"], name="target_external_id_idx"
                    ),
                    models.Index(condition=models.Q(("state_at__isnull", False)), fields=["-state_at", "-id"], name="target_state_at_idx"),
                ],
                "constraints": [
                    models.UniqueConstraint(
                        deferrable=django.db.models.constraints.Deferrable["DEFERRED"],
                        fields=("mission", "sequence"),
                        name="target_sequence",
                    ),
                    models.CheckConstraint(
                        condition=models.Q(("state__in", ["pending", "in-progress", "complete", "skipped", "failed"])),
                        name="target_state_known",
                    ),
                    models.CheckConstraint(condition=models.Q(("priority__in", ["low", "normal", "high"])), name="target_priority_known"),
                ],
            },
        ),
        migrations.CreateModel(
            name="Approval",
            fields=[
                ("id", models.UUIDField(default=uuid.uuid4, editable=False, primary_key=True, serialize=False)),
                ("document", models.JSONField(help_text="routes, items, zones, conditions and terrain; see services/approval/approval.py")),
                ("content_sha256", models.CharField(help_text="of the document in its canonical form", max_length=64)),
                ("approved_at", models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ("revoke_requested_at", models.DateTimeField(blank=True, help_text="since when UAVs are being rid of it", null=True)),
                ("revoked_at", models.DateTimeField(blank=True, null=True)),
                ("revoke_reason", models.CharField(blank=True, max_length=300)),
                (
                    "approved_by",
                    models.ForeignKey(
                        null=True, on_delete=django.db.models.deletion.SET_NULL, related_name="+", to=settings.AUTH_USER_MODEL
                    ),
                ),
                (
                    "revoked_by",
                    models.ForeignKey(
                        blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name="+", to=settings.AUTH_USER_MODEL
                    ),
                ),
                (
                    "mission",
                    models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name="approvals", to="missions.mission"),
                ),
            ],
            options={
                "ordering": ["-approved_at"],
                "constraints": [
                    models.UniqueConstraint(condition=models.Q(("revoked_at", None)), fields=("mission",), name="approval_one_in_force")
                ],
            },
        ),
        migrations.CreateModel(
            name="PlannedStarts",
            fields=[
                ("id", models.UUIDField(default=uuid.uuid4, editable=False, primary_key=True, serialize=False)),
                ("created_at", models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                (
                    "looked_at",
                    models.DateTimeField(
                        db_default=django.db.models.functions.datetime.Now(), help_text="when its times were last compared with the clock"
                    ),
                ),
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
                    models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name="planned_starts", to="missions.mission"),
                ),
            ],
            options={
                "verbose_name_plural": "planned starts",
                "ordering": ["-created_at"],
                "constraints": [
                    models.UniqueConstraint(condition=models.Q(("ended_at", None)), fields=("mission",), name="planned_starts_one_open"),
                    models.CheckConstraint(
                        condition=models.Q(("end__in", ["", "done", "stopped", "commanded", "mission-over", "interrupted"])),
                        name="planned_starts_end_known",
                    ),
                ],
            },
        ),
        migrations.CreateModel(
            name="ReplanOffer",
            fields=[
                ("id", models.UUIDField(default=uuid.uuid4, editable=False, primary_key=True, serialize=False)),
                ("code", models.CharField(help_text="why: uav-out, zone-active, battery-short, asked-for", max_length=50)),
                ("cause", models.JSONField(blank=True, default=dict, help_text="UAV, zone, figures of the cause")),
                (
                    "state",
                    models.CharField(
                        choices=[
                            ("computing", "Being worked out"),
                            ("open", "Waits for a decision"),
                            ("accepted", "Accepted"),
                            ("declined", "Declined"),
                            ("outdated", "Outdated"),
                            ("impossible", "No way was found"),
                        ],
                        default="computing",
                        max_length=12,
                    ),
                ),
                ("difference", models.JSONField(blank=True, default=dict, help_text="what would change, per UAV and target")),
                ("created_at", models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ("decided_at", models.DateTimeField(blank=True, null=True)),
                ("outcome", models.CharField(blank=True, help_text="why it is outdated or impossible, in words", max_length=500)),
                (
                    "continuation",
                    models.OneToOneField(
                        blank=True,
                        help_text="the planned mission that is offered",
                        null=True,
                        on_delete=django.db.models.deletion.SET_NULL,
                        related_name="offered_by",
                        to="missions.mission",
                    ),
                ),
                (
                    "decided_by",
                    models.ForeignKey(
                        blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name="+", to=settings.AUTH_USER_MODEL
                    ),
                ),
                (
                    "mission",
                    models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name="replan_offers", to="missions.mission"),
                ),
            ],
            options={
                "ordering": ["-created_at"],
                "constraints": [
                    models.UniqueConstraint(
                        condition=models.Q(("state__in", ["computing", "open"])), fields=("mission",), name="replan_offer_one_undecided"
                    ),
                    models.CheckConstraint(
                        condition=models.Q(("state__in", ["computing", "open", "accepted", "declined", "outdated", "impossible"])),
                        name="replan_offer_state_known",
                    ),
                ],
            },
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
                "constraints": [models.UniqueConstraint(fields=("organisation", "name"), name="saved_selection_name_unique")],
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
                ("mass_kg", models.FloatField(blank=True, help_text="kilograms at take-off; empty = 1.545, the Iris's", null=True)),
                ("reserve_percent", models.FloatField(db_default=20.0, default=20.0, help_text="of the battery, that no plan uses")),
                ("max_airspeed_mps", models.FloatField(blank=True, help_text="through the air; empty = its cruise speed", null=True)),
                (
                    "rotor_disk_m2",
                    models.FloatField(blank=True, help_text="area swept by all rotors; empty = 0.206, the Iris's", null=True),
                ),
                (
                    "hover_power_w",
                    models.FloatField(blank=True, help_text="watts in a calm hover, if measured; empty = worked out", null=True),
                ),
                (
                    "sensors",
                    django.contrib.postgres.fields.ArrayField(
                        base_field=models.CharField(max_length=50), blank=True, default=list, size=None
                    ),
                ),
                (
                    "alert_limits",
                    models.JSONField(
                        blank=True,
                        db_default={},
                        default=dict,
                        help_text="limits of alerts that differ from the usual ones; see telemetry/alerting/limits.py",
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
                "constraints": [
                    models.UniqueConstraint(fields=("organisation", "name"), name="uav_type_name_unique"),
                    models.CheckConstraint(
                        condition=models.Q(("max_range_m", None), ("max_range_m__gt", 0), _connector="OR"), name="uav_type_range_positive"
                    ),
                    models.CheckConstraint(condition=models.Q(("cruise_speed_mps__gt", 0)), name="uav_type_speed_positive"),
                    models.CheckConstraint(
                        condition=models.Q(("battery_wh", None), ("battery_wh__gt", 0), _connector="OR"), name="uav_type_battery_positive"
                    ),
                    models.CheckConstraint(
                        condition=models.Q(("mass_kg", None), ("mass_kg__gt", 0), _connector="OR"), name="uav_type_mass_positive"
                    ),
                    models.CheckConstraint(
                        condition=models.Q(("reserve_percent__gte", 0), ("reserve_percent__lt", 100)), name="uav_type_reserve_percent"
                    ),
                    models.CheckConstraint(
                        condition=models.Q(("max_airspeed_mps", None), ("max_airspeed_mps__gt", 0), _connector="OR"),
                        name="uav_type_airspeed_positive",
                    ),
                    models.CheckConstraint(
                        condition=models.Q(("rotor_disk_m2", None), ("rotor_disk_m2__gt", 0), _connector="OR"),
                        name="uav_type_disk_positive",
                    ),
                    models.CheckConstraint(
                        condition=models.Q(("hover_power_w", None), ("hover_power_w__gt", 0), _connector="OR"),
                        name="uav_type_hover_positive",
                    ),
                ],
            },
        ),
        migrations.CreateModel(
            name="Uav",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                ("name", models.CharField(max_length=100)),
                (
                    "base_name",
                    models.CharField(
                        blank=True, help_text="the base's name where it is one of the list; else as it was typed", max_length=100
                    ),
                ),
                (
                    "state",
                    models.CharField(
                        choices=[("active", "Active"), ("maintenance", "In maintenance"), ("retired", "Retired")],
                        default="active",
                        max_length=12,
                    ),
                ),
                ("serial_number", models.CharField(blank=True, max_length=100)),
                (
                    "mavlink_system_id",
                    models.PositiveSmallIntegerField(blank=True, help_text="1 to 254; one vehicle each", null=True, unique=True),
                ),
                (
                    "link",
                    models.CharField(
                        choices=[("mavlink", "MAVLink"), ("http", "Companion computer over HTTP")],
                        db_default="mavlink",
                        default="mavlink",
                        max_length=10,
                    ),
                ),
                (
                    "allows_unsigned",
                    models.BooleanField(
                        db_default=False,
                        default=False,
                        help_text="MAVLink without a signature is taken for this UAV's: only on a closed network",
                    ),
                ),
                (
                    "is_simulated",
                    models.BooleanField(db_default=False, default=False, help_text="no real aircraft; may fly without terrain data"),
                ),
                ("is_demo", models.BooleanField(db_default=False, default=False, help_text="made with the demo data, and goes with them")),
                ("location", django.contrib.gis.db.models.fields.PointField(srid=4326)),
                ("located_at", models.DateTimeField(blank=True, help_text="when the location was set or reported", null=True)),
                (
                    "max_range_m",
                    models.FloatField(blank=True, help_text="metres on one battery; empty = its type's, else not limited", null=True),
                ),
                ("cruise_speed_mps", models.FloatField(blank=True, help_text="empty = its type's, else the usual speed", null=True)),
                ("battery_wh", models.FloatField(blank=True, help_text="watt-hours of a full battery; empty = its type's", null=True)),
                ("mass_kg", models.FloatField(blank=True, help_text="kilograms at take-off; empty = its type's", null=True)),
                (
                    "reserve_percent",
                    models.FloatField(blank=True, help_text="of the battery, that no plan uses; empty = its type's, else 20", null=True),
                ),
                (
                    "max_airspeed_mps",
                    models.FloatField(blank=True, help_text="through the air; empty = its type's, else its cruise speed", null=True),
                ),
                (
                    "heading_deg",
                    models.FloatField(blank=True, help_text="degrees from true north, clockwise; empty = not known", null=True),
                ),
                ("battery_percent", models.FloatField(blank=True, null=True)),
                (
                    "autopilot_return",
                    models.JSONField(
                        blank=True,
                        db_default={},
                        default=dict,
                        help_text="parameters of its own return, as read from it; see mavlink/rtl.py",
                    ),
                ),
                ("autopilot_return_read_at", models.DateTimeField(blank=True, null=True)),
                ("sensor", models.CharField(blank=True, max_length=100)),
                (
                    "external_id",
                    models.CharField(
                        blank=True, db_default="", default="", help_text="another system's id of it; one UAV each", max_length=200
                    ),
                ),
                ("attributes", models.JSONField(blank=True, db_default={}, default=dict, help_text="names and values of other systems")),
                (
                    "end_action",
                    models.CharField(
                        choices=[
                            ("hover", "Hover at the last target"),
                            ("return", "Return to start"),
                            ("land", "Land at the last target"),
                            ("base", "Land at the nearest base"),
                        ],
                        default="hover",
                        max_length=10,
                    ),
                ),
                ("created_at", models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ("revision", models.PositiveIntegerField(default=1, help_text="counts the changes; the ETag")),
                ("updated_at", models.DateTimeField(auto_now=True)),
                (
                    "base",
                    models.ForeignKey(
                        blank=True, null=True, on_delete=django.db.models.deletion.PROTECT, related_name="uavs", to="missions.base"
                    ),
                ),
                (
                    "organisation",
                    models.ForeignKey(
                        default=1, on_delete=django.db.models.deletion.CASCADE, related_name="uavs", to="workspace.organisation"
                    ),
                ),
                (
                    "uav_type",
                    models.ForeignKey(
                        blank=True, null=True, on_delete=django.db.models.deletion.PROTECT, related_name="uavs", to="missions.uavtype"
                    ),
                ),
            ],
            options={
                "verbose_name": "UAV",
                "verbose_name_plural": "UAVs",
                "ordering": ["name"],
                "constraints": [
                    models.UniqueConstraint(fields=("organisation", "name"), name="uav_name_unique"),
                    models.UniqueConstraint(
                        condition=models.Q(("external_id", ""), _negated=True),
                        fields=("organisation", "external_id"),
                        name="uav_external_id_unique",
                    ),
                    models.CheckConstraint(
                        condition=models.Q(("max_range_m", None), ("max_range_m__gt", 0), _connector="OR"), name="uav_range_positive"
                    ),
                    models.CheckConstraint(condition=models.Q(("cruise_speed_mps__gt", 0)), name="uav_speed_positive"),
                    models.CheckConstraint(
                        condition=models.Q(("battery_wh", None), ("battery_wh__gt", 0), _connector="OR"), name="uav_battery_positive"
                    ),
                    models.CheckConstraint(
                        condition=models.Q(("mass_kg", None), ("mass_kg__gt", 0), _connector="OR"), name="uav_mass_positive"
                    ),
                    models.CheckConstraint(
                        condition=models.Q(
                            ("reserve_percent", None), models.Q(("reserve_percent__gte", 0), ("reserve_percent__lt", 100)), _connector="OR"
                        ),
                        name="uav_reserve_percent",
                    ),
                    models.CheckConstraint(
                        condition=models.Q(("max_airspeed_mps", None), ("max_airspeed_mps__gt", 0), _connector="OR"),
                        name="uav_airspeed_positive",
                    ),
                    models.CheckConstraint(
                        condition=models.Q(
                            ("heading_deg", None), models.Q(("heading_deg__gte", 0), ("heading_deg__lt", 360)), _connector="OR"
                        ),
                        name="uav_heading_degrees",
                    ),
                    models.CheckConstraint(
                        condition=models.Q(("battery_percent", None), ("battery_percent__range", (0, 100)), _connector="OR"),
                        name="uav_battery_percent",
                    ),
                    models.CheckConstraint(condition=models.Q(("state__in", ["active", "maintenance", "retired"])), name="uav_state_known"),
                    models.CheckConstraint(condition=models.Q(("link__in", ["mavlink", "http"])), name="uav_link_known"),
                    models.CheckConstraint(
                        condition=models.Q(("mavlink_system_id", None), ("mavlink_system_id__range", (1, 254)), _connector="OR"),
                        name="uav_system_id_range",
                    ),
                ],
            },
        ),
        migrations.CreateModel(
            name="MissionUav",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                ("sequence", models.PositiveSmallIntegerField()),
                ("name", models.CharField(max_length=100)),
                ("start", django.contrib.gis.db.models.fields.PointField(srid=4326)),
                ("max_range_m", models.FloatField(blank=True, null=True)),
                ("cruise_speed_mps", models.FloatField()),
                (
                    "end_action",
                    models.CharField(
                        choices=[
                            ("hover", "Hover at the last target"),
                            ("return", "Return to start"),
                            ("land", "Land at the last target"),
                            ("base", "Land at the nearest base"),
                        ],
                        default="hover",
                        max_length=10,
                    ),
                ),
                ("most_targets", models.PositiveIntegerField(blank=True, help_text="that it does at most; empty = not limited", null=True)),
                (
                    "sorties",
                    models.PositiveSmallIntegerField(
                        db_default=1, default=1, help_text="flights that it makes at most, each on a full battery"
                    ),
                ),
                (
                    "sensors",
                    django.contrib.postgres.fields.ArrayField(
                        base_field=models.CharField(max_length=100), blank=True, default=list, size=None
                    ),
                ),
                (
                    "performance",
                    models.JSONField(blank=True, default=dict, help_text="battery, mass and airspeed; see planning/energy/performance.py"),
                ),
                (
                    "own_figures",
                    django.contrib.postgres.fields.ArrayField(
                        base_field=models.CharField(max_length=20),
                        blank=True,
                        db_default=[],
                        default=list,
                        help_text="names of the figures that are said for this mission; the others were the UAV's when it was made",
                        size=None,
                    ),
                ),
                (
                    "fleet_figures",
                    models.JSONField(
                        blank=True,
                        db_default={},
                        default=dict,
                        help_text="of the own figures: what the UAV had for them when they were said",
                    ),
                ),
                (
                    "home",
                    django.contrib.gis.db.models.fields.PointField(
                        blank=True, help_text="where it took off, if it is in the air already; empty = at start", null=True, srid=4326
                    ),
                ),
                ("home_amsl_m", models.FloatField(blank=True, help_text="of the ground there; empty without terrain data", null=True)),
                (
                    "mission",
                    models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name="mission_uavs", to="missions.mission"),
                ),
                (
                    "uav",
                    models.ForeignKey(
                        blank=True, null=True, on_delete=django.db.models.deletion.PROTECT, related_name="mission_uavs", to="missions.uav"
                    ),
                ),
            ],
            options={
                "verbose_name": "UAV in a mission",
                "verbose_name_plural": "UAVs in missions",
                "ordering": ["sequence"],
                "constraints": [
                    models.UniqueConstraint(fields=("mission", "sequence"), name="mission_uav_sequence"),
                    models.CheckConstraint(
                        condition=models.Q(("most_targets", None), ("most_targets__gte", 1), _connector="OR"),
                        name="mission_uav_does_something",
                    ),
                ],
            },
        ),
        migrations.CreateModel(
            name="Route",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                ("graph_version", models.BigIntegerField(help_text="equals the mission's: a mission is never mixed from two plans")),
                ("length_m", models.FloatField()),
                ("duration_s", models.FloatField()),
                ("departs_s", models.FloatField(db_default=0.0, default=0.0, help_text="seconds after the mission's departure")),
                ("energy_wh", models.FloatField(blank=True, help_text="empty without a battery", null=True)),
                ("charging", models.JSONField(blank=True, default=list, help_text="stops at towers to charge; see services/planning/plan_json.py")),
                ("battery_percent", models.FloatField(blank=True, help_text="left at the end; empty without a battery", null=True)),
                (
                    "base_name",
                    models.CharField(blank=True, default="", help_text="the base at which it lands, where it ends at one", max_length=100),
                ),
                (
                    "lands_at",
                    django.contrib.gis.db.models.fields.PointField(
                        blank=True, help_text="where that base was when the route was planned", null=True, srid=4326
                    ),
                ),
                (
                    "flights_flown",
                    models.PositiveSmallIntegerField(db_default=0, default=0, help_text="of its flights, since it was approved"),
                ),
                (
                    "has_failed",
                    models.BooleanField(
                        db_default=False, default=False, help_text="a flight of it, since it was approved: it is not flown on"
                    ),
                ),
                (
                    "begun_by",
                    models.PositiveIntegerField(
                        blank=True,
                        help_text="of one that is begun in the air: the waypoint until which that may be; empty = it takes off",
                        null=True,
                    ),
                ),
                (
                    "geometry",
                    django.contrib.gis.db.models.fields.LineStringField(
                        blank=True, help_text="empty when the UAV is not used", null=True, srid=4326
                    ),
                ),
                (
                    "before_hand",
                    models.JSONField(
                        blank=True,
                        db_default=[],
                        default=list,
                        help_text="its waypoints before each change by hand that can be taken back; see services/manual_edits/edits.py",
                    ),
                ),
                (
                    "continued_by",
                    models.ForeignKey(
                        blank=True,
                        help_text="the mission that has taken over what was left of it: it is not flown on",
                        null=True,
                        on_delete=django.db.models.deletion.SET_NULL,
                        related_name="continued_routes",
                        to="missions.mission",
                    ),
                ),
                ("mission", models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name="routes", to="missions.mission")),
                (
                    "mission_uav",
                    models.OneToOneField(on_delete=django.db.models.deletion.CASCADE, related_name="route", to="missions.missionuav"),
                ),
            ],
            options={
                "ordering": ["mission_uav__sequence"],
            },
        ),
        migrations.CreateModel(
            name="UavCommand",
            fields=[
                ("id", models.UUIDField(default=uuid.uuid4, editable=False, primary_key=True, serialize=False)),
                ("sequence", models.BigIntegerField()),
                (
                    "kind",
                    models.CharField(
                        choices=[
                            ("upload-mission", "Send the mission"),
                            ("clear-mission", "Take the mission off the UAV"),
                            ("arm", "Arm"),
                            ("take-off", "Take off"),
                            ("start", "Start the mission"),
                            ("pause", "Pause"),
                            ("resume", "Resume"),
                            ("hold", "Hold"),
                            ("return", "Return"),
                            ("land", "Land"),
                            ("abort", "Abort the mission"),
                            ("change-speed", "Change speed"),
                        ],
                        max_length=20,
                    ),
                ),
                ("priority", models.PositiveSmallIntegerField(choices=[(0, "Safety"), (1, "Pause"), (2, "Mission"), (3, "Parameter")])),
                (
                    "axis",
                    models.CharField(
                        choices=[("flight", "Flight"), ("mission", "Mission"), ("speed", "Speed")],
                        help_text="what it sets: one open command of a UAV each",
                        max_length=10,
                    ),
                ),
                ("parameters", models.JSONField(blank=True, default=dict)),
                (
                    "state",
                    models.CharField(
                        choices=[
                            ("queued", "Queued"),
                            ("sent", "Sent"),
                            ("acknowledged", "Acknowledged"),
                            ("applied", "Applied"),
                            ("failed", "Failed"),
                            ("expired", "Expired"),
                        ],
                        default="queued",
                        max_length=12,
                    ),
                ),
                (
                    "link",
                    models.CharField(
                        choices=[("mavlink", "MAVLink"), ("http", "Companion computer over HTTP")],
                        help_text="the door by which it goes",
                        max_length=10,
                    ),
                ),
                ("why", models.CharField(blank=True, help_text="as the person who gave it wrote", max_length=300)),
                ("created_at", models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ("expires_at", models.DateTimeField(blank=True, null=True)),
                ("attempts", models.PositiveIntegerField(default=0)),
                ("holder", models.CharField(blank=True, help_text="the gateway that carries it", max_length=100)),
                ("lease_expires_at", models.DateTimeField(blank=True, null=True)),
                ("sent_at", models.DateTimeField(blank=True, help_text="first", null=True)),
                ("acknowledged_at", models.DateTimeField(blank=True, null=True)),
                ("finished_at", models.DateTimeField(blank=True, null=True)),
                ("progress", models.JSONField(blank=True, help_text="of an upload: items done and in all", null=True)),
                ("outcome_code", models.CharField(blank=True, max_length=50)),
                ("outcome", models.CharField(blank=True, help_text="why it failed or expired, in words", max_length=500)),
                (
                    "approval",
                    models.ForeignKey(
                        blank=True, null=True, on_delete=django.db.models.deletion.PROTECT, related_name="commands", to="missions.approval"
                    ),
                ),
                (
                    "created_by",
                    models.ForeignKey(
                        blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name="+", to=settings.AUTH_USER_MODEL
                    ),
                ),
                (
                    "mission",
                    models.ForeignKey(
                        blank=True, null=True, on_delete=django.db.models.deletion.CASCADE, related_name="commands", to="missions.mission"
                    ),
                ),
                (
                    "organisation",
                    models.ForeignKey(
                        default=1, on_delete=django.db.models.deletion.CASCADE, related_name="uav_commands", to="workspace.organisation"
                    ),
                ),
                ("uav", models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name="commands", to="missions.uav")),
            ],
            options={
                "verbose_name": "UAV command",
                "ordering": ["-created_at", "-sequence"],
                "indexes": [
                    models.Index(
                        condition=models.Q(("state__in", ["queued", "sent", "acknowledged"])),
                        fields=["priority", "created_at"],
                        name="uav_command_open_idx",
                    ),
                    models.Index(fields=["mission", "-created_at"], name="uav_command_of_mission_idx"),
                    models.Index(fields=["organisation", "finished_at"], name="uav_command_just_ended_idx"),
                ],
                "constraints": [
                    models.UniqueConstraint(fields=("uav", "sequence"), name="uav_command_sequence"),
                    models.UniqueConstraint(
                        condition=models.Q(("state__in", ["queued", "sent", "acknowledged"])),
                        fields=("uav", "axis"),
                        name="uav_command_one_open_of_an_axis",
                    ),
                    models.CheckConstraint(
                        condition=models.Q(("state__in", ["queued", "sent", "acknowledged", "applied", "failed", "expired"])),
                        name="uav_command_state_known",
                    ),
                    models.CheckConstraint(
                        condition=models.Q(
                            (
                                "kind__in",
                                [
                                    "upload-mission",
                                    "clear-mission",
                                    "arm",
                                    "take-off",
                                    "start",
                                    "pause",
                                    "resume",
                                    "hold",
                                    "return",
                                    "land",
                                    "abort",
                                    "change-speed",
                                ],
                            )
                        ),
                        name="uav_command_kind_known",
                    ),
                    models.CheckConstraint(
                        condition=models.Q(
                            models.Q(("kind", "upload-mission"), _negated=True), ("approval__isnull", False), _connector="OR"
                        ),
                        name="uav_command_upload_is_approved",
                    ),
                ],
            },
        ),
        migrations.CreateModel(
            name="UavCommandEvent",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                (
                    "state",
                    models.CharField(
                        choices=[
                            ("queued", "Queued"),
                            ("sent", "Sent"),
                            ("acknowledged", "Acknowledged"),
                            ("applied", "Applied"),
                            ("failed", "Failed"),
                            ("expired", "Expired"),
                        ],
                        max_length=12,
                    ),
                ),
                ("attempt", models.PositiveIntegerField()),
                ("holder", models.CharField(blank=True, max_length=100)),
                ("note", models.CharField(blank=True, max_length=500)),
                ("recorded_at", models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                (
                    "command",
                    models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name="events", to="missions.uavcommand"),
                ),
            ],
            options={
                "ordering": ["pk"],
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
                (
                    "replaced_at",
                    models.DateTimeField(blank=True, help_text="a newer one was made; this one counts until that was used", null=True),
                ),
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
                "constraints": [
                    models.UniqueConstraint(
                        condition=models.Q(("replaced_at", None), ("revoked_at", None)),
                        fields=("uav", "kind"),
                        name="uav_credential_one_newest",
                    ),
                    models.CheckConstraint(
                        condition=models.Q(("kind__in", ["link-token", "mavlink-key"])), name="uav_credential_kind_known"
                    ),
                ],
            },
        ),
        migrations.CreateModel(
            name="Waypoint",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                ("sequence", models.PositiveIntegerField()),
                (
                    "kind",
                    models.CharField(
                        choices=[
                            ("start", "Start"),
                            ("pass", "Pass"),
                            ("target", "Target"),
                            ("end", "End"),
                            ("base", "Between two flights"),
                        ],
                        max_length=10,
                    ),
                ),
                ("position", django.contrib.gis.db.models.fields.PointField(srid=4326)),
                ("task", models.JSONField(blank=True, null=True)),
                ("altitude_agl_m", models.FloatField()),
                ("altitude_amsl_m", models.FloatField(blank=True, help_text="empty without terrain data", null=True)),
                ("altitude_relative_m", models.FloatField()),
                (
                    "arrival_s",
                    models.FloatField(blank=True, help_text="seconds after the mission's departure; empty in older plans", null=True),
                ),
                ("used_wh", models.FloatField(blank=True, help_text="since take-off; empty without a battery", null=True)),
                ("battery_left_percent", models.FloatField(blank=True, null=True)),
                (
                    "speed_mps",
                    models.FloatField(blank=True, help_text="over ground on the leg to it, by hand; empty = the UAV's own", null=True),
                ),
                (
                    "is_by_hand",
                    models.BooleanField(db_default=False, default=False, help_text="put in, moved or flown otherwise by a person"),
                ),
                (
                    "asset",
                    models.ForeignKey(
                        blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name="+", to="inspection.asset"
                    ),
                ),
                ("route", models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name="waypoints", to="missions.route")),
                (
                    "target",
                    models.ForeignKey(
                        blank=True,
                        null=True,
                        on_delete=django.db.models.deletion.CASCADE,
                        related_name="waypoints",
                        to="missions.inspectiontarget",
                    ),
                ),
            ],
            options={
                "ordering": ["sequence"],
                "constraints": [models.UniqueConstraint(fields=("route", "sequence"), name="waypoint_sequence")],
            },
        ),
    ]
