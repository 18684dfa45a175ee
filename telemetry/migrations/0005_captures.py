"""Photos that UAVs took, and the reports of each."""

import django.contrib.gis.db.models.fields
import django.contrib.postgres.indexes
import django.db.models.deletion
from django.db import migrations, models


class Migration(migrations.Migration):

    dependencies = [
        ('missions', '0013_cameras'),
        ('telemetry', '0004_last_message_times'),
    ]

    operations = [
        migrations.CreateModel(
            name='Capture',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('flight', models.PositiveSmallIntegerField(blank=True, help_text='of the approved route, from 1', null=True)),
                ('waypoint_sequence', models.IntegerField(blank=True, help_text='of the approved route', null=True)),
                ('mission_item', models.IntegerField(blank=True, help_text="that the vehicle's list was at, as its autopilot counts", null=True)),
                ('is_taken', models.BooleanField(db_default=True, default=True, help_text='false: the camera reported a failure')),
                ('camera', models.PositiveSmallIntegerField(blank=True, help_text='MAVLink component of the camera', null=True)),
                ('image_index', models.BigIntegerField(blank=True, help_text='as its sender counts; begins anew after a restart', null=True)),
                ('taken_at', models.DateTimeField(help_text="by the server's clock")),
                ('time_source', models.CharField(help_text='vehicle-clock, utc, uav or receipt', max_length=20)),
                ('time_bound_s', models.FloatField(blank=True, help_text='95 %', null=True)),
                ('received_at', models.DateTimeField(help_text='of the first report')),
                ('position', django.contrib.gis.db.models.fields.PointField(blank=True, null=True, spatial_index=False, srid=4326)),
                ('position_source', models.CharField(blank=True, help_text='photo: told with it; vehicle: where the UAV was last before', max_length=20)),
                ('position_bound_m', models.FloatField(blank=True, help_text='radius of 95 %', null=True)),
                ('altitude_amsl_m', models.FloatField(blank=True, null=True)),
                ('altitude_relative_m', models.FloatField(blank=True, help_text='above take-off', null=True)),
                ('altitude_agl_m', models.FloatField(blank=True, help_text='above ground, as the UAV measured it', null=True)),
                ('roll_deg', models.FloatField(blank=True, null=True)),
                ('pitch_deg', models.FloatField(blank=True, help_text='from the horizon; -90 is straight down', null=True)),
                ('yaw_deg', models.FloatField(blank=True, null=True)),
                ('yaw_frame', models.CharField(blank=True, help_text='earth: from true north; vehicle: from the nose', max_length=10)),
                ('attitude_source', models.CharField(blank=True, help_text='camera, gimbal, or vehicle: where the camera looked is unknown', max_length=10)),
                ('file_url', models.CharField(blank=True, help_text='of the picture, as the camera names it', max_length=205)),
                ('mission', models.ForeignKey(blank=True, db_index=False, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='captures', to='missions.mission')),
                ('uav', models.ForeignKey(db_index=False, on_delete=django.db.models.deletion.CASCADE, related_name='captures', to='missions.uav')),
            ],
            options={
                'ordering': ['taken_at', 'pk'],
            },
        ),
        migrations.CreateModel(
            name='CaptureReport',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('key', models.CharField(max_length=64)),
                ('source', models.CharField(help_text='the message', max_length=30)),
                ('received_at', models.DateTimeField()),
                ('values', models.JSONField(help_text='see mavlink/decoding/captures.py')),
                ('capture', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='reports', to='telemetry.capture')),
                ('stream', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='capture_reports', to='telemetry.telemetrystream')),
            ],
            options={
                'ordering': ['received_at', 'pk'],
            },
        ),
        migrations.AddIndex(
            model_name='capture',
            index=django.contrib.postgres.indexes.BrinIndex(fields=['received_at'], name='capture_received_brin'),
        ),
        migrations.AddIndex(
            model_name='capture',
            index=models.Index(fields=['uav', '-taken_at'], name='capture_of_uav_idx'),
        ),
        migrations.AddIndex(
            model_name='capture',
            index=models.Index(condition=models.Q(('mission__isnull', False)), fields=['mission', 'taken_at'], name='capture_of_mission_idx'),
        ),
        migrations.AddConstraint(
            model_name='capturereport',
            constraint=models.UniqueConstraint(fields=('stream', 'key'), name='capture_report_once'),
        ),
    ]
