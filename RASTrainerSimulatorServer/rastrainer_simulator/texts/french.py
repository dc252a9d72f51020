"""The same texts in French, which addresses the trainee as "vous".

Point: point. Touch, as a noun: pointage. Fiducial: marqueur. Landmark: repère. Registration:
recalage. Target: cible. Trial: essai. Trial run: prise en main. Trace: tracé. Stroke: trait.
Undo: retirer. Abort: abandonner. Match: ajustement.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rastrainer_simulator.texts import typesetting

_ITEMS: Mapping[str, str] = {
    "sus_1": "voudrais l'utiliser souvent",
    "sus_2": "inutilement complexe",
    "sus_3": "facile à utiliser",
    "sus_4": "besoin de l'aide d'un technicien",
    "sus_5": "fonctions bien intégrées",
    "sus_6": "trop d'incohérences",
    "sus_7": "la plupart l'apprennent vite",
    "sus_8": "peu commode",
    "sus_9": "sentiment de confiance",
    "sus_10": "beaucoup à apprendre d'abord",
    "sus.low": "pas du tout d'accord",
    "sus.high": "tout à fait d'accord",
    "tlx_mental": "Exigence mentale",
    "tlx_physical": "Exigence physique",
    "tlx_temporal": "Exigence temporelle",
    "tlx_performance": "Performance",
    "tlx_performance.low": "parfait",
    "tlx_performance.high": "échec",
    "tlx_effort": "Effort",
    "tlx_frustration": "Frustration",
    "nasa-tlx.low": "très faible",
    "nasa-tlx.high": "très élevé",
    "ssq_discomfort": "Malaise général",
    "ssq_fatigue": "Fatigue",
    "ssq_headache": "Mal de tête",
    "ssq_eyestrain": "Fatigue oculaire",
    "ssq_focusing": "Difficulté à voir net",
    "ssq_salivation": "Salivation accrue",
    "ssq_sweating": "Transpiration",
    "ssq_nausea": "Nausée",
    "ssq_concentrating": "Difficulté à se concentrer",
    "ssq_fullness": "Tête lourde",
    "ssq_blurred": "Vision floue",
    "ssq_dizzy_open": "Étourdissement, yeux ouverts",
    "ssq_dizzy_closed": "Étourdissement, yeux fermés",
    "ssq_vertigo": "Vertige rotatoire",
    "ssq_stomach": "Estomac qui se fait sentir",
    "ssq_burping": "Éructations",
    "ssq.low": "pas du tout",
    "ssq.high": "fortement",
    "feedback.skin": "La peau s'était déplacée de {shift:.1f} mm (RMS) et était enfoncée de "
    "{indentation:.1f} mm : l'erreur vraie à la cible était de {tre:.2f} mm.",
    "feedback.skin and error": "La peau s'était déplacée de {shift:.1f} mm (RMS) et était enfoncée "
    "de {indentation:.1f} mm : l'erreur vraie à la cible était de {tre:.2f} mm, et aurait été sans "
    "cela de {without:.2f} mm.",
}

_FEEDBACK: Mapping[str, str] = {
    "feedback.touch": "Point {label} : écart de {residual:.1f} mm{where}{hurry}{tremor}.",
    "feedback.touch above": ", surtout en profondeur ({depth:.1f} mm au-dessus de la peau)",
    "feedback.touch below": ", surtout en profondeur ({depth:.1f} mm sous la peau)",
    "feedback.touch aside": ", surtout le long de la peau",
    "feedback.touch hurry": " ; le geste était précipité : restez immobile un instant avant de "
    "toucher",
    "feedback.touch tremor": " ; la pointe tremblait : prenez la vitesse lente pour le dernier "
    "centimètre",
    "feedback.no touch": "Aucun pointage ne se détache : les erreurs sont réparties également.",
    "feedback.contact": "Vous avez heurté la tête une fois en chemin. Relevez l'outil avant "
    "d'aller au point suivant.",
    "feedback.contacts": "Vous avez heurté la tête {count} fois en chemin. Relevez l'outil avant "
    "d'aller au point suivant.",
    "feedback.dragging": "L'outil est resté {time:.0f} s sur la tête hors des points, sur "
    "{path:.0f} mm : relevez-le avant d'aller au point suivant.",
    "feedback.pressing": "Aux points, vous avez enfoncé l'outil de {depth:.1f} mm dans la tête : "
    "arrêtez-vous dès que la pointe touche la peau.",
    "feedback.worst touch": "Soignez davantage le point {points} : sans cette erreur, le recalage "
    "serait plus précis d'environ {share:.0f} %.",
    "feedback.worst touches": "Soignez davantage les points {points} : sans ces erreurs, le "
    "recalage serait plus précis d'environ {share:.0f} %.",
    "feedback.depth": "L'erreur est surtout en profondeur : amenez la pointe jusque sur la peau, "
    "et regardez de côté avant de toucher.",
    "feedback.common bias": "En moyenne, les pointages sont décalés de {bias:.1f} mm {direction}, "
    "ce que l'erreur de recalage ne peut pas montrer : regardez la pointe d'un second côté avant "
    "de toucher.",
    "feedback.oblique common bias": "En moyenne, les pointages sont décalés de {bias:.1f} mm "
    "{direction} et {second}, ce que l'erreur de recalage ne peut pas montrer : regardez la "
    "pointe d'un second côté avant de toucher.",
    "feedback.bias to the left": "vers la gauche du patient",
    "feedback.bias to the right": "vers la droite du patient",
    "feedback.bias to the back": "vers l'arrière de la tête",
    "feedback.bias to the face": "vers le visage",
    "feedback.bias to the neck": "vers le cou",
    "feedback.bias to the crown": "vers le sommet de la tête",
    "feedback.idle time": "L'outil est resté immobile {idle:.0f} s sur {time:.0f} s : cherchez le "
    "point suivant pendant que vous êtes encore à celui-ci.",
    "feedback.detours": "L'outil a parcouru {times:.1f} fois le chemin le plus court : passez "
    "autour de la tête plus près d'elle et d'un seul mouvement.",
    "feedback.repeated touch": "1 pointage a été refusé ou retiré : vérifiez le numéro du point "
    "avant de toucher.",
    "feedback.repeated touches": "{count} pointages ont été refusés ou retirés : vérifiez le "
    "numéro du point avant de toucher.",
    "feedback.pace": "Vous avez mis {time:.0f} s ; {usual:.0f} s sont habituelles : allez plus "
    "vite entre les points, et ne ralentissez que près de la peau.",
    "feedback.first trial": "C'est votre premier essai de cette tâche dans ce mode.",
    "feedback.first of this score": "Vos essais antérieurs de cette tâche ont des scores d'une "
    "version antérieure, qui ne peuvent pas être comparés à celui-ci.",
    "feedback.more points": "{points:.0f} points de plus que la moyenne de vos {trials} derniers "
    "essais de cette tâche.{best}",
    "feedback.less points": "{points:.0f} points de moins que la moyenne de vos {trials} derniers "
    "essais de cette tâche.{best}",
    "feedback.more points than last": "{points:.0f} points de plus qu'à votre dernier essai de "
    "cette tâche.{best}",
    "feedback.less points than last": "{points:.0f} points de moins qu'à votre dernier essai de "
    "cette tâche.{best}",
    "feedback.best": " C'est votre meilleur jusqu'ici.",
    "feedback.unacceptable": "Non réussi : l'erreur vraie dans le cerveau, le biais commun à tous "
    "les pointages ou le contact avec la tête dépasse ce qui est acceptable.",
    "feedback.passed": "Réussi : le seuil est de {mark:.0f}.",
    "feedback.not passed": "Pas encore réussi : il manque {points:.0f} points pour le seuil de "
    "{mark:.0f}.",
    "feedback.no mark": "Ni réussi ni échoué : le seuil de cette étude vaut pour une autre version "
    "du score.",
    "feedback.competent": "Vos essais montrent votre compétence depuis le numéro {number} : parmi "
    "ceux qui échouent encore à {failing:.0f} % de leurs essais, {risk:.0f} % arrivent jusque-là "
    "par hasard en {trials} essais (LC-CUSUM).",
    "feedback.not competent": "{share:.0f} % du chemin vers une compétence démontrée (LC-CUSUM ; "
    "essais jusqu'ici : {trials}).",
}

_TABLE: Mapping[str, str] = {
    # What the trainee reads at the top of the picture.
    "idle": "Choisissez une tâche pour commencer.",
    "start": "{trainee}, touchez le point {point}.",
    "touched": "{trainee}, le point {label} est enregistré. Touchez maintenant le point {point}.",
    "undone": "{trainee}, le point {label} est retiré. Touchez-le à nouveau.",
    "complete": "{trainee}, les {count} points sont touchés. Recalez-les maintenant.",
    # Tracing the skin, one point a millimeter.
    "trace": "{trainee}, les repères sont touchés. Passez maintenant la pointe sur la peau : "
    "{least} points ou plus, un par millimètre.",
    "tracing": "{trainee}, passez la pointe sur la peau, aussi là où elle est orientée autrement.",
    "traced": "{trainee}, {traced} points sont tracés. Continuez : il en faut {least}.",
    "traced enough": "{trainee}, {traced} points sont tracés. Recalez-les, ou continuez le tracé.",
    "traced all": "{trainee}, {traced} points sont tracés, le maximum d'un essai. Recalez-les "
    "maintenant.",
    "paused": "{trainee}, l'essai est en pause. Reprenez quand vous voulez.",
    "resumed": "{trainee}, continuez avec le point {point}.",
    "registered": "{trainee}, vos points sont en cours de recalage et de notation.",
    "scored": "{trainee}, votre score est de {score:.0f} sur 100 : {fre:.2f} mm d'erreur de "
    "recalage, {tre:.2f} mm d'erreur vraie à la cible.",
    "aborted": "{trainee}, l'essai a été abandonné. Choisissez une tâche pour recommencer.",
    # A procedure, from the registration to the placed instrument.
    "verifying": "{trainee}, vos points sont en cours de recalage.",
    "verify": "{trainee}, vos points sont recalés : FRE {fre:.2f} mm. Touchez des points de "
    "contrôle, puis acceptez le recalage ou recommencez-le.",
    "checked": "{trainee}, selon votre recalage, {name} est à {error:.1f} mm de sa place. "
    "Contrôlez un autre point, acceptez le recalage ou recommencez-le.",
    "register again": "{trainee}, touchez à nouveau tous les points. Commencez par le point "
    "{point}.",
    "align": "{trainee}, amenez le guide sur la trajectoire planifiée de {name}, puis "
    "verrouillez-le.",
    "align next": "{trainee}, l'instrument est posé. Amenez maintenant le guide sur la "
    "trajectoire planifiée de {name}.",
    "drill": "{trainee}, le guide est verrouillé. Forez à travers le crâne le long de {name}.",
    "realign": "{trainee}, le foret est retiré. Amenez à nouveau le guide sur la trajectoire "
    "planifiée de {name}.",
    "insert": "{trainee}, avancez l'instrument jusqu'à la cible de {name}, puis libérez-le.",
    "procedure done": "{trainee}, la procédure est terminée et en cours de notation.",
    "interrupted procedure": "{trainee}, cet essai a été interrompu ; tout est conservé. Reprenez "
    "la procédure quand vous voulez, ou abandonnez-le.",
    # What a procedure does not allow.
    "no checkpoints": "Cette procédure n'a pas de points de contrôle : AcceptRegistration ou "
    "RegisterAgain.",
    "too many checkpoints": "{most} points de contrôle sont touchés, le maximum d'un essai : "
    "AcceptRegistration ou RegisterAgain.",
    "too many attempts": "Les points ont été recalés {most} fois, le maximum d'un essai : "
    "AcceptRegistration ou Abort.",
    "too far from checkpoints": "Il n'y a pas de point de contrôle ici : {name}, le plus proche "
    "selon votre recalage, est à {distance:.1f} mm ; un point compte jusqu'à {radius:g} mm.",
    "above a checkpoint": "{height:.1f} mm au-dessus de la peau : abaissez la pointe sur le point "
    "de contrôle.",
    "not in use yet": "Les points sont encore en cours de recalage : d'abord UseRegistration.",
    "already in use": "Un autre recalage est utilisé : AcceptRegistration ou RegisterAgain.",
    "not rigid": "UseRegistration demande une transformation rigide : WorldToHead, ligne par "
    "ligne, en mm.",
    "off the head": "L'axe du guide ne rencontre pas la tête : dirigez-le vers la tête avant de "
    "le verrouiller.",
    "too far to lock": "La pointe du guide est à {distance:.0f} mm de la peau le long de son "
    "axe : verrouillez-le à {limit:.0f} mm au plus.",
    "no self-alignment": "Avec ce réglage, le robot n'aligne pas le guide lui-même : amenez-le à "
    "la main sur la trajectoire.",
    "line out of reach": "Le robot ne peut pas tenir le guide sur cette trajectoire à une distance "
    "de {stand_off:g} mm : choisissez une autre distance, ou amenez-le à la main.",
    "bone is cut": "Le foret a entamé l'os : le trou reste où il est. Continuez à forer, puis "
    "insérez l'instrument.",
    "nothing drilled": "Rien n'est encore foré : forez avant d'insérer l'instrument.",
    "still in the guide": "L'instrument est encore dans le guide : avancez-le avant de le libérer.",
    # Touches that do not count.
    "too far": "Trop loin du point {point} : un pointage compte jusqu'à {radius:g} mm.",
    "above the skin": "{height:.1f} mm au-dessus de la peau : abaissez la pointe sur le point "
    "{point}.",
    "wrong point": "Mauvais point : c'est le point {label}, à {nearest:.1f} mm ; le suivant est le "
    "point {point}.",
    # Commands in the wrong phase.
    "no trial": "Aucun essai n'est en cours : commencez-en un par StartTask.",
    "another trial is open": "Cet essai est terminé. Celui qui est maintenant ouvert, {task} de "
    "{trainee}, n'a pas été abandonné.",
    "trial is open": "{trainee} fait encore {task} : Register ou Abort avant StartTask.",
    "procedure is open": "{trainee} est encore à la procédure après {task} : terminez-la, ou "
    "Abort, avant StartTask.",
    "no other head in a trial": "Un essai est en cours : Register ou Abort avant un autre "
    "scénario.",
    "being set up": "Le simulateur charge encore une autre tête ou d'autres réglages : attendez "
    "quelques secondes.",
    "not at the procedure": "Cela vient après Register, dans un essai que StartTask a commencé "
    "avec une procédure.",
    "verifying now": "Le recalage est en cours de contrôle : Capture pour les points de contrôle, "
    "puis AcceptRegistration ou RegisterAgain.",
    "aligning now": "Le guide est en cours d'alignement : amenez-le sur la trajectoire planifiée, "
    "puis LockGuide.",
    "drilling now": "Le foret est dans le guide et le bras est maintenu : Feed pour le foret, puis "
    "StartInsertion.",
    "inserting now": "L'instrument est dans le guide et le bras est maintenu : Feed jusqu'à sa "
    "cible, puis ReleaseInstrument.",
    "not all touched": "{kept} points sur {count} sont touchés : Register vient après le dernier ; "
    "le suivant est le point {point}.",
    "nothing is traced": "Cet essai n'a pas de tracé : StartTask avec la méthode surface ou "
    "landmarks-surface en commence un qui en a.",
    "landmarks first": "{kept} repères sur {count} sont touchés : Capture pour le point {point} "
    "avant Trace.",
    "landmarks touched": "Les {count} repères sont touchés : Trace sur la peau maintenant, ou Undo "
    "pour le dernier.",
    "trace is full": "{traced} points sont tracés, le maximum d'un essai : Register, ou Undo pour "
    "le dernier trait.",
    "all traced": "{traced} points sont tracés : Register, Trace pour continuer, ou Undo pour le "
    "dernier trait.",
    "still tracing": "Un trait est en cours : terminez-le par Trace avant Register.",
    "too few traced": "{traced} points sont tracés : Register en demande {least}, continuez donc "
    "par Trace.",
    "not paused trace": "L'essai n'est pas en pause : Trace sur la peau, ou d'abord Pause.",
    "not paused": "L'essai n'est pas en pause : Capture pour le point {point}, ou d'abord Pause.",
    "is paused": "L'essai est en pause : d'abord Resume.",
    "already paused": "L'essai est déjà en pause : Resume ou Abort.",
    "all touched": "Les {count} points sont touchés : Register, ou Undo pour le dernier.",
    "is registered": "L'essai est recalé et conservé : StartTask commence le suivant.",
    "nothing to undo": "Aucun point n'est encore touché : touchez d'abord le point {point}.",
    "not registered": "L'essai n'est pas encore recalé : d'abord Capture pour ses {count} points "
    "et Register.",
    "no registration": "L'essai n'a pas encore de recalage : SubmitRegistration vient avant "
    "TrialScored.",
    "registration is final": "Ce recalage est définitif : l'erreur vraie a été révélée, aucun "
    "autre n'est donc accepté.",
    "no such trial": "Il n'y a pas d'essai {trial_id} ici : GetTrial, SubmitRegistration et "
    "TrialScored prennent l'identifiant que StartTask a donné.",
    "not a simulation command": "{command} n'est pas une commande de la simulation.",
    # When the record cannot be written.
    "not recorded": "L'essai ne peut pas être enregistré ({reason}). Ce qui n'a pas été enregistré "
    "ne compte pas ; faites de la place ou choisissez un autre dossier, puis reprenez.",
    # When the simulator had ended in the middle of a trial and is there again.
    "interrupted": "{trainee}, cet essai a été interrompu ; {kept} points sur {count} sont "
    "conservés. Continuez avec le point {point} quand vous voulez, ou abandonnez-le.",
    "interrupted complete": "{trainee}, cet essai a été interrompu ; les {count} points sont "
    "conservés. Recalez-les maintenant.",
    "interrupted trace": "{trainee}, cet essai a été interrompu ; {traced} points tracés sont "
    "conservés. Continuez le tracé quand vous voulez, ou abandonnez-le ; {least} points suffisent "
    "pour le recalage.",
    # When nobody could see the trial, which pauses it.
    "unseen.left": "Pause : la vue qui montrait l'essai a été fermée ou perdue.",
    "unseen.unplugged": "Pause : la manette a été débranchée.",
    "unseen.hidden": "Pause : l'essai n'était pas visible.",
    "unseen.instructor": "Pause demandée par votre formateur.",
    "instructor.says": "Votre formateur : {text}",
    "instructor.nothing runs": "Rien n'est en cours à ce poste qui pourrait être mis en pause.",
    "instructor.no result": "Un essai peut être remontré tant que son résultat est à l'écran du "
    "poste.",
    "unseen.still": "Pause : l'image est restée figée quelques secondes, car cet ordinateur était "
    "trop occupé pour la dessiner. Si cela se reproduit, fermez d'autres programmes.",
    # The simulator's menus.
    "start.title": "RASTrainer",
    "start.text": "Entraînez-vous au recalage du patient assisté par robot sur un KUKA LBR iiwa 7 "
    "virtuel. Pas pour un usage clinique.",
    "start.train": "Commencer l'entraînement",
    "start.introduction": "Introduction",
    "start.controls": "Commandes",
    "start.settings": "Réglages",
    "start.quit": "Quitter",
    "quit.title": "Quitter RASTrainer ?",
    "quit.text": "Le simulateur s'arrête pour tous ceux qui y sont connectés.",
    "quit.stay": "Rester",
    "quit.leave": "Quitter",
    "introduction.title.1": "À quoi vous vous entraînez",
    "introduction.text.1": "Avant d'aider à une opération du cerveau, un robot doit savoir où se "
    "trouve la tête. C'est vous qui le lui montrez : avec l'outil du robot, vous touchez quinze "
    "points numérotés sur la tête, l'un après l'autre, aussi précisément que possible.",
    "introduction.title.2": "Comment se passe une tâche",
    "introduction.text.2": "Suivez les numéros et les flèches sur la peau du point 1 au point 15. "
    "À moins de 20 mm de la tête, un son retentit, et un anneau autour de la pointe se ferme à "
    "mesure que vous approchez. Il devient vert là où un pointage compte : enregistrez-y le point. "
    "Le rouge signale une erreur. Un pointage manqué peut être retiré.",
    "introduction.title.3": "Ce que vous obtenez",
    "introduction.text.3": "Après le dernier point, vous recalez : 3D Slicer met vos points en "
    "correspondance avec l'IRM et vous montre l'erreur et votre score. La précision et le temps "
    "comptent tous deux. Vous commencez par un tutoriel de deux minutes et cinq minutes de prise "
    "en main, puis viennent les tâches 1 à 5.",
    "introduction.sheet": "Page {sheet} sur {sheets}",
    "introduction.next": "Suivant",
    "introduction.skip": "Passer aux commandes",
    "introduction.back": "Retour",
    "controls.title": "Commandes",
    "controls.text": "La manette, le clavier et les contrôleurs d'un casque font tous la même "
    "chose.",
    "controls.move_along": "Vers l'avant, l'arrière",
    "controls.move_across": "Vers la gauche, la droite",
    "controls.move_vertically": "Vers le haut, le bas",
    "controls.fine": "Mouvement lent (maintenir)",
    "controls.touch": "Enregistrer un pointage",
    "controls.undo": "Retirer le dernier pointage",
    "controls.camera": "Vue de face : proche ou éloignée",
    "controls.best_view": "Meilleure vue du point suivant",
    "controls.turn_view": "Vue de gauche, de droite",
    "controls.tilt_view": "Vue de dessus, de dessous",
    "controls.zoom_view": "Vue de plus près, de plus loin",
    "controls.pause": "Pause",
    "controls.menu": "Menu",
    "controls.next": "Suivant",
    "controls.test": "Essayer les commandes",
    "controls.rebind": "Modifier les commandes",
    "controls.back": "Retour",
    "experiment.title": "Expérience",
    "experiment.trainee": "Votre identifiant",
    "experiment.trainee help": "Votre formateur vous donne cet identifiant ; il est conservé avec "
    "vos essais.",
    "experiment.clicked": "Saisir l'identifiant à la souris",
    "experiment.mode": "Mode",
    "mode.desktop": "Écran",
    "mode.hmd": "Casque",
    "experiment.done": "fait",
    "experiment.task help": "Commencer cette tâche.",
    "experiment.no trainee": "Saisissez d'abord votre identifiant.",
    "experiment.order": "D'abord : {task}.",
    "experiment.trial run first": "D'abord : {task}. Touchez tous ses points, ou entraînez-vous "
    "jusqu'à la fin de son temps.",
    "experiment.tutorial": "Tutoriel",
    "experiment.tutorial time": "2 minutes",
    "experiment.tutorial help": "Apprenez à déplacer le robot, une commande après l'autre.",
    "experiment.tutorial first": "D'abord le tutoriel, avec l'appareil que vous utilisez "
    "maintenant : il dure deux minutes.",
    "experiment.study": "Pas maintenant. {step} Seul votre formateur peut sauter une étape, dans "
    "3D Slicer et en donnant une raison.",
    # What a study that Slicer leads asks for next.
    "study.questionnaire": "Étape {number} sur {count} : répondez au questionnaire "
    "{questionnaire}, ici ou là où 3D Slicer fonctionne.",
    "study.answered": "Vos réponses à {questionnaire} sont en route vers 3D Slicer, qui dira ce "
    "qui vient ensuite.",
    "study.trial-run": "Étape {number} sur {count} : faites la prise en main {mode} pendant "
    "{minutes:g} minutes.",
    "study.trial": "Étape {number} sur {count} : faites {task} {mode}.",
    "study.break": "Étape {number} sur {count} : faites une pause d'au moins {minutes:g} minutes, "
    "encore {left}. Ensuite, 3D Slicer dira ce qui vient.",
    "study.all-done": "Toutes les étapes de l'étude sont faites. Merci !",
    "study.repeat": "Étape {number} sur {count} : {task} a été abandonnée. Le formateur doit "
    "saisir dans 3D Slicer la raison de la répéter.",
    "study.played": "C'est fait : {task}. 3D Slicer dira ce qui vient ensuite.",
    "study.desktop": "à l'écran",
    "study.hmd": "avec le casque",
    "study.by landmarks": "par des repères du visage",
    "study.by surface": "par un tracé sur la peau",
    "study.by landmarks-surface": "par des repères et un tracé",
    "experiment.assignments": "Vos objectifs",
    "assignments.title": "Vos objectifs",
    "assignments.back": "Retour",
    "assignments.with procedure": "{trial}, puis {procedure}",
    "assignments.summary": "{reached} sur {count} atteints",
    "assignments.reached": "atteint",
    "assignments.just reached": "Atteint : {assignment}.",
    "assignments.locked": "verrouillé",
    "assignments.count": "{done} / {needed}",
    "assignments.percent": "{done} %",
    "assignments.one trial": "Atteint quand un essai obtient {mark:g} points ou plus, sans "
    "dépasser aucune limite.",
    "assignments.trials": "Atteint quand {needed} essais de suite obtiennent {mark:g} points ou "
    "plus, sans dépasser aucune limite.",
    "assignments.competent": "Atteint quand les essais montrent la compétence (LC-CUSUM) ; un "
    "essai est réussi à partir de {mark:g} points.",
    "assignments.no mark": "Il n'y a pas de seuil de réussite pour le score actuel : demandez à "
    "votre formateur.",
    "assignments.gate": "Verrouillé. Atteignez d'abord : {assignments}.",
    "assignments.other head": "Cette tête n'a pas cet objectif : choisissez-en une autre.",
    "assignments.all reached": "Tous les objectifs sont atteints.",
    "assignments.next in brief": "Ensuite : {assignment} ({progress})",
    "assignments.next": "Ensuite : {assignment}, votre point le plus faible.",
    "assignments.next unplayed": "Ensuite : {assignment}, pas encore essayé.",
    "assignments.weakest": "Ce qui coûte le plus de points : {part}.",
    "assignments.part time": "le temps",
    "assignments.part accuracy": "la précision",
    "assignments.part common bias": "le biais commun à tous les pointages",
    "assignments.part safety": "les contacts involontaires et l'enfoncement",
    "assignments.part target": "l'erreur à la cible",
    "assignments.part entry": "l'erreur à l'entrée",
    "assignments.part angle": "l'angle",
    "assignments.part plunge": "un forage trop profond",
    "assignments.part distance": "une distance trop faible aux structures interdites",
    "experiment.answer": "Répondre au questionnaire",
    "questionnaire.text": "{trainee}, répondez à chaque ligne : {lowest} signifie {low}, {highest} "
    "signifie {high}, sauf indication contraire. Votre formateur a le formulaire au texte complet.",
    "questionnaire.ends": "{topic} : {lowest} = {low}, {highest} = {high}",
    "questionnaire.open": "Certaines lignes sont encore sans réponse.",
    "questionnaire.keep": "Terminé",
    "questionnaire.back": "Retour, sans réponses",
    **_ITEMS,
    **_FEEDBACK,
    "experiment.trend": "Vos scores dans ce mode ; la ligne est le seuil de réussite, {mark:.0f}.",
    "experiment.trend in study": "Vos scores dans ce mode.",
    "experiment.scores": "Scores, du plus ancien au plus récent : {scores}.",
    "experiment.method": "Recalage",
    "experiment.method help": "Sur quoi la tête est recalée au prochain essai. Les repères ne sont "
    "pas marqués sur la peau : trouvez-les d'après leur nom.",
    "method.fiducials": "marqueurs",
    "method.landmarks": "repères du visage",
    "method.surface": "tracé sur la peau",
    "method.landmarks-surface": "repères, puis un tracé",
    "experiment.procedure": "Après les pointages",
    "experiment.procedure help": "Ce qui suit le recalage : rien, ou une procédure, dans laquelle "
    "il sert à placer un instrument. La prise en main n'en a pas.",
    "experiment.touches alone": "Rien d'autre",
    "experiment.scenario": "Tête",
    "experiment.back": "Retour",
    "scenario.title": "Têtes",
    "scenario.text": "Sur quelle tête voulez-vous vous entraîner ?",
    "scenario.looking": "Recherche des têtes.",
    "scenario.help": "S'entraîner désormais sur cette tête.",
    "scenario.loading": "en cours de chargement",
    "scenario.present": "utilisée",
    "scenario.back": "Retour",
    "task.trial-run": "Prise en main",
    "task.task-1": "Tâche 1",
    "task.task-2": "Tâche 2",
    "task.task-3": "Tâche 3",
    "task.task-4": "Tâche 4",
    "task.task-5": "Tâche 5",
    "clicked-id.title": "Votre identifiant",
    "clicked-id.delete": "Effacer",
    "clicked-id.done": "Terminé",
    "character.back": "Retour",
    "pin.title": "PIN du formateur",
    "pin.text": "Il déverrouille les réglages, l'ordre des tâches et le passage des commandes, "
    "jusqu'à ce que le stagiaire change ou qu'un essai commence.",
    "pin.too short": "Un PIN a 6 à 12 chiffres.",
    "pin.delete": "Effacer",
    "pin.unlock": "Déverrouiller",
    "pin.cancel": "Annuler",
    "pin.unlocked": "Déverrouillé jusqu'à ce que le stagiaire change ou qu'un essai commence.",
    "pin.wrong": "Ce n'est pas le PIN de ce poste.",
    "pin.wait": "Il y a eu trop de PIN erronés : attendez {seconds} s.",
    "keyboard.title": "Votre identifiant",
    "keyboard.row": "Écrire",
    "keyboard.delete": "Effacer",
    "keyboard.done": "Terminé",
    "trial.title": "{task}",
    "trial.paused": "{trainee}, l'essai est en pause avec {kept} points touchés. Son chronomètre "
    "est arrêté.",
    "trial.complete": "{trainee}, les {kept} points sont touchés.",
    "trial.paused trace": "{trainee}, l'essai est en pause avec {traced} points tracés. Son "
    "chronomètre est arrêté.",
    "trial.complete trace": "{trainee}, {traced} points sont tracés.",
    "trial.resume": "Reprendre",
    "trial.register": "Recaler",
    "trial.controls": "Commandes",
    "trial.settings": "Réglages",
    "trial.finish": "Terminer la prise en main",
    "trial.abort": "Abandonner la tâche",
    "abort.title": "Abandonner la tâche ?",
    "abort.text": "{trainee}, vos {kept} points touchés ne seraient pas recalés.",
    "abort.keep": "Continuer",
    "abort.abort": "Abandonner",
    "practice.title": "Le temps de la prise en main est écoulé",
    "practice.text": "{trainee}, vous pouvez commencer la tâche 1 maintenant, ou continuer à vous "
    "entraîner.",
    "practice.study": "{trainee}, terminez la prise en main pour poursuivre l'étude, ou continuez "
    "à vous entraîner.",
    "practice.finish": "Terminer la prise en main",
    "practice.resume": "Continuer à s'entraîner",
    "complete.title": "Tous les points sont touchés",
    "complete.text": "{trainee}, recalez vos {count} points pour qu'ils soient notés. Ensuite, ils "
    "ne pourront plus être modifiés.",
    "complete.register": "Recaler",
    "complete.undo": "Retirer le dernier pointage",
    "complete.abort": "Abandonner la tâche",
    "match.title": "Accepter cet ajustement ?",
    "match.looking": "Le tracé est en cours d'ajustement à la peau …",
    "match.impossible": "Le tracé ne peut pas être ajusté : {reason} Continuez à tracer, ou "
    "retirez des traits.",
    "match.residual and error": "Le résidu est la distance du tracé à la peau. L'erreur est la "
    "distance de la cible à l'endroit où elle semble être. Un petit résidu ne signifie pas une "
    "petite erreur. Après cela, les points ne peuvent plus être modifiés.",
    "match.residual": "Résidu",
    "match.counts": "Points qui comptent",
    "match.interval": "Intervalle à 95 % de cette erreur",
    "match.interval value": "{low:.2f} à {high:.2f} mm",
    "match.slides": "L'ajustement peut glisser : la tête peut être décalée de {slide:.1f} mm au "
    "plus, si petit que soit le résidu. Tracez des endroits orientés autrement, comme le nez, les "
    "sourcils, les tempes et les joues.",
    "match.several-minima": "Le tracé s'ajuste à plusieurs endroits. Tracez davantage le visage.",
    "match.not-converged": "L'ajustement n'était pas stable à son arrêt. Tracez davantage le "
    "visage.",
    "match.few-inliers": "Beaucoup de points sont hors de la peau. Gardez la pointe sur la peau "
    "pendant le tracé.",
    "match.far-points": "Certains points sont loin de la peau et ne comptent pas.",
    "match.poor-fit": "Le tracé ne s'ajuste pas à cette tête. Des repères ont-ils été échangés ?",
    "match.accept": "Accepter et recaler",
    "match.draw": "Continuer le tracé",
    "waiting.title": "Recalé",
    "waiting.slicer": "{trainee}, 3D Slicer note vos points.",
    "waiting.nobody": "{trainee}, vos points sont conservés. 3D Slicer n'est pas connecté ; il les "
    "notera dès qu'il le sera.",
    "waiting.own": "{trainee}, 3D Slicer n'est pas connecté : le simulateur recale et note vos "
    "points lui-même.",
    "waiting.problem": "Le simulateur ne peut pas les noter lui-même : {reason}",
    "result.own": "Ce score est celui du simulateur et n'est conservé dans aucune étude. Quand 3D "
    "Slicer se connecte, il note et conserve l'essai, et son score remplace celui-ci.",
    "result.title": "{trainee} : {task}",
    "result.score": "Score",
    "result.fre": "Erreur de recalage (FRE)",
    "result.expected tre": "Erreur attendue à la cible (TRE)",
    "result.interval note": "L'erreur attendue suppose des erreurs de pointage indépendantes, sans "
    "biais et de même ampleur. Elle ne voit pas un décalage commun à tous les pointages.",
    "result.true tre": "Erreur vraie à la cible (TRE)",
    "result.region tre": "Erreur vraie dans le cerveau (TRE)",
    "result.common bias": "Biais commun à tous les pointages",
    "result.unacceptable score": "{score:.0f} / 100, non acceptable",
    "result.not accurate": "Non acceptable : un instrument guidé par ce recalage manquerait sa "
    "cible. L'erreur vraie dans le cerveau dépasse la limite.",
    "result.not unbiased": "Non acceptable : tous les pointages sont décalés dans la même "
    "direction, au-delà de la limite.",
    "result.not safe": "Non acceptable : l'outil est resté trop longtemps sur la tête ou y a été "
    "enfoncé trop profondément.",
    "result.ctps": "CTPS",
    "result.of 100": "{score:.0f} / 100",
    "result.mm": "{error:.2f} mm",
    "result.points": "{points:.1f}",
    "result.time": "Temps",
    "result.repeated": "Pointages refusés / retirés",
    "result.next": "Suite : {task}",
    "result.again": "À nouveau : {task}",
    "result.replay": "Revoir l'essai",
    "result.errors": "Montrer les erreurs sur la tête",
    "result.procedure": "Erreurs de la procédure",
    "procedure.title.verifying": "Contrôler le recalage",
    "procedure.title.aligning": "Aligner le guide",
    "procedure.title.drilling": "Forer",
    "procedure.title.inserting": "Insérer l'instrument",
    "procedure.accept": "Accepter le recalage",
    "procedure.accept help": "Le plan est désormais montré selon lui.",
    "procedure.again": "Recommencer le recalage",
    "procedure.again help": "Touchez encore une fois les quinze points.",
    "procedure.waits": "Les points sont encore en cours de recalage.",
    "procedure.lock": "Verrouiller le guide",
    "procedure.lock help": "Le bras est alors maintenu, et le foret est dans le guide.",
    "procedure.align": "Laisser le robot aligner le guide",
    "procedure.align help": "Il amène le guide sur la trajectoire planifiée, telle que la montre "
    "votre recalage. Un stick l'arrête.",
    "procedure.insert": "Insérer l'instrument",
    "procedure.insert help": "Le foret est retiré ; l'instrument part de la pointe du guide.",
    "procedure.retract": "Retirer le foret et aligner à nouveau",
    "procedure.retract help": "Possible tant que le foret n'a pas entamé l'os.",
    "procedure.release": "Libérer l'instrument",
    "procedure.release help": "Il reste où il est ; puis vient la trajectoire suivante, ou le "
    "score.",
    "procedure.work": "Retour au travail",
    "procedure-errors.title": "Erreurs : {name}",
    "procedure-errors.text": "Par rapport à la vérité. Entre parenthèses : part du recalage / part "
    "de la main. Ces longueurs ne s'additionnent pas : les deux peuvent se compenser.",
    "procedure-errors.trajectory": "Trajectoire",
    "procedure-errors.lines": "Montrer les trajectoires dans la tête",
    "procedure-errors.back": "Retour",
    "procedure-errors.score": "Score de la procédure",
    "procedure-errors.rms": "Erreur au point cible (RMS)",
    "procedure-errors.target": "Erreur au point cible",
    "procedure-errors.entry": "Erreur au point d'entrée",
    "procedure-errors.radial": "Erreur radiale",
    "procedure-errors.depth": "Erreur en profondeur",
    "procedure-errors.angle": "Écart angulaire",
    "procedure-errors.plunge": "Dépassement du foret",
    "procedure-errors.touches": "Score des pointages",
    "procedure-errors.split mm": "{error:.2f} mm ({registration:.2f} / {hand:.2f})",
    "procedure-errors.split deg": "{error:.1f}° ({registration:.1f} / {hand:.1f})",
    "procedure-errors.no inner table": "à côté de la table interne",
    "procedure-errors.kept": "à {distance:.1f} mm",
    "procedure-errors.hit": "touché",
    "procedure-lines.title": "Vert : plan. Jaune : selon votre recalage. Bleu : posé.",
    "procedure-lines.back": "Retour",
    "errors.title": "Vos erreurs, agrandies {longer:.0f} fois : vert jusqu'à {good:.0f} mm, rouge "
    "dès {poor:.0f} mm",
    "errors.back": "Retour",
    "result.worst": "Montrer le pire pointage",
    "result.menu": "Menu de l'expérience",
    # The tutorial: {control} is what the trainee presses or pushes, such as "Left stick up".
    "tutorial.title": "Tutoriel",
    "tutorial.place": "Étape {step} sur {steps}",
    "tutorial.done mm": "{done} mm sur {goal}",
    "tutorial.done degrees": "{done}° sur {goal}",
    "tutorial.done points": "{done} points sur {goal}",
    "tutorial.homing": "Le robot va là où vous commencez.",
    "tutorial.right": "Déplacez l'outil de 30 mm vers la droite : {control}.",
    "tutorial.left": "30 mm vers la gauche : {control}.",
    "tutorial.forward": "30 mm vers l'avant, en vous éloignant : {control}.",
    "tutorial.forward.robot": "30 mm vers l'avant, selon l'orientation du robot : {control}.",
    "tutorial.back": "30 mm vers l'arrière, vers vous : {control}.",
    "tutorial.back.robot": "30 mm vers l'arrière, selon l'orientation du robot : {control}.",
    "tutorial.up": "30 mm vers le haut : {control}.",
    "tutorial.down": "30 mm vers le bas : {control}.",
    "tutorial.slow": "Maintenez {control} et déplacez l'outil de 10 mm : près de la peau, il doit "
    "être lent.",
    "tutorial.slow.touch screen": "Appuyez sur {control} et déplacez l'outil de 10 mm : près de la "
    "peau, il doit être lent. Appuyez à nouveau pour la vitesse normale.",
    "tutorial.slow.mouse": "Cliquez sur {control} et déplacez l'outil de 10 mm : près de la peau, "
    "il doit être lent. Cliquez à nouveau pour la vitesse normale.",
    "tutorial.turn view": "Tournez la vue de 20° : {control}.",
    "tutorial.turn view.keyboard": "Tournez la vue de 20° : {control}, ou glissez avec le bouton "
    "droit de la souris.",
    "tutorial.turn view.mouse": "Tournez la vue de 20° : glissez avec le bouton droit de la "
    "souris.",
    "tutorial.turn view.touch screen": "Tournez la vue de 20° : glissez un doigt sur l'image.",
    "tutorial.look around": "Tournez la tête de côté, et poussez le stick gauche : ses directions "
    "tournent avec vous.",
    "tutorial.best view": "Meilleure vue du point {point} : {control}.",
    "tutorial.lower": "Abaissez la pointe sur le point {point} : l'anneau se ferme, et devient "
    "vert sur la peau.",
    "tutorial.touch": "Enregistrez le pointage : {control}. Seuls comptent les pointages à moins "
    "de 10 mm du point.",
    "tutorial.undo": "Tout le monde peut déraper. Retirez le pointage : {control}.",
    "tutorial.pause": "Ouvrez le menu : {control}. Pendant ce temps, tout attend ; puis reprenez.",
    "tutorial.guided": "Touchez maintenant {count} points, chacun aussi précisément que possible. "
    "Le premier est le point {point}.",
    "tutorial.praise": "Bien joué.",
    "tutorial.recorded": "Enregistré, à {error:.1f} mm du point.",
    "tutorial.touched": "Point {label} : écart de {error:.1f} mm. Touchez maintenant le point "
    "{point}.",
    "tutorial.head is gone": "Le tutoriel est terminé : une autre tête est utilisée.",
    "tutorial is open": "{trainee} suit le tutoriel : attendez qu'il soit terminé, ou quittez-le "
    "dans le menu du simulateur.",
    "tutorial.paused": "Le tutoriel attend à l'étape {step} sur {steps}.",
    "tutorial.resume": "Continuer",
    "tutorial.controls": "Commandes",
    "tutorial.restart": "Recommencer du début",
    "tutorial.leave": "Quitter le tutoriel",
    "tutorial.skip": "Passer le tutoriel",
    "tutorial.mm": "{error:.1f} mm",
    "tutorial-done.title": "Vous savez piloter le robot",
    "tutorial-done.text": "{trainee}, vient ensuite la prise en main : quinze points, pour vous "
    "entraîner aussi longtemps que dure son temps.",
    "tutorial-done.time": "Temps",
    "tutorial-done.first": "Erreur de votre premier pointage",
    "tutorial-done.touches": "Erreurs des trois derniers",
    "tutorial-done.trial-run": "Commencer la prise en main",
    "tutorial-done.again": "Refaire le tutoriel",
    "tutorial-done.menu": "Menu de l'expérience",
    # Settings.
    "settings.title": "Réglages",
    "settings.back": "Retour",
    "settings.unlock": "PIN du formateur",
    "settings.lock": "Verrouiller à nouveau",
    "settings.locked": "Verrouillé : un formateur saisit le PIN ci-dessous.",
    "settings.waits": "Cela ne peut pas être modifié avant la fin de l'essai.",
    "settings.language": "Langue",
    "settings.language help": "Langue de tous les écrans.",
    "settings.language.en": "English",
    "settings.language.de": "Deutsch",
    "settings.language.fr": "Français",
    "settings.language.es": "Español",
    "settings.language.zh-Hans": "简体中文",
    "settings.volume": "Volume",
    "settings.volume help": "Volume de tous les sons.",
    "settings.muted": "Muet",
    "settings.muted help": "Couper tous les sons.",
    "settings.muted.yes": "Oui",
    "settings.muted.no": "Non",
    "settings.speech": "Lecture à voix haute",
    "settings.speech help": "La page et le casque lisent les consignes, avertissements et "
    "menus avec la voix du navigateur.",
    "settings.speech.yes": "Oui",
    "settings.speech.no": "Non",
    "settings.order": "Ordre des tâches",
    "settings.order help": "Si les tâches doivent être faites dans leur ordre. Les formateurs "
    "modifient cela avec leur PIN, ou dans le fichier {file}.",
    "settings.order.fixed": "L'une après l'autre",
    "settings.order.any": "Libre",
    "settings.coarse": "Vitesse",
    "settings.coarse help": "Vitesse de la pointe quand un stick est poussé à fond.",
    "settings.fine": "Vitesse lente",
    "settings.fine help": "Vitesse de la pointe tant que la commande du mouvement lent est "
    "maintenue.",
    "settings.axes": "Directions",
    "settings.axes help": "Si la droite, l'avant et le haut sont ceux de la vue ou ceux du robot.",
    "settings.axes.camera": "Selon la vue",
    "settings.axes.robot": "Selon le robot",
    "settings.touch": "Un pointage compte",
    "settings.touch help": "Seulement sur la peau, ou partout à moins de 10 mm du point, comme "
    "dans l'étude publiée. L'enregistrement le note.",
    "settings.self_alignment": "Guide aligné par le robot",
    "settings.self_alignment help": "Si le robot peut amener lui-même le guide d'une procédure sur "
    "la trajectoire planifiée, comme le font les robots cliniques.",
    "settings.self_alignment.yes": "Sur demande",
    "settings.self_alignment.no": "Jamais",
    "settings.touch.on skin": "Sur la peau",
    "settings.touch.within radius": "À moins de 10 mm",
    "settings.view": "Meilleure vue du point suivant",
    "settings.view help": "Si la vue se tourne d'elle-même vers chaque point suivant tant que les "
    "sticks sont relâchés. L'enregistrement le note. La commande de la meilleure vue agit "
    "toujours.",
    "settings.view.practice": "Sauf dans les études",
    "settings.view.always": "Automatique",
    "settings.view.never": "Seulement sur demande",
    "settings.guidance": "Guidage au point suivant",
    "settings.guidance help": "Des directions en mots, une flèche, ou ni l'un ni l'autre ; pour un "
    "tracé sur la peau, aussi ce qui est couvert et où continuer. Une étude peut fixer le sien. "
    "L'enregistrement le note.",
    "settings.guidance.fading": "De moins en moins",
    "settings.guidance.words": "Mots et flèche",
    "settings.guidance.arrow": "Flèche",
    "settings.guidance.none": "Aucun",
    "settings.ghost": "Fantôme à côté du bras",
    "settings.ghost help": "Montre l'outil d'un essai antérieur de la même tâche, selon le temps "
    "écoulé depuis le début. Aucun dans les études, sauf si leur protocole en prévoit un. "
    "L'enregistrement le note. L'identifiant de l'expert est dans le fichier {file}.",
    "settings.ghost.off": "Aucun",
    "settings.ghost.own best": "Votre meilleur essai",
    "settings.ghost.expert": "Le meilleur essai de l'expert",
    "ghost.none": "Pas de fantôme : il n'y a pas encore d'essai acceptable de cette tâche à "
    "montrer.",
    "settings.tutorial": "Tutoriel",
    "settings.tutorial help": "Si la prise en main l'attend. Une étude peut fixer le sien. Les "
    "formateurs modifient cela avec leur PIN, ou dans le fichier {file}.",
    "settings.tutorial.required": "Avant la prise en main",
    "settings.tutorial.optional": "Peut être passé",
    "settings.tutorial.skipped": "Aucun",
    "settings.direction": "Direction de l'outil",
    "settings.direction help": "Qui décide où pointe l'outil : le bras, vous ou la peau.",
    "settings.direction.free": "Libre (position seule)",
    "settings.direction.clear": "Libre, à l'écart de la tête",
    "settings.direction.held": "Dirigée par vous",
    "settings.direction.normal": "Perpendiculaire à la peau",
    "settings.direction.pose": "Dirigée par vous, sans roulis",
    # Controls: what they do, and what they are called.
    "bindings.title": "Modifier les commandes",
    "bindings.device": "Appareil",
    "bindings.preset": "Disposition",
    "bindings.preset.two hands": "Deux mains",
    "bindings.preset.left-handed": "Gaucher",
    "bindings.preset.right alone": "Main droite seule",
    "bindings.preset.left alone": "Main gauche seule",
    "bindings.preset.own": "Personnelle",
    "bindings.group": "Commandes pour",
    "bindings.group.work": "Le travail",
    "bindings.group.movement": "Le mouvement de l'outil",
    "bindings.group.view": "La vue",
    "bindings.group.menus": "Les menus",
    "bindings.defaults": "Rétablir les commandes par défaut",
    "bindings.back": "Retour",
    "bindings.are default": "Toutes les commandes par défaut sont rétablies.",
    "bindings.changed": "{control} : maintenant {input}.",
    "bindings.impossible": "Ces deux commandes ne peuvent pas être échangées : l'une ferait deux "
    "choses à la fois.",
    "listen.title": "{control}",
    "listen.gamepad": "Appuyez sur le nouveau bouton ou poussez le nouvel axe pour {control} "
    "({seconds} s).",
    "listen.keyboard": "Appuyez sur la nouvelle touche pour {control} ({seconds} s).",
    "listen.cancel": "Annuler",
    "conflict.title": "Déjà utilisé",
    "conflict.text": "{input} sert déjà à {other}. L'échanger avec {control} ?",
    "conflict.exchange": "Échanger",
    "conflict.another": "En choisir une autre",
    "conflict.cancel": "Annuler",
    "test.title": "Essayer les commandes",
    "test.text": "Poussez et pressez tout ; chaque action est montrée et se ressent. {menu} "
    "ramène en arrière.",
    "test.back": "Retour",
    "test.yes": "Oui",
    "test.no": "Non",
    "test.nothing": "rien",
    "control.touch": "Toucher",
    "control.undo": "Retirer",
    "control.camera": "Vue de face",
    "control.fine": "Lent",
    "control.pause": "Pause",
    "control.menu": "Menu",
    "control.move_left": "Vers la gauche",
    "control.move_right": "Vers la droite",
    "control.move_back": "Vers l'arrière",
    "control.move_forward": "Vers l'avant",
    "control.move_down": "Vers le bas",
    "control.move_up": "Vers le haut",
    "control.turn_left": "Tourner à gauche",
    "control.turn_right": "Tourner à droite",
    "control.turn_down": "Tourner vers le bas",
    "control.turn_up": "Tourner vers le haut",
    "control.best_view": "Meilleure vue",
    "control.view_left": "Vue de gauche",
    "control.view_right": "Vue de droite",
    "control.view_lower": "Vue de dessous",
    "control.view_higher": "Vue de dessus",
    "control.view_farther": "Vue de plus loin",
    "control.view_nearer": "Vue de plus près",
    "control.accept": "Valider",
    "control.back": "Retour",
    "control.up": "Haut",
    "control.down": "Bas",
    "control.left": "Gauche",
    "control.right": "Droite",
    "control.taken": "Maintenant aux commandes : {source}.",
    "control.held": "Aux commandes : {source}. Pour les reprendre, appuyez sur {menu} après "
    "{seconds:.0f} s sans action.",
    "control.locked": "Aux commandes : {source}. Seul un formateur peut les passer : {menu}, "
    "Réglages, PIN du formateur.",
    "control.holder": "Aux commandes : {source}",
    "control.nobody": "Aux commandes : personne",
    "source.gamepad": "manette",
    "source.keyboard": "clavier",
    "source.mouse": "souris",
    "source.touch screen": "écran tactile",
    "source.browser's gamepad": "manette du navigateur",
    "source.headset's controllers": "contrôleurs du casque",
    "device.gamepad": "Manette",
    "device.keyboard": "Clavier",
    "gamepad.a": "A",
    "gamepad.b": "B",
    "gamepad.x": "X",
    "gamepad.y": "Y",
    "gamepad.back": "Bouton Back",
    "gamepad.guide": "Bouton logo",
    "gamepad.start": "Bouton Start",
    "gamepad.leftstick": "Stick gauche enfoncé",
    "gamepad.rightstick": "Stick droit enfoncé",
    "gamepad.leftshoulder": "LB",
    "gamepad.rightshoulder": "RB",
    "gamepad.dpup": "Croix haut",
    "gamepad.dpdown": "Croix bas",
    "gamepad.dpleft": "Croix gauche",
    "gamepad.dpright": "Croix droite",
    "gamepad.-leftx": "Stick gauche à gauche",
    "gamepad.+leftx": "Stick gauche à droite",
    "gamepad.-lefty": "Stick gauche en haut",
    "gamepad.+lefty": "Stick gauche en bas",
    "gamepad.-rightx": "Stick droit à gauche",
    "gamepad.+rightx": "Stick droit à droite",
    "gamepad.-righty": "Stick droit en haut",
    "gamepad.+righty": "Stick droit en bas",
    "gamepad.-lefttrigger": "LT relâchée",
    "gamepad.+lefttrigger": "LT",
    "gamepad.-righttrigger": "RT relâchée",
    "gamepad.+righttrigger": "RT",
    # Where a headset's controllers differ from a gamepad.
    "headset.fine": "Gâchette",
    "headset.menu": "X",
    "headset.pause": "X",
    "headset.up": "Stick en haut",
    "headset.down": "Stick en bas",
    "headset.left": "Stick à gauche",
    "headset.right": "Stick à droite",
    "headset.tilt": "Gâchette droite + stick",
    # What is clicked among the hints while the sticks on the screen are dragged.
    "mouse.touch": "Toucher",
    "mouse.undo": "Retirer",
    "mouse.camera": "Vue de face",
    "mouse.best_view": "Meilleure vue",
    "mouse.fine": "Lent",
    "mouse.menu": "Menu",
    "mouse.pause": "Menu",
    "mouse.view_left": "Clic droit et glisser à gauche",
    "mouse.view_right": "Clic droit et glisser à droite",
    # What is written on the buttons that the page has on a touch screen.
    "touch screen.touch": "Toucher",
    "touch screen.undo": "Retirer",
    "touch screen.camera": "Vue de face",
    "touch screen.best_view": "Meilleure vue",
    "touch screen.fine": "Lent",
    "touch screen.menu": "Pause",
    "touch screen.pause": "Pause",
    "touch screen.accept": "Appuyer",
    "touch screen.back": "Retour",
    "keyboard.Space": "Espace",
    "keyboard.Enter": "Entrée",
    "keyboard.NumpadEnter": "Entrée du pavé numérique",
    "keyboard.Backspace": "Retour arrière",
    "keyboard.Escape": "Échap",
    "keyboard.Tab": "Tab",
    "keyboard.ShiftLeft": "Maj gauche",
    "keyboard.ShiftRight": "Maj droite",
    "keyboard.ControlLeft": "Ctrl gauche",
    "keyboard.ControlRight": "Ctrl droite",
    "keyboard.AltLeft": "Alt gauche",
    "keyboard.AltRight": "Alt droite",
    "keyboard.ArrowLeft": "Flèche gauche",
    "keyboard.ArrowRight": "Flèche droite",
    "keyboard.ArrowUp": "Flèche haut",
    "keyboard.ArrowDown": "Flèche bas",
    "keyboard.PageUp": "Page préc.",
    "keyboard.PageDown": "Page suiv.",
    # While the trainee works.
    "work.complete": "{trainee}, les {count} points sont touchés. Appuyez sur {touch} pour les "
    "recaler.",
    "work.on skin": "Sur la peau : appuyez sur {touch}.",
    "work.off the way": "{trainee}, vous vous écartez du chemin vers le point {point}.",
    "warning.shaft": "La tige touche la tête : relevez l'outil.",
    "warning.elsewhere": "La pointe touche la peau hors du point : relevez-la.",
    "warning.pressing": "Vous enfoncez la pointe de {depth:.1f} mm : relâchez.",
    "warning.reach": "Le bras ne va pas plus loin dans cette direction.",
    "warning.obstacle.links": "La tête gêne le bras : approchez par un autre côté.",
    "warning.obstacle.self": "Le bras se gêne lui-même : changez de direction.",
    "warning.obstacle.table": "La table gêne le bras : approchez par le haut.",
    "warning.nobody registers": "Personne ne recale les points ici : connectez 3D Slicer.",
    "felt.bone": "Le foret est dans l'os.",
    "felt.through": "Le foret a traversé l'os : arrêtez.",
    "felt.blocked": "L'instrument bute sur de l'os qui n'est pas foré de part en part.",
    "warning.slicer": "La connexion à 3D Slicer est perdue. Continuez : tout est enregistré ici et "
    "sera noté plus tard.",
    "warning.unplugged": "La manette {name} est débranchée : le robot ne bouge plus. Rebranchez-la "
    "ou continuez au clavier.",
    "warning.unmapped": "La disposition de la manette {name} est inconnue : prenez-en une autre ou "
    "le clavier.",
    "warning.no SDL": "Les manettes ne peuvent pas être lues sur cet ordinateur ({reason}) : "
    "prenez le clavier.",
    "warning.settings": "{reason} Les réglages par défaut sont utilisés.",
    # What the window says itself, because the simulator cannot.
    "window.left stick": "Gauche, droite, avant, arrière",
    "window.right stick": "Haut, bas, tourner",
    "window.title": "RASTrainer",
    "window.connecting": "La fenêtre se connecte au simulateur.",
    "window.lost": "La connexion au simulateur est perdue. Elle sera rétablie dès que le "
    "simulateur répondra.",
    "window.unknown": "Le simulateur ne connaît pas cette fenêtre : fermez-la et ouvrez-en une "
    "avec le code d'appairage que le simulateur affiche maintenant.",
    "window.refused": "Le nombre maximal de vues est ouvert : fermez-en une.",
    "window.no font": "Cet ordinateur n'a pas de police de caractères chinois, donc sa fenêtre "
    "ne peut pas afficher le chinois : installez-en une, comme WenQuanYi Micro Hei, et "
    "redémarrez.",
    "window.pairing": "Pour appairer un navigateur ou un casque : code {code} à {addresses}",
    "status.points": "{kept} points sur {count}",
    "status.traced": "{traced} points tracés sur {least}–{most}",
    "coverage": "À moins de {distance} mm de points tracés",
    "status.line": "Trajectoire {number} sur {count}",
    "status.checkpoint": "{name} : écart de {error:.1f} mm",
    "status.entry": "Entrée : à {distance:.1f} mm de l'axe",
    "status.angle": "Angle : {angle:.1f}°",
    "status.stand off": "Distance : {distance:.0f} mm",
    "status.to inner": "{left:.1f} mm jusqu'à la table interne",
    "status.past inner": "{past:.1f} mm au-delà de la table interne",
    "status.to target": "{left:.1f} mm jusqu'à la cible",
    "status.past target": "{past:.1f} mm au-delà de la cible",
    "panel.mm": "{value:.1f} mm",
    "panel.deg": "{value:.1f}°",
    "status.left": "encore {time}",
    "status.point": "Point {point}",
    "status.next place": "Suite",
    "status.near": "{name} : à moins de {distance} mm",
    "status.toward": "{name} : {distance} mm {direction}",
    "way.left": "à gauche",
    "way.right": "à droite",
    "way.back": "en arrière",
    "way.forward": "en avant",
    "way.down": "en bas",
    "way.up": "en haut",
    "hint.move": "Déplacer",
    "hint.up_and_down": "Haut, bas",
    "hint.touch": "Toucher",
    "hint.register": "Recaler",
    "hint.trace": "Commencer ou finir un trait",
    "hint.undo": "Retirer",
    "hint.fine": "Lent",
    "hint.best_view": "Meilleure vue",
    "hint.on": "oui",
    "hint.off": "non",
    "hint.mouse": "Souris",
    "hint.sticks": "Montrer les sticks",
    "hint.hide sticks": "Cacher les sticks",
    "hint.right stick": "Stick droit",
    "hint.turn_view": "Tourner la vue",
    "hint.camera": "Caméra",
    "hint.front": "Vue de face",
    "hint.menu": "Menu",
    "hint.choose": "Choisir",
    "hint.accept": "Valider",
    "hint.back": "Retour",
    "hint.play": "Lecture, pause",
    "hint.seek": "5 s en arrière, en avant",
    "hint.worst": "Pire pointage",
    "hint.end": "Terminer",
    "hint.rate": "Évaluer",
    "rating.replay": "Relecture {number} sur {count} : regardez-la, puis évaluez-la",
    "rating.title": "{form} : {domain}",
    "rating.text": "Relecture {number} sur {count}. 1 est la plus mauvaise note, 5 la meilleure ; "
    "2 et 4 se situent entre les phrases.",
    "rating.mark": "{mark} : {sentence}",
    "rating.undo": "Retirer la dernière note",
    "rating.watch": "Regarder à nouveau la relecture",
    "rating.previous": "La relecture précédente",
    "rating.next": "Relecture suivante",
    "rating.leave": "Quitter ; toutes les notes sont gardées",
    "rated.title": "La relecture {number} sur {count} est évaluée",
    "rated.text": "{rated} relectures sur {count} sont évaluées.",
    "rated.all": "Les {count} relectures sont évaluées",
    "rated.all text": "Merci. {rated} relectures sur {count} sont évaluées ; le rapport de l'étude "
    "dit à quel point les évaluateurs concordent.",
    "rating-loading.title": "Relecture {number} sur {count}",
    "rating-loading.text": "La relecture est en cours de chargement.",
    "rate.gears_depth": "Perception de la profondeur",
    "rate.gears_depth.low": "Se trompe sans cesse de profondeur ; très loin ou enfoncé",
    "rate.gears_depth.middle": "Profondeur parfois inexacte, aussitôt corrigée",
    "rate.gears_depth.high": "S'arrête directement sur la peau",
    "rate.gears_efficiency": "Efficacité",
    "rate.gears_efficiency.low": "Détours et pauses ; n'avance guère",
    "rate.gears_efficiency.middle": "Sans hâte, le plus souvent vers le but",
    "rate.gears_efficiency.high": "Droit vers chaque but, sans hésiter",
    "rate.gears_force": "Sensibilité à la force",
    "rate.gears_force.low": "Appuie ou frotte à maintes reprises sur la peau",
    "rate.gears_force.middle": "Touche parfois trop fort",
    "rate.gears_force.high": "Chaque pointage est léger",
    "rate.gears_control": "Maîtrise du robot",
    "rate.gears_control.low": "Le bras va où il ne devrait pas, ou par à-coups",
    "rate.gears_control.middle": "Le plus souvent comme voulu ; quelques postures défavorables",
    "rate.gears_control.high": "Le bras va sans heurt, toujours en bonne posture",
    "rate.osats_tissue": "Respect des tissus",
    "rate.osats_tissue.low": "Beaucoup de contacts inutiles ou trop profonds",
    "rate.osats_tissue.middle": "Prudent, avec quelques dérapages",
    "rate.osats_tissue.high": "Seulement les contacts que la tâche demande",
    "rate.osats_motion": "Temps et mouvements",
    "rate.osats_motion.low": "La plupart des mouvements ne servent à rien",
    "rate.osats_motion.middle": "Certains mouvements pourraient être évités",
    "rate.osats_motion.high": "Rien ne pourrait être évité",
    "rate.osats_handling": "Maniement de l'instrument",
    "rate.osats_handling.low": "L'outil est mené sans assurance",
    "rate.osats_handling.middle": "Mené sûrement, mais sans aisance",
    "rate.osats_handling.high": "Mené avec fluidité et précision",
    "rate.osats_flow": "Déroulement et anticipation",
    "rate.osats_flow.low": "S'arrête, comme sans savoir quoi faire ensuite",
    "rate.osats_flow.middle": "Avance régulièrement, en anticipant un peu",
    "rate.osats_flow.high": "Chaque geste prépare le suivant",
    "hint.checkpoint": "Toucher le point de contrôle",
    "hint.next step": "Étape suivante",
    "hint.feed": "Avancer, reculer",
    "hint.turn": "Tourner",
    "hint.tilt": "Incliner",
    "hint.result": "Résultat",
    "replay.title": "{task} de {trainee}, à nouveau",
    "replay.worst": "Point {point}, le pire pointage, à demi-vitesse",
    "replay.paused": "En pause",
    "replay.loading": "Chargement de votre essai",
    "replay.back": "Retour au résultat",
    "replay.no worst": "Le pire pointage de cet essai ne peut pas être déterminé.",
    "replay.no journal": "L'essai ne peut pas être remontré : son journal n'est plus dans le "
    "dossier des enregistrements.",
    # What a learning platform's users read after a launch.
    "lti.you are": "Votre pseudonyme au simulateur",
    "lti.what to do": "Marche à suivre",
    "lti.go": "Allez à un simulateur de votre laboratoire et faites choisir {pseudonym} dans 3D "
    "Slicer, sous « Trainees ».",
    "lti.play": "Faites {task} {mode}, aussi souvent que vous le voulez.",
    "lti.any task": "une tâche au choix",
    "lti.any mode": "à l'écran ou avec le casque",
    "lti.return": "Ouvrez à nouveau le lien dans votre cours pour voir ici vos nouveaux scores.",
    "lti.scores": "Vos essais",
    "lti.seconds": "{seconds:.0f} s",
    "lti.no trials": "Aucun ne compte encore pour ce lien.",
    "lti.grade best": "Votre meilleur score acceptable est transmis à votre cours : {score:.1f} / "
    "100.",
    "lti.grade latest": "Le score de votre dernier essai acceptable est transmis à votre cours : "
    "{score:.1f} / 100.",
    "lti.no grade yet": "Votre cours recevra une note dès qu'un essai sera acceptable.",
    "lti.no grade": "Ce lien ne transmet aucune note au cours.",
    "lti.data": "Vos données",
    "lti.data text": "{platform} reçoit tout au plus votre note et le moment de son envoi. Ce "
    "laboratoire conserve votre identifiant sur {platform} avec votre pseudonyme dans un fichier "
    "privé, mais ni votre nom ni votre adresse électronique. Le laboratoire vous demandera si vos "
    "essais peuvent servir à la recherche.",
    "lti.no learner": "Vous ne suivez pas ce cours en tant qu'apprenant : vous ne recevez donc ni "
    "pseudonyme ni note.",
    "lti.link works": "Le lien fonctionne, et des notes peuvent être transmises au cours.",
    "lti.refused": "Ce lancement ne peut pas être utilisé",
    "lti.refused help": "Ouvrez à nouveau le lien dans votre cours. Si cette page réapparaît, "
    "montrez ce qui suit aux responsables du cours ou du simulateur.",
    "decimal sign": ",",
    "list separator": ", ",
}

FRENCH: Mapping[str, str] = MappingProxyType(
    {key: typesetting.french(text) for key, text in _TABLE.items()}
)
