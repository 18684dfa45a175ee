/** German: where alerts begin. */

export default {
  "Alert thresholds": "Alarmschwellen",
  "Alert thresholds: {name}": "Alarmschwellen: {name}",
  "Change alert thresholds": "Alarmschwellen ändern",
  "Default thresholds.": "Übliche Schwellen.",
  "For all UAVs of this type, at once, also in flight. Blank: default (grey). A mission can have its own.":
    "Für alle UAVs dieses Typs, sofort, auch im Flug. Leer: Standard (grau). Eine Mission kann eigene haben.",
  "For this mission only, also in flight. Blank: value of each UAV's type, else default (grey).":
    "Nur für diese Mission, auch im Flug. Leer: Wert des Typs jedes UAV, sonst Standard (grau).",
  "Reset to defaults": "Auf Standard zurücksetzen",
  "Thresholds saved.": "Schwellen gespeichert.",
  "The server does not take this figure.": "Der Server nimmt diesen Wert nicht an.",
  "Not below “{other}” ({figure}). Raise this one, or lower the other.":
    "Nicht unter „{other}“ ({figure}). Diesen Wert erhöhen oder den anderen senken.",
  "Late after": "Überfällig nach",
  "Lost after": "Verloren nach",
  "Beside its route": "Neben seiner Route",
  "Above or below its route": "Über oder unter seiner Route",
  "Warning from": "Warnung ab",
  "Critical from": "Kritisch ab",
  "Battery at the end of the flight": "Akku am Ende des Flugs",
  "Warning below the reserve by": "Warnung unter der Reserve um",
  "Critical below": "Kritisch unter",
  "Zones and other UAVs": "Zonen und andere UAVs",
  "Zones ahead within": "Zonen voraus in",
  "Meetings ahead within": "Begegnungen voraus in",
  "Apart, aside": "Abstand, seitlich",
  "Apart, in height": "Abstand, in der Höhe",
  "Of its highest airspeed": "Von seiner Höchstgeschwindigkeit",
  "In any case from (0: never)": "In jedem Fall ab (0: nie)",
  "Position and progress": "Position und Fortschritt",
  "Satellites, at least": "Satelliten, mindestens",
  "HDOP, at most": "HDOP, höchstens",
  "A jump is faster than": "Ein Sprung ist schneller als",
  "Stands still for": "Steht still seit",
};
