"""Commands and offers that ended with a fixed sentence get its code. Not in one transaction: rows are locked one statement at a time."""

from django.db import migrations

# by outcome_code: the outbox ended these, with one sentence for each
ENDED = {
    "not-delivered": "not_delivered",
    "unconfirmed": "unconfirmed",
    "unheard": "unacknowledged",
    "withdrawn": "withdrawn",
    "revoked": "revoked",
    "simulation-ended": "simulation_ended",
}
SENTENCES = {
    "The gateway failed; the error is in its log.": "gateway_failed",
    "The vehicle did not do it.": "not_done",
    "The vehicle did it, and left it again.": "undone",
    "Only PX4 and ArduPilot are commanded: what another autopilot does is not known.": "only_known_autopilots",
    "The UAV does not tell whether it stands or flies.": "in_air_unknown",
    "The UAV is on the ground: a mission is started there, not resumed.": "resume_on_ground",
    "The UAV is on the ground: this route begins in the air.": "mid_air_start_on_ground",
    "This route begins in the air, and the UAV does not fly.": "mid_air_start_not_flying",
    "The UAV is on the ground.": "on_ground",
    "The UAV does not surely hold its approved route: it cannot return along it.": "list_not_sure",
    "From where the UAV is now no way along its route is clear.": "no_clear_return",
    "The UAV is not on the way on which its route begins. Plan the rest again.": "off_first_leg",
    "The UAV has not told its height above sea level.": "height_unknown",
    "The UAV does not hold this flight of the approved mission: send it first.": "flight_not_loaded",
    "The UAV does not hold a flight of the approved mission.": "no_flight_loaded",
    "Only a mission that was approved can be flown.": "not_approved",
    "Only a mission that is being flown can be resumed.": "only_active_resumed",
    "The approval was taken back.": "approval_revoked",
    "The approval is not the one that was given: its hash is another one.": "damaged_approval",
    "The approval has no such flight of this UAV.": "no_such_flight",
    "The UAV does not tell where its home is, from which it counts its heights.": "home_unknown",
    "The UAV does not tell where it stands.": "stand_unknown",
    "The UAV does not tell where it flies.": "position_unknown",
    "The UAV does not tell which waypoint it would fly to.": "waypoint_unknown",
    "The UAV has flown its mission to the end: there is nothing to go on with.": "flown_to_end",
    "Nothing was sent: what the vehicle holds could not be read.": "holdings_unreadable",
    "The UAV has not told how far apart waypoints may be.": "limits_unknown",
    "The mission could not be sent whole, and what was there of it was taken off: the vehicle holds none.": "mission_taken_off",
    "The vehicle holds what it held before.": "holds_what_before",
    "The vehicle has not told how high it returns.": "return_height_unknown",
    "The UAV holds something else than what was approved.": "uav_holds_other",
    "The UAV does not say what it holds.": "uav_holds_unknown",
    "The UAV gave no reason.": "no_reason_given",
}
OFFERS = {
    "It was asked for again.": "asked_for_again",
    "Something else has happened since.": "something_else_happened",
    "It was not worked out in time.": "not_worked_out_in_time",
    "The mission does not fly any more.": "mission_not_flying",
    "It was worked out too long ago.": "worked_out_too_long_ago",
    "Nothing would change: the UAVs fly on as they do.": "nothing_would_change",
    "No other UAV of the mission is in the air.": "nobody_else_in_air",
}

# Ended commands alone: the gateways of the version before write to the others.
_COMMANDS = """
UPDATE missions_uavcommand command SET outcome_why = jsonb_build_object(
    'text', command.outcome, 'reasons', jsonb_build_array(jsonb_build_object('code', known.code, 'params', '{}'::jsonb)))
FROM unnest(%s::text[], %s::text[]) AS known(stored, code)
WHERE command.outcome_why IS NULL AND command.outcome <> '' AND command.state IN ('failed', 'expired') AND command.{column} = known.stored
"""
_OFFERS = """
UPDATE missions_replanoffer offer SET outcome_why = jsonb_build_object(
    'text', offer.outcome, 'reasons', jsonb_build_array(jsonb_build_object('code', known.code, 'params', '{}'::jsonb)))
FROM unnest(%s::text[], %s::text[]) AS known(stored, code)
WHERE offer.outcome_why IS NULL AND offer.outcome = known.stored
"""


def give_codes(apps, schema_editor):
    for statement, codes in (
        (_COMMANDS.replace("{column}", "outcome_code"), ENDED),
        (_COMMANDS.replace("{column}", "outcome"), SENTENCES),
        (_OFFERS, OFFERS),
    ):
        schema_editor.execute(statement, [list(codes), list(codes.values())])


class Migration(migrations.Migration):
    atomic = False
    dependencies = [("missions", "0008_offer_and_state_why")]
    operations = [migrations.RunPython(give_codes, migrations.RunPython.noop, elidable=True)]
