"""The sentence of each code for the progress of a simulation, and for why it ended."""

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
    # problems that simulated UAVs report
    "battery_at": gettext_noop("Battery %(percent)s %%"),
    "battery_low": gettext_noop("Battery low: %(percent)s %%"),
    "battery_low_hold": gettext_noop("Battery low: %(percent)s %%: hold"),
    "battery_low_return": gettext_noop("Battery low: %(percent)s %%: return"),
    "battery_low_land": gettext_noop("Battery low: %(percent)s %%: land"),
    "battery_critical": gettext_noop("Battery critical: %(percent)s %%"),
    "battery_critical_hold": gettext_noop("Battery critical: %(percent)s %%: hold"),
    "battery_critical_return": gettext_noop("Battery critical: %(percent)s %%: return"),
    "battery_critical_land": gettext_noop("Battery critical: %(percent)s %%: land"),
    "battery_empty": gettext_noop("Battery empty: the motors stop"),
    "battery_holds": gettext_noop("The battery holds %(percent)s %%."),
    "dead_reckoning": gettext_noop("No GPS fix, dead reckoning"),
    "gps_lost": gettext_noop("GPS lost"),
    "gps_lost_hold": gettext_noop("GPS lost: hold"),
    "gps_lost_return": gettext_noop("GPS lost: return"),
    "gps_lost_land": gettext_noop("GPS lost: land"),
    "no_gps_fix": gettext_noop("There is no GPS fix."),
    "no_mission": gettext_noop("There is no mission."),
    "take_off_not_flown": gettext_noop("A take-off to %(height)s m is not flown."),
    "touched_ground": gettext_noop("Touched the ground outside of a landing"),
    "overturned": gettext_noop("It overturned."),
    "hit_ground": gettext_noop("It hit the ground at %(speed)s m/s."),
    "flight_model_failed": gettext_noop("The flight model: %(error)s."),
    "crashed": gettext_noop("Crashed: %(reason)s"),
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
