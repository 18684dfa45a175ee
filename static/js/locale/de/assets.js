/** Assets. English → German; [one, other] where there is a plural. */

export default {
  "All assets": "Alle Objekte",
  "Import an OpenStreetMap file, or download the visible area from OpenStreetMap.":
    "Eine OpenStreetMap-Datei importieren oder den sichtbaren Bereich von OpenStreetMap herunterladen.",
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
  "Deleted.": "Gelöscht.",
  "Other words, another kind, or a larger part of the map may have it.":
    "Andere Wörter, eine andere Art oder ein größerer Kartenausschnitt helfen vielleicht.",
  "Used for routing": "Wird für Routen verwendet",
  "Since {when}; missions still know it.": "Seit {when}; Missionen kennen das Objekt noch.",
  "Voltages, highest first": "Spannungen, höchste zuerst",
  "Write kilovolts up to {most}, such as 110, 20.": "Kilovolt bis {most} angeben, etwa 110, 20.",
  "{count} tag of the source": ["{count} Merkmal der Quelle", "{count} Merkmale der Quelle"],
};
