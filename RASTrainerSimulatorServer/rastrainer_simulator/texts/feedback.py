"""What Slicer's feedback on a trial says: it tells keys and values, and English for all others."""

from __future__ import annotations

from collections.abc import Mapping

from rastrainer.feedback.wording import ENGLISH

ENGLISH_FEEDBACK: Mapping[str, str] = {f"feedback.{key}": text for key, text in ENGLISH.items()}

GERMAN_FEEDBACK: Mapping[str, str] = {
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
    "feedback.unacceptable": "Nicht bestanden: der wahre Fehler im Gehirn oder der Kontakt mit dem "
    "Kopf ist größer als zulässig.",
    "feedback.passed": "Bestanden: die Marke ist {mark:.0f}.",
    "feedback.not passed": "Noch nicht bestanden: {points:.0f} Punkte bis zur Marke von "
    "{mark:.0f}.",
    "feedback.competent": "Deine Versuche zeigen Können seit Nummer {number}: von denen, die noch "
    "in {failing:.0f} % ihrer Versuche scheitern, kommen durch Zufall {risk:.0f} % in {trials} "
    "Versuchen so weit (LC-CUSUM).",
    "feedback.not competent": "{share:.0f} % des Wegs zum nachgewiesenen Können (LC-CUSUM; "
    "Versuche bisher: {trials}).",
}
