/** German: simulated UAVs that fly in real time. */

export default {
  "Fly": "Fliegen",
  "Report": "Bericht",
  "Stages of the mission": "Abschnitte der Mission",
  "Simulation at {rate}×; times on this page are real time.":
    "Simulation mit {rate}×; Zeiten auf dieser Seite sind Echtzeit.",
  "{rate}×": "{rate}×",
  "End {name}": "{name} beenden",
  "End {name}?": "{name} beenden?",
  "The simulated UAV stops at once; in flight it shows as link lost. The others fly on.":
    "Das simulierte UAV endet sofort; im Flug erscheint es mit verlorener Verbindung. Die anderen fliegen weiter.",
  "Fly in simulation": "In der Simulation fliegen",
  "Set the wind": "Wind setzen",
  "Wind and faults of": "Gilt für",
  "Clear faults": "Störungen beheben",
  "{real} s real time = {flown} s simulated": "{real} s Echtzeit = {flown} s simuliert",
  "calm": "windstill",
  "wind {speed} from {degrees}°": "Wind {speed} aus {degrees}°",
  "starting": "startet gerade",
  "crashed": "abgestürzt",
  "in the air at {height}": "in der Luft auf {height}",
  "on the ground": "am Boden",
  "link lost": "Verbindung verloren",
  "The UAVs of this mission are simulated: start them here, then upload the mission and fly it with the usual buttons.":
    "Die UAVs dieser Mission sind simuliert: Starten Sie sie hier, laden Sie dann die Mission hoch und fliegen Sie sie mit den gewohnten Knöpfen.",
  "The UAVs of this mission are simulated. An operator starts them.":
    "Die UAVs dieser Mission sind simuliert. Wer Missionen fliegt, startet sie.",
  "The simulation is over: {why}": "Die Simulation ist vorbei: {why}",
  "This machine is too slow for this speed: {seconds} s behind.":
    "Dieser Rechner ist für diese Geschwindigkeit zu langsam: {seconds} s zurück.",
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
  "Simulated UAVs stop at once; those in flight show as link lost.":
    "Simulierte UAVs enden sofort; solche im Flug erscheinen mit verlorener Verbindung.",
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
  "{count} simulated UAV at {speed}× real time.": [
    "{count} simuliertes UAV mit {speed}× Echtzeit.",
    "{count} simulierte UAVs mit {speed}× Echtzeit.",
  ],
  "Wind speed|panel": "Windstärke",
  "Choose first which UAV it is for.": "Wählen Sie zuerst, für welches UAV es gilt.",
  "Choose a UAV": "UAV wählen",
  "All UAVs of this mission": "Alle UAVs dieser Mission",
  "For {names}.": "Für {names}.",
};
