/** Drawing shapes. English → German; [one, other] where there is a plural. */

export default {
  "A hole crosses the border or another hole.": "Ein Loch kreuzt den Rand oder ein anderes Loch.",
  "A hole lies outside of the area.": "Ein Loch liegt außerhalb der Fläche.",
  "A line cannot cross the 180th meridian: draw it as two.":
    "Eine Linie kann den 180. Längengrad nicht kreuzen: als zwei zeichnen.",
  "A line needs two points.": "Eine Linie braucht zwei Punkte.",
  "A part lies within another.": "Ein Teil liegt in einem anderen.",
  "Add a point in the middle of the map": "Einen Punkt in der Kartenmitte hinzufügen",
  "Alt-click removes a point. Hold Ctrl or Alt to turn off snapping.":
    "Klick mit Alt entfernt einen Punkt. Strg oder Alt gedrückt halten schaltet das Einrasten aus.",
  "An area needs three points.": "Eine Fläche braucht drei Punkte.",
  "Choose a point by its number; the arrow keys then move it, Del removes it.":
    "Einen Punkt über seine Nummer wählen; die Pfeiltasten verschieben ihn, Entf entfernt ihn.",
  "Click along the line; Enter or a click on the last point ends it.":
    "Entlang der Linie klicken; die Eingabetaste oder ein Klick auf den letzten Punkt beendet sie.",
  "Click round the area; Enter or a click on the first point closes it.":
    "Rund um die Fläche klicken; die Eingabetaste oder ein Klick auf den ersten Punkt schließt sie.",
  "Click the centre, then how far it reaches.": "Den Mittelpunkt anklicken, dann, wie weit er reicht.",
  "Click where it stands.": "Klicken, wo es steht.",
  "Drag a point; drag the small one between two to add another.":
    "Einen Punkt ziehen; der kleine zwischen zweien wird beim Ziehen ein neuer.",
  "Drag it to its place, or write where it stands under Points.":
    "An seinen Ort ziehen oder den Ort unter Punkte eintragen.",
  "Drag the centre, or the point on the rim.": "Den Mittelpunkt ziehen oder den Punkt am Rand.",
  "Drag the whole shape, or move it with the arrow keys.":
    "Die ganze Form ziehen oder mit den Pfeiltasten verschieben.",
  "Draw a hole in the area": "Ein Loch in die Fläche zeichnen",
  "Draw another part of the area": "Einen weiteren Teil der Fläche zeichnen",
  "Finish": "Beenden",
  "Hold a point to remove it.": "Einen Punkt gedrückt halten entfernt ihn.",
  "Hole": "Loch",
  "Latitude of point {number}": "Breite von Punkt {number}",
  "Longitude of point {number}": "Länge von Punkt {number}",
  "Move": "Verschieben",
  "Move the whole shape by dragging, or with the arrow keys":
    "Die ganze Form durch Ziehen oder mit den Pfeiltasten verschieben",
  "Part": "Teil",
  "Point": "Punkt",
  "Point {number}": "Punkt {number}",
  "Points": "Punkte",
  "Points with longitude and latitude in degrees": "Punkte mit Länge und Breite in Grad",
  "Radius": "Radius",
  "Redo (Ctrl+Shift+Z)": "Wiederholen (Strg+Umschalt+Z)",
  "Remove hole": "Loch entfernen",
  "Remove part": "Teil entfernen",
  "Remove point": "Punkt entfernen",
  "The border crosses itself.": "Der Rand kreuzt sich selbst.",
  "Two parts cross each other.": "Zwei Teile kreuzen einander.",
  "Two points lie in one place.": "Zwei Punkte liegen an derselben Stelle.",
  "Undo (Ctrl+Z)": "Rückgängig (Strg+Z)",
  "{count} more is on the map.": ["{count} weiterer ist auf der Karte.", "{count} weitere sind auf der Karte."],
  "{radius} radius": "Radius {radius}",
};
