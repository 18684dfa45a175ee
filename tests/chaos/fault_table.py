"""The fault table: every row with its parts. Experiments say their targets themselves; here stands what is shown if one fails to begin."""

from tests.chaos.rows import Elsewhere, Experiment, Row, Tests

UPLOADS = "tests/mavlink/mission_sync/test_lossy_upload.py"
GATEWAY = "tests/telemetry/gateway"
LIVE = "tests/telemetry/live"
WORKSPACE = "tests/workspace"

RELIABILITY = (
    Row(
        "R1", "200 items are uploaded over links that lose, double and reorder messages", 4.0,
        (
            Tests(
                "0, 10, 30 % of all messages lost each way, ACKs among them, 10 % doubled, 10 % reordered; two autopilots, 100 seeds",
                "100 % arrive byte for byte, exactly one mission active",
                (f"{UPLOADS}::test_upload_over_a_bad_link_arrives_byte_for_byte_and_is_the_only_one",),
                "{passed} of {all} uploads",
            ),
            Tests(
                "50 % lost each way", "arrives, or fails and says what is there; never a mix that is called whole",
                (f"{UPLOADS}::test_upload_over_half_a_link_arrives_or_fails_and_says_what_is_there",),
                "{passed} of {all} uploads",
            ),
        ),
    ),
    Row(
        "R2", "an upload is broken at every message", 0.5,
        (
            Tests(
                "either end dies at each message index",
                "PX4: a whole list of one or the other in 100 %; ArduPilot, whose uploads are not atomic: a mix is named",
                ("tests/mavlink/mission_sync/test_cut_uploads.py",), "{passed} of {all} families of cuts",
            ),
        ),
    ),
    Row(
        "R3", "commands under overload over bad links, by programs that are killed", 20.0,
        (
            Tests(
                "10,000 commands, 30 % lost each way, carriers killed 5 times",
                "0 lost, 0 out of order, every step told; p99 wait of the top priority at most 10 % of the lowest's",
                ("tests/telemetry/links/test_command_delivery.py",), "{passed} of {all} tests",
            ),
            Tests(
                "1,300 commands to 40 UAVs by MAVLink, 30 % lost each way, the gateway killed 5 times; overload with and without kills",
                "0 lost, 0 out of order; p99 wait of the top priority at most 10 % of the lowest's",
                (f"{GATEWAY}/commands/test_command_storm.py",), "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "R4", "a UAV's link is lost for 5 s to 10 min", 6.0,
        (
            Tests(
                "a vehicle with a buffer loses its link for 5, 60 and 600 s and sends what it kept, some of it twice",
                "0 records lost, 0 doubled",
                (f"{GATEWAY}/outages/test_outages.py::test_a_buffering_vehicle_loses_and_doubles_nothing",), "{passed} of {all} flights",
            ),
            Tests(
                "a UAV falls silent", "late and lost are told in time, once; it is heard again",
                ("tests/telemetry/alerts/test_alerting.py::test_a_uav_that_is_silent_is_late_then_lost_by_one_alert_and_heard_again_it_is_over",
                 "tests/telemetry/alerting/test_faults.py::test_each_fault_fifty_times"),
                "{passed} of {all} families of faults, 50 flights each",
            ),
            Tests(
                "where it is meanwhile, over 200 flights", "inside its bound in 95 of 100 seconds",
                ("tests/telemetry/estimation/test_accuracy.py",), "{passed} of {all} sets of flights",
            ),
        ),
    ),
    Row(
        "R5", "web, live, gateway, estimator and workers are killed under the mixed load", 22.0,
        (Experiment("kill -9 at random moments", "killed_programs", "0 acknowledged lost, 0 doubled; recovery p95 15 s, at most 30 s"),),
    ),
    Row(
        "R6", "Redis is killed and comes back empty", 8.0,
        (
            Experiment("kill -9 and emptied, under the mixed load", "emptied_redis", "all jobs end; pages live again within 10 s, no gap"),
            Tests(
                "killed and emptied ten times while a UAV reports and a page is open", "live again within 10 s each time, no record lost",
                (f"{LIVE}/test_outages.py",), "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "R7", "PostgreSQL is killed and away for 30 s", 7.0,
        (
            Experiment(
                "kill -9 and 30 s away under the mixed load", "database_away",
                "503 with Retry-After, never 500; no acknowledged write lost; every program at work again within 5 s, by itself",
            ),
            Tests(
                "killed 3 times while a gateway stores and carries", "0 stored or told records lost, 0 commands lost or out of order",
                (f"{GATEWAY}/outages/test_killed_database.py",), "{passed} of {all} tests",
            ),
            Tests(
                "every page and list of the API while it cannot be reached", "503 with Retry-After",
                (f"{WORKSPACE}/test_database_away.py",), "{passed} of {all} addresses",
            ),
        ),
    ),
    Row(
        "R8", "one of several web replicas is killed, another drained", 6.0,
        (
            Experiment("at the article's load of plans", "lost_replicas", "0 failed requests"),
            Tests(
                "one web program after the other is stopped and started again", "0 failed requests, GET and POST",
                ("tests/scripts/test_rolling_update.py",), "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "R9", "a job is delivered again and again", 12.0,
        (
            Tests(
                "a job longer than the visibility timeout; the same job delivered 5 times", "its effect exactly once, 5 of 5 harmless",
                ("tests/missions/commands/test_delivered_again.py",), "{passed} of {all} tests",
            ),
            Tests(
                "100 large plans, 20 workers killed", "every job ends once, every mission is planned once",
                ("tests/missions/test_lost_planners.py", "tests/inspection/test_lost_workers.py",
                 "tests/simulation/rehearsals/test_lost_rehearsals.py"),
                "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "R10", "500 pages are open, some of which read nothing", 7.0,
        (
            Experiment("stalled readers among 500", "stalled_readers", "live readers: 0 gaps; memory flat within 5 %"),
            Tests("a reader that stalls", "is told the latest of each object", (f"{LIVE}/test_slow_pages.py",), "{passed} of {all} tests"),
        ),
    ),
    Row(
        "R11", "clocks that are wrong", 4.0,
        (
            Experiment("the gateway, a worker and the web an hour and ten years off", "wrong_clocks", "see the row"),
            Tests(
                "a UAV's clock is wrong", "stored and flagged, never shown as the latest, nothing held up",
                ("tests/telemetry/test_ingest.py", "tests/telemetry/test_latest.py", "tests/telemetry/links/test_link_telemetry.py",
                 "tests/telemetry/links/test_link_results.py", f"{GATEWAY}/test_caution.py"),
                "{passed} of {all} tests", "future or clock or late or order",
            ),
        ),
    ),
    Row(
        "R12", "a new version beside the old one", 1.5,
        (
            Tests(
                "every migration", "the version before goes on beside it", ("tests/test_migrations.py",), "{passed} of {all} tests",
            ),
            Tests(
                "programs are told to stop while requests and tasks are under way", "0 requests and tasks lost, end within 10 s",
                ("tests/scripts/test_rolling_update.py", "tests/config/test_drained_workers.py"), "{passed} of {all} tests",
            ),
            Elsewhere(
                "1,000 requests during a migration", "0 errors",
                "not shown: there is one released version only; the rule for migrations keeps it, and the next release can measure it",
            ),
        ),
    ),
    Row(
        "R13", "backup, wipe, restore", 2.0,
        (
            Tests(
                "of the demo region, and of damaged, foreign and half backups", "row hashes equal, in 60 s; else nothing is changed",
                ("tests/scripts/test_backups.py",), "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "R14", "the disk is full", 4.0,
        (
            Experiment("a file system of 400 MiB is filled up while work goes on", "full_disk", "refusals told, nothing half written"),
            Tests(
                "the folder of flights' logs cannot be written", "nothing else stops",
                (f"{GATEWAY}/test_flight_logs.py::test_a_folder_that_cannot_be_written_stops_nothing",), "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "R15", "a long day at half of the peak", 0.0,
        (
            Elsewhere(
                "30 minutes of the mixed load", "memory slope below 1 % an hour, connections flat, invariants in SQL",
                "`python deploy/load/soak.py --write`: docs/load-tests.md",
            ),
        ),
    ),
)  # fmt: skip

SECURITY = (
    Row(
        "S1", "malformed datagrams", 4.0,
        (
            Tests(
                "1,100,000 datagrams, flipped, cut, random, foreign, among good ones", "0 crashes, every good one stored, memory flat",
                (f"{GATEWAY}/test_malformed.py",), "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "S2", "a signed link is attacked", 1.0,
        (
            Tests(
                "replayed, unsigned, wrong key, old, future, after a restart", "100 % refused and counted; the key in no log",
                (f"{GATEWAY}/test_signing.py", "tests/mavlink/test_signing.py"), "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "S3", "somebody reaches for what is not theirs", 1.5,
        (
            Tests(
                "every address of the API by every role, with rows of another organisation; UAVs as other UAVs", "0 wrongly allowed",
                (f"{WORKSPACE}/test_foreign_rows.py", f"{WORKSPACE}/sessions/test_roles.py",
                 "tests/telemetry/links/test_link_authentication.py", "tests/telemetry/links/test_link_route.py", f"{LIVE}/test_rights.py"),
                "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "S4", "websockets", 1.5,
        (
            Tests(
                "foreign and absent Origin, no session, session and role that end meanwhile, large and unknown words",
                "all refused; hung up on within 5 s",
                (f"{LIVE}/test_rights.py", f"{WORKSPACE}/live/test_live.py"), "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "S5", "hostile files", 2.0,
        (
            Tests(
                "zip and PBF bombs, slips, links, many entries, deep and large JSON, NaN, files cut and flipped anywhere",
                "refused, memory and disk bounded, nothing left",
                ("tests/inspection/importers/assets/test_hostile_files.py", "tests/inspection/importers/osm/test_hostile_files.py",
                 "tests/inspection/imports/test_uploads_api.py", "tests/inspection/geodesy/test_geometry_validator.py"),
                "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "S6", "odd zones", 6.0,
        (
            Tests(
                "the set of odd geometries, and random ones", "each has its result; the database is never asked to repair one",
                ("tests/inspection/zones", "tests/inspection/importers/zones", "tests/inspection/geodesy"), "{passed} of {all} tests",
            ),
            Tests(
                "2,200 random missions over real regions, judged by an exact test of their own", "0 routes cross a zone",
                ("tests/missions/property_tests/test_random_missions.py", "tests/missions/planning/test_zone_race.py"),
                "{passed} of {all} runs",
            ),
        ),
    ),
    Row(
        "S7", "guessing and flooding", 4.0,
        (
            Experiment("one user floods plans and lists", "request_flood", "429 before work; p95 of others changes by less than 20 %"),
            Tests(
                "passwords and tokens are guessed, names are hammered", "429 before work, nobody is kept out of their own account",
                (f"{WORKSPACE}/sessions/test_sign_in_limits.py", f"{WORKSPACE}/api/test_throttling.py"), "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "S8", "fetching from outside", 0.5,
        (
            Tests(
                "private addresses in every spelling, redirects, rebinding, drips, a gigabyte", "refused, time and size capped",
                (f"{WORKSPACE}/test_http_client.py",), "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "S9", "TLS", 2.0,
        (Experiment("redirect, HSTS, old versions, a new certificate under load", "certificates", "0 dropped requests"),),
    ),
    Row(
        "S10", "what tools find", 3.0,
        (
            Tests(
                "kubernetes-validate, kubectl kustomize, checkov, hadolint, schemas of compose and pipelines",
                "0 findings, each waiver with its reason", ("tests/deploy/test_tools.py", "tests/deploy/test_kubernetes.py"),
                "{passed} of {all} checks",
            ),
            Elsewhere("ruff with its security rules, check --deploy", "0 findings", "steps of every ./check"),
            Elsewhere("known vulnerabilities of libraries", "0", "needs a network: pipelines run pip-audit --strict"),
        ),
    ),
    Row(
        "S11", "whatever the API's own description allows is sent to it", 5.0,
        (
            Tests(
                "20,000 requests made from the OpenAPI document, a fixed seed", "0 answers 5xx, 0 statuses that are not described",
                (f"{WORKSPACE}/api/test_any_request.py",), "{passed} of {all} tests",
            ),
        ),
    ),
)  # fmt: skip

OPERATION = (
    Row(
        "O1", "a fresh machine", 1.0,
        (
            Elsewhere("./run and ./check from nothing", "3 and 10 min cold", "every pipeline begins so; needs an empty machine"),
            Tests(
                "the servers of a checkout and their supervisor are killed", "start again, with what was acknowledged",
                ("tests/scripts/test_supervision.py",), "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "O2", "the image in pods of the shipped YAML", 0.0,
        (
            Elsewhere(
                "each Deployment, read-only root, no capabilities, not root", "ready in 60 s, SIGTERM 10 s, one killed: 0 failed",
                "`python deploy/prove_image.py`: docs/deployment.md",
            ),
        ),
    ),
    Row(
        "O3", "programs follow the load", 0.0,
        (
            Elsewhere(
                "a local scaler on the signals of the autoscalers", "up and down with the article's ramp, 0 failed requests",
                "deploy/load: docs/load-tests.md; a HorizontalPodAutoscaler itself needs a cluster",
            ),
        ),
    ),
)  # fmt: skip

FLIGHT = (
    Row(
        "F1", "a route through what is closed is refused", 0.5,
        (
            Tests(
                "at the approval, by zones of that moment", "refused",
                ("tests/missions/test_approval.py",), "{passed} of {all} tests", "zone or ground or departure or battery",
            ),
        ),
    ),
    Row(
        "F2", "a zone comes across a mission that flies", 0.5,
        (
            Tests(
                "a zone is saved around a flying UAV", "told within 5 s, another plan is offered",
                ("tests/telemetry/alerts/test_alerting.py::test_a_zone_that_is_saved_around_a_flying_uav_is_told",
                 "tests/telemetry/alerts/test_replan_hooks.py"),
                "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "F3", "a battery that does not suffice", 0.5,
        (
            Tests(
                "when planning, and in flight", "refused with what lacks; told",
                ("tests/missions/planning/test_batteries.py", "tests/telemetry/alerts/test_replan_hooks.py"), "{passed} of {all} tests",
            ),
        ),
    ),
    Row(
        "F4", "two flights in conflict", 2.0,
        (
            Tests(
                "two missions at one time and place; two UAVs that meet, 50 pairs", "not both approved; told in time and once",
                ("tests/missions/test_approval.py::test_two_missions_on_the_same_way_at_the_same_time_are_not_both_approved",
                 "tests/missions/planning/test_other_flights.py", "tests/telemetry/alerting/test_conflicts.py"),
                "{passed} of {all} tests",
            ),
        ),
    ),
)  # fmt: skip

ROWS = (*RELIABILITY, *SECURITY, *OPERATION, *FLIGHT)
