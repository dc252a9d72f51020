"""The same texts in German."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

_ITEMS: Mapping[str, str] = {
    "sus_1": "würde es gern häufig benutzen",
    "sus_2": "unnötig komplex",
    "sus_3": "einfach zu benutzen",
    "sus_4": "brauche die Hilfe einer technisch kundigen Person",
    "sus_5": "Funktionen gut aufeinander abgestimmt",
    "sus_6": "zu viele Unstimmigkeiten",
    "sus_7": "die meisten lernen es schnell",
    "sus_8": "umständlich",
    "sus_9": "fühlte mich sicher",
    "sus_10": "musste vorher viel lernen",
    "sus.low": "stimme gar nicht zu",
    "sus.high": "stimme völlig zu",
    "tlx_mental": "Geistige Anforderung",
    "tlx_physical": "Körperliche Anforderung",
    "tlx_temporal": "Zeitliche Anforderung",
    "tlx_performance": "Leistung",
    "tlx_performance.low": "perfekt",
    "tlx_performance.high": "Misserfolg",
    "tlx_effort": "Anstrengung",
    "tlx_frustration": "Frustration",
    "nasa-tlx.low": "sehr gering",
    "nasa-tlx.high": "sehr hoch",
    "ssq_discomfort": "Allgemeines Unwohlsein",
    "ssq_fatigue": "Müdigkeit",
    "ssq_headache": "Kopfschmerzen",
    "ssq_eyestrain": "Überanstrengte Augen",
    "ssq_focusing": "Schwierigkeiten, scharf zu sehen",
    "ssq_salivation": "Erhöhter Speichelfluss",
    "ssq_sweating": "Schwitzen",
    "ssq_nausea": "Übelkeit",
    "ssq_concentrating": "Konzentrationsschwierigkeiten",
    "ssq_fullness": "Druckgefühl im Kopf",
    "ssq_blurred": "Verschwommenes Sehen",
    "ssq_dizzy_open": "Schwindel bei offenen Augen",
    "ssq_dizzy_closed": "Schwindel bei geschlossenen Augen",
    "ssq_vertigo": "Drehschwindel",
    "ssq_stomach": "Magen macht sich bemerkbar",
    "ssq_burping": "Aufstoßen",
    "ssq.low": "gar nicht",
    "ssq.high": "stark",
}

_FEEDBACK: Mapping[str, str] = {
    "feedback.skin": "Die Haut hatte sich um {shift:.1f} mm (RMS) verschoben und war "
    "{indentation:.1f} mm eingedrückt: Der wahre Fehler am Ziel war {tre:.2f} mm.",
    "feedback.skin and error": "Die Haut hatte sich um {shift:.1f} mm (RMS) verschoben und war "
    "{indentation:.1f} mm eingedrückt: Der wahre Fehler am Ziel war {tre:.2f} mm und wäre sonst "
    "{without:.2f} mm gewesen.",
    "feedback.touch": "Punkt {label} lag {residual:.1f} mm daneben{where}{hurry}{tremor}.",
    "feedback.touch above": ", vor allem in der Tiefe ({depth:.1f} mm über der Haut)",
    "feedback.touch below": ", vor allem in der Tiefe ({depth:.1f} mm unter der Haut)",
    "feedback.touch aside": ", vor allem entlang der Haut",
    "feedback.touch hurry": "; du warst in Eile: halte einen Moment still, bevor du berührst",
    "feedback.touch tremor": "; die Spitze hat gezittert: nimm für den letzten Zentimeter die "
    "feine Geschwindigkeit",
    "feedback.no touch": "Keine Berührung fällt auf: die Fehler sind gleichmäßig verteilt.",
    "feedback.contact": "Du bist unterwegs einmal an den Kopf gestoßen. Heb ab, bevor du zum "
    "nächsten Punkt fährst.",
    "feedback.contacts": "Du bist unterwegs {count}-mal an den Kopf gestoßen. Heb ab, bevor du zum "
    "nächsten Punkt fährst.",
    "feedback.dragging": "Das Werkzeug lag abseits der Punkte {time:.0f} s auf dem Kopf, über "
    "{path:.0f} mm: heb ab, bevor du zum nächsten Punkt fährst.",
    "feedback.pressing": "Du hast an den Punkten {depth:.1f} mm in den Kopf gedrückt: halt an, "
    "sobald die Spitze die Haut berührt.",
    "feedback.worst touch": "Achte mehr auf den Punkt {points}: ohne diesen Fehler wäre die "
    "Registrierung etwa {share:.0f} % genauer.",
    "feedback.worst touches": "Achte mehr auf die Punkte {points}: ohne diese Fehler wäre die "
    "Registrierung etwa {share:.0f} % genauer.",
    "feedback.depth": "Der Fehler liegt vor allem in der Tiefe: bring die Spitze ganz auf die "
    "Haut, und schau von der Seite, bevor du berührst.",
    "feedback.common bias": "Die Berührungen liegen im Mittel {bias:.1f} mm zu weit {direction}, "
    "was der Registrierungsfehler nicht zeigen kann: sieh dir die Spitze von einer zweiten Seite "
    "an, bevor du berührst.",
    "feedback.oblique common bias": "Die Berührungen liegen im Mittel {bias:.1f} mm zu weit "
    "{direction} und {second}, was der Registrierungsfehler nicht zeigen kann: sieh dir die Spitze "
    "von einer zweiten Seite an, bevor du berührst.",
    "feedback.bias to the left": "zur linken Seite des Patienten hin",
    "feedback.bias to the right": "zur rechten Seite des Patienten hin",
    "feedback.bias to the back": "zum Hinterkopf hin",
    "feedback.bias to the face": "zum Gesicht hin",
    "feedback.bias to the neck": "zum Hals hin",
    "feedback.bias to the crown": "zum Scheitel hin",
    "feedback.idle time": "Das Werkzeug stand {idle:.0f} s von {time:.0f} s still: such den "
    "nächsten Punkt, während du noch an diesem bist.",
    "feedback.detours": "Das Werkzeug fuhr das {times:.1f}-Fache des kürzesten Wegs: fahr näher "
    "und in einem Zug um den Kopf.",
    "feedback.repeated touch": "1 Berührung wurde abgelehnt oder zurückgenommen: prüf die Nummer "
    "des Punkts, bevor du berührst.",
    "feedback.repeated touches": "{count} Berührungen wurden abgelehnt oder zurückgenommen: prüf "
    "die Nummer des Punkts, bevor du berührst.",
    "feedback.pace": "Du hast {time:.0f} s gebraucht, üblich sind {usual:.0f} s: fahr zwischen den "
    "Punkten schneller und erst nah an der Haut langsam.",
    "feedback.first trial": "Das ist dein erster Versuch dieser Aufgabe in diesem Modus.",
    "feedback.first of this score": "Deine früheren Versuche dieser Aufgabe haben Punktzahlen "
    "einer früheren Version, die sich mit dieser nicht vergleichen lassen.",
    "feedback.more points": "{points:.0f} Punkte mehr als im Mittel deiner letzten {trials} "
    "Versuche dieser Aufgabe.{best}",
    "feedback.less points": "{points:.0f} Punkte weniger als im Mittel deiner letzten {trials} "
    "Versuche dieser Aufgabe.{best}",
    "feedback.more points than last": "{points:.0f} Punkte mehr als in deinem letzten Versuch "
    "dieser Aufgabe.{best}",
    "feedback.less points than last": "{points:.0f} Punkte weniger als in deinem letzten Versuch "
    "dieser Aufgabe.{best}",
    "feedback.best": " Es ist dein bisher bester.",
    "feedback.unacceptable": "Nicht bestanden: der wahre Fehler im Gehirn, der gemeinsame Versatz "
    "aller Berührungen oder der Kontakt mit dem Kopf ist größer als zulässig.",
    "feedback.passed": "Bestanden: die Marke ist {mark:.0f}.",
    "feedback.not passed": "Noch nicht bestanden: {points:.0f} Punkte bis zur Marke von "
    "{mark:.0f}.",
    "feedback.no mark": "Weder bestanden noch nicht bestanden: die Marke dieser Studie gilt für "
    "eine andere Version der Punktzahl.",
    "feedback.competent": "Deine Versuche zeigen Können seit Nummer {number}: von denen, die noch "
    "in {failing:.0f} % ihrer Versuche scheitern, kommen durch Zufall {risk:.0f} % in {trials} "
    "Versuchen so weit (LC-CUSUM).",
    "feedback.not competent": "{share:.0f} % des Wegs zum nachgewiesenen Können (LC-CUSUM; "
    "Versuche bisher: {trials}).",
}

GERMAN: Mapping[str, str] = MappingProxyType(
    {
        # What the trainee reads at the top of the picture.
        "idle": "Wähle eine Aufgabe, um zu beginnen.",
        "start": "{trainee}, berühre Punkt {point}.",
        "touched": "{trainee}, Punkt {label} ist aufgenommen. Berühre jetzt Punkt {point}.",
        "undone": "{trainee}, Punkt {label} ist zurückgenommen. Berühre ihn noch einmal.",
        "complete": "{trainee}, alle {count} Punkte sind berührt. Registriere sie jetzt.",
        # Über die Haut ziehen, ein Punkt je Millimeter.
        "trace": "{trainee}, die Landmarken sind berührt. Zieh die Spitze jetzt über die Haut: "
        "{least} Punkte oder mehr, einer je Millimeter.",
        "tracing": "{trainee}, zieh die Spitze über die Haut, auch dorthin, wo sie anders "
        "gerichtet ist.",
        "traced": "{trainee}, {traced} Punkte sind gezogen. Mach weiter: {least} sind nötig.",
        "traced enough": "{trainee}, {traced} Punkte sind gezogen. Registriere sie, oder zieh "
        "weiter.",
        "traced all": "{trainee}, {traced} Punkte sind gezogen, mehr nimmt ein Versuch nicht auf. "
        "Registriere sie jetzt.",
        "paused": "{trainee}, der Versuch ist angehalten. Mach weiter, wenn du bereit bist.",
        "resumed": "{trainee}, weiter mit Punkt {point}.",
        "registered": "{trainee}, deine Punkte werden nun registriert und bewertet.",
        "scored": "{trainee}, du hast {score:.0f} von 100: {fre:.2f} mm Registrierungsfehler, "
        "{tre:.2f} mm wahrer Fehler am Ziel.",
        "aborted": "{trainee}, der Versuch wurde abgebrochen. Wähle eine Aufgabe, um neu zu "
        "beginnen.",
        # A procedure, from the registration to the placed instrument.
        "verifying": "{trainee}, deine Punkte werden registriert.",
        "verify": "{trainee}, deine Punkte sind registriert: FRE {fre:.2f} mm. Berühre "
        "Kontrollpunkte, dann nimm die Registrierung an oder registriere neu.",
        "checked": "{trainee}, {name} liegt nach deiner Registrierung {error:.1f} mm daneben. "
        "Prüfe einen weiteren Punkt, nimm die Registrierung an oder registriere neu.",
        "register again": "{trainee}, berühre alle Punkte noch einmal. Beginne mit Punkt {point}.",
        "align": "{trainee}, bringe die Führung auf die geplante Linie von {name}, dann arretiere "
        "sie.",
        "align next": "{trainee}, das Instrument ist gesetzt. Bringe die Führung jetzt auf die "
        "geplante Linie von {name}.",
        "drill": "{trainee}, die Führung ist arretiert. Bohre entlang {name} durch den Schädel.",
        "realign": "{trainee}, der Bohrer ist zurückgezogen. Bringe die Führung noch einmal auf "
        "die geplante Linie von {name}.",
        "insert": "{trainee}, schiebe das Instrument bis zum Ziel von {name} vor, dann löse es.",
        "procedure done": "{trainee}, die Prozedur ist abgeschlossen und wird bewertet.",
        "interrupted procedure": "{trainee}, dieser Versuch wurde unterbrochen; alles ist "
        "gesichert. Setze die Prozedur fort, wenn du bereit bist, oder brich ihn ab.",
        # What a procedure does not allow.
        "no checkpoints": "Diese Prozedur hat keine Kontrollpunkte: AcceptRegistration oder "
        "RegisterAgain.",
        "too many checkpoints": "{most} Kontrollpunkte sind berührt, mehr behält ein Versuch "
        "nicht: AcceptRegistration oder RegisterAgain.",
        "too many attempts": "Die Punkte wurden {most}-mal registriert, öfter behält ein Versuch "
        "es nicht: AcceptRegistration oder Abort.",
        "too far from checkpoints": "Hier ist kein Kontrollpunkt: {name}, der nach deiner "
        "Registrierung nächste, ist {distance:.1f} mm entfernt; einer zählt bis {radius:g} mm.",
        "above a checkpoint": "{height:.1f} mm über der Haut: Senke die Spitze auf den "
        "Kontrollpunkt.",
        "not in use yet": "Die Punkte werden noch registriert: Zuerst kommt UseRegistration.",
        "already in use": "Eine andere Registrierung ist in Gebrauch: AcceptRegistration oder "
        "RegisterAgain.",
        "not rigid": "UseRegistration braucht eine starre Transformation: WorldToHead, Zeile für "
        "Zeile, in mm.",
        "off the head": "Die Achse der Führung trifft den Kopf nicht: Richte sie auf den Kopf, "
        "bevor du sie arretierst.",
        "too far to lock": "Die Spitze der Führung ist entlang ihrer Achse {distance:.0f} mm von "
        "der Haut entfernt: Arretiere sie im Abstand von höchstens {limit:.0f} mm.",
        "no self-alignment": "In dieser Einstellung richtet der Roboter die Führung nicht selbst "
        "aus: Bringe sie von Hand auf die Linie.",
        "line out of reach": "Der Roboter kann die Führung auf dieser Linie im Abstand von "
        "{stand_off:g} mm nicht halten: Wähle einen anderen Abstand oder bewege sie von Hand.",
        "bone is cut": "Der Bohrer hat Knochen abgetragen: Das Loch bleibt, wo es ist. Bohre "
        "weiter, dann führe das Instrument ein.",
        "nothing drilled": "Noch ist nichts gebohrt: Bohre, bevor du das Instrument einführst.",
        "still in the guide": "Das Instrument ist noch in der Führung: Schiebe es vor, bevor du es "
        "löst.",
        # Touches that do not count.
        "too far": "Zu weit von Punkt {point}: Eine Berührung zählt bis {radius:g} mm.",
        "above the skin": "{height:.1f} mm über der Haut: Senke die Spitze auf Punkt {point}.",
        "wrong point": "Falscher Punkt: Das ist Punkt {label}, {nearest:.1f} mm entfernt; Punkt "
        "{point} ist an der Reihe.",
        # Commands in the wrong phase.
        "no trial": "Es läuft kein Versuch: Beginne einen mit StartTask.",
        "another trial is open": "Dieser Versuch ist vorbei. Der jetzt offene, {task} von "
        "{trainee}, wurde nicht abgebrochen.",
        "trial is open": "{trainee} ist noch bei {task}: Register oder Abort vor StartTask.",
        "procedure is open": "{trainee} ist noch bei der Prozedur nach {task}: Beende sie, oder "
        "Abort, vor StartTask.",
        "no other head in a trial": "Ein Versuch läuft: Register oder Abort vor einem anderen "
        "Szenario.",
        "being set up": "Der Simulator lädt noch einen anderen Kopf oder andere Einstellungen: "
        "Warte ein paar Sekunden.",
        "not at the procedure": "Das kommt nach Register, in einem Versuch, den StartTask mit "
        "einer Prozedur begonnen hat.",
        "verifying now": "Die Registrierung wird geprüft: Capture für Kontrollpunkte, dann "
        "AcceptRegistration oder RegisterAgain.",
        "aligning now": "Die Führung wird ausgerichtet: Bringe sie auf die geplante Linie, dann "
        "LockGuide.",
        "drilling now": "Der Bohrer ist in der Führung, und der Arm wird gehalten: Feed für den "
        "Bohrer, dann StartInsertion.",
        "inserting now": "Das Instrument ist in der Führung, und der Arm wird gehalten: Feed bis "
        "zum Ziel, dann ReleaseInstrument.",
        "not all touched": "{kept} von {count} Punkten sind berührt: Register kommt nach dem "
        "letzten; Punkt {point} ist an der Reihe.",
        "nothing is traced": "In diesem Versuch wird nicht über die Haut gezogen: StartTask mit "
        "der Methode surface oder landmarks-surface beginnt einen solchen.",
        "landmarks first": "{kept} von {count} Landmarken sind berührt: Vor Trace kommt Capture "
        "für Punkt {point}.",
        "landmarks touched": "Alle {count} Landmarken sind berührt: jetzt Trace über die Haut, "
        "oder Undo für die letzte.",
        "trace is full": "{traced} Punkte sind gezogen, mehr nimmt ein Versuch nicht auf: "
        "Register, oder Undo für den letzten Strich.",
        "all traced": "{traced} Punkte sind gezogen: Register, weiter mit Trace, oder Undo für "
        "den letzten Strich.",
        "still tracing": "Ein Strich wird gezogen: erst mit Trace beenden, dann Register.",
        "too few traced": "{traced} Punkte sind gezogen: Register braucht {least}, also weiter "
        "mit Trace.",
        "not paused trace": "Der Versuch ist nicht angehalten: Trace über die Haut, oder erst "
        "Pause.",
        "not paused": "Der Versuch ist nicht angehalten: Capture für Punkt {point}, oder erst "
        "Pause.",
        "is paused": "Der Versuch ist angehalten: erst Resume.",
        "already paused": "Der Versuch ist schon angehalten: Resume oder Abort.",
        "all touched": "Alle {count} Punkte sind berührt: Register, oder Undo für den letzten.",
        "is registered": "Der Versuch ist registriert und aufbewahrt: StartTask beginnt den "
        "nächsten.",
        "nothing to undo": "Noch ist kein Punkt berührt: erst Punkt {point} berühren.",
        "not registered": "Der Versuch ist noch nicht registriert: erst Capture für seine {count} "
        "Punkte und Register.",
        "no registration": "Der Versuch ist noch nicht registriert: Vor TrialScored kommt "
        "SubmitRegistration.",
        "registration is final": "Diese Registrierung ist endgültig: Der wahre Fehler wurde "
        "bekanntgegeben, deshalb wird keine andere mehr angenommen.",
        "no such trial": "Es gibt hier keinen Versuch {trial_id}: GetTrial, SubmitRegistration und "
        "TrialScored nehmen die ID, mit der StartTask geantwortet hat.",
        "not a simulation command": "{command} ist kein Befehl der Simulation.",
        # When the record cannot be written.
        "not recorded": "Der Versuch kann nicht aufgezeichnet werden ({reason}). Was nicht "
        "aufgezeichnet wurde, zählt nicht; schaffe Platz oder wähle einen anderen Ordner und mach "
        "dann weiter.",
        # Wenn der Simulator mitten in einem Versuch geendet hat und wieder da ist.
        "interrupted": "{trainee}, dieser Versuch wurde unterbrochen; {kept} von {count} Punkten "
        "sind gesichert. Mach mit Punkt {point} weiter, wenn du bereit bist, oder brich ihn ab.",
        "interrupted complete": "{trainee}, dieser Versuch wurde unterbrochen; alle {count} Punkte "
        "sind gesichert. Registriere sie jetzt.",
        "interrupted trace": "{trainee}, dieser Versuch wurde unterbrochen; {traced} gezogene "
        "Punkte sind gesichert. Zieh weiter, wenn du bereit bist, oder brich ihn ab; {least} "
        "Punkte lassen sich registrieren.",
        # Wenn niemand den Versuch sehen konnte, was ihn anhält.
        "unseen.left": "Angehalten: Die Ansicht des Versuchs wurde geschlossen oder ging verloren.",
        "unseen.unplugged": "Pause: Das Gamepad wurde abgesteckt.",
        "unseen.hidden": "Angehalten: Der Versuch war nicht zu sehen.",
        "unseen.instructor": "Angehalten von den Ausbildenden.",
        "instructor.says": "Von den Ausbildenden: {text}",
        "instructor.nothing runs": "An diesem Platz läuft nichts, das angehalten werden könnte.",
        "instructor.no result": "Eine Wiederholung kann gezeigt werden, solange am Platz das "
        "Ergebnis eines Versuchs zu sehen ist.",
        "unseen.still": "Angehalten: Das Bild stand einige Sekunden still, weil dieser Rechner zu "
        "beschäftigt war. Geschieht das wieder, so schließ andere Programme.",
        # The simulator's menus.
        "start.title": "RASTrainer",
        "start.text": "Übe die robotergestützte Patientenregistrierung an einem virtuellen KUKA "
        "LBR iiwa 7. Nicht für den klinischen Gebrauch.",
        "start.train": "Training beginnen",
        "start.introduction": "Einführung",
        "start.controls": "Steuerung",
        "start.settings": "Einstellungen",
        "start.quit": "Beenden",
        "quit.title": "RASTrainer beenden?",
        "quit.text": "Der Simulator endet für alle, die mit ihm verbunden sind.",
        "quit.stay": "Bleiben",
        "quit.leave": "Beenden",
        "introduction.title.1": "Was du übst",
        "introduction.text.1": "Bevor ein Roboter am Gehirn helfen kann, muss er wissen, wo der "
        "Kopf liegt. Du zeigst es ihm: Mit seinem Werkzeug berührst du fünfzehn nummerierte "
        "Punkte am Kopf, einen nach dem anderen, so genau du kannst.",
        "introduction.title.2": "Wie eine Aufgabe abläuft",
        "introduction.text.2": "Folge den Nummern und Pfeilen auf der Haut von Punkt 1 bis Punkt "
        "15. Näher als 20 mm am Kopf erklingt ein Ton, und ein Ring um die Spitze schließt sich, "
        "je näher du kommst. Wo eine Berührung zählt, wird er grün: Nimm den Punkt dort auf. Rot "
        "heißt, dass etwas nicht stimmt. Ein Ausrutscher lässt sich zurücknehmen.",
        "introduction.title.3": "Was daraus wird",
        "introduction.text.3": "Nach dem letzten Punkt registrierst du: 3D Slicer gleicht deine "
        "Punkte mit der MRT ab und zeigt dir den Fehler und deine Punktzahl. Genauigkeit und Zeit "
        "zählen beide. Du beginnst mit einem Tutorial von zwei Minuten und fünf Minuten freiem "
        "Üben, dann kommen die Aufgaben 1 bis 5.",
        "introduction.sheet": "Seite {sheet} von {sheets}",
        "introduction.next": "Weiter",
        "introduction.skip": "Gleich zur Steuerung",
        "introduction.back": "Zurück",
        "controls.title": "Steuerung",
        "controls.text": "Gamepad, Tastatur und die Controller eines Headsets können alle "
        "dasselbe.",
        "controls.move_along": "Nach vorn, hinten",
        "controls.move_across": "Nach links, rechts",
        "controls.move_vertically": "Nach oben, unten",
        "controls.fine": "Langsam bewegen (halten)",
        "controls.touch": "Berührung aufnehmen",
        "controls.undo": "Letzte Berührung zurücknehmen",
        "controls.camera": "Ansicht von vorn: nah oder fern",
        "controls.best_view": "Beste Ansicht des nächsten Punkts",
        "controls.turn_view": "Ansicht von links, von rechts",
        "controls.tilt_view": "Ansicht von oben, von unten",
        "controls.zoom_view": "Ansicht von näher, von weiter weg",
        "controls.pause": "Pause",
        "controls.menu": "Menü",
        "controls.next": "Weiter",
        "controls.test": "Steuerung ausprobieren",
        "controls.rebind": "Steuerung ändern",
        "controls.back": "Zurück",
        "experiment.title": "Experiment",
        "experiment.trainee": "Deine ID",
        "experiment.trainee help": "Diese ID gibt dir die Kursleitung; sie steht auf deinen "
        "Versuchen.",
        "experiment.clicked": "ID mit der Maus eingeben",
        "experiment.mode": "Modus",
        "mode.desktop": "Bildschirm",
        "mode.hmd": "Headset",
        "experiment.done": "erledigt",
        "experiment.task help": "Diese Aufgabe beginnen.",
        "experiment.no trainee": "Gib zuerst deine ID ein.",
        "experiment.trial run first": "{task} kommt zuerst: Berühre alle Punkte, oder übe, bis die "
        "Zeit um ist.",
        "experiment.order": "{task} kommt zuerst.",
        "experiment.tutorial": "Tutorial",
        "experiment.tutorial time": "2 Minuten",
        "experiment.tutorial help": "Lerne den Roboter zu bewegen, ein Bedienelement nach dem "
        "anderen.",
        "experiment.tutorial first": "Zuerst kommt das Tutorial mit dem Gerät, das du jetzt "
        "benutzt: Es dauert zwei Minuten.",
        "experiment.study": "Jetzt nicht. {step} Nur die Kursleitung kann einen Schritt auslassen, "
        "in 3D Slicer und mit einem Grund.",
        "study.questionnaire": "Schritt {number} von {count}: Beantworte den Fragebogen "
        "{questionnaire}, hier oder dort, wo 3D Slicer läuft.",
        "study.answered": "Deine Antworten zu {questionnaire} sind auf dem Weg zu 3D Slicer, das "
        "sagen wird, was als Nächstes kommt.",
        "study.trial-run": "Schritt {number} von {count}: Lerne {mode} {minutes:g} Minuten lang "
        "den Probelauf kennen.",
        "study.trial": "Schritt {number} von {count}: Spiele {task} {mode}.",
        "study.break": "Schritt {number} von {count}: Mach mindestens {minutes:g} Minuten Pause, "
        "noch {left}. Dann wird 3D Slicer sagen, was als Nächstes kommt.",
        "study.all-done": "Alle Schritte der Studie sind getan. Danke!",
        "study.repeat": "Schritt {number} von {count}: {task} wurde abgebrochen. Die Kursleitung "
        "gibt in 3D Slicer an, warum der Versuch wiederholt wird.",
        "study.played": "{task} ist erledigt. 3D Slicer wird sagen, was als Nächstes kommt.",
        "study.desktop": "am Bildschirm",
        "study.hmd": "mit dem Headset",
        "study.by landmarks": "anhand von Landmarken des Gesichts",
        "study.by surface": "anhand einer Spur über die Haut",
        "study.by landmarks-surface": "anhand von Landmarken und einer Spur",
        "experiment.assignments": "Deine Aufträge",
        "assignments.title": "Deine Aufträge",
        "assignments.back": "Zurück",
        "assignments.with procedure": "{trial}, dann {procedure}",
        "assignments.summary": "{reached} von {count} erreicht",
        "assignments.reached": "erreicht",
        "assignments.just reached": "Erreicht: {assignment}.",
        "assignments.locked": "gesperrt",
        "assignments.count": "{done} / {needed}",
        "assignments.percent": "{done} %",
        "assignments.one trial": "Erreicht, wenn ein Versuch mindestens {mark:g} Punkte hat, "
        "innerhalb aller Grenzen.",
        "assignments.trials": "Erreicht, wenn {needed} Versuche in Folge mindestens {mark:g} "
        "Punkte haben, innerhalb aller Grenzen.",
        "assignments.competent": "Erreicht, wenn die Versuche Kompetenz zeigen (LC-CUSUM); ein "
        "Versuch ist ab {mark:g} Punkten bestanden.",
        "assignments.no mark": "Für diese Punktzahl ist keine Marke zum Bestehen gesetzt: Frag die "
        "Kursleitung.",
        "assignments.gate": "Gesperrt. Erreiche zuerst: {assignments}.",
        "assignments.other head": "Diesen Auftrag gibt es an diesem Kopf nicht: Wähle einen "
        "anderen.",
        "assignments.all reached": "Alle Aufträge sind erreicht.",
        "assignments.next in brief": "Als Nächstes: {assignment} ({progress})",
        "assignments.next": "Als Nächstes: {assignment}, dein schwächster Auftrag.",
        "assignments.next unplayed": "Als Nächstes: {assignment}, noch nicht gespielt.",
        "assignments.weakest": "Was die meisten Punkte kostet: {part}.",
        "assignments.part time": "die Zeit",
        "assignments.part accuracy": "die Genauigkeit",
        "assignments.part common bias": "die gemeinsame Abweichung aller Berührungen",
        "assignments.part safety": "unbeabsichtigter Kontakt und Eindrücken",
        "assignments.part target": "der Fehler am Ziel",
        "assignments.part entry": "der Fehler am Eintritt",
        "assignments.part angle": "der Winkel",
        "assignments.part plunge": "zu tiefes Bohren",
        "assignments.part distance": "zu wenig Abstand zu verbotenen Strukturen",
        "experiment.trend": "Deine Punktzahlen in diesem Modus; die Linie ist die Marke zum "
        "Bestehen, {mark:.0f}.",
        "experiment.trend in study": "Deine Punktzahlen in diesem Modus.",
        "experiment.scores": "Punktzahlen, die älteste zuerst: {scores}.",
        "experiment.method": "Registrierung",
        "experiment.method help": "Wodurch der Kopf im nächsten Versuch registriert wird. "
        "Landmarken sind auf der Haut nicht markiert: Finde sie nach ihren Namen.",
        "method.fiducials": "markierte Punkte",
        "method.landmarks": "Landmarken des Gesichts",
        "method.surface": "Spur über die Haut",
        "method.landmarks-surface": "Landmarken, dann Spur",
        "experiment.procedure": "Nach den Berührungen",
        "experiment.procedure help": "Was auf die Registrierung folgt: nichts, oder eine Prozedur, "
        "in der nach ihr ein Instrument gesetzt wird. Der Probelauf hat keine.",
        "experiment.touches alone": "Nichts: nur Berührungen",
        "experiment.scenario": "Kopf",
        "experiment.answer": "Den Fragebogen beantworten",
        "questionnaire.text": "{trainee}, beantworte jede Zeile: {lowest} bedeutet {low}, "
        "{highest} bedeutet {high}, wenn in der Zeile nichts anderes steht. Deine Kursleitung hat "
        "den Bogen mit dem vollen Wortlaut.",
        "questionnaire.ends": "{topic}: {lowest} = {low}, {highest} = {high}",
        "questionnaire.open": "Einige Zeilen sind noch nicht beantwortet.",
        "questionnaire.keep": "Fertig",
        "questionnaire.back": "Zurück, ohne Antworten",
        **_ITEMS,
        **_FEEDBACK,
        "experiment.back": "Zurück",
        "scenario.title": "Köpfe",
        "scenario.text": "An welchem Kopf möchtest du üben?",
        "scenario.looking": "Die Köpfe werden gesucht.",
        "scenario.help": "Von nun an an diesem Kopf üben.",
        "scenario.loading": "wird geladen",
        "scenario.present": "in Gebrauch",
        "scenario.back": "Zurück",
        "task.trial-run": "Probelauf",
        "task.task-1": "Aufgabe 1",
        "task.task-2": "Aufgabe 2",
        "task.task-3": "Aufgabe 3",
        "task.task-4": "Aufgabe 4",
        "task.task-5": "Aufgabe 5",
        "clicked-id.title": "Deine ID",
        "clicked-id.delete": "Löschen",
        "clicked-id.done": "Fertig",
        "character.back": "Zurück",
        "pin.title": "PIN der Ausbildenden",
        "pin.text": "Sie gibt die Einstellungen, die Reihenfolge der Aufgaben und die Weitergabe "
        "der Steuerung frei, bis jemand anderes übt oder ein Versuch beginnt.",
        "pin.too short": "Eine PIN hat 6 bis 12 Ziffern.",
        "pin.delete": "Löschen",
        "pin.unlock": "Freigeben",
        "pin.cancel": "Abbrechen",
        "pin.unlocked": "Freigegeben, bis jemand anderes übt oder ein Versuch beginnt.",
        "pin.wrong": "Das ist nicht die PIN dieses Platzes.",
        "pin.wait": "Es waren zu viele falsche PINs: warte {seconds} s.",
        "keyboard.title": "Deine ID",
        "keyboard.row": "Schreiben",
        "keyboard.delete": "Löschen",
        "keyboard.done": "Fertig",
        "trial.title": "{task}",
        "trial.paused": "{trainee}, der Versuch ist mit {kept} berührten Punkten angehalten. "
        "Seine Zeit steht still.",
        "trial.complete": "{trainee}, alle {kept} Punkte sind berührt.",
        "trial.paused trace": "{trainee}, der Versuch ist mit {traced} gezogenen Punkten "
        "angehalten. Seine Zeit steht still.",
        "trial.complete trace": "{trainee}, {traced} Punkte sind gezogen.",
        "trial.resume": "Weitermachen",
        "trial.register": "Registrieren",
        "trial.controls": "Steuerung",
        "trial.settings": "Einstellungen",
        "trial.finish": "Probelauf beenden",
        "trial.abort": "Aufgabe abbrechen",
        "abort.title": "Aufgabe abbrechen?",
        "abort.text": "{trainee}, deine {kept} berührten Punkte würden nicht registriert.",
        "abort.keep": "Weitermachen",
        "abort.abort": "Abbrechen",
        "practice.title": "Die Zeit zum Üben ist vorbei",
        "practice.text": "{trainee}, du kannst jetzt zu Aufgabe 1 übergehen oder so lange üben, "
        "wie du magst.",
        "practice.study": "{trainee}, beende den Probelauf, um mit der Studie weiterzumachen, oder "
        "übe weiter.",
        "practice.finish": "Probelauf beenden",
        "practice.resume": "Weiter üben",
        "complete.title": "Alle Punkte sind berührt",
        "complete.text": "{trainee}, registriere deine {count} Punkte, damit sie bewertet werden. "
        "Danach lassen sie sich nicht mehr ändern.",
        "complete.register": "Registrieren",
        "complete.undo": "Letzten Punkt zurücknehmen",
        "complete.abort": "Aufgabe abbrechen",
        "match.title": "Diese Registrierung annehmen?",
        "match.looking": "Die Spur wird an die Haut angepasst …",
        "match.impossible": "Die Spur lässt sich nicht anpassen: {reason} Zieh weiter, oder nimm "
        "Striche zurück.",
        "match.residual and error": "Das Residuum sagt, wie weit die Spur von der Haut abweicht, "
        "der Fehler, wie weit das Ziel von dort liegt, wo es zu sein scheint. Ein kleines Residuum "
        "bedeutet keinen kleinen Fehler. Danach lassen sich die Punkte nicht mehr ändern.",
        "match.residual": "Residuum",
        "match.counts": "Punkte, die zählen",
        "match.interval": "95-%-Intervall dieses Fehlers",
        "match.interval value": "{low:.2f} bis {high:.2f} mm",
        "match.slides": "Die Lage kann verrutschen: Ein Ziel kann um bis zu {slide:.1f} mm falsch "
        "liegen, wie klein das Residuum auch ist. Zieh über Stellen, die anders gerichtet sind, "
        "etwa Nase, Brauen, Schläfen und Wangen.",
        "match.several-minima": "Die Spur passt an mehreren Stellen. Zieh über mehr vom Gesicht.",
        "match.not-converged": "Die Anpassung kam nicht zur Ruhe. Zieh über mehr vom Gesicht.",
        "match.few-inliers": "Viele Punkte liegen nicht auf der Haut. Lass die Spitze beim Ziehen "
        "auf der Haut.",
        "match.far-points": "Einige Punkte liegen weit von der Haut und zählen nicht.",
        "match.poor-fit": "Die Spur passt nicht zu diesem Kopf. Wurden Landmarken vertauscht?",
        "match.accept": "Annehmen und registrieren",
        "match.draw": "Weiter ziehen",
        "waiting.title": "Registriert",
        "waiting.slicer": "{trainee}, 3D Slicer bewertet deine Punkte.",
        "waiting.nobody": "{trainee}, deine Punkte sind aufbewahrt. 3D Slicer ist nicht "
        "verbunden: Er bewertet sie, sobald er es ist.",
        "waiting.own": "{trainee}, 3D Slicer ist nicht verbunden: Der Simulator registriert und "
        "bewertet deine Punkte selbst.",
        "waiting.problem": "Der Simulator kann sie nicht selbst bewerten: {reason}",
        "result.own": "Diese Punktzahl ist die des Simulators und in keiner Studie gespeichert. "
        "Sobald 3D Slicer verbunden ist, bewertet und speichert er den Versuch; seine Punktzahl "
        "ersetzt dann diese.",
        "result.title": "{trainee}: {task}",
        "result.score": "Punktzahl",
        "result.fre": "Registrierungsfehler (FRE)",
        "result.expected tre": "Erwarteter Fehler am Ziel (TRE)",
        "result.interval note": "Der erwartete Fehler setzt voraus, dass die Berührungen "
        "unabhängig voneinander, ohne systematische Abweichung und gleich stark streuen. Eine "
        "Verschiebung, die alle gemeinsam haben, sieht er nicht.",
        "result.true tre": "Wahrer Fehler am Ziel (TRE)",
        "result.region tre": "Wahrer Fehler im Gehirn (TRE)",
        "result.common bias": "Gemeinsamer Versatz aller Berührungen",
        "result.unacceptable score": "{score:.0f} / 100, nicht zulässig",
        "result.not accurate": "Nicht zulässig: ein Instrument, das dieser Registrierung folgt, "
        "würde sein Ziel verfehlen. Der wahre Fehler im Gehirn ist größer als zulässig.",
        "result.not unbiased": "Nicht zulässig: alle Berührungen liegen in derselben Richtung "
        "neben ihren Punkten, weiter als zulässig.",
        "result.not safe": "Nicht zulässig: das Werkzeug lag zu lange am Kopf an oder wurde zu "
        "tief eingedrückt.",
        "result.ctps": "CTPS",
        "result.of 100": "{score:.0f} / 100",
        "result.mm": "{error:.2f} mm",
        "result.points": "{points:.1f}",
        "result.time": "Zeit",
        "result.repeated": "Berührungen abgelehnt / zurückgenommen",
        "result.next": "Weiter: {task}",
        "result.again": "Noch einmal: {task}",
        "result.replay": "Versuch noch einmal zeigen",
        "result.errors": "Fehler am Kopf zeigen",
        "result.procedure": "Fehler der Prozedur",
        "procedure.title.verifying": "Registrierung prüfen",
        "procedure.title.aligning": "Führung ausrichten",
        "procedure.title.drilling": "Bohren",
        "procedure.title.inserting": "Instrument einführen",
        "procedure.accept": "Registrierung annehmen",
        "procedure.accept help": "Von da an zeigt sie den Plan.",
        "procedure.again": "Neu registrieren",
        "procedure.again help": "Berühre alle fünfzehn Punkte noch einmal.",
        "procedure.waits": "Die Punkte werden noch registriert.",
        "procedure.lock": "Führung arretieren",
        "procedure.lock help": "Von da an steht der Arm, und der Bohrer ist in der Führung.",
        "procedure.align": "Führung vom Roboter ausrichten lassen",
        "procedure.align help": "Er bringt sie auf die geplante Linie, wie deine Registrierung "
        "sie zeigt. Ein Stick hält ihn an.",
        "procedure.insert": "Instrument einführen",
        "procedure.insert help": "Der Bohrer wird herausgezogen; das Instrument beginnt an der "
        "Spitze der Führung.",
        "procedure.retract": "Bohrer zurückziehen und neu ausrichten",
        "procedure.retract help": "Möglich, bis der Bohrer Knochen abgetragen hat.",
        "procedure.release": "Instrument lösen",
        "procedure.release help": "Es bleibt, wo es ist; dann folgt die nächste Linie oder die "
        "Punktzahl.",
        "procedure.work": "Zurück an die Arbeit",
        "procedure-errors.title": "Fehler: {name}",
        "procedure-errors.text": "Gegen die Wahrheit. In Klammern: Anteil der Registrierung / "
        "Anteil der Hand. Diese Längen addieren sich nicht: Beide können sich aufheben.",
        "procedure-errors.trajectory": "Linie",
        "procedure-errors.lines": "Linien im Kopf zeigen",
        "procedure-errors.back": "Zurück",
        "procedure-errors.score": "Punktzahl der Prozedur",
        "procedure-errors.rms": "Fehler am Zielpunkt (RMS)",
        "procedure-errors.target": "Fehler am Zielpunkt",
        "procedure-errors.entry": "Fehler am Eintrittspunkt",
        "procedure-errors.radial": "Radialer Fehler",
        "procedure-errors.depth": "Tiefenfehler",
        "procedure-errors.angle": "Winkelabweichung",
        "procedure-errors.plunge": "Durchbruchtiefe",
        "procedure-errors.touches": "Punktzahl der Berührungen",
        "procedure-errors.split mm": "{error:.2f} mm ({registration:.2f} / {hand:.2f})",
        "procedure-errors.split deg": "{error:.1f}° ({registration:.1f} / {hand:.1f})",
        "procedure-errors.no inner table": "neben der Innentafel",
        "procedure-errors.kept": "{distance:.1f} mm entfernt",
        "procedure-errors.hit": "getroffen",
        "procedure-lines.title": "Grün: Plan. Gelb: nach deiner Registrierung. Blau: gesetzt.",
        "procedure-lines.back": "Zurück",
        "errors.title": "Dein Fehler an jedem Punkt, {longer:.0f}-mal so lang: grün bis "
        "{good:.0f} mm, rot ab {poor:.0f} mm",
        "errors.back": "Zurück",
        "result.worst": "Schlechteste Berührung zeigen",
        "result.menu": "Experiment-Menü",
        # Settings.
        "tutorial.title": "Tutorial",
        "tutorial.place": "Schritt {step} von {steps}",
        "tutorial.done mm": "{done} von {goal} mm",
        "tutorial.done degrees": "{done} von {goal}°",
        "tutorial.done points": "{done} von {goal} Punkten",
        "tutorial.homing": "Der Roboter fährt dorthin, wo du beginnst.",
        "tutorial.right": "Bewege das Werkzeug 30 mm nach rechts: {control}.",
        "tutorial.left": "30 mm nach links: {control}.",
        "tutorial.forward": "30 mm nach vorn, von dir weg: {control}.",
        "tutorial.forward.robot": "30 mm nach vorn, wie der Roboter steht: {control}.",
        "tutorial.back": "30 mm nach hinten, zu dir hin: {control}.",
        "tutorial.back.robot": "30 mm nach hinten, wie der Roboter steht: {control}.",
        "tutorial.up": "30 mm nach oben: {control}.",
        "tutorial.down": "30 mm nach unten: {control}.",
        "tutorial.slow": "Halte {control} und bewege das Werkzeug 10 mm: Nah an der Haut soll es "
        "langsam sein.",
        "tutorial.slow.touch screen": "Drücke {control} und bewege das Werkzeug 10 mm: Nah an der "
        "Haut soll es langsam sein. Noch einmal gedrückt ist es wieder schnell.",
        "tutorial.slow.mouse": "Klicke auf {control} und bewege das Werkzeug 10 mm: Nah an der "
        "Haut soll es langsam sein. Klicke noch einmal, um schnell zu sein.",
        "tutorial.turn view": "Dreh die Ansicht um 20°: {control}.",
        "tutorial.turn view.keyboard": "Dreh die Ansicht um 20°: {control}, oder zieh mit der "
        "rechten Maustaste.",
        "tutorial.turn view.mouse": "Dreh die Ansicht um 20°: Zieh mit der rechten Maustaste.",
        "tutorial.turn view.touch screen": "Dreh die Ansicht um 20°: Zieh mit einem Finger über "
        "das Bild.",
        "tutorial.look around": "Dreh den Kopf zur Seite und drück den linken Stick: Seine "
        "Richtungen drehen sich mit dir.",
        "tutorial.best view": "Beste Ansicht von Punkt {point}: {control}.",
        "tutorial.lower": "Senke die Spitze auf Punkt {point}: Der Ring schließt sich und wird auf "
        "der Haut grün.",
        "tutorial.touch": "Nimm die Berührung auf: {control}. Nur Berührungen bis 10 mm vom Punkt "
        "zählen.",
        "tutorial.undo": "Jeder rutscht einmal ab. Nimm die Berührung zurück: {control}.",
        "tutorial.pause": "Öffne das Menü: {control}. Solange steht alles still; mach dann weiter.",
        "tutorial.guided": "Berühre jetzt {count} Punkte, jeden so genau du kannst. Punkt {point} "
        "ist der erste.",
        "tutorial.praise": "Gut gemacht.",
        "tutorial.recorded": "Aufgenommen, {error:.1f} mm vom Punkt.",
        "tutorial.touched": "Punkt {label}: {error:.1f} mm daneben. Berühre jetzt Punkt {point}.",
        "tutorial.head is gone": "Das Tutorial ist zu Ende: Ein anderer Kopf ist in Gebrauch.",
        "tutorial is open": "{trainee} macht gerade das Tutorial: Warte, bis es fertig ist, oder "
        "verlasse es im Menü des Simulators.",
        "tutorial.paused": "Das Tutorial wartet bei Schritt {step} von {steps}.",
        "tutorial.resume": "Weitermachen",
        "tutorial.controls": "Steuerung",
        "tutorial.restart": "Von vorn beginnen",
        "tutorial.leave": "Tutorial verlassen",
        "tutorial.skip": "Tutorial überspringen",
        "tutorial.mm": "{error:.1f} mm",
        "tutorial-done.title": "Du kannst den Roboter steuern",
        "tutorial-done.text": "{trainee}, als Nächstes kommt der Probelauf: fünfzehn Punkte zum "
        "Üben, solange seine Zeit reicht.",
        "tutorial-done.time": "Zeit",
        "tutorial-done.first": "Fehler deiner ersten Berührung",
        "tutorial-done.touches": "Fehler der letzten drei",
        "tutorial-done.trial-run": "Probelauf beginnen",
        "tutorial-done.again": "Tutorial wiederholen",
        "tutorial-done.menu": "Experiment-Menü",
        "settings.title": "Einstellungen",
        "settings.back": "Zurück",
        "settings.unlock": "PIN der Ausbildenden",
        "settings.lock": "Wieder sperren",
        "settings.locked": "Gesperrt: Ausbildende geben unten die PIN ein.",
        "settings.waits": "Das lässt sich erst nach dem Ende des Versuchs ändern.",
        "settings.language": "Sprache",
        "settings.language help": "Sprache aller Bildschirme.",
        "settings.language.en": "English",
        "settings.language.de": "Deutsch",
        "settings.language.fr": "Français",
        "settings.language.es": "Español",
        "settings.language.zh-Hans": "简体中文",
        "settings.volume": "Lautstärke",
        "settings.volume help": "Lautstärke aller Töne.",
        "settings.muted": "Stumm",
        "settings.muted help": "Alle Töne ausschalten.",
        "settings.muted.yes": "Ja",
        "settings.muted.no": "Nein",
        "settings.speech": "Vorlesen",
        "settings.speech help": "Seite und Headset lesen Anweisungen, Warnungen und Menüs "
        "vor, mit der Stimme des Browsers.",
        "settings.speech.yes": "Ja",
        "settings.speech.no": "Nein",
        "settings.order": "Reihenfolge der Aufgaben",
        "settings.order help": "Ob die Aufgaben der Reihe nach kommen. Ausbildende ändern es "
        "mit ihrer PIN oder in der Datei {file}.",
        "settings.order.fixed": "Eine nach der anderen",
        "settings.order.any": "Beliebig",
        "settings.coarse": "Geschwindigkeit",
        "settings.coarse help": "Geschwindigkeit der Spitze, wenn ein Stick ganz ausgelenkt ist.",
        "settings.fine": "Langsame Geschwindigkeit",
        "settings.fine help": "Geschwindigkeit der Spitze, solange die Steuerung für langsames "
        "Bewegen gehalten wird.",
        "settings.axes": "Richtungen",
        "settings.axes help": "Ob rechts, vorn und oben die der Ansicht oder des Roboters sind.",
        "settings.axes.camera": "Wie die Ansicht sie zeigt",
        "settings.axes.robot": "Wie der Roboter steht",
        "settings.touch": "Eine Berührung zählt",
        "settings.touch help": "Nur auf der Haut oder überall im Umkreis von 10 mm um den Punkt, "
        "wie in der veröffentlichten Studie. Die Aufzeichnung hält fest, was galt.",
        "settings.self_alignment": "Führung vom Roboter ausgerichtet",
        "settings.self_alignment help": "Ob der Roboter die Führung einer Prozedur selbst auf die "
        "geplante Linie bringen darf, wie es klinische Roboter tun.",
        "settings.self_alignment.yes": "Auf Wunsch",
        "settings.self_alignment.no": "Nie",
        "settings.touch.on skin": "Auf der Haut",
        "settings.touch.within radius": "Im Umkreis von 10 mm",
        "settings.view": "Beste Ansicht des nächsten Punkts",
        "settings.view help": "Ob sich die Ansicht automatisch zum jeweils nächsten Punkt dreht, "
        "solange die Sticks losgelassen sind. Der Datensatz hält es fest. Die Taste für die beste "
        "Ansicht geht immer.",
        "settings.view.practice": "Automatisch, außer in Studien",
        "settings.view.always": "Automatisch",
        "settings.view.never": "Nur auf Wunsch",
        "settings.guidance": "Führung zum nächsten Punkt",
        "settings.guidance help": "Richtungen in Worten, ein Pfeil oder keins von beiden; wo über "
        "die Haut gezogen wird, auch was abgedeckt ist und wo es weitergeht. Eine Studie kann es "
        "selbst festlegen. Der Datensatz hält es fest.",
        "settings.guidance.fading": "Von Aufgabe zu Aufgabe weniger",
        "settings.guidance.words": "Worte und Pfeil",
        "settings.guidance.arrow": "Pfeil",
        "settings.guidance.none": "Keine",
        "settings.ghost": "Geist neben dem Arm",
        "settings.ghost help": "Zeigt das Werkzeug eines früheren Versuchs derselben Aufgabe, "
        "nach der Zeit seit dem Beginn. In Studien nur, wenn das Protokoll es vorsieht. Der "
        "Datensatz hält es fest. Die ID der Expertin oder des Experten steht in der Datei {file}.",
        "settings.ghost.off": "Keiner",
        "settings.ghost.own best": "Dein bester Versuch",
        "settings.ghost.expert": "Bester Versuch der Expertin, des Experten",
        "ghost.none": "Kein Geist: Es gibt noch keinen akzeptablen Versuch dieser Aufgabe.",
        "settings.tutorial": "Tutorial",
        "settings.tutorial help": "Ob der Probelauf auf das Tutorial wartet. Eine Studie kann das "
        "selbst festlegen. Ausbildende ändern das mit ihrer PIN oder in der Datei "
        "{file}.",
        "settings.tutorial.required": "Vor dem Probelauf",
        "settings.tutorial.optional": "Darf entfallen",
        "settings.tutorial.skipped": "Keines",
        "settings.direction": "Richtung des Werkzeugs",
        "settings.direction help": "Wer bestimmt, wohin das Werkzeug zeigt: der Arm, du oder die "
        "Haut.",
        "settings.direction.free": "Frei (nur Position)",
        "settings.direction.clear": "Frei, ohne den Kopf zu streifen",
        "settings.direction.held": "Von dir gelenkt",
        "settings.direction.normal": "Senkrecht auf die Haut",
        "settings.direction.pose": "Von dir gelenkt, ohne Rollen",
        # Controls: what they do, and what they are called.
        "bindings.title": "Steuerung ändern",
        "bindings.device": "Gerät",
        "bindings.preset": "Belegung",
        "bindings.preset.two hands": "Beide Hände",
        "bindings.preset.left-handed": "Linkshändig",
        "bindings.preset.right alone": "Nur rechte Hand",
        "bindings.preset.left alone": "Nur linke Hand",
        "bindings.preset.own": "Eigene",
        "bindings.group": "Steuerung für",
        "bindings.group.work": "Arbeiten",
        "bindings.group.movement": "Bewegen des Werkzeugs",
        "bindings.group.view": "Die Ansicht",
        "bindings.group.menus": "Menüs",
        "bindings.defaults": "Standard wiederherstellen",
        "bindings.back": "Zurück",
        "bindings.are default": "Die ganze Steuerung ist auf den Standard zurückgesetzt.",
        "bindings.changed": "{control} ist jetzt {input}.",
        "bindings.impossible": "Diese beiden lassen sich nicht tauschen: Eine von ihnen täte dann "
        "zweierlei.",
        "listen.title": "{control}",
        "listen.gamepad": "Drücke die neue Taste oder bewege die neue Achse für {control} "
        "({seconds} s).",
        "listen.keyboard": "Drücke die neue Taste für {control} ({seconds} s).",
        "listen.cancel": "Abbrechen",
        "conflict.title": "Schon vergeben",
        "conflict.text": "{input} ist jetzt {other}. Mit {control} tauschen?",
        "conflict.exchange": "Tauschen",
        "conflict.another": "Eine andere wählen",
        "conflict.cancel": "Abbrechen",
        "test.title": "Steuerung ausprobieren",
        "test.text": "Bewege und drücke alles; jede Eingabe wird gezeigt und ist zu spüren. "
        "{menu} führt zurück.",
        "test.back": "Zurück",
        "test.yes": "An",
        "test.no": "Aus",
        "test.nothing": "nichts",
        "control.touch": "Berühren",
        "control.undo": "Zurücknehmen",
        "control.camera": "Ansicht von vorn",
        "control.fine": "Langsam",
        "control.pause": "Pause",
        "control.menu": "Menü",
        "control.move_left": "Nach links",
        "control.move_right": "Nach rechts",
        "control.move_back": "Nach hinten",
        "control.move_forward": "Nach vorn",
        "control.move_down": "Nach unten",
        "control.move_up": "Nach oben",
        "control.turn_left": "Links drehen",
        "control.turn_right": "Rechts drehen",
        "control.turn_down": "Nach unten drehen",
        "control.turn_up": "Nach oben drehen",
        "control.best_view": "Beste Ansicht",
        "control.view_left": "Ansicht von links",
        "control.view_right": "Ansicht von rechts",
        "control.view_lower": "Ansicht von unten",
        "control.view_higher": "Ansicht von oben",
        "control.view_farther": "Ansicht von weiter weg",
        "control.view_nearer": "Ansicht von näher",
        "control.accept": "Bestätigen",
        "control.back": "Zurück",
        "control.up": "Hoch",
        "control.down": "Runter",
        "control.left": "Links",
        "control.right": "Rechts",
        "control.taken": "Die Steuerung ist jetzt hier: {source}.",
        "control.held": "Die Steuerung liegt hier: {source}. Wer übernehmen will, kann das mit "
        "{menu} nach {seconds:.0f} s ohne Eingabe.",
        "control.locked": "Die Steuerung liegt hier: {source}. Nur Ausbildende können sie "
        "weitergeben: {menu}, Einstellungen, PIN der Ausbildenden.",
        "control.holder": "Steuerung: {source}",
        "control.nobody": "Steuerung: niemand",
        "source.gamepad": "Gamepad",
        "source.keyboard": "Tastatur",
        "source.mouse": "Maus",
        "source.touch screen": "Touchscreen",
        "source.browser's gamepad": "Gamepad am Browser",
        "source.headset's controllers": "Controller des Headsets",
        "device.gamepad": "Gamepad",
        "device.keyboard": "Tastatur",
        "gamepad.a": "A",
        "gamepad.b": "B",
        "gamepad.x": "X",
        "gamepad.y": "Y",
        "gamepad.back": "Back-Taste",
        "gamepad.guide": "Logo-Taste",
        "gamepad.start": "Start-Taste",
        "gamepad.leftstick": "Linker Stick gedrückt",
        "gamepad.rightstick": "Rechter Stick gedrückt",
        "gamepad.leftshoulder": "LB",
        "gamepad.rightshoulder": "RB",
        "gamepad.dpup": "Steuerkreuz hoch",
        "gamepad.dpdown": "Steuerkreuz runter",
        "gamepad.dpleft": "Steuerkreuz links",
        "gamepad.dpright": "Steuerkreuz rechts",
        "gamepad.-leftx": "Linker Stick links",
        "gamepad.+leftx": "Linker Stick rechts",
        "gamepad.-lefty": "Linker Stick hoch",
        "gamepad.+lefty": "Linker Stick runter",
        "gamepad.-rightx": "Rechter Stick links",
        "gamepad.+rightx": "Rechter Stick rechts",
        "gamepad.-righty": "Rechter Stick hoch",
        "gamepad.+righty": "Rechter Stick runter",
        "gamepad.-lefttrigger": "LT losgelassen",
        "gamepad.+lefttrigger": "LT",
        "gamepad.-righttrigger": "RT losgelassen",
        "gamepad.+righttrigger": "RT",
        # Where a headset's controllers differ from a gamepad.
        "headset.fine": "Trigger",
        "headset.menu": "X",
        "headset.pause": "X",
        "headset.up": "Stick hoch",
        "headset.down": "Stick runter",
        "headset.left": "Stick links",
        "headset.right": "Stick rechts",
        "headset.tilt": "Rechter Trigger + Stick",
        # What is clicked among the hints while the sticks on the screen are dragged.
        "mouse.touch": "Berühren",
        "mouse.undo": "Zurücknehmen",
        "mouse.camera": "Von vorn",
        "mouse.best_view": "Beste Ansicht",
        "mouse.fine": "Langsam",
        "mouse.menu": "Menü",
        "mouse.pause": "Menü",
        "mouse.view_left": "Rechts ziehen nach links",
        "mouse.view_right": "Rechts ziehen nach rechts",
        # What is written on the buttons that the page has on a touch screen.
        "touch screen.touch": "Berühren",
        "touch screen.undo": "Zurücknehmen",
        "touch screen.camera": "Von vorn",
        "touch screen.best_view": "Beste Ansicht",
        "touch screen.fine": "Langsam",
        "touch screen.menu": "Pause",
        "touch screen.pause": "Pause",
        "touch screen.accept": "Antippen",
        "touch screen.back": "Zurück",
        "keyboard.Space": "Leertaste",
        "keyboard.Enter": "Eingabe",
        "keyboard.NumpadEnter": "Eingabe am Ziffernblock",
        "keyboard.Backspace": "Rücktaste",
        "keyboard.Escape": "Esc",
        "keyboard.Tab": "Tab",
        "keyboard.ShiftLeft": "Umschalt links",
        "keyboard.ShiftRight": "Umschalt rechts",
        "keyboard.ControlLeft": "Strg links",
        "keyboard.ControlRight": "Strg rechts",
        "keyboard.AltLeft": "Alt links",
        "keyboard.AltRight": "Alt rechts",
        "keyboard.ArrowLeft": "Pfeil links",
        "keyboard.ArrowRight": "Pfeil rechts",
        "keyboard.ArrowUp": "Pfeil hoch",
        "keyboard.ArrowDown": "Pfeil runter",
        "keyboard.PageUp": "Bild auf",
        "keyboard.PageDown": "Bild ab",
        # While the trainee works.
        "work.complete": "{trainee}, alle {count} Punkte sind berührt. Drücke {touch}, um sie zu "
        "registrieren.",
        "work.on skin": "Auf der Haut: Drücke {touch}.",
        "work.off the way": "{trainee}, du bist abseits des Weges zu Punkt {point}.",
        "warning.shaft": "Der Schaft berührt den Kopf: Hebe das Werkzeug an.",
        "warning.elsewhere": "Die Spitze berührt neben dem Punkt: Hebe sie an.",
        "warning.pressing": "Du drückst {depth:.1f} mm tief: Lass nach.",
        "warning.reach": "Weiter reicht der Arm in diese Richtung nicht.",
        "warning.obstacle.links": "Der Arm ist am Kopf: Komm von einer anderen Seite.",
        "warning.obstacle.self": "Der Arm ist an sich selbst: Nimm einen anderen Weg.",
        "warning.obstacle.table": "Der Arm ist am Tisch: Komm von oben.",
        "warning.nobody registers": "Hier registriert niemand die Punkte: Verbinde 3D Slicer.",
        "felt.bone": "Der Bohrer ist im Knochen.",
        "felt.through": "Der Bohrer ist durch den Knochen: Halte an.",
        "felt.blocked": "Das Instrument steht auf Knochen, der nicht durchbohrt ist.",
        "warning.slicer": "Die Verbindung zu 3D Slicer ist verloren. Mach weiter: Alles wird hier "
        "aufgezeichnet und später bewertet.",
        "warning.unplugged": "Das Gamepad {name} ist ausgesteckt: Der Roboter steht still. Steck "
        "es wieder ein oder mach mit der Tastatur weiter.",
        "warning.unmapped": "Das Gamepad {name} hat eine unbekannte Belegung: Nimm ein anderes "
        "oder die Tastatur.",
        "warning.no SDL": "Auf diesem Rechner lassen sich keine Gamepads lesen ({reason}): Nimm "
        "die Tastatur.",
        "warning.settings": "{reason} Es gelten die Voreinstellungen.",
        "window.left stick": "Links, rechts, vor, zurück",
        "window.right stick": "Auf, ab, drehen",
        "window.title": "RASTrainer",
        "window.connecting": "Das Fenster verbindet sich mit dem Simulator.",
        "window.lost": "Die Verbindung zum Simulator ist verloren. Sie wird wiederhergestellt, "
        "sobald der Simulator antwortet.",
        "window.unknown": "Der Simulator kennt dieses Fenster nicht: Schließ es und öffne eines "
        "mit dem Kopplungscode, den der Simulator jetzt zeigt.",
        "window.refused": "Es sind so viele Ansichten offen wie möglich: Schließ eine.",
        "window.no font": "Dieser Rechner hat keine Schrift mit chinesischen Zeichen, deshalb "
        "kann sein Fenster kein Chinesisch zeigen: Installiere eine, etwa WenQuanYi Micro Hei, "
        "und starte neu.",
        "window.pairing": "Browser oder Headset koppeln: Code {code} auf {addresses}",
        "status.points": "{kept} von {count} Punkten",
        "status.traced": "{traced} von {least}–{most} Punkten gezogen",
        "coverage": "Bis {distance} mm um gezogene Punkte",
        "status.line": "Linie {number} von {count}",
        "status.checkpoint": "{name}: {error:.1f} mm daneben",
        "status.entry": "Eintritt: {distance:.1f} mm neben der Achse",
        "status.angle": "Winkel: {angle:.1f}°",
        "status.stand off": "Abstand: {distance:.0f} mm",
        "status.to inner": "{left:.1f} mm bis zur Innentafel",
        "status.past inner": "{past:.1f} mm hinter der Innentafel",
        "status.to target": "{left:.1f} mm bis zum Ziel",
        "status.past target": "{past:.1f} mm hinter dem Ziel",
        "panel.mm": "{value:.1f} mm",
        "panel.deg": "{value:.1f}°",
        "status.left": "noch {time}",
        "status.point": "Punkt {point}",
        "status.next place": "Weiter",
        "status.near": "{name}: weniger als {distance} mm entfernt",
        "status.toward": "{name}: {distance} mm {direction}",
        "way.left": "links",
        "way.right": "rechts",
        "way.back": "zurück",
        "way.forward": "vor",
        "way.down": "runter",
        "way.up": "hoch",
        "hint.move": "Bewegen",
        "hint.up_and_down": "Auf, ab",
        "hint.touch": "Berühren",
        "hint.register": "Registrieren",
        "hint.trace": "Strich beginnen oder beenden",
        "hint.undo": "Zurücknehmen",
        "hint.fine": "Langsam",
        "hint.best_view": "Beste Ansicht",
        "hint.on": "an",
        "hint.off": "aus",
        "hint.mouse": "Maus",
        "hint.sticks": "Sticks zeigen",
        "hint.hide sticks": "Sticks verbergen",
        "hint.right stick": "Rechter Stick",
        "hint.turn_view": "Ansicht drehen",
        "hint.camera": "Kamera",
        "hint.front": "Von vorn",
        "hint.menu": "Menü",
        "hint.choose": "Wählen",
        "hint.accept": "Bestätigen",
        "hint.back": "Zurück",
        "hint.play": "Start, Pause",
        "hint.seek": "5 s zurück, vor",
        "hint.worst": "Schlechteste",
        "hint.end": "Beenden",
        "hint.rate": "Bewerten",
        # Verblindete Bewertung von Wiederholungen.
        "rating.replay": "Wiederholung {number} von {count}: ansehen, dann bewerten",
        "rating.title": "{form}: {domain}",
        "rating.text": "Wiederholung {number} von {count}. 1 ist die schlechteste, 5 die beste "
        "Note; 2 und 4 liegen zwischen den Sätzen.",
        "rating.mark": "{mark}: {sentence}",
        "rating.undo": "Letzte Note zurücknehmen",
        "rating.watch": "Wiederholung noch einmal ansehen",
        "rating.previous": "Die Wiederholung davor",
        "rating.next": "Nächste Wiederholung",
        "rating.leave": "Beenden; alle Noten bleiben",
        "rated.title": "Wiederholung {number} von {count} ist bewertet",
        "rated.text": "{rated} von {count} Wiederholungen sind bewertet.",
        "rated.all": "Alle {count} Wiederholungen sind bewertet",
        "rated.all text": "Danke. {rated} von {count} Wiederholungen sind bewertet; der Bericht "
        "der Studie sagt, wie weit die Bewertenden übereinstimmen.",
        "rating-loading.title": "Wiederholung {number} von {count}",
        "rating-loading.text": "Die Wiederholung wird geladen.",
        "rate.gears_depth": "Tiefenwahrnehmung",
        "rate.gears_depth.low": "Verschätzt sich immer wieder; weit weg oder eingedrückt",
        "rate.gears_depth.middle": "Tiefe stimmt manchmal nicht und wird gleich berichtigt",
        "rate.gears_depth.high": "Kommt direkt auf der Haut zur Ruhe",
        "rate.gears_efficiency": "Effizienz",
        "rate.gears_efficiency.low": "Umwege und Pausen; kommt kaum voran",
        "rate.gears_efficiency.middle": "Ohne Eile, meist auf das Ziel zu",
        "rate.gears_efficiency.high": "Geradewegs zu jedem Ziel, ohne Zögern",
        "rate.gears_force": "Gefühl für Kräfte",
        "rate.gears_force.low": "Drückt oder schleift wiederholt auf der Haut",
        "rate.gears_force.middle": "Berührt hin und wieder zu fest",
        "rate.gears_force.high": "Jede Berührung ist leicht",
        "rate.gears_control": "Beherrschung des Roboters",
        "rate.gears_control.low": "Der Arm fährt, wohin er nicht soll, oder ruckt",
        "rate.gears_control.middle": "Meist wie gewollt; manche Haltung ist ungünstig",
        "rate.gears_control.high": "Der Arm fährt ruhig, immer in guter Haltung",
        "rate.osats_tissue": "Schonung des Gewebes",
        "rate.osats_tissue.low": "Viel unnötiger oder zu tiefer Kontakt",
        "rate.osats_tissue.middle": "Vorsichtig, mit wenigen Ausrutschern",
        "rate.osats_tissue.high": "Nur der Kontakt, den die Aufgabe braucht",
        "rate.osats_motion": "Zeit und Bewegung",
        "rate.osats_motion.low": "Die meiste Bewegung dient keinem Zweck",
        "rate.osats_motion.middle": "Manche Bewegung könnte entfallen",
        "rate.osats_motion.high": "Nichts könnte entfallen",
        "rate.osats_handling": "Führung des Instruments",
        "rate.osats_handling.low": "Das Werkzeug wird unsicher geführt",
        "rate.osats_handling.middle": "Sicher geführt, aber nicht leicht",
        "rate.osats_handling.high": "Flüssig und genau geführt",
        "rate.osats_flow": "Ablauf und Vorausplanung",
        "rate.osats_flow.low": "Hält inne, als wäre der nächste Schritt unbekannt",
        "rate.osats_flow.middle": "Geht gleichmäßig weiter und blickt etwas voraus",
        "rate.osats_flow.high": "Jede Bewegung bereitet die nächste vor",
        "hint.checkpoint": "Kontrollpunkt berühren",
        "hint.next step": "Weiter",
        "hint.feed": "Vor, zurück",
        "hint.turn": "Schwenken",
        "hint.tilt": "Kippen",
        "hint.result": "Ergebnis",
        "replay.title": "{task} von {trainee}, noch einmal gezeigt",
        "replay.worst": "Punkt {point}, die schlechteste Berührung, in halber Geschwindigkeit",
        "replay.paused": "Angehalten",
        "replay.loading": "Dein Versuch wird geladen",
        "replay.back": "Zum Ergebnis",
        "replay.no worst": "Die schlechteste Berührung dieses Versuchs lässt sich nicht bestimmen.",
        "replay.no journal": "Der Versuch kann nicht wiedergegeben werden: Sein Journal ist nicht "
        "mehr im Ordner der Aufzeichnungen.",
        # What a learning platform's users read after a launch.
        "lti.you are": "Dein Pseudonym am Simulator",
        "lti.what to do": "So geht es weiter",
        "lti.go": "Geh an einen Simulator deines Labors und lass in 3D Slicer unter „Trainees“ "
        "{pseudonym} auswählen.",
        "lti.play": "Spiele {task} {mode}, so oft du willst.",
        "lti.any task": "eine beliebige Aufgabe",
        "lti.any mode": "am Bildschirm oder mit dem Headset",
        "lti.return": "Öffne den Link in deinem Kurs erneut, um hier deine neuen Punktzahlen zu "
        "sehen.",
        "lti.scores": "Deine Versuche",
        "lti.seconds": "{seconds:.0f} s",
        "lti.no trials": "Es gibt noch keinen, der für diesen Link zählt.",
        "lti.grade best": "Deine beste zulässige Punktzahl geht an deinen Kurs: {score:.1f} / 100.",
        "lti.grade latest": "Die Punktzahl deines letzten zulässigen Versuchs geht an deinen "
        "Kurs: {score:.1f} / 100.",
        "lti.no grade yet": "Dein Kurs bekommt eine Bewertung, sobald ein Versuch zulässig ist.",
        "lti.no grade": "Dieser Link gibt dem Kurs keine Bewertung zurück.",
        "lti.data": "Deine Daten",
        "lti.data text": "{platform} bekommt höchstens deine Bewertung und den Zeitpunkt, zu dem "
        "sie gesendet wurde. Das Labor bewahrt deine Nutzerkennung bei {platform} zusammen mit "
        "deinem Pseudonym in einer privaten Datei auf, aber weder deinen Namen noch deine "
        "E-Mail-Adresse. Ob deine Versuche für die Forschung verwendet werden dürfen, wirst du im "
        "Labor gefragt.",
        "lti.no learner": "Du nimmst an diesem Kurs nicht als Lernender teil und bekommst deshalb "
        "weder Pseudonym noch Bewertung.",
        "lti.link works": "Der Link funktioniert, und Bewertungen können an den Kurs "
        "zurückgegeben werden.",
        "lti.refused": "Dieser Start kann nicht verwendet werden",
        "lti.refused help": "Öffne den Link in deinem Kurs erneut. Wenn diese Seite wieder "
        "erscheint, zeige denen, die den Kurs oder den Simulator betreuen, was hier folgt.",
        "decimal sign": ",",
        "list separator": ", ",
    }
)
