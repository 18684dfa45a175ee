"""Groups of operations in the OpenAPI document: their headings, titles and descriptions, in the order in which they are shown."""

from typing import Any

TitleAndDescription = tuple[str, str]

HEADINGS: dict[str, dict[str, TitleAndDescription]] = {
    "Planning": {
        "missions": ("Missions", "Create, plan, rehearse, approve, upload and close missions; their results, logs and history."),
        "plans": ("Plans without a mission", "Plan routes without storing them, with the reasons for routes and unassigned targets."),
        "campaigns": ("Campaigns", "Missions from several launch sites over several working days, and the days of their crews."),
        "selections": ("Saved selections", "Lists of targets that an organisation keeps under a name."),
        "reachability": ("Reachability", "Which assets the chosen UAVs can inspect, and why not the others."),
        "leg-checks": ("Leg checks", "Check single legs against no-fly zones."),
        "view-plans": ("Photo plans", "Plan photos of a tower, its wires or a bridge at a ground sample distance."),
        "camera-catalogue": ("Camera catalogue", "Inspection cameras with their figures and sources."),
    },
    "Flying": {
        "live": ("Live", "What flies now, for clients that poll; the websocket /ws/live sends the same as it changes."),
        "alerts": ("Alerts", "List, acknowledge, note and close alerts."),
        "commands": ("Commands", "The delivery state of a command to a UAV."),
        "planned-starts": ("Planned starts", "Missions whose UAVs are started in planned order."),
        "replan-offers": ("Re-planning", "Plans for the open targets of a mission in flight: accept or decline."),
        "returns": ("Returns", "What UAVs meet if all of them return now."),
        "telemetry": ("Telemetry", "What UAVs reported, of all missions."),
        "uav-link": ("UAV link over HTTP", "For companion computers, with the link token of a UAV: route, telemetry, photos, results."),
        "unknown-vehicles": ("Unregistered vehicles", "Vehicles that a gateway received and that belong to no UAV."),
    },
    "Simulation": {
        "simulations": ("Simulations", "Simulated UAVs for a ground station or for own programs."),
        "simulated-vehicles": ("Simulated UAVs", "Air, faults and end of one simulated UAV."),
        "airframes": ("Airframes", "Simulated airframes that fly rehearsals."),
        "rehearsal-rule": ("Rehearsal rule", "Whether approval requires a passed rehearsal."),
    },
    "Results": {
        "results": ("Results of targets", "What was found at targets, over all missions."),
        "media": ("Photos and videos", "List, place, download and delete photos and videos."),
        "media-uploads": ("Uploads of photos and videos", "Resumable uploads by the tus protocol."),
        "findings": ("Findings", "Defects with evidence in photos, their state, comments and history."),
        "finding-categories": ("Categories of findings", "The list of categories in the user's language."),
    },
    "Fleet": {
        "uavs": ("UAVs", "UAVs, their link credentials, commands, flights and logs."),
        "uav-types": ("UAV types", "Figures, cameras and alert limits that the UAVs of a type share."),
        "bases": ("Bases", "Places where UAVs are stationed."),
    },
    "Map data": {
        "assets": ("Assets", "Towers, lines, railways and bridges: search, edit, export."),
        "zones": ("No-fly zones", "Draw, correct and export no-fly zones."),
        "zone-sets": ("Zone sets", "The sources of zones, with their versions."),
        "zone-subscriptions": ("Zone subscriptions", "Zone sources that are fetched at intervals."),
        "imports": ("Imports", "Read a file, review what it changes, apply or undo it."),
        "uploads": ("Uploads of files", "Files for imports, sent in parts."),
        "exports": ("Files of registers", "Large files of assets and zones, written by a job: fetch, stop or delete."),
        "data-issues": ("Data quality", "Faults in the data, and their repairs."),
        "history": ("History of map data", "Changes of assets and zones, and undo."),
        "regions": ("Regions", "Named regions with map data."),
        "terrain": ("Terrain", "Terrain models, heights and profiles."),
        "geometry-checks": ("Geometry checks", "Check a geometry before it is stored."),
        "ground": ("State of the data", "What map data there are, and the state of the inspection graph."),
        "tiles": ("Vector tiles", "Assets and zones as vector tiles."),
        "scene": ("3D view", "What stands in a box, for a 3D view."),
    },
    "Administration": {
        "account": ("Account", "The signed-in user: preferences, password, passkeys, sessions and tokens."),
        "users": ("Users", "Users of the organisation, their roles and access."),
        "invitations": ("Invitations", "Invite users by a link."),
        "service-accounts": ("Service accounts", "Accounts and tokens for programs."),
        "sign-ins": ("Sign-ins", "Sign-ins and failed attempts of the organisation's users."),
        "organisation": ("Organisation", "Its name and time zone."),
        "second-factor-rule": ("Second factor rule", "Whether all users need a second factor."),
        "jobs": ("Jobs", "Long work in the background: progress, result, cancellation."),
        "demo-data": ("Demo data", "Create and remove the demo missions."),
    },
}


def tags() -> list[dict[str, str]]:
    """Return the `tags` of the document."""
    groups = [group for of_heading in HEADINGS.values() for group in of_heading.items()]
    return [{"name": name, "x-displayName": title, "description": description} for name, (title, description) in groups]


def root_extensions() -> dict[str, Any]:
    """Return the headings over the tags, under the name that readers of OpenAPI documents know."""
    return {"x-tagGroups": [{"name": heading, "tags": [*of_heading]} for heading, of_heading in HEADINGS.items()]}
