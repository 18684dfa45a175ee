/** Assets. English → German; [one, other] where there is a plural. */

export default {
  "All assets": "Alle Objekte",
  "Bring in an OpenStreetMap file, or take the visible area from Overpass.":
    "Eine OpenStreetMap-Datei einlesen oder den sichtbaren Bereich von Overpass holen.",
  "Height above ground": "Höhe über Grund",
  "Light rail": "Stadtbahn",
  "Minor line": "Kleine Leitung",
  "Network": "Netz",
  "New bridge": "Neue Brücke",
  "New power line": "Neue Freileitung",
  "New power tower": "Neuer Mast",
  "New railway": "Neue Bahnstrecke",
  "No assets yet.": "Noch keine Objekte.",
  "not flown": "nicht beflogen",
  "Off the ground.": "Nicht mehr im Bestand.",
  "Other words, another kind, or a larger part of the map may have it.":
    "Andere Wörter, eine andere Art oder ein größerer Kartenausschnitt helfen vielleicht.",
  "Part of the flying network": "Teil des Flugnetzes",
  "Since {when}; missions still know it.": "Seit {when}; Missionen kennen das Objekt noch.",
  "Voltages, highest first": "Spannungen, höchste zuerst",
  "Write kilovolts up to {most}, such as 110, 20.": "Kilovolt bis {most} angeben, etwa 110, 20.",
  "{count} tag of the source": ["{count} Merkmal der Quelle", "{count} Merkmale der Quelle"],
};
