"""The sentence of each code that tells how far a simulation is, and why one ended."""

from operation.reasons import gettext_noop, register_sentences

SENTENCES = register_sentences({
    "waiting_for_worker": gettext_noop("Waiting for a worker"),
    # demo missions
    "demo_planning": gettext_noop("Planning “%(mission)s”"),
    "demo_starting_uavs": gettext_noop("Starting the simulated UAVs of “%(mission)s”"),
    "demo_loading": gettext_noop("Loading “%(mission)s”"),
    "demo_starting": gettext_noop("Starting “%(mission)s”"),
    "demo_flying": gettext_noop("Flying “%(mission)s”"),
    "demo_made": gettext_noop("Demo missions made"),
    "demo_region_removed": gettext_noop("The demo region was removed."),
    "demo_not_flown_in_time": gettext_noop("The demo missions were not flown in time."),
    "demo_simulation_failed": gettext_noop("The simulation of the demo mission failed."),
    "command_not_taken": gettext_noop("%(uav)s did not take a command."),
    "demo_failed": gettext_noop("The demo missions could not be made; the error is in the log."),
    # rehearsals
    "flying_run": gettext_noop("Flying %(number)s of %(all)s"),
    "rehearsed": gettext_noop("Rehearsed"),
    "changed_while_rehearsed": gettext_noop("The mission was changed while it was being rehearsed. Rehearse it again."),
    "ground_changed_while_rehearsed": gettext_noop(
        "Zones, terrain, towers or wires about the routes were changed while the mission was being rehearsed. Rehearse it again."
    ),
    "not_flown_in_time": gettext_noop("Not flown within %(minutes)s min. Rehearse fewer conditions at once, or split the mission."),
    "rehearsal_failed": gettext_noop("The rehearsal failed inside Spanwise; the error is in the log."),
})  # fmt: skip
