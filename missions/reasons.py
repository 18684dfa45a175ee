"""Texts of the reason codes of commands, offers and plans."""

from operation.reasons import gettext_noop, ngettext_noop, register_sentences

SENTENCES = register_sentences({
    # codes with which the outbox ends commands
    "superseded": gettext_noop("A later command took its place: %(command)s."),
    "command_upload-mission": gettext_noop("Send the mission"),
    "command_clear-mission": gettext_noop("Take the mission off the UAV"),
    "command_arm": gettext_noop("Arm"),
    "command_take-off": gettext_noop("Take off"),
    "command_start": gettext_noop("Start the mission"),
    "command_pause": gettext_noop("Pause"),
    "command_resume": gettext_noop("Resume"),
    "command_hold": gettext_noop("Hold"),
    "command_return": gettext_noop("Return"),
    "command_land": gettext_noop("Land"),
    "command_abort": gettext_noop("Abort the mission"),
    "command_change-speed": gettext_noop("Change speed"),
    "command_set-return-height": gettext_noop("Set the return height"),
    "not_delivered": gettext_noop("It could not be delivered in time."),
    "not_sent_in_time": gettext_noop("It was not sent in time."),
    "unconfirmed": gettext_noop("It was sent; whether it was done is not known."),
    "unacknowledged": gettext_noop(
        "Sent again and again; nothing is heard from the UAV, and whether it does it is not known."
    ),
    "withdrawn": gettext_noop("It was withdrawn before it was sent."),
    "revoked": gettext_noop("The approval was revoked."),
    "simulation_ended": gettext_noop("The simulation has ended."),
    # offers of another plan while a mission flies
    "working_out_rest": gettext_noop("Working out what is left"),
    "looking_up_rest": gettext_noop("Looking up what is left"),
    "comparing_shares": gettext_noop("Comparing ways to share it out"),
    "worked_out": gettext_noop("Worked out"),
    "asked_for_again": gettext_noop("It was asked for again."),
    "something_else_happened": gettext_noop("Something else has happened since."),
    "not_worked_out_in_time": gettext_noop("It was not worked out in time."),
    "mission_not_flying": gettext_noop("The mission does not fly any more."),
    "worked_out_too_long_ago": gettext_noop("It was worked out too long ago."),
    "nothing_would_change": gettext_noop("Nothing would change: the UAVs fly on as they do."),
    "nobody_else_in_air": gettext_noop("No other UAV of the mission is in the air."),
    "battery_short_for_route": gettext_noop("Its battery does not last for its route."),
    "zone_across_route": gettext_noop("%(zone)s lies across its route."),
    "taken_over": gettext_noop("Taken over by %(mission)s."),
    "continues": gettext_noop("Continues %(mission)s."),
    "other_command_since": gettext_noop("%(uav)s was given another command since."),
    "reason_has_ended": gettext_noop("Its reason has ended: %(uav)s continues its mission."),
    "target_done_meanwhile": gettext_noop("%(target)s was done meanwhile."),
    "not_as_reckoned": gettext_noop("%(uav)s is not where it was reckoned to be."),
    "passed_diversion": gettext_noop("%(uav)s has passed the diversion point."),
    "place_unknown": gettext_noop("%(uav)s: no recent telemetry, position unknown."),
    "nobody_knows_where": gettext_noop("Nobody knows where %(uav)s is."),
    "dropped_out": gettext_noop("%(uav)s has dropped out."),
    "coming_down": gettext_noop("%(uav)s was told to come down."),
    "not_of_fleet": gettext_noop("%(uav)s is not a UAV of the fleet: it cannot be sent anything."),
    "flown_by_companion": gettext_noop("%(uav)s is flown by a companion computer, which is not given another mission in the air."),
    "not_taken_off": gettext_noop("%(uav)s has not taken off."),
    "several_flights": gettext_noop("%(uav)s flies its route in several flights, and lands in between."),
    "off_route": gettext_noop("%(uav)s is %(metres)s m off its route."),
    "below_take_off": gettext_noop("%(uav)s would fly below the place where it took off."),
    "battery_does_not_last": gettext_noop("The battery of %(uav)s does not last for it."),
    "too_little_route_left": gettext_noop(
        "%(uav)s comes to it too soon, or has too little of its route left. Hold it, and plan the rest again."
    ),
    "takes_photos": gettext_noop("%(uav)s takes photos beside wires. Change its route when it is on its way again."),
    "no_range_left": gettext_noop("%(uav)s has no range left."),
    "too_little_battery_left": gettext_noop("%(uav)s has too little battery left."),
    "does_as_many_as_it_may": gettext_noop("%(uav)s does as many targets as it may."),
    "flight_failed": gettext_noop("A flight of %(uav)s has failed: it does not fly on in this mission."),
    # imports
    "touches_flown_missions": gettext_noop(
        "Missions that are flown or were sent to UAVs and whose targets or routes it touches: %(number)s."
    ),
    # jobs that plan
    "planning_targets": ngettext_noop("Planning %(count)s target", "Planning %(count)s targets"),
    "looking_up_targets": gettext_noop("Looking up the targets"),
    "planning_photos": gettext_noop("Planning photos: target %(target)s of %(targets)s"),
    "looking_for_better_plan": gettext_noop("Looking for a better plan"),
    "proof_ended": gettext_noop("Looked for a better plan"),
    "planned": gettext_noop("Planned"),
    "campaign_planned": ngettext_noop("Planned %(count)s mission", "Planned %(count)s missions"),
    "too_many_missions": gettext_noop(
        "It would take more than %(most)s missions. Allow a greater distance from launch sites, or choose fewer targets."
    ),
    "campaign_missions_in_use": ngettext_noop(
        "%(count)s mission of this campaign is approved or has flown. Its missions stay as they are.",
        "%(count)s missions of this campaign are approved or have flown. Its missions stay as they are.",
    ),
    "campaign_deleted": gettext_noop("The campaign has been deleted."),
    "planning_stopped": gettext_noop("Stopped; the best plan until then is kept"),
    "no_network": gettext_noop("There is no network yet: import infrastructure first, or wait until it has been linked."),
    "zones_changing": gettext_noop("The no-fly zones are being changed just now. Plan again in a moment."),
    "mission_changed": gettext_noop("The mission was changed while its plan was being made. Plan it again."),
    "mission_frozen": gettext_noop("Only drafts and planned missions can be planned."),
    "nothing_to_plan": gettext_noop("A mission needs at least one UAV and one target."),
    "no_plan_in_time": gettext_noop("No plan within %(minutes)s min. Split the mission."),
    "planner_failed": gettext_noop("The planner failed; the error is in the log."),
})  # fmt: skip
