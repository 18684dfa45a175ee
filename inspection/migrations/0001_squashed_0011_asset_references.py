"""The tables as they were after 0011_asset_references: one migration instead of 11.

An installation that has applied all of them counts this one as applied. An older one is first updated
to the last version that has them.
"""

import django.contrib.gis.db.models.fields
import django.contrib.postgres.fields
import django.contrib.postgres.indexes
import django.contrib.postgres.operations
import django.db.models.deletion
import django.db.models.functions.datetime
import django.db.models.functions.text
import uuid
from django.conf import settings
from django.db import migrations, models


class Migration(migrations.Migration):

    replaces = [('inspection', '0001_initial'), ('inspection', '0002_initial'), ('inspection', '0003_asset_parts'), ('inspection', '0004_names_in_the_admin'), ('inspection', '0005_supports_on_their_line'), ('inspection', '0006_trusted_data'), ('inspection', '0007_gap_search'), ('inspection', '0008_lines_by_importance'), ('inspection', '0009_search_by_voltage'), ('inspection', '0010_records_not_read'), ('inspection', '0011_asset_references')]

    initial = True

    dependencies = [
        ('workspace', '0001_squashed_0010_service_accounts'),
        ('workspace', '__first__'),
    ]

    operations = [
        django.contrib.postgres.operations.CreateExtension(
            name='postgis',
        ),
        django.contrib.postgres.operations.TrigramExtension(
        ),
        migrations.CreateModel(
            name='GraphSnapshot',
            fields=[
                ('version', models.BigAutoField(primary_key=True, serialize=False)),
                ('ground_revision', models.PositiveBigIntegerField(help_text='the ground that it shows')),
                ('rules', models.JSONField(help_text='the linking rules that it was built with')),
                ('nodes', models.PositiveIntegerField()),
                ('edges', models.PositiveIntegerField()),
                ('components', models.PositiveIntegerField()),
                ('excluded_nodes', models.PositiveIntegerField()),
                ('excluded_edges', models.PositiveIntegerField()),
                ('arrays', models.BinaryField(help_text='npz, see inspection/network/snapshot_file.py')),
                ('arrays_sha256', models.CharField(max_length=64)),
                ('build_s', models.FloatField()),
                ('built_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
            ],
            options={
                'ordering': ['-version'],
            },
        ),
        migrations.CreateModel(
            name='DataImport',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('kind', models.CharField(choices=[('osm', 'OpenStreetMap'), ('zones', 'No-fly zones'), ('assets', 'Asset file'), ('terrain', 'Terrain')], max_length=20)),
                ('file_name', models.CharField(max_length=255)),
                ('sha256', models.CharField(max_length=64)),
                ('attribution', models.CharField(blank=True, max_length=300)),
                ('licence', models.CharField(blank=True, max_length=200)),
                ('source_address', models.URLField(blank=True, help_text='where the file was fetched; empty for one that somebody sent', max_length=500)),
                ('fetched_at', models.DateTimeField(blank=True, null=True)),
                ('valid_from', models.DateTimeField(blank=True, help_text='as the file states it', null=True)),
                ('valid_until', models.DateTimeField(blank=True, help_text='as the file states it', null=True)),
                ('is_synthetic', models.BooleanField(default=False, help_text='made data, such as the demo region; said wherever it is shown')),
                ('data_timestamp', models.DateTimeField(blank=True, help_text='how fresh the file says that its data is', null=True)),
                ('counts', models.JSONField(default=dict)),
                ('imported_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('imported_by', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, to=settings.AUTH_USER_MODEL)),
            ],
            options={
                'ordering': ['-imported_at', '-pk'],
            },
        ),
        migrations.CreateModel(
            name='AssetSet',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('name', models.CharField(max_length=200, unique=True)),
                ('mapping', models.JSONField(blank=True, default=dict, help_text='which column says what; kept for the next file')),
                ('data_import', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='asset_sets', to='inspection.dataimport')),
            ],
            options={
                'ordering': ['name'],
            },
        ),
        migrations.CreateModel(
            name='Asset',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('kind', models.CharField(choices=[('tower', 'Power tower'), ('line', 'Power line'), ('railway', 'Railway'), ('bridge', 'Bridge')], max_length=20)),
                ('subtype', models.CharField(blank=True, help_text='tower, pole, portal; line, minor_line, cable; rail, tram; way, area', max_length=40)),
                ('osm_type', models.CharField(blank=True, choices=[('n', 'Node'), ('w', 'Way'), ('r', 'Relation')], max_length=1)),
                ('osm_id', models.BigIntegerField(blank=True, null=True)),
                ('source_key', models.CharField(blank=True, db_default='', default='', help_text="the asset's own key in its set", max_length=200)),
                ('geometry', django.contrib.gis.db.models.fields.GeometryField(srid=4326)),
                ('centre', django.contrib.gis.db.models.fields.PointField(help_text='where the asset is drawn and targeted as a point', srid=4326)),
                ('name', models.CharField(blank=True, max_length=255)),
                ('ref', models.CharField(blank=True, max_length=255)),
                ('operator', models.CharField(blank=True, max_length=255)),
                ('voltages_v', django.contrib.postgres.fields.ArrayField(base_field=models.PositiveIntegerField(), blank=True, default=list, help_text='highest first', size=None)),
                ('max_voltage_v', models.PositiveIntegerField(blank=True, null=True)),
                ('circuits', models.PositiveSmallIntegerField(blank=True, null=True)),
                ('height_m', models.FloatField(blank=True, help_text='above ground, as tagged; empty when not stated', null=True)),
                ('length_m', models.FloatField(blank=True, help_text='geodesic length of a line or railway', null=True)),
                ('is_flyable', models.BooleanField(default=True, help_text='part of the inspection graph: not underground, disused, a busbar or a bay')),
                ('node_osm_ids', django.contrib.postgres.fields.ArrayField(base_field=models.BigIntegerField(), blank=True, default=list, editable=False, help_text='OSM node of each vertex of a way', size=None)),
                ('tags', models.JSONField(blank=True, default=dict)),
                ('parts', models.JSONField(blank=True, default=list, editable=False, help_text='the OSM ways on a bridge\'s area: [{"osm_id", "tags"}]')),
                ('place_on_line', models.PositiveSmallIntegerField(editable=False, help_text="counted from 1 in the line's direction", null=True)),
                ('places_on_line', models.PositiveSmallIntegerField(editable=False, help_text="the line's supports", null=True)),
                ('carries', models.GeneratedField(db_persist=True, expression=models.Case(models.When(models.Q(('kind', 'bridge'), _negated=True), then=models.Value('')), models.When(models.Q(models.Q(models.Func(models.F('tags'), models.Value('$.highway ? (!(@ like_regex "^(footway|path|pedestrian|steps|cycleway|bridleway|corridor|platform)$"))'), function='jsonb_path_exists', output_field=models.BooleanField()), models.Func(models.F('parts'), models.Value('$[*].tags.highway ? (!(@ like_regex "^(footway|path|pedestrian|steps|cycleway|bridleway|corridor|platform)$"))'), function='jsonb_path_exists', output_field=models.BooleanField()), _connector='OR'), models.Q(models.Func(models.F('tags'), models.Value('$.railway ? (@ like_regex "^(rail|light_rail|narrow_gauge|tram|subway|monorail|funicular|preserved|miniature)$")'), function='jsonb_path_exists', output_field=models.BooleanField()), models.Func(models.F('parts'), models.Value('$[*].tags.railway ? (@ like_regex "^(rail|light_rail|narrow_gauge|tram|subway|monorail|funicular|preserved|miniature)$")'), function='jsonb_path_exists', output_field=models.BooleanField()), _connector='OR')), then=models.Value('a road and a railway')), models.When(models.Q(models.Func(models.F('tags'), models.Value('$.railway ? (@ like_regex "^(rail|light_rail|narrow_gauge|tram|subway|monorail|funicular|preserved|miniature)$")'), function='jsonb_path_exists', output_field=models.BooleanField()), models.Func(models.F('parts'), models.Value('$[*].tags.railway ? (@ like_regex "^(rail|light_rail|narrow_gauge|tram|subway|monorail|funicular|preserved|miniature)$")'), function='jsonb_path_exists', output_field=models.BooleanField()), _connector='OR'), then=models.Value('a railway')), models.When(models.Q(models.Func(models.F('tags'), models.Value('$.highway ? (!(@ like_regex "^(footway|path|pedestrian|steps|cycleway|bridleway|corridor|platform)$"))'), function='jsonb_path_exists', output_field=models.BooleanField()), models.Func(models.F('parts'), models.Value('$[*].tags.highway ? (!(@ like_regex "^(footway|path|pedestrian|steps|cycleway|bridleway|corridor|platform)$"))'), function='jsonb_path_exists', output_field=models.BooleanField()), _connector='OR'), then=models.Value('a road')), models.When(models.Q(models.Func(models.F('tags'), models.Value('$.highway ? (@ like_regex "^(footway|path|pedestrian|steps|cycleway|bridleway|corridor|platform)$")'), function='jsonb_path_exists', output_field=models.BooleanField()), models.Func(models.F('parts'), models.Value('$[*].tags.highway ? (@ like_regex "^(footway|path|pedestrian|steps|cycleway|bridleway|corridor|platform)$")'), function='jsonb_path_exists', output_field=models.BooleanField()), _connector='OR'), then=models.Value('a path')), models.When(models.Q(models.Func(models.F('tags'), models.Value('$.waterway'), function='jsonb_path_exists', output_field=models.BooleanField()), models.Func(models.F('parts'), models.Value('$[*].tags.waterway'), function='jsonb_path_exists', output_field=models.BooleanField()), _connector='OR'), then=models.Value('water')), models.When(models.Q(models.Func(models.F('tags'), models.Value('$.man_made ? (@ == "pipeline")'), function='jsonb_path_exists', output_field=models.BooleanField()), models.Func(models.F('parts'), models.Value('$[*].tags.man_made ? (@ == "pipeline")'), function='jsonb_path_exists', output_field=models.BooleanField()), _connector='OR'), then=models.Value('a pipeline')), default=models.Value('')), output_field=models.CharField(max_length=30))),
                ('content_hash', models.CharField(blank=True, editable=False, help_text='of what the last import said', max_length=64)),
                ('is_edited', models.BooleanField(default=False, help_text='changed by a curator; imports leave the row alone')),
                ('source_facts', models.JSONField(blank=True, editable=False, help_text='of an edited row: what its source says, brought up to date by imports', null=True)),
                ('revision', models.PositiveIntegerField(db_default=1, default=1, editable=False, help_text='counts the changes; what If-Match compares')),
                ('vanished_at', models.DateTimeField(blank=True, help_text='when an import no longer had it', null=True)),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('updated_at', models.DateTimeField(auto_now=True)),
                ('line', models.ForeignKey(editable=False, help_text='of a support: the line of the highest voltage that it carries; see services/ground.py', null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='supports', to='inspection.asset')),
                ('asset_set', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='assets', to='inspection.assetset')),
                ('data_import', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='assets', to='inspection.dataimport')),
            ],
            options={
                'ordering': ['pk'],
                'indexes': [models.Index(fields=['kind', 'id'], name='asset_kind_idx'), models.Index(models.OrderBy(models.F('max_voltage_v'), descending=True, nulls_last=True), models.OrderBy(models.F('length_m'), descending=True, nulls_last=True), condition=models.Q(('kind', 'line'), ('vanished_at', None)), name='asset_lines_idx'), models.Index(fields=['osm_type', 'osm_id'], name='asset_osm_idx'), django.contrib.postgres.indexes.GinIndex(fields=['voltages_v'], name='asset_voltages_idx'), django.contrib.postgres.indexes.GinIndex(django.contrib.postgres.indexes.OpClass(django.db.models.functions.text.Upper('name'), name='gin_trgm_ops'), django.contrib.postgres.indexes.OpClass(django.db.models.functions.text.Upper('ref'), name='gin_trgm_ops'), django.contrib.postgres.indexes.OpClass(django.db.models.functions.text.Upper('operator'), name='gin_trgm_ops'), name='asset_text_idx')],
                'constraints': [models.UniqueConstraint(condition=models.Q(('osm_id__isnull', False)), fields=('kind', 'osm_type', 'osm_id'), name='asset_osm_key'), models.UniqueConstraint(condition=models.Q(('source_key', ''), _negated=True), fields=('asset_set', 'kind', 'source_key'), name='asset_set_key'), models.CheckConstraint(condition=models.Q(('kind__in', ['tower', 'line', 'railway', 'bridge'])), name='asset_kind_known')],
            },
        ),
        migrations.CreateModel(
            name='Bridge',
            fields=[
            ],
            options={
                'proxy': True,
                'indexes': [],
                'constraints': [],
            },
            bases=('inspection.asset',),
        ),
        migrations.CreateModel(
            name='PowerLine',
            fields=[
            ],
            options={
                'proxy': True,
                'indexes': [],
                'constraints': [],
            },
            bases=('inspection.asset',),
        ),
        migrations.CreateModel(
            name='PowerTower',
            fields=[
            ],
            options={
                'proxy': True,
                'indexes': [],
                'constraints': [],
            },
            bases=('inspection.asset',),
        ),
        migrations.CreateModel(
            name='Railway',
            fields=[
            ],
            options={
                'proxy': True,
                'indexes': [],
                'constraints': [],
            },
            bases=('inspection.asset',),
        ),
        migrations.CreateModel(
            name='GapSearch',
            fields=[
                ('id', models.PositiveSmallIntegerField(default=1, primary_key=True, serialize=False)),
                ('ground_revision', models.PositiveBigIntegerField()),
                ('ground_changed_at', models.DateTimeField(help_text='two grounds may have the same revision', null=True)),
                ('recipe', models.PositiveSmallIntegerField(help_text='of quality/repair.py')),
                ('found', models.PositiveIntegerField()),
                ('search_s', models.FloatField()),
                ('searched_at', models.DateTimeField()),
            ],
            options={
                'verbose_name_plural': 'gap searches',
                'constraints': [models.CheckConstraint(condition=models.Q(('id', 1)), name='gap_search_single')],
            },
        ),
        migrations.CreateModel(
            name='Ground',
            fields=[
                ('id', models.PositiveSmallIntegerField(default=1, primary_key=True, serialize=False)),
                ('revision', models.PositiveBigIntegerField(default=0)),
                ('changed_at', models.DateTimeField(null=True)),
            ],
            options={
                'verbose_name_plural': 'ground',
                'constraints': [models.CheckConstraint(condition=models.Q(('id', 1)), name='ground_single')],
            },
        ),
        migrations.CreateModel(
            name='TerrainTile',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('extent', django.contrib.gis.db.models.fields.PolygonField(srid=4326)),
                ('west_deg', models.FloatField(help_text='longitude of the centre of the first column')),
                ('north_deg', models.FloatField(help_text='latitude of the centre of the first row')),
                ('step_lon_deg', models.FloatField()),
                ('step_lat_deg', models.FloatField()),
                ('columns', models.PositiveIntegerField()),
                ('rows', models.PositiveIntegerField()),
                ('heights_amsl_m', models.BinaryField()),
                ('vertical_datum', models.CharField(default='EGM96', max_length=50)),
                ('data_import', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='terrain_tiles', to='inspection.dataimport')),
            ],
        ),
        migrations.CreateModel(
            name='Upload',
            fields=[
                ('id', models.UUIDField(default=uuid.uuid4, editable=False, primary_key=True, serialize=False)),
                ('file_name', models.CharField(max_length=255)),
                ('size_bytes', models.BigIntegerField()),
                ('received_bytes', models.BigIntegerField(default=0, help_text='without a gap from the start')),
                ('sha256', models.CharField(blank=True, help_text='of the whole file, once it is here', max_length=64)),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('updated_at', models.DateTimeField(auto_now=True)),
                ('created_by', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, to=settings.AUTH_USER_MODEL)),
            ],
            options={
                'ordering': ['-created_at'],
                'constraints': [models.CheckConstraint(condition=models.Q(('received_bytes__gte', 0), ('received_bytes__lte', models.F('size_bytes'))), name='upload_within_size')],
            },
        ),
        migrations.CreateModel(
            name='ImportProposal',
            fields=[
                ('id', models.UUIDField(default=uuid.uuid4, editable=False, primary_key=True, serialize=False)),
                ('kind', models.CharField(choices=[('osm', 'OpenStreetMap'), ('zones', 'No-fly zones'), ('assets', 'Asset file'), ('terrain', 'Terrain')], max_length=20)),
                ('origin', models.CharField(choices=[('upload', 'Uploaded file'), ('overpass', 'Overpass'), ('subscription', 'Subscription'), ('roll_back', 'Roll-back')], default='upload', max_length=20)),
                ('state', models.CharField(choices=[('reading', 'Reading'), ('refused', 'Refused'), ('ready', 'Ready to look at'), ('applying', 'Applying'), ('applied', 'Applied'), ('discarded', 'Discarded')], default='reading', max_length=20)),
                ('file_name', models.CharField(blank=True, max_length=255)),
                ('parameters', models.JSONField(blank=True, default=dict, help_text="such as the zone set's name, the column mapping, the vertical datum")),
                ('provenance', models.JSONField(blank=True, default=dict, help_text='source_address, licence, attribution, fetched_at')),
                ('faults', models.JSONField(blank=True, default=list, help_text='[{"place", "message", "position"}] of a refused file')),
                ('summary', models.JSONField(blank=True, default=dict, help_text='what is in the file')),
                ('difference', models.JSONField(blank=True, default=dict, help_text='numbers of changes by action')),
                ('ground_revision', models.PositiveBigIntegerField(blank=True, help_text='the ground that the difference was taken against', null=True)),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('decided_at', models.DateTimeField(blank=True, null=True)),
                ('created_by', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to=settings.AUTH_USER_MODEL)),
                ('data_import', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='proposals', to='inspection.dataimport')),
                ('decided_by', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to=settings.AUTH_USER_MODEL)),
                ('job', models.ForeignKey(blank=True, help_text='that reads or applies it', null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to='workspace.job')),
                ('upload', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='proposals', to='inspection.upload')),
            ],
            options={
                'ordering': ['-created_at', '-pk'],
                'constraints': [models.CheckConstraint(condition=models.Q(('state__in', ['reading', 'refused', 'ready', 'applying', 'applied', 'discarded'])), name='proposal_state_known')],
            },
        ),
        migrations.CreateModel(
            name='ProposedChange',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('action', models.CharField(choices=[('new', 'New'), ('changed', 'Changed'), ('vanished', 'Vanished'), ('kept', 'Kept as edited by hand'), ('not_read', 'Not read')], max_length=20)),
                ('subject', models.CharField(help_text='asset kind, or zone', max_length=20)),
                ('subject_id', models.BigIntegerField(blank=True, help_text='of the row that it changes', null=True)),
                ('label', models.CharField(max_length=300)),
                ('geometry', django.contrib.gis.db.models.fields.GeometryField(blank=True, null=True, srid=4326)),
                ('before', models.JSONField(blank=True, help_text='facts that differ, as they are', null=True)),
                ('after', models.JSONField(blank=True, help_text='facts that differ, as they would be', null=True)),
                ('proposal', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='changes', to='inspection.importproposal')),
            ],
            options={
                'ordering': ['pk'],
                'indexes': [models.Index(fields=['proposal', 'action', 'id'], name='change_action_idx')],
            },
        ),
        migrations.CreateModel(
            name='UploadPart',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('first_byte', models.BigIntegerField()),
                ('content', models.BinaryField()),
                ('upload', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='parts', to='inspection.upload')),
            ],
            options={
                'ordering': ['first_byte'],
                'constraints': [models.UniqueConstraint(fields=('upload', 'first_byte'), name='upload_part_place')],
            },
        ),
        migrations.CreateModel(
            name='ZoneSet',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('name', models.CharField(max_length=200, unique=True)),
                ('source_format', models.CharField(blank=True, max_length=20)),
                ('data_import', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='zone_sets', to='inspection.dataimport')),
            ],
            options={
                'ordering': ['name'],
            },
        ),
        migrations.CreateModel(
            name='NoFlyZone',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('identifier', models.CharField(help_text="the source's own key", max_length=100)),
                ('layer', models.PositiveSmallIntegerField(default=0)),
                ('name', models.CharField(max_length=255)),
                ('geometry', django.contrib.gis.db.models.fields.MultiPolygonField(srid=4326)),
                ('restriction', models.CharField(blank=True, max_length=100)),
                ('reason', models.CharField(blank=True, max_length=255)),
                ('lower_limit_m', models.FloatField(blank=True, null=True)),
                ('lower_reference', models.CharField(blank=True, choices=[('AGL', 'above ground'), ('AMSL', 'above sea level'), ('WGS84', 'above the ellipsoid'), ('STD', 'flight level, metres of standard pressure altitude')], max_length=5)),
                ('upper_limit_m', models.FloatField(blank=True, null=True)),
                ('upper_reference', models.CharField(blank=True, choices=[('AGL', 'above ground'), ('AMSL', 'above sea level'), ('WGS84', 'above the ellipsoid'), ('STD', 'flight level, metres of standard pressure altitude')], max_length=5)),
                ('source_heights', models.JSONField(blank=True, default=dict, help_text='limits, unit and references as the file gives them')),
                ('circle', models.JSONField(blank=True, help_text='{"centre": [lon, lat], "radius_m": number}; the polygon encloses it', null=True)),
                ('schedule', models.JSONField(blank=True, help_text='periods of applicability as the file gives them; null = permanent', null=True)),
                ('properties', models.JSONField(blank=True, default=dict, help_text='everything else that the source says')),
                ('is_edited', models.BooleanField(db_default=False, default=False, help_text='changed by a curator; imports leave the row alone unless told otherwise')),
                ('revision', models.PositiveIntegerField(db_default=1, default=1, editable=False, help_text='counts the changes; what If-Match compares')),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('updated_at', models.DateTimeField(auto_now=True)),
                ('zone_set', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.CASCADE, related_name='zones', to='inspection.zoneset')),
            ],
            options={
                'verbose_name': 'no-fly zone',
                'ordering': ['pk'],
                'constraints': [models.UniqueConstraint(fields=('zone_set', 'identifier', 'layer'), name='zone_source_key'), models.CheckConstraint(condition=models.Q(('lower_limit_m', None), ('upper_limit_m', None), models.Q(('lower_reference', models.F('upper_reference')), _negated=True), ('upper_limit_m__gte', models.F('lower_limit_m')), _connector='OR'), name='zone_band_upright')],
            },
        ),
        migrations.CreateModel(
            name='ZoneSetVersion',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('number', models.PositiveIntegerField(help_text='counted from 1 in the set')),
                ('zones', models.PositiveIntegerField()),
                ('content', models.BinaryField(help_text='JSON of every zone, zlib')),
                ('created_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('created_by', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to=settings.AUTH_USER_MODEL)),
                ('data_import', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to='inspection.dataimport')),
                ('zone_set', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='versions', to='inspection.zoneset')),
            ],
            options={
                'ordering': ['-number'],
                'constraints': [models.UniqueConstraint(fields=('zone_set', 'number'), name='zone_set_version_number')],
            },
        ),
        migrations.CreateModel(
            name='ZoneSubscription',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('address', models.URLField(max_length=500)),
                ('source_format', models.CharField(blank=True, help_text='ed269, ed318, openair, geojson; empty = found out from the file', max_length=20)),
                ('licence', models.CharField(blank=True, max_length=200)),
                ('attribution', models.CharField(blank=True, max_length=300)),
                ('interval_h', models.PositiveIntegerField(default=24)),
                ('is_active', models.BooleanField(default=True)),
                ('etag', models.CharField(blank=True, editable=False, max_length=300)),
                ('last_modified', models.CharField(blank=True, editable=False, max_length=100)),
                ('next_fetch_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now())),
                ('fetched_at', models.DateTimeField(blank=True, help_text='when the source last answered', null=True)),
                ('sha256', models.CharField(blank=True, editable=False, help_text='of what it answered', max_length=64)),
                ('problem', models.CharField(blank=True, help_text='why the last fetch brought nothing; empty = it did', max_length=500)),
                ('failures', models.PositiveSmallIntegerField(default=0, help_text='one after the other')),
                ('proposal', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to='inspection.importproposal')),
                ('zone_set', models.OneToOneField(on_delete=django.db.models.deletion.CASCADE, related_name='subscription', to='inspection.zoneset')),
            ],
            options={
                'ordering': ['zone_set__name'],
            },
        ),
        migrations.CreateModel(
            name='AssetReference',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('external_id', models.CharField(blank=True, db_default='', default='', max_length=200)),
                ('attributes', models.JSONField(blank=True, db_default={}, default=dict)),
                ('updated_at', models.DateTimeField(auto_now=True, db_default=django.db.models.functions.datetime.Now())),
                ('asset', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='references', to='inspection.asset')),
                ('organisation', models.ForeignKey(on_delete=django.db.models.deletion.CASCADE, related_name='asset_references', to='workspace.organisation')),
            ],
            options={
                'ordering': ['pk'],
                'constraints': [models.UniqueConstraint(fields=('organisation', 'asset'), name='asset_reference_one_each'), models.UniqueConstraint(condition=models.Q(('external_id', ''), _negated=True), fields=('organisation', 'external_id'), name='asset_external_id_unique')],
            },
        ),
        migrations.CreateModel(
            name='DataGap',
            fields=[
                ('id', models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name='ID')),
                ('kind', models.CharField(choices=[('long_span', "Span far longer than the line's others"), ('missing_support', 'Line vertex without a tower'), ('tower_on_no_line', 'Tower on no line'), ('line_without_towers', 'Line without towers'), ('dead_end', 'Line that ends in nothing'), ('ends_apart', 'Ends that should join'), ('bridge_without_way', 'Bridge without a way'), ('impossible_voltage', 'Impossible voltage')], max_length=30)),
                ('key', models.CharField(help_text='kind and the places that it is about; the same on every run', max_length=200, unique=True)),
                ('state', models.CharField(choices=[('open', 'Open'), ('repaired', 'Repaired'), ('dismissed', 'Left as it is')], default='open', max_length=20)),
                ('position', django.contrib.gis.db.models.fields.PointField(srid=4326)),
                ('geometry', django.contrib.gis.db.models.fields.GeometryField(blank=True, help_text='what to draw: the span, the two ends', null=True, srid=4326)),
                ('details', models.JSONField(blank=True, default=dict, help_text='figures with units in their names')),
                ('cut_off_m', models.FloatField(default=0.0, help_text='length of network that it cuts off')),
                ('ground_revision', models.PositiveBigIntegerField(help_text='where it was last found')),
                ('note', models.CharField(blank=True, max_length=500)),
                ('decided_at', models.DateTimeField(blank=True, null=True)),
                ('found_at', models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ('asset', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.CASCADE, related_name='gaps', to='inspection.asset')),
                ('decided_by', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to=settings.AUTH_USER_MODEL)),
                ('other_asset', models.ForeignKey(blank=True, null=True, on_delete=django.db.models.deletion.SET_NULL, related_name='+', to='inspection.asset')),
            ],
            options={
                'ordering': ['-cut_off_m', 'pk'],
                'indexes': [models.Index(fields=['state', '-cut_off_m', 'id'], name='gap_worst_idx')],
                'constraints': [models.CheckConstraint(condition=models.Q(('kind__in', ['long_span', 'missing_support', 'tower_on_no_line', 'line_without_towers', 'dead_end', 'ends_apart', 'bridge_without_way', 'impossible_voltage'])), name='gap_kind_known'), models.CheckConstraint(condition=models.Q(('state__in', ['open', 'repaired', 'dismissed'])), name='gap_state_known')],
            },
        ),
    ]
