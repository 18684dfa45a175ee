/** The admin's geometry fields. English → German; [one, other] where there is a plural. */

export default {
  "A GeoJSON geometry has a type and coordinates.": "Eine GeoJSON-Geometrie hat einen Typ und Koordinaten.",
  "A position is longitude, then latitude, in degrees.": "Eine Position ist Länge, dann Breite, in Grad.",
  "Map of the geometry": "Karte der Geometrie",
  "This is not JSON.": "Das ist kein JSON.",
};
