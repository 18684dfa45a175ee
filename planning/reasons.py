"""The planner's reasons: the sentence of each code."""

from operation.reasons import gettext_noop, ngettext_noop, register_sentences

SENTENCES = register_sentences(
    {
        # what is wrong with a request
        "no_battery_to_save": gettext_noop("%(uav)s states no battery capacity: its energy cannot be calculated."),
        "sorties_without_return": gettext_noop("%(uav)s can fly again only where it returns to its start."),
        "unknown_uav_name": gettext_noop("There is no UAV named %(name)s in this plan."),
        "ambiguous_uav_name": gettext_noop("%(count)s UAVs of this plan are named %(name)s."),
        "unknown_target": gettext_noop("There is no target %(target)s."),
        "target_locked_twice": gettext_noop("Target %(target)s is locked twice."),
        "target_tied_elsewhere": gettext_noop("Target %(target)s is tied to %(uav)s, another UAV than it is locked to."),
        "sensor_missing": gettext_noop("Target %(target)s needs the sensor %(sensor)s, which %(uav)s does not have."),
        "two_runs_at_start": gettext_noop("%(uav)s has another locked run at its start."),
        "two_runs_at_end": gettext_noop("%(uav)s has another locked run at its end."),
        "run_is_whole_route": gettext_noop("A locked run is all that %(uav)s flies: it has no place for another one."),
        "too_many_locked": ngettext_noop(
            "%(uav)s may do %(most)s target at most, but %(locked)s are locked to it.",
            "%(uav)s may do %(most)s targets at most, but %(locked)s are locked to it.",
        ),
        "wind_too_strong_on_route": gettext_noop("The wind is too strong for %(uav)s on its route."),
        "target_deleted": gettext_noop("A target of this route is no longer in the data. Plan again."),
        "target_unreachable": gettext_noop("A target of this route cannot be reached any more. Plan again."),
        "uav_now_inside_zone": gettext_noop("This UAV stands inside a no-fly zone now. Plan again."),
        "uav_flies_no_route": gettext_noop("This UAV flies no route."),
        # what is wrong with a camera
        "camera_not_positive": gettext_noop("Must be greater than 0."),
        "camera_focal_lengths": gettext_noop("State at least one focal length in mm; several in ascending order."),
        "camera_field_of_view": gettext_noop("The angle of view would not lie between %(min)s and %(max)s°. State the real focal length."),
        "camera_gimbal": gettext_noop("The lowest angle must not be above the highest; both lie between -180 and 180."),
        "camera_offset": gettext_noop("Must be numbers."),
        "camera_pixels_not_square": gettext_noop("With this sensor pixels would not be square. Check its size and the numbers of pixels."),
        # why no route visits a target
        "asset_deleted": gettext_noop("The asset has been deleted since it was picked."),
        "beyond_launch_sites": gettext_noop("No launch site is near enough: UAVs would have to fly up to %(needed_m)s from one."),
        "drive_takes_day": gettext_noop("The drive to launch sites near it and back takes the whole working day."),
        "no_launch_site": gettext_noop("There is no place to launch from."),
        "above_height_limit": gettext_noop(
            "It is %(height_m)s high: a UAV would have to fly at %(needed_m)s, above the limit of %(limit_m)s."
        ),
        "stands_inside_zone": gettext_noop("It stands inside %(zone)s."),
        "runs_through_zone": gettext_noop("It runs through %(zone)s."),
        "lands_through_zone": gettext_noop("Landing there leads through %(zone)s."),
        "locked_to_grounded": gettext_noop("It is locked to %(uav)s."),
        "locked_to_unreachable": gettext_noop("It is locked to others of which one cannot be reached: the run is left out as a whole."),
        "locked_run": gettext_noop("It is locked to others: the run is left out as a whole."),
        "tied_without_sensor": gettext_noop("It is tied to %(uav)s, which does not have the sensor %(sensor)s."),
        "tied_to_grounded": gettext_noop("It is tied to %(uav)s."),
        "tied_to_unable": gettext_noop("It is tied to %(uav)s, which cannot fly to it."),
        "tied_to_full": gettext_noop("It is tied to %(uav)s, which has as many targets as it may have."),
        "photos_meet_zone": gettext_noop("Its photos would be taken inside %(zone)s, or too near to it."),
        "photos_bridge_height_unknown": gettext_noop(
            "The height of this bridge's pylons or arches is not known. State the height of the bridge."
        ),
        "photos_bridge_outline": gettext_noop("The outline of this bridge is not valid, or has too many corners. Edit the bridge."),
        "photos_bridge_too_long": gettext_noop("Photos are planned of bridges up to 600 m long."),
        "photos_ground_unknown": gettext_noop("Photos near wires need terrain data under the whole route. Upload terrain that covers it."),
        "photos_need_terrain": gettext_noop("Photos need terrain data around the tower or bridge. Upload terrain that covers it."),
        "photos_not_a_tower": gettext_noop(
            "Photos are planned of power towers that carry a line, and of bridges; those of wires of towers alone."
        ),
        "photos_too_many": gettext_noop(
            "It would take too many photos. Choose a coarser ground sample distance, or a camera with more pixels."
        ),
        "photos_none_possible": gettext_noop(
            "At this ground sample distance the camera can show nothing of it from outside the clearance."
        ),
        "photos_no_way": gettext_noop("No flight keeps clear of wires, structures, ground and the greatest height there."),
        "no_uav_with_sensor": gettext_noop("No UAV of the plan has the sensor %(sensor)s."),
        "no_flying_uav_with_sensor": gettext_noop("No UAV that can take off has the sensor %(sensor)s."),
        "no_uav_allowed": gettext_noop("No UAV of the plan is allowed to do it: none has the sensor or is the UAV that it is tied to."),
        "no_uav_takes_off": gettext_noop("There is no UAV that can take off."),
        "all_uavs_full": gettext_noop("Each UAV that can do it has as many targets as it may have."),
        "uav_full": gettext_noop("%(uav)s has as many targets as it may have (%(most)s)."),
        "uavs_full": gettext_noop("%(uavs)s and %(last)s have as many targets as they may have."),
        "no_path": gettext_noop("No permitted route from any base."),
        "not_connected": gettext_noop("It is not connected to the network of any UAV: the nearest stands %(away_km)s away."),
        "barred_by_zone": gettext_noop("%(zone)s is in the way."),
        "no_path_for_uavs": gettext_noop("There is no permitted route for %(uavs)s."),
        "no_path_to_base": gettext_noop("There is no path from it to a base outside every no-fly zone."),
        "not_on_one_route": gettext_noop("A UAV can get there, but not on one route with its other targets. Add a UAV."),
        "access_barred": gettext_noop("Every straight leg to it from the network within %(reach_km)s meets a no-fly zone."),
        "too_far_from_network": gettext_noop("It is more than %(reach_km)s from the network."),
        "no_access_for_uavs": gettext_noop("No UAV has a clear leg of up to %(reach_km)s to the network from where it stands."),
        "wind_too_strong": gettext_noop("The wind is too strong on every path to it, or back."),
        "beyond_range": gettext_noop("It is %(needed_m)s %(there)s, %(missing_m)s more than the range of %(uav)s."),
        "in_range_alone": gettext_noop("In range on its own, but not together with the other targets."),
        "beyond_battery": gettext_noop("It takes %(needed_wh)s %(there)s, %(missing_wh)s more than the usable battery of %(uav)s."),
        "beyond_battery_as_drawn": gettext_noop(
            "Including terrain and obstacles it needs %(needed_wh)s %(there)s, %(missing_wh)s more than the usable battery of %(uav)s."
        ),
        "beyond_battery_with_charging": gettext_noop("Even with charging stops, %(uav)s is up to %(missing_wh)s short for this target."),
        "beyond_battery_in_every_route": gettext_noop(
            "Including terrain and obstacles, every route tried with it takes more than the usable battery."
        ),
        "battery_too_small": gettext_noop("The battery of %(any_uav)s is too small for it."),
        "battery_too_small_with_charging": gettext_noop("Even with charging stops, the battery of %(any_uav)s is too small for it."),
        "in_reach_alone": gettext_noop("Reachable on its own, but not together with the other targets."),
        "wires_in_the_way": gettext_noop("%(uav)s would have to pass a mast, wires or a bridge that cannot be flown over."),
        "wires_after_others": gettext_noop(
            "From its other targets %(uav)s would have to pass a mast, wires or a bridge that cannot be flown over."
        ),
        "other_uavs": gettext_noop("Other UAVs: %(limits)s."),
        # why a UAV stays on the ground, and of what else a plan warns
        "uav_retired": gettext_noop("%(uav)s is retired and flies no more."),
        "uav_in_maintenance": gettext_noop("%(uav)s is in maintenance and does not fly."),
        "uav_without_type": gettext_noop("%(uav)s is incomplete: it has no type. Choose one on its page."),
        "uav_without_range": gettext_noop(
            "%(uav)s is incomplete: its range is not stated. State a range or a battery, or choose unlimited range for its type."
        ),
        "uav_inside_zone": gettext_noop("%(uav)s stands inside %(zone)s and cannot take off."),
        "uav_in_air": gettext_noop(
            "%(uav)s is reported to be in the air: the plan begins with a take-off from the ground where it was last seen."
        ),
        "shortest_paths": gettext_noop(
            "The routes take shorter paths than preferred, farther from the lines: along the lines, not all targets are in reach."
        ),
        "airspeed_not_stated": gettext_noop(
            "%(uav)s states no top airspeed: it is taken to fly no faster than its speed, through the air."
        ),
        "edits_discarded": gettext_noop(
            "%(missed)s of %(legs)s manually edited legs of %(uav)s were discarded: their endpoints moved, or they are now obstructed."
        ),
        # how far a search is
        "looking_for_first_plan": gettext_noop("Looking for a first plan"),
        "measuring_paths": gettext_noop("Measuring the ways between the targets"),
        "working_out_locked": gettext_noop("Working out what the locked parts cost"),
        "working_out_heights": gettext_noop("Working out heights and checking every leg"),
        "longest_route": gettext_noop("longest route %(length_km)s"),
        "length_in_total": gettext_noop("%(length_km)s in total"),
        "minutes_in_total": gettext_noop("%(duration_min)s min in total"),
        "energy_in_total": gettext_noop("%(energy_wh)s in total"),
        "some_not_reached": gettext_noop("%(found)s, %(missed)s not reached"),
        # what stands in sentences
        "there": gettext_noop("there"),
        "there_and_back": gettext_noop("there and back"),
        "there_and_to_base": gettext_noop("there and on to the nearest base"),
        "zone_margin": gettext_noop("the %(margin_m)s around a no-fly zone"),
        "obstacle_margin": gettext_noop("the surroundings of a mast, wires or a bridge that cannot be flown over"),
        "cannot_take_off": gettext_noop("cannot take off (%(uavs)s)"),
        "without_sensor": gettext_noop("without the sensor (%(uavs)s)"),
        "no_permitted_route": gettext_noop("no permitted route (%(uavs)s)"),
        "wind_too_strong_for": gettext_noop("wind too strong (%(uavs)s)"),
        "range_too_short": gettext_noop("range too short (%(uavs)s)"),
        "battery_too_small_of": gettext_noop("battery too small (%(uavs)s)"),
        "wires_for": gettext_noop("mast, wires or bridge in the way (%(uavs)s)"),
    }
)
