/** German: simulated UAVs that fly in real time. */

export default {
  "Fly": "Fliegen",
  "Report": "Bericht",
  "Stages of the mission": "Abschnitte der Mission",
  "It flies {rate} times as fast as the clock on the wall, by which all times here are told.":
    "Es fliegt {rate}-mal so schnell wie die Uhr an der Wand, nach der alle Zeiten hier gehen.",
  "{rate}×": "{rate}×",
  "End {name}": "{name} beenden",
  "End {name}?": "{name} beenden?",
  "It is gone at once, wherever it is: if it is in the air, its link is lost. The others fly on.":
    "Es ist sofort weg, wo immer es ist: Ist es in der Luft, reißt die Verbindung ab. Die anderen fliegen weiter.",
  "Pace": "Tempo",
  "Fly in simulation": "In der Simulation fliegen",
  "Set the wind": "Wind setzen",
  "Wind and faults of": "Gilt für",
  "Speed|wind": "Stärke",
  "All well again": "Alles wieder gut",
  "By the clock on the wall; {flown} s of the flight.": "Nach der Uhr an der Wand; {flown} s des Fluges.",
  "calm": "windstill",
  "wind {speed} from {degrees}°": "Wind {speed} aus {degrees}°",
  "is being started": "wird gestartet",
  "crashed": "abgestürzt",
  "in the air at {height}": "in der Luft auf {height}",
  "on the ground": "am Boden",
  "its link is lost": "seine Verbindung ist weg",
  "The UAVs of this mission are simulated: start them here, then send the mission and fly it with the usual buttons.":
    "Die UAVs dieser Mission sind simuliert: Starten Sie sie hier, senden Sie dann die Mission und fliegen Sie sie mit den gewohnten Knöpfen.",
  "The UAVs of this mission are simulated. An operator starts them.":
    "Die UAVs dieser Mission sind simuliert. Wer Missionen fliegt, startet sie.",
  "The simulation is over: {why}": "Die Simulation ist vorbei: {why}",
  "This machine is too slow for that pace: {seconds} s behind.":
    "Dieser Rechner ist für dieses Tempo zu langsam: {seconds} s zurück.",
  "Real time": "Echtzeit",
  "{count} simulated UAV in real time.": [
    "{count} simuliertes UAV in Echtzeit.",
    "{count} simulierte UAVs in Echtzeit.",
  ],
  "{speed}× real time": "{speed}× Echtzeit",
  "Simulated UAVs are being started.": "Simulierte UAVs werden gestartet.",
  "The wind has changed.": "Der Wind hat sich geändert.",
  "{fault}: done.": "{fault}: erledigt.",
  "End the simulation?": "Die Simulation beenden?",
  "Its UAVs are gone at once, wherever they are: of those in the air the link is lost.":
    "Ihre UAVs sind sofort weg, wo immer sie sind: Zu denen in der Luft reißt die Verbindung ab.",
  "End the simulation": "Simulation beenden",
  "Faults": "Störungen",
  "Link or GPS lost for": "Ausfall dauert",
  "Lose the link": "Verbindung weg",
  "Lose GPS": "GPS weg",
  "Motor failure": "Motorausfall",
  "Waiting for a simulator.": "Wartet auf einen Simulator.",
  "Crashed: {names}.": "Abgestürzt: {names}.",
  "Lost with their simulator: {names}.": "Mit ihrem Simulator verloren: {names}.",
  "Simulated, no real aircraft: {names}.": "Simuliert, kein echtes Luftfahrzeug: {names}.",
  "{count} simulated UAV at {speed} times real time.": [
    "{count} simuliertes UAV in {speed}-facher Echtzeit.",
    "{count} simulierte UAVs in {speed}-facher Echtzeit.",
  ],
};
