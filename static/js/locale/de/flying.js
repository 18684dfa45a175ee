/** German: a mission that is approved, sent, flown. */

export default {
  "Checking the return path …": "Rückweg wird geprüft …",
  "Checking the landing place …": "Landeplatz wird geprüft …",
  "Checking how long it can hold …": "Haltedauer wird geprüft …",
  "Upload mission": "Mission hochladen",
  "Remove mission": "Mission entfernen",
  "Arm": "Scharf schalten",
  "Take off": "Abheben",
  "Start": "Starten",
  "Resume": "Fortsetzen",
  "Hold": "Anhalten",
  "Land here": "Hier landen",
  "Abort": "Abbrechen",
  "Change speed": "Tempo ändern",
  "sent": "gesendet",
  "acknowledged": "bestätigt",
  "done": "ausgeführt",
  "failed": "gescheitert",
  "expired": "verfallen",
  "Not uploaded yet": "Noch nicht hochgeladen",
  "Removed from the UAV": "Vom UAV entfernt",
  "Being removed from the UAV": "Wird vom UAV entfernt",
  "Still on the UAV: {why}": "Noch auf dem UAV: {why}",
  "Mixed mission on the UAV – {why}": "Gemischte Mission auf dem UAV – {why}",
  "Flight {flight} uploaded": "Flug {flight} hochgeladen",
  "Uploaded": "Hochgeladen",
  "Not uploaded: {why}": "Nicht hochgeladen: {why}",
  "Uploading, {done} of {total} items": "Wird hochgeladen, {done} von {total} Punkten",
  "Waiting for the UAV": "Wartet auf das UAV",
  "{kind}: {state} {time}": "{kind}: {state} {time}",
  "given": "gegeben",
  "The approval is being revoked.": "Die Freigabe wird gerade widerrufen.",
  "{name} does not have its mission yet.": "{name} hat seine Mission noch nicht.",
  "{name} has no mission.": "{name} hat keine Mission.",
  "A flight of {name} has failed: it does not fly on in this mission.":
    "Ein Flug von {name} ist gescheitert: Es fliegt in dieser Mission nicht weiter.",
  "{name} has not started its mission: there is nothing to go on with.":
    "{name} hat seine Mission nicht begonnen: Es gibt nichts fortzusetzen.",
  "Return path not checked: it flies straight, at its own return altitude.":
    "Rückweg nicht geprüft: Es fliegt geradeaus, auf seiner eigenen Rückkehrhöhe.",
  "Return path clear, {height} above take-off (read {time}).":
    "Rückweg frei, {height} über Startplatz (gelesen {time}).",
  "it has booted since": "es ist seither neu gestartet",
  "another ground station has changed its lists since": "eine andere Bodenstation hat seither seine Listen geändert",
  "its list has another length since": "seine Liste ist seither anders lang",
  "verified {ago}; uncertain now: {why}": "geprüft {ago}; jetzt unsicher: {why}",
  "verified {ago}": "geprüft {ago}",
  "Mission on the UAV unknown: upload it again.": "Mission auf dem UAV unbekannt: Laden Sie sie erneut hoch.",
  "{what}, {read}": "{what}, {read}",
  "{kind}: verifying the mission on board, {done} of {total} items":
    "{kind}: prüft die Mission an Bord, {done} von {total} Punkten",
  "{name} has flown this flight.": "{name} hat diesen Flug schon geflogen.",
  "{name} has already been started.": "{name} wurde schon gestartet.",
  "Flown to its end. Save a copy to fly it again.":
    "Zu Ende geflogen. Sichern Sie eine Kopie, um sie wieder zu fliegen.",
  "Aborted. Save a copy to fly it again.": "Abgebrochen. Sichern Sie eine Kopie, um sie wieder zu fliegen.",
  "A flight failed. Save a copy to fly it again.":
    "Ein Flug ist gescheitert. Sichern Sie eine Kopie, um sie wieder zu fliegen.",
  "The approval is being revoked: {reason}. It ends once the mission is removed from every UAV.":
    "Die Freigabe wird widerrufen: {reason}. Sie endet, sobald die Mission von jedem UAV entfernt ist.",
  "Approved by {name} {time}.": "Freigegeben von {name} {time}.",
  "It is being flown: nothing of it can be changed.": "Sie wird geflogen: Nichts daran kann geändert werden.",
  "Nothing of it can be changed until that is revoked.": "Bis das widerrufen wird, kann nichts daran geändert werden.",
  "The command expires if it is not delivered in time.":
    "Der Befehl verfällt, wenn er nicht rechtzeitig zugestellt wird.",
  "Why (kept in the history)": "Warum (steht im Verlauf)",
  "Start {name}?": "{name} starten?",
  "It takes off and flies its approved route: {length}, {time}.":
    "Es hebt ab und fliegt seine freigegebene Route: {length}, {time}.",
  "Start {name}": "{name} starten",
  "Arm {name}?": "{name} scharf schalten?",
  "Its rotors may start at once. Keep people clear of it.":
    "Seine Rotoren können sofort anlaufen. Halten Sie Personen fern.",
  "Arm {name}": "{name} scharf schalten",
  "Let {name} take off?": "{name} abheben lassen?",
  "It climbs straight up and hovers until the next command.":
    "Es steigt senkrecht auf und schwebt bis zum nächsten Befehl.",
  "Let {name} take off": "{name} abheben lassen",
  "Height above take-off [m]": "Höhe über Startplatz [m]",
  "Keep flying": "Weiterfliegen",
  "Start {name} outside its slot?": "{name} außerhalb seines Zeitfensters starten?",
  Wait: "Warten",
  "Start {name} all the same": "{name} trotzdem starten",
  "Resume the flight of {name}?": "Den Flug von {name} fortsetzen?",
  "It continues its route from its present position.": "Es setzt seine Route von seiner jetzigen Position fort.",
  "Resume {name}": "{name} fortsetzen",
  "Hold {name}?": "{name} anhalten?",
  "Hold {name}": "{name} anhalten",
  "Return {name}?": "{name} zurückholen?",
  "It returns to its take-off place and lands. Its remaining targets stay open.":
    "Es kehrt zu seinem Startplatz zurück und landet. Seine übrigen Ziele bleiben offen.",
  "Return {name}": "{name} zurückholen",
  "Land {name} here?": "{name} hier landen?",
  "It lands where it is now. Its remaining targets stay open.":
    "Es landet, wo es jetzt ist. Seine übrigen Ziele bleiben offen.",
  "Return: holds until {time}": "Zurück: hält bis {time}",
  "Return straight now": "Jetzt geradeaus zurück",
  "Set return height": "Rückkehrhöhe setzen",
  "Battery at landing not known: {why}": "Akku bei der Landung nicht bekannt: {why}",
  "Lands with about {landing} of its battery (reserve {reserve}).":
    "Landet mit etwa {landing} seines Akkus (Reserve {reserve}).",
  "Landing place not checked.": "Landeplatz nicht geprüft.",
  "Hold time unknown.": "Haltedauer unbekannt.",
  "It cannot hold: its battery is needed for the return and the reserve.":
    "Es kann nicht halten: Sein Akku wird für Rückkehr und Reserve gebraucht.",
  "It can hold for about {time}, with battery left for the return and the reserve.":
    "Es kann etwa {time} halten; der Akku reicht dann noch für Rückkehr und Reserve.",
  "Hold time unknown: {names}.": "Haltedauer unbekannt: {names}.",
  "Checked from where it was measured {age} ago.": "Geprüft von da, wo es vor {age} gemessen wurde.",
  "Checked from where it is estimated, ± {distance}; last report {age} ago.":
    "Geprüft von seinem geschätzten Ort aus, ± {distance}; letzte Meldung vor {age}.",
  "Return at {height}": "Auf {height} zurück",
  "Hold {time}, then return": "{time} halten, dann zurück",
  "Along the route: straight to waypoint {number}, then as approved, {distance}, {time}.":
    "Entlang der Route: geradeaus zu Wegpunkt {number}, dann wie freigegeben, {distance}, {time}.",
  "Battery at landing not known.": "Akku bei der Landung nicht bekannt.",
  "Lands with about {landing} of its battery.": "Landet mit etwa {landing} seines Akkus.",
  "Return along the route": "Entlang der Route zurück",
  "Hold {time}, then return at {height}": "{time} halten, dann auf {height} zurück",
  "On separate ways they keep apart: {ways}.": "Auf getrennten Wegen bleiben sie auseinander: {ways}.",
  "{names}: no return path is clear. They return straight.":
    "{names}: Kein Rückweg ist frei. Sie kehren geradeaus zurück.",
  "Return on separate ways": "Auf getrennten Wegen zurück",
  "{count} target is still visited.": ["{count} Ziel wird noch angeflogen.", "{count} Ziele werden noch angeflogen."],
  "All return at once: their return paths are separated.":
    "Alle kehren zugleich zurück: Ihre Rückwege sind gestaffelt.",
  "Also set the return altitude of {name} to {height}: lower, its return path is obstructed":
    "Rückkehrhöhe von {name} dabei auf {height} setzen: Tiefer ist der Rückweg versperrt",
  "Set return height to {height}": "Rückkehrhöhe auf {height} setzen",
  "Land {name} here": "{name} hier landen",
  "Abort the flight of {name}?": "Den Flug von {name} abbrechen?",
  "Earlier commands are cancelled. Its remaining targets stay open; the other UAVs continue.":
    "Frühere Befehle entfallen. Seine übrigen Ziele bleiben offen; die anderen UAVs fliegen weiter.",
  "Abort {name}": "{name} abbrechen",
  "Change the speed of {name}?": "Das Tempo von {name} ändern?",
  "Over ground, until its route says otherwise. Planned times no longer hold.":
    "Über Grund, bis die Route etwas anderes sagt. Geplante Zeiten gelten dann nicht mehr.",
  "Change the speed of {name}": "Tempo von {name} ändern",
  "Speed [m/s]; now planned with {speed}": "Tempo [m/s]; geplant sind {speed}",
  "The mission was changed by someone else. Review it again.":
    "Die Mission wurde von jemand anderem geändert. Prüfen Sie sie noch einmal.",
  "Approve “{name}”?": "„{name}“ freigeben?",
  "Approval locks the mission. Only the approved mission can be uploaded to UAVs. The approval can be revoked.":
    "Die Freigabe sperrt die Mission. Nur die freigegebene Mission kann auf UAVs hochgeladen werden. Die Freigabe kann widerrufen werden.",
  "Approve": "Freigeben",
  "Maximum waypoint spacing [m]; blank: as planned": "Größter Wegpunktabstand [m]; leer: wie geplant",
  "Not approved.": "Nicht freigegeben.",
  "Revoke the approval of “{name}”?": "Die Freigabe von „{name}“ widerrufen?",
  "The mission is removed from every UAV that may have it. The approval ends once that is confirmed; then the mission can be changed again.":
    "Die Mission wird von jedem UAV entfernt, das sie haben kann. Die Freigabe endet, sobald das bestätigt ist; dann kann die Mission wieder geändert werden.",
  "Until then it can be neither uploaded nor started.": "Bis dahin kann sie weder hochgeladen noch gestartet werden.",
  "The mission can be changed again, and must be approved again before it is uploaded.":
    "Die Mission kann wieder geändert werden und muss vor dem Hochladen neu freigegeben werden.",
  "Keep it approved": "Freigegeben lassen",
  "Revoke": "Widerrufen",
  "Not revoked.": "Nicht widerrufen.",
  "A UAV that is not connected receives its route on contact, within the hour.":
    "Ein nicht verbundenes UAV erhält seine Route beim nächsten Kontakt, innerhalb einer Stunde.",
  "Not sent.": "Nicht gesendet.",
  "Abort “{name}”?": "„{name}“ abbrechen?",
  "Sent to {names} ahead of all other commands. Remaining targets stay open, and the mission cannot be resumed.":
    "Wird vor allen anderen Befehlen an {names} gesendet. Übrige Ziele bleiben offen, und die Mission kann nicht fortgesetzt werden.",
  "Abort the mission": "Mission abbrechen",
  "Not aborted.": "Nicht abgebrochen.",
  "{act}: not sent to {name}.": "{act}: nicht an {name} gesendet.",
  "{act}: sending to {name}.": "{act}: wird an {name} gesendet.",
  "{act}: done by {name}.": "{act}: von {name} ausgeführt.",
  "{act}: not done by {name}. {outcome}": "{act}: von {name} nicht ausgeführt. {outcome}",
  "It has changed since it was planned. Plan again first.":
    "Sie hat sich seit der Planung geändert. Planen Sie zuerst neu.",
  "It is not saved yet.": "Sie ist noch nicht gesichert.",
  "The plan reaches no target: there is nothing to approve.":
    "Der Plan erreicht kein Ziel: Es gibt nichts freizugeben.",
  "Sending to {name}": "Senden an {name}",
  "Commands to {name}": "Befehle an {name}",
  "by the program": "vom Programm",
  "Hold the chosen UAV": "Das gewählte UAV anhalten",
  "Return the chosen UAV": "Das gewählte UAV zurückholen",
  "Land the chosen UAV here": "Das gewählte UAV hier landen",
  "as {hash}": "als {hash}",
  "Approval revoked": "Freigabe widerrufen",
  "Approval is being revoked": "Freigabe wird widerrufen",
  "Uploaded to UAVs": "Auf UAVs hochgeladen",
  "Started": "Gestartet",
  "{count} UAV flies {length} in all: {names}.": [
    "{count} UAV fliegt insgesamt {length}: {names}.",
    "{count} UAVs fliegen insgesamt {length}: {names}.",
  ],
  "In the air: {names}. The mission can be closed once all UAVs are down.":
    "In der Luft: {names}. Die Mission kann abgeschlossen werden, sobald alle UAVs gelandet sind.",
  "Keep open": "Offen lassen",
  "Close mission": "Mission abschließen",
  "Not closed.": "Nicht abgeschlossen.",
  "No target is open. Nothing of this mission can be started any more.":
    "Kein Ziel ist offen. Danach kann nichts mehr von dieser Mission gestartet werden.",
  "Plan a follow-up with the targets not inspected": "Folgemission mit den nicht inspizierten Zielen planen",
  "Close “{name}”?": "„{name}“ abschließen?",
  "The same reason for all without one": "Derselbe Grund für alle ohne Grund",
  "{count} target is open. Say why it is left; the reason is in the report.": [
    "{count} Ziel ist offen. Geben Sie an, warum es entfällt; der Grund steht im Bericht.",
    "{count} Ziele sind offen. Geben Sie an, warum sie entfallen; die Gründe stehen im Bericht.",
  ],
  "It stops where it is and waits for Resume, as long as its battery lasts.":
    "Es hält an, wo es ist, und wartet auf „Fortsetzen“, solange sein Akku reicht.",
  "The plan separates UAVs by time. Started now, you have to separate them: hold one, or return one.":
    "Der Plan staffelt UAVs zeitlich. Startet es jetzt, müssen Sie staffeln: eines anhalten oder zurückholen.",
  "Fly: {act}": "Fliegen: {act}",
  "Upload flight {flight}": "Flug {flight} hochladen",
  "Upload again": "Erneut hochladen",
  "The mission is already on {name}.": "Die Mission ist schon auf {name}.",
  "Upload flight {flight} to {name}?": "Flug {flight} auf {name} hochladen?",
  "Upload its route to {name}?": "Die Route auf {name} hochladen?",
  "The upload is verified against the approved mission. The UAV does not take off.":
    "Das Hochgeladene wird mit der freigegebenen Mission verglichen. Das UAV startet nicht.",
  "Upload to {name}": "Auf {name} hochladen",
  "Autopilot parameter: {names}": "Parameter des Autopiloten: {names}",
  "Return altitude not reported by {count} UAVs: {names}. Their return paths are not checked against terrain and zones.":
    "Rückkehrhöhe von {count} UAVs nicht gemeldet: {names}. Ihre Rückwege werden nicht gegen Gelände und Zonen geprüft.",
};
