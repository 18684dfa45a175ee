"""The tables as they were after 0015_vehicle_type_of_a_link: one migration instead of 15.

An installation that has applied all of them counts this one as applied. An older one is first updated
to the last version that has them.
"""

import django.contrib.gis.db.models.fields
import django.contrib.postgres.indexes
import django.db.models.deletion
import django.db.models.functions.datetime
from django.conf import settings
from django.db import migrations, models


class Migration(migrations.Migration):

    replaces = [('telemetry', '0001_initial'), ('telemetry', '0002_boots_of_a_link'), ('telemetry', '0003_results_by_approval'), ('telemetry', '0004_limits_of_a_vehicle'), ('telemetry', '0005_waypoints_and_read_backs'), ('telemetry', '0006_live_monitoring'), ('telemetry', '0007_alert_words'), ('telemetry', '0008_lists_left_alone'), ('telemetry', '0009_looks_of_live_pages'), ('telemetry', '0010_alert_course'), ('telemetry', '0011_no_index_on_what_changes_each_second'), ('telemetry', '0012_doubt_of_a_new_link'), ('telemetry', '0013_room_for_what_changes_each_second'), ('telemetry', '0014_battery_state_and_rate_of_a_link'), ('telemetry', '0015_vehicle_type_of_a_link')]

    initial = True

    dependencies = [
        ('missions', '0001_squashed_0034_visits_of_targets'),
        ('workspace', '0001_squashed_0010_service_accounts'),
        ('workspace', '__first__'),
    ]

    operations = [
        migrations.CreateModel(
            name='UavLink',
            fields=[
                ('uav', models.OneToOneField(on_delete=django.db.models.deletion.CASCADE, primary_key=True, related_name='connection', serialize=False, to='missions.uav')),
                ('holder', models.CharField(blank=True, help_text='the gateway that serves it', max_length=100)),
                ('lease_expires_at', models.DateTimeField(blank=True, null=True)),
                ('heard_at', models.DateTimeField(blank=True, help_text="when anything was last received, by the server's clock", null=True)),
                ('address', models.CharField(blank=True, help_text='whence it was received: transport, host and port', max_length=100)),
                ('autopilot', models.CharField(blank=True, help_text='px4, ardupilot or other', max_length=20)),
                ('firmware', models.CharField(blank=True, max_length=50)),
                ('vehicle_type', models.PositiveSmallIntegerField(blank=True, help_text='MAV_TYPE of its heartbeat', null=True)),
                ('mode', models.CharField(blank=True, max_length=30)),
                ('is_armed', models.BooleanField(blank=True, null=True)),
                ('is_in_air', models.BooleanField(blank=True, null=True)),
                ('home', django.contrib.gis.db.models.fields.PointField(blank=True, null=True, srid=4326)),
                ('home_amsl_m', models.FloatField(blank=True, null=True)),
                ('mission_item', models.IntegerField(blank=True, help_text='that its list is at, as the autopilot counts; by MAVLink only', null=True)),
                ('waypoint_sequence', models.IntegerField(blank=True, help_text='of its approved route that it flies to, or is at', null=True)),
                ('loaded_sha256', models.CharField(blank=True, help_text='of the approved mission found on it by reading back; empty = none', max_length=64)),
                ('loaded_approval', models.UUIDField(blank=True, null=True)),
                ('loaded_flight', models.PositiveSmallIntegerField(blank=True, null=True)),
                ('loaded_read_at', models.DateTimeField(blank=True, help_text="when it was last read back, by the server's clock", null=True)),
                ('loaded_doubt', models.CharField(blank=True, db_default='', default='', help_text='why it may hold something else by now; empty = nothing says so', max_length=20)),
                ('loaded_beside', models.JSONField(blank=True, db_default={}, default=dict, help_text='SHA-256 of lists of its own that were left beside it: fence, rally')),
                ('clock_offset_s', models.FloatField(blank=True, help_text="server's time at the vehicle's time since boot of 0", null=True)),
                ('clock_rate', models.FloatField(blank=True, help_text="vehicle's seconds a second; a simulation may run faster", null=True)),
                ('boots', models.JSONField(blank=True, db_default=[], default=list, help_text="runs of the vehicle's clock, the last one last; see mavlink/decoding/boots.py")),
                ('signing', models.JSONField(blank=True, default=dict, help_text='last timestamps by link, so that nothing is taken twice')),
                ('losses', models.JSONField(blank=True, default=dict, help_text='what was refused or lost, by cause')),
                ('limits', models.JSONField(blank=True, db_default={}, default=dict, help_text="what it would not fly, by its parameters' names [m]; see mavlink/mission_sync/limits.py")),
                ('battery_state', models.CharField(blank=True, db_default='', default='', help_text='as the vehicle itself has it: ok, low, critical, …', max_length=20)),
                ('received_bytes_s', models.FloatField(blank=True, help_text='bytes a second of its frames, of late', null=True)),
                ('received_messages_s', models.FloatField(blank=True, null=True)),
            ],
            options={
                'verbose_name': "UAV's link",
            },
        ),
        migrations.CreateModel(
            name='Alert',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('level', models.CharField(choices=[('critical', 'Critical'), ('warning', 'Warning'), ('advisory', 'Advisory')], max_length=10)),
                ('code', models.CharField(help_text='the cause: mission-mixed, …', max_length=50)),
                ('subject', models.CharField(blank=True, db_default='', default='', help_text='which of a kind: a zone, another UAV', max_length=100)),
                ('message', models.CharField(help_text='in English; a template where there are values', max_length=500)),
                ('values', models.JSONField(blank=True, db_default={}, default=dict, help_text='what is put into the message when it is shown')),
                ('details', models.JSONField(blank=True, default=dict)),
                ('opened_at', models.DateTimeField()),
                ('written_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), help_text='when its words were written')),
                ('closed_at', models.DateTimeField(blank=True, null=True)),
                ('close_reason', models.CharField(blank=True, db_default='', default='', help_text='cleared, landed, mission-ended, by-person', max_length=30)),
                ('acknowledged_at', models.DateTimeField(blank=True, null=True)),
                ('course', models.JSONField(blank=True, db_default=[], default=list, help_text='what became of it: at, what, level, by, reason')),
                ('revision', models.PositiveIntegerField(db_default=1, default=1, help_text='counts the changes')),
                ('acknowledged_by', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to=settings.AUTH_USER_MODEL)),
                ('mission', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.CASCADE, related_name='alerts', to='missions.mission')),
                ('organisation', models.ForeignKey(default=1, on_delete=django.db.models.deletion.CASCADE, related_name='alerts', to='workspace.organisation')),
                ('uav', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.CASCADE, related_name='alerts', to='missions.uav')),
            ],
            options={
                'ordering': ['-opened_at'],
                'indexes': [models.Index(fields=['organisation', 'closed_at'], name='alert_open_or_just_closed_idx')],
                'constraints': [models.UniqueConstraint(condition=models.Q(('closed_at', None)), fields=('uav', 'code', 'subject'), name='alert_one_open_of_a_cause'), models.CheckConstraint(condition=models.Q(('level__in', ['critical', 'warning', 'advisory'])), name='alert_level_known')],
            },
        ),
        migrations.CreateModel(
            name='AlertNote',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('text', models.CharField(max_length=1000)),
                ('written_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('alert', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='notes', to='telemetry.alert')),
                ('author', models.ForeignKey(null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to=settings.AUTH_USER_MODEL)),
            ],
            options={
                'ordering': ['written_at', 'pk'],
            },
        ),
        migrations.CreateModel(
            name='FlightLog',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('path', models.CharField(help_text='under the folder of logs', max_length=200)),
                ('started_at', models.DateTimeField()),
                ('ended_at', models.DateTimeField(blank=True, null=True)),
                ('size_bytes', models.BigIntegerField(default=0)),
                ('mission', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='flight_logs', to='missions.mission')),
                ('organisation', models.ForeignKey(default=1, on_delete=django.db.models.deletion.CASCADE, related_name='flight_logs', to='workspace.organisation')),
                ('uav', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='flight_logs', to='missions.uav')),
            ],
            options={
                'ordering': ['-started_at'],
            },
        ),
        migrations.CreateModel(
            name='PositionEstimate',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('estimated_for', models.DateTimeField(help_text='the moment that it speaks of')),
                ('made_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('report_at', models.DateTimeField(help_text='when the last report that it rests on was measured', null=True)),
                ('position', django.contrib.gis.db.models.fields.PointField(spatial_index=False, srid=4326)),
                ('altitude_amsl_m', models.FloatField(blank=True, null=True)),
                ('altitude_relative_m', models.FloatField(blank=True, help_text='above take-off', null=True)),
                ('speed_mps', models.FloatField(help_text='over ground')),
                ('heading_deg', models.FloatField(blank=True, null=True)),
                ('bound_along_m', models.FloatField(help_text='semi-axis of the ellipse along its bearing')),
                ('bound_across_m', models.FloatField()),
                ('bound_bearing_deg', models.FloatField()),
                ('bound_height_m', models.FloatField()),
                ('bound_speed_mps', models.FloatField()),
                ('waypoint_sequence', models.IntegerField(blank=True, null=True)),
                ('is_lost', models.BooleanField(default=False, help_text='past what the estimator vouches for')),
                ('replaced_at', models.DateTimeField(blank=True, null=True)),
                ('mission', models.ForeignKey(blank=True, db_index=False, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='estimates', to='missions.mission')),
                ('uav', models.ForeignKey(db_index=False, on_delete=django.db.models.deletion.CASCADE, related_name='estimates', to='missions.uav')),
            ],
            options={
                'ordering': ['estimated_for'],
                'indexes': [models.Index(fields=['mission', 'estimated_for'], name='estimate_of_mission_idx')],
                'constraints': [models.UniqueConstraint(fields=('uav', 'estimated_for'), name='position_estimate_once')],
            },
        ),
        migrations.CreateModel(
            name='TelemetryStream',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('link', models.CharField(choices=[('mavlink', 'MAVLink'), ('http', 'Companion computer over HTTP')], max_length=10)),
                ('key', models.CharField(help_text="that the sender gives, or the gateway from the vehicle's clock", max_length=64)),
                ('started_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('uav', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='streams', to='missions.uav')),
            ],
            options={
                'ordering': ['-started_at'],
                'constraints': [models.UniqueConstraint(fields=('uav', 'link', 'key'), name='telemetry_stream_once')],
            },
        ),
        migrations.CreateModel(
            name='TelemetryRecord',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('sequence', models.BigIntegerField(help_text='within the stream; the time since boot [ms] where the vehicle counts nothing else')),
                ('measured_at', models.DateTimeField(help_text="by the UAV's clock, set right where it is known to be wrong")),
                ('received_at', models.DateTimeField(help_text="by the server's clock")),
                ('stored_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('position', django.contrib.gis.db.models.fields.PointField(blank=True, null=True, spatial_index=False, srid=4326)),
                ('altitude_amsl_m', models.FloatField(blank=True, null=True)),
                ('altitude_relative_m', models.FloatField(blank=True, help_text='above take-off', null=True)),
                ('altitude_agl_m', models.FloatField(blank=True, help_text='above the terrain model, or as measured', null=True)),
                ('velocity_north_mps', models.FloatField(blank=True, null=True)),
                ('velocity_east_mps', models.FloatField(blank=True, null=True)),
                ('velocity_down_mps', models.FloatField(blank=True, null=True)),
                ('airspeed_mps', models.FloatField(blank=True, null=True)),
                ('roll_deg', models.FloatField(blank=True, null=True)),
                ('pitch_deg', models.FloatField(blank=True, null=True)),
                ('heading_deg', models.FloatField(blank=True, help_text='from true north, clockwise', null=True)),
                ('battery_percent', models.FloatField(blank=True, null=True)),
                ('battery_v', models.FloatField(blank=True, null=True)),
                ('battery_a', models.FloatField(blank=True, null=True)),
                ('mode', models.CharField(blank=True, max_length=30)),
                ('is_armed', models.BooleanField(blank=True, null=True)),
                ('is_in_air', models.BooleanField(blank=True, null=True)),
                ('link_quality_percent', models.FloatField(blank=True, null=True)),
                ('gps_fix', models.PositiveSmallIntegerField(blank=True, help_text='GPS_FIX_TYPE: 3 is a fix in space', null=True)),
                ('satellites', models.PositiveSmallIntegerField(blank=True, null=True)),
                ('hdop', models.FloatField(blank=True, null=True)),
                ('wind_north_mps', models.FloatField(blank=True, help_text='towards which the air moves', null=True)),
                ('wind_east_mps', models.FloatField(blank=True, null=True)),
                ('mission_item', models.IntegerField(blank=True, help_text='that its list is at, as the autopilot counts (ArduPilot: 0 is home); by MAVLink only', null=True)),
                ('waypoint_sequence', models.IntegerField(blank=True, help_text='of its approved route that it flies to, or is at; see services/waypoints.py', null=True)),
                ('is_from_future', models.BooleanField(db_default=False, default=False, help_text='measured more than a minute after it was received')),
                ('is_late', models.BooleanField(db_default=False, default=False, help_text='measured before a record that was stored earlier')),
                ('mission', models.ForeignKey(blank=True, db_index=False, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='records', to='missions.mission')),
                ('uav', models.ForeignKey(db_index=False, on_delete=django.db.models.deletion.CASCADE, related_name='records', to='missions.uav')),
                ('stream', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='records', to='telemetry.telemetrystream')),
            ],
            options={
                'ordering': ['measured_at', 'pk'],
                'indexes': [django.contrib.postgres.indexes.BrinIndex(fields=['received_at'], name='telemetry_received_brin'), models.Index(fields=['uav', '-measured_at'], name='telemetry_of_uav_idx'), models.Index(condition=models.Q(('mission__isnull', False)), fields=['mission', 'measured_at'], name='telemetry_of_mission_idx')],
                'constraints': [models.UniqueConstraint(fields=('stream', 'sequence'), name='telemetry_record_once'), models.CheckConstraint(condition=models.Q(('battery_percent', None), ('battery_percent__range', (0, 100)), _connector='OR'), name='telemetry_battery_percent')],
            },
        ),
        migrations.CreateModel(
            name='InspectionResult',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('sequence', models.BigIntegerField()),
                ('place', models.PositiveIntegerField(help_text="the target's place in the mission as it was approved, from 0")),
                ('measured_at', models.DateTimeField()),
                ('received_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('outcome', models.CharField(help_text='complete, skipped or failed', max_length=12)),
                ('note', models.CharField(blank=True, max_length=2000)),
                ('values', models.JSONField(blank=True, default=dict, help_text='as the payload measured them')),
                ('approval', models.ForeignKey(help_text='that it was flown by', null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='results', to='missions.approval')),
                ('mission', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='results', to='missions.mission')),
                ('target', models.ForeignKey(help_text='empty: the mission is another one by now', null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='results', to='missions.inspectiontarget')),
                ('uav', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='results', to='missions.uav')),
                ('stream', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='results', to='telemetry.telemetrystream')),
            ],
            options={
                'ordering': ['-measured_at'],
                'constraints': [models.UniqueConstraint(fields=('stream', 'sequence'), name='inspection_result_once')],
            },
        ),
        migrations.CreateModel(
            name='UavWatch',
            fields=[
                ('uav', models.OneToOneField(on_delete=django.db.models.deletion.CASCADE, primary_key=True, related_name='watch', serialize=False, to='missions.uav')),
                ('holder', models.CharField(blank=True, help_text='the watch that estimates it', max_length=100)),
                ('lease_expires_at', models.DateTimeField(blank=True, null=True)),
                ('version', models.BigIntegerField(db_default=1, default=1, help_text='counts the changes')),
                ('measured', models.JSONField(blank=True, help_text='the newest report that is not from the future', null=True)),
                ('estimated', models.JSONField(blank=True, help_text='see estimation/estimate.py; empty: it is not flying a mission', null=True)),
                ('updated_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now())),
                ('mission', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to='missions.mission')),
                ('organisation', models.ForeignKey(default=1, on_delete=django.db.models.deletion.CASCADE, related_name='+', to='workspace.organisation')),
            ],
            options={
                'verbose_name_plural': 'UAV watches',
            },
        ),
        migrations.CreateModel(
            name='UnknownVehicle',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('mavlink_system_id', models.PositiveSmallIntegerField(unique=True)),
                ('autopilot', models.CharField(blank=True, max_length=20)),
                ('vehicle_type', models.CharField(blank=True, max_length=50)),
                ('address', models.CharField(blank=True, max_length=100)),
                ('is_signed', models.BooleanField(default=False)),
                ('location', django.contrib.gis.db.models.fields.PointField(blank=True, null=True, srid=4326)),
                ('state', models.CharField(choices=[('new', 'New'), ('ignored', 'Ignored'), ('adopted', 'Adopted')], default='new', max_length=10)),
                ('first_heard_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('heard_at', models.DateTimeField()),
                ('settled_at', models.DateTimeField(blank=True, null=True)),
                ('settled_by', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to=settings.AUTH_USER_MODEL)),
                ('uav', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to='missions.uav')),
            ],
            options={
                'ordering': ['-heard_at'],
                'constraints': [models.CheckConstraint(condition=models.Q(('state__in', ['new', 'ignored', 'adopted'])), name='unknown_vehicle_state_known')],
            },
        ),
        migrations.CreateModel(
            name='VehicleText',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('severity', models.PositiveSmallIntegerField(help_text='MAV_SEVERITY: 0 emergency to 7 debug')),
                ('text', models.CharField(max_length=500)),
                ('received_at', models.DateTimeField()),
                ('uav', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='texts', to='missions.uav')),
            ],
            options={
                'ordering': ['-received_at', '-pk'],
                'indexes': [models.Index(fields=['uav', '-received_at'], name='vehicle_text_newest_idx')],
            },
        ),
        # Room on the page for the next version of a row that changes several times a second: a row of a watch fills a quarter of a page.
        # Without room each change went to another page, and after three minutes of 200 UAVs their 200 rows lay in 57 MB, which every
        # look of a live page read.
        migrations.RunSQL(
            "ALTER TABLE telemetry_uavwatch"
            " SET (fillfactor = 25, autovacuum_vacuum_scale_factor = 0, autovacuum_vacuum_threshold = 2000)",
            "ALTER TABLE telemetry_uavwatch RESET (fillfactor, autovacuum_vacuum_scale_factor, autovacuum_vacuum_threshold)",
        ),
    ]
