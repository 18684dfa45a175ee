/** Planning: priorities, who flies what, locks, how good a plan is. English → German; [one, other] where there is a plural. */

export default {
  "{count} warning": ["{count} Warnung", "{count} Warnungen"],
  "Within {share} of the best plan without temporary zones.":
    "Höchstens {share} über dem besten Plan ohne zeitweise Zonen.",
  "Within {share} of the best plan with the locked targets and without temporary zones.":
    "Höchstens {share} über dem besten Plan mit den festgelegten Zielen und ohne zeitweise Zonen.",
  "As good as the best plan without temporary zones.": "So gut wie der beste Plan ohne zeitweise Zonen.",
  "(locked)": "(festgelegt)",
  "Best possible.": "Optimal.",
  "Add a base": "Basis anlegen",
  "as many as fit": "so viele wie möglich",
  "as planned": "wie geplant",
  "At most this many targets": "Höchstens so viele Ziele",
  "at most {count} target": ["höchstens {count} Ziel", "höchstens {count} Ziele"],
  "Within {share} of the best possible with the locked targets.":
    "Höchstens {share} über dem Optimum mit den festgelegten Zielen.",
  "Within {share} of the best possible.": "Höchstens {share} über dem Optimum.",
  "before your last change": "vor Ihrer letzten Änderung",
  "different": "verschieden",
  "Each UAV lands at the nearest base": "Jedes UAV landet auf der nächsten Basis",
  "Earlier": "Früher",
  "Every UAV that could fly it has as many targets as it may.":
    "Jedes UAV, das es könnte, hat so viele Ziele, wie es darf.",
  "Lock to UAV": "Auf UAV festlegen",
  "High": "Hoch",
  "High priority": "Hohe Priorität",
  "Land at the nearest base": "Auf der nächsten Basis landen",
  "Let {name} do one more": "{name} eines mehr anfliegen lassen",
  "Let all return to the start": "Alle zum Start zurückkehren lassen",
  "Let any UAV fly it": "Jedes UAV darf es anfliegen",
  "lands at the base {name}": "landet auf der Basis {name}",
  "lands at the nearest base": "landet auf der nächsten Basis",
  "Later": "Später",
  "Lock here": "Hier festlegen",
  "Lock or unlock the chosen target": "Gewähltes Ziel festlegen oder freigeben",
  "Locked": "Festgelegt",
  "Locked to {uav}": "Auf {uav} festgelegt",
  "locks changed": "Festlegungen geändert",
  "Low": "Niedrig",
  "Low priority": "Niedrige Priorität",
  "Required sensor": "Vorgeschriebener Sensor",
  "needs {sensor}": "braucht {sensor}",
  "Lower bound: {time}.": "Untere Schranke: {time}.",
  "Lower bound: {length}.": "Untere Schranke: {length}.",
  "No sensor is stated for it.": "Für es ist kein Sensor angegeben.",
  "No UAV may fly it: none has the sensor, or is the one it is tied to.":
    "Kein UAV darf es anfliegen: Keines hat den Sensor oder ist das eine, das es soll.",
  "none|sensor": "keiner",
  "Normal": "Normal",
  "Nothing is locked: {count} UAVs of this mission are called {name}.":
    "Nichts ist festgelegt: {count} UAVs dieser Mission heißen {name}.",
  "Nothing is locked any more.": "Nichts ist mehr festgelegt.",
  "Place in the plan": "Platz im Plan",
  "Priority and requirements": "Priorität und Vorgaben",
  "Required UAV": "Vorgeschriebenes UAV",
  "only {uav}": "nur {uav}",
  "Priority": "Priorität",
  "Proven shortest.": "Bewiesen am kürzesten.",
  "Proven shortest with what is locked.": "Bewiesen am kürzesten mit dem, was festgelegt ist.",
  "Proven soonest with what is locked.": "Bewiesen am schnellsten mit dem, was festgelegt ist.",
  "Proven shortest of plans that reach as many targets.":
    "Bewiesen am kürzesten unter den Plänen, die so viele Ziele erreichen.",
  "Proven shortest with what is locked, of plans that reach as many targets.":
    "Bewiesen am kürzesten mit dem Festgelegten, unter den Plänen, die so viele Ziele erreichen.",
  "Proven soonest of plans that reach as many targets.":
    "Bewiesen am schnellsten unter den Plänen, die so viele Ziele erreichen.",
  "Proven soonest with what is locked, of plans that reach as many targets.":
    "Bewiesen am schnellsten mit dem Festgelegten, unter den Plänen, die so viele Ziele erreichen.",
  "Proven soonest.": "Bewiesen am schnellsten.",
  "Raise its limit to {count}": "Seine Grenze auf {count} erhöhen",
  "Sensors: {names}": "Sensoren: {names}",
  "Task, priority, UAV: {name}": "Aufgabe, Priorität, UAV: {name}",
  "The chosen target earlier": "Gewähltes Ziel früher",
  "The chosen target later": "Gewähltes Ziel später",
  "The priority of {count} target is set.": [
    "Die Priorität von {count} Ziel ist gesetzt.",
    "Die Priorität von {count} Zielen ist gesetzt.",
  ],
  "The sensor of {count} target is set.": [
    "Der Sensor von {count} Ziel ist gesetzt.",
    "Der Sensor von {count} Zielen ist gesetzt.",
  ],
  "Unlock": "Freigeben",
  "Unlock its targets": "Seine Ziele freigeben",
  "Unlock all": "Alle freigeben",
  "Cost of the change unknown.": "Kosten der Änderung unbekannt.",
  "The new plan is no better ({figures}). The one on the page stays.":
    "Der neue Plan ist nicht besser ({figures}). Der auf der Seite bleibt.",
  "The plan is of what was picked when planning began.": "Der Plan gilt für das, was bei Planungsbeginn gewählt war.",
  "The selection has changed since.": "Die Auswahl hat sich seitdem geändert.",
  "The change costs nothing.": "Die Änderung kostet nichts.",
  "The change costs {figure} more{share}.": "Die Änderung kostet {figure} mehr{share}.",
  "Change not planned yet.": "Änderung noch nicht geplant.",
  "The change leaves out {count} target more.": [
    "Die Änderung lässt {count} Ziel mehr aus.",
    "Die Änderung lässt {count} Ziele mehr aus.",
  ],
  "The change saves {figure}{share}: the search had not found it.":
    "Die Änderung spart {figure}{share}: Die Suche hatte sie nicht gefunden.",
  "{count} target changed": ["{count} Ziel geändert", "{count} Ziele geändert"],
  "{count} route so far": ["bisher {count} Route", "bisher {count} Routen"],
  "{count} target is flown by {uav} alone.": [
    "{count} Ziel fliegt allein {uav} an.",
    "{count} Ziele fliegt allein {uav} an.",
  ],
  "{count} target is locked.": ["{count} Ziel ist festgelegt.", "{count} Ziele sind festgelegt."],
  "{count} target may be flown by any UAV.": [
    "{count} Ziel darf jedes UAV anfliegen.",
    "{count} Ziele darf jedes UAV anfliegen.",
  ],
  "{figure} so far": "bisher {figure}",
  "{figure} so far, within {share} of the best possible ({least})":
    "bisher {figure}, höchstens {share} über dem Optimum ({least})",
  "{name} may do {count} target at most.": [
    "{name} darf höchstens {count} Ziel anfliegen.",
    "{name} darf höchstens {count} Ziele anfliegen.",
  ],
  "{names} could fly there, but has as many targets as it may have.": [
    "{names} könnte hinfliegen, hat aber so viele Ziele, wie es haben darf.",
    "{names} könnten hinfliegen, haben aber so viele Ziele, wie sie haben dürfen.",
  ],
  "{name} is called {other} in this mission: another UAV has its name.":
    "{name} heißt in dieser Mission {other}: Ein anderes UAV hat seinen Namen.",
  "{target} is locked as target {number} of {uav}.": "{target} ist als Ziel {number} von {uav} festgelegt.",
  "{target} is locked to {uav}.": "{target} ist auf {uav} festgelegt.",
  "{target} is not locked any more.": "{target} ist nicht mehr festgelegt.",
};
