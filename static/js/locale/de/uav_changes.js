/** UAVs that have changed since a mission took their figures over. English → German; [one, other] where there is a plural. */

export default {
  "{count} more UAV": ["{count} weiteres UAV", "{count} weitere UAVs"],
  "A UAV changed since this mission was made.": [
    "Ein UAV hat sich geändert, seit diese Mission angelegt wurde.",
    "{count} UAVs haben sich geändert, seit diese Mission angelegt wurde.",
  ],
  "A UAV changed since this was planned.": [
    "Ein UAV hat sich seit der Planung geändert.",
    "{count} UAVs haben sich seit der Planung geändert.",
  ],
  "A UAV has other figures than it was planned with, or flies no more. Open it to see which.":
    "Ein UAV hat andere Werte als bei der Planung oder fliegt nicht mehr. Öffnen zeigt, welches.",
  "battery|figure": "Akku",
  "flies again, and the plan leaves it on the ground": "fliegt wieder, und der Plan lässt es am Boden",
  "highest airspeed|figure": "höchste Fluggeschwindigkeit",
  "is in maintenance": "ist in Wartung",
  "is retired": "ist ausgemustert",
  "mass|figure": "Masse",
  "not stated|airspeed": "nicht angegeben",
  "not stated|range": "nicht angegeben",
  "power in the hover|figure": "Leistung im Schwebeflug",
  "range|figure": "Reichweite",
  "reserve|figure": "Reserve",
  "rotor area|figure": "Rotorfläche",
  "sensors {kept} → {now}": "Sensoren {kept} → {now}",
  "speed|figure": "Geschwindigkeit",
  "The present figures are taken.": "Die heutigen Werte sind übernommen.",
  "UAV changed since": "UAV seither geändert",
  "Use the fleet's instead of this mission's own": "Die der Flotte statt der eigenen dieser Mission nehmen",
  "The fleet's figures changed since this mission was given its own.":
    "Werte der Flotte haben sich geändert, seit diese Mission eigene bekam.",
  "The fleet's figures are taken.": "Die Werte der Flotte gelten jetzt.",
  "{change} in the fleet, but not in this mission": "{change} in der Flotte, nicht aber in dieser Mission",
  "Use the present figures": "Heutige Werte übernehmen",
};
