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
  "Its rotors may turn from then on. Make sure that nobody stands beside it.":
    "Von da an können sich die Rotoren drehen. Vergewissern Sie sich, dass niemand daneben steht.",
  "Arm {name}": "{name} scharf schalten",
  "Let {name} take off?": "{name} abheben lassen?",
  "It rises straight up from where it stands, and stays there until it is told otherwise.":
    "Es steigt senkrecht auf und bleibt dort, bis es etwas anderes hört.",
  "Let {name} take off": "{name} abheben lassen",
  "Height above the place of take-off [m]": "Höhe über dem Startplatz [m]",
  "Keep flying": "Weiterfliegen",
  "Start {name} outside its slot?": "{name} außerhalb seines Zeitfensters starten?",
  Wait: "Warten",
  "Start {name} all the same": "{name} trotzdem starten",
  "Resume the flight of {name}?": "Den Flug von {name} fortsetzen?",
  "It flies on along its route from where it is.": "Es fliegt seine Route weiter, von da, wo es ist.",
  "Resume {name}": "{name} fortsetzen",
  "Hold {name}?": "{name} anhalten?",
  "Hold {name}": "{name} anhalten",
  "Return {name}?": "{name} zurückholen?",
  "It flies back to where it took off and lands there. Targets that it has not reached stay undone.":
    "Es fliegt dahin zurück, wo es abgehoben hat, und landet dort. Ziele, die es nicht erreicht hat, bleiben offen.",
  "Return {name}": "{name} zurückholen",
  "Land {name} here?": "{name} hier landen?",
  "It comes straight down where it is now. Targets that it has not reached stay undone.":
    "Es kommt da, wo es jetzt ist, senkrecht herunter. Ziele, die es nicht erreicht hat, bleiben offen.",
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
  "Whatever else it was told no longer counts. Targets that it has not reached stay undone; the other UAVs go on.":
    "Was ihm sonst gesagt wurde, gilt nicht mehr. Ziele, die es nicht erreicht hat, bleiben offen; die anderen UAVs fliegen weiter.",
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
  "A UAV that is not connected gets its route when it is, within the hour.":
    "Ein UAV, das nicht verbunden ist, bekommt seine Route, sobald es das ist, innerhalb einer Stunde.",
  "Not sent.": "Nicht gesendet.",
  "Abort “{name}”?": "„{name}“ abbrechen?",
  "{names} are told before anything else that is waiting. Targets that are not reached stay undone, and the mission cannot be taken up again.":
    "{names} hören das vor allem anderen, was wartet. Ziele, die nicht erreicht sind, bleiben offen, und die Mission kann nicht wieder aufgenommen werden.",
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
  "Plans keep UAVs apart by their times. Started now, it is up to you to keep them apart: hold one, or have one return.":
    "Pläne halten UAVs durch ihre Zeiten auseinander. Startet es jetzt, müssen Sie sie auseinanderhalten: eines anhalten oder zurückholen.",
  "Fly: {act}": "Fliegen: {act}",
  "Upload flight {flight}": "Flug {flight} hochladen",
  "Upload again": "Erneut hochladen",
  "The mission is already on {name}.": "Die Mission ist schon auf {name}.",
  "Upload flight {flight} to {name}?": "Flug {flight} auf {name} hochladen?",
  "Upload its route to {name}?": "Die Route auf {name} hochladen?",
  "The upload is verified against the approved mission. The UAV does not take off.":
    "Das Hochgeladene wird mit der freigegebenen Mission verglichen. Das UAV startet nicht.",
  "Upload to {name}": "Auf {name} hochladen",
};
