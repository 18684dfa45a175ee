/** The mission page's panels. English → German; [one, other] where there is a plural. */

export default {
  "at {distance}": "bei {distance}",
  "cannot take off": "kann nicht starten",
  "flat ground assumed": "flaches Gelände angenommen",
  "for the selection before": "für die Auswahl zuvor",
  "ground not known": "Gelände nicht bekannt",
  "In the last plan {name} flew {length} in {time}.": "Im letzten Plan flog {name} {length} in {time}.",
  "not needed": "nicht gebraucht",
  "The ground could not be read.": "Das Gelände konnte nicht gelesen werden.",
  "up to {height} above sea level": "bis {height} über dem Meer",
  "up to {height} above take-off": "bis {height} über dem Start",
  "Why does {name} fly this route?": "Warum fliegt {name} diese Route?",
  "Why?": "Warum?",
  "{height} above take-off": "{height} über dem Start",
  "{low} to {high} above ground": "{low} bis {high} über Grund",
};
