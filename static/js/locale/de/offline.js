/** Offline copies, and the list of the live page. */

export default {
  "The server cannot be reached. Nothing here is live, and commands are off until it answers.":
    "Der Server ist nicht erreichbar. Nichts hier ist live, und Befehle sind aus, bis er antwortet.",
  "This is an offline copy: nothing can be sent.": "Dies ist eine Offline-Kopie: Es kann nichts gesendet werden.",
  "Offline copy from {time}": "Offline-Kopie von {time}",
  "Offline copy: commands need a connection.": "Offline-Kopie: Befehle brauchen eine Verbindung.",
  "Without a link each UAV flies its route to the end.": "Ohne Verbindung fliegt jedes UAV seine Route zu Ende.",
  "Without a link each UAV holds, then flies to the nearest of its start and the rally points.":
    "Ohne Verbindung wartet jedes UAV auf der Stelle und fliegt dann zum nächsten Punkt: Start oder Sammelpunkt.",
  "Without a link each UAV flies to the nearest of its start and the rally points.":
    "Ohne Verbindung fliegt jedes UAV zum nächsten Punkt: Start oder Sammelpunkt.",
  "Start and landing": "Start und Landung",
  "Planned by {name}": "Geplant von {name}",
  "Approved by {name}, {time}": "Freigegeben von {name}, {time}",
  "Approved mission": "Freigegebene Mission",
  "No rally points. UAVs land at their starts.": "Keine Sammelpunkte. UAVs landen an ihrem Start.",
  "Fence": "Geofence",
  "No zone is near the routes.": "In der Nähe der Routen liegt keine Zone.",
  "Contacts": "Kontakte",
  "No contacts are stored.": "Keine Kontakte gespeichert.",
  "Plan|stage": "Plan",
  "{count} area that UAVs keep out of": ["{count} Gebiet, das UAVs meiden", "{count} Gebiete, die UAVs meiden"],
  "With alerts": "Mit Alarmen",
  "Without telemetry": "Ohne Telemetrie",
  "Find a UAV or a mission": "UAV oder Mission suchen",
  "Which UAVs": "Welche UAVs",
  "{shown} of {all} UAVs shown.": "{shown} von {all} UAVs angezeigt.",
  "{flying} of {uavs} in the air": "{flying} von {uavs} in der Luft",
  "Not in a mission": "In keiner Mission",
  "reported by its companion computer {age} ago": "vor {age} vom Begleitrechner gemeldet",
  "reported by its autopilot {age} ago": "vor {age} vom Autopiloten gemeldet",
  "Wind {speed}": "Wind {speed}",
};
