"""The same texts in Spanish, which addresses the trainee as "usted".

Point: punto. Touch, as a noun: toque. Fiducial: fiducial. Landmark: referencia. Registration:
registro. Target: objetivo. Trial: ensayo. Trial run: práctica libre. Trace: trazado. Stroke: trazo.
Undo: deshacer. Abort: abandonar. Record: grabación, because a registro is a registration. Match:
ajuste. Settings: configuración, because an ajuste is a match.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

_ITEMS: Mapping[str, str] = {
    "sus_1": "querría usarlo a menudo",
    "sus_2": "innecesariamente complejo",
    "sus_3": "fácil de usar",
    "sus_4": "necesito la ayuda de un técnico",
    "sus_5": "funciones bien integradas",
    "sus_6": "demasiadas incoherencias",
    "sus_7": "la mayoría lo aprende pronto",
    "sus_8": "engorroso",
    "sus_9": "me sentí con confianza",
    "sus_10": "tuve que aprender mucho antes",
    "sus.low": "muy en desacuerdo",
    "sus.high": "muy de acuerdo",
    "tlx_mental": "Exigencia mental",
    "tlx_physical": "Exigencia física",
    "tlx_temporal": "Exigencia temporal",
    "tlx_performance": "Rendimiento",
    "tlx_performance.low": "perfecto",
    "tlx_performance.high": "fracaso",
    "tlx_effort": "Esfuerzo",
    "tlx_frustration": "Frustración",
    "nasa-tlx.low": "muy baja",
    "nasa-tlx.high": "muy alta",
    "ssq_discomfort": "Malestar general",
    "ssq_fatigue": "Fatiga",
    "ssq_headache": "Dolor de cabeza",
    "ssq_eyestrain": "Vista cansada",
    "ssq_focusing": "Dificultad para enfocar",
    "ssq_salivation": "Aumento de la salivación",
    "ssq_sweating": "Sudoración",
    "ssq_nausea": "Náuseas",
    "ssq_concentrating": "Dificultad para concentrarse",
    "ssq_fullness": "Pesadez de cabeza",
    "ssq_blurred": "Visión borrosa",
    "ssq_dizzy_open": "Mareo con los ojos abiertos",
    "ssq_dizzy_closed": "Mareo con los ojos cerrados",
    "ssq_vertigo": "Vértigo giratorio",
    "ssq_stomach": "Molestias de estómago",
    "ssq_burping": "Eructos",
    "ssq.low": "nada",
    "ssq.high": "mucho",
    "feedback.skin": "La piel se había desplazado {shift:.1f} mm (RMS) y estaba hundida "
    "{indentation:.1f} mm: el error verdadero en el objetivo fue de {tre:.2f} mm.",
    "feedback.skin and error": "La piel se había desplazado {shift:.1f} mm (RMS) y estaba hundida "
    "{indentation:.1f} mm: el error verdadero en el objetivo fue de {tre:.2f} mm; sin eso habría "
    "sido de {without:.2f} mm.",
}

_FEEDBACK: Mapping[str, str] = {
    "feedback.touch": "Punto {label}: desviación de {residual:.1f} mm{where}{hurry}{tremor}.",
    "feedback.touch above": ", sobre todo en profundidad ({depth:.1f} mm por encima de la piel)",
    "feedback.touch below": ", sobre todo en profundidad ({depth:.1f} mm por debajo de la piel)",
    "feedback.touch aside": ", sobre todo a lo largo de la piel",
    "feedback.touch hurry": "; fue con prisa: quédese quieto un momento antes de tocar",
    "feedback.touch tremor": "; la punta temblaba: use la velocidad lenta en el último centímetro",
    "feedback.no touch": "Ningún toque destaca: los errores se reparten por igual.",
    "feedback.contact": "Chocó una vez con la cabeza por el camino. Levante la herramienta antes "
    "de ir al punto siguiente.",
    "feedback.contacts": "Chocó {count} veces con la cabeza por el camino. Levante la herramienta "
    "antes de ir al punto siguiente.",
    "feedback.dragging": "La herramienta estuvo {time:.0f} s sobre la cabeza fuera de los puntos, "
    "a lo largo de {path:.0f} mm: levántela antes de ir al punto siguiente.",
    "feedback.pressing": "En los puntos hundió la herramienta {depth:.1f} mm en la cabeza: "
    "deténgase en cuanto la punta toque la piel.",
    "feedback.worst touch": "Cuide más el punto {points}: sin este error, el registro sería un "
    "{share:.0f} % más exacto, aproximadamente.",
    "feedback.worst touches": "Cuide más los puntos {points}: sin estos errores, el registro sería "
    "un {share:.0f} % más exacto, aproximadamente.",
    "feedback.depth": "El error está sobre todo en profundidad: lleve la punta hasta la piel y "
    "mire de lado antes de tocar.",
    "feedback.common bias": "De media, los toques están desplazados {bias:.1f} mm {direction}, lo "
    "que el error de registro no puede mostrar: mire la punta desde otro lado antes de tocar.",
    "feedback.oblique common bias": "De media, los toques están desplazados {bias:.1f} mm "
    "{direction} y {second}, lo que el error de registro no puede mostrar: mire la punta desde "
    "otro lado antes de tocar.",
    "feedback.bias to the left": "hacia la izquierda del paciente",
    "feedback.bias to the right": "hacia la derecha del paciente",
    "feedback.bias to the back": "hacia la nuca",
    "feedback.bias to the face": "hacia la cara",
    "feedback.bias to the neck": "hacia el cuello",
    "feedback.bias to the crown": "hacia la coronilla",
    "feedback.idle time": "La herramienta estuvo parada {idle:.0f} s de {time:.0f} s: busque el "
    "punto siguiente mientras aún está en este.",
    "feedback.detours": "La herramienta recorrió {times:.1f} veces el camino más corto: rodee la "
    "cabeza más cerca de ella y de un solo movimiento.",
    "feedback.repeated touch": "1 toque se rechazó o se deshizo: compruebe el número del punto "
    "antes de tocar.",
    "feedback.repeated touches": "{count} toques se rechazaron o se deshicieron: compruebe el "
    "número del punto antes de tocar.",
    "feedback.pace": "Tardó {time:.0f} s; lo habitual son {usual:.0f} s: vaya más rápido entre los "
    "puntos y despacio solo cerca de la piel.",
    "feedback.first trial": "Es su primer ensayo de esta tarea en este modo.",
    "feedback.first of this score": "Sus ensayos anteriores de esta tarea tienen puntuaciones de "
    "una versión anterior, que no se pueden comparar con esta.",
    "feedback.more points": "{points:.0f} puntos más que la media de sus últimos {trials} ensayos "
    "de esta tarea.{best}",
    "feedback.less points": "{points:.0f} puntos menos que la media de sus últimos {trials} "
    "ensayos de esta tarea.{best}",
    "feedback.more points than last": "{points:.0f} puntos más que en su último ensayo de esta "
    "tarea.{best}",
    "feedback.less points than last": "{points:.0f} puntos menos que en su último ensayo de esta "
    "tarea.{best}",
    "feedback.best": " Es el mejor hasta ahora.",
    "feedback.unacceptable": "No aprobado: el error verdadero en el cerebro, el sesgo común a "
    "todos los toques o el contacto con la cabeza supera lo aceptable.",
    "feedback.passed": "Aprobado: el umbral es {mark:.0f}.",
    "feedback.not passed": "Aún no aprobado: faltan {points:.0f} puntos para el umbral de "
    "{mark:.0f}.",
    "feedback.no mark": "Ni aprobado ni suspenso: el umbral de este estudio vale para otra versión "
    "de la puntuación.",
    "feedback.competent": "Sus ensayos muestran competencia desde el número {number}: de quienes "
    "aún fallan en el {failing:.0f} % de sus ensayos, el {risk:.0f} % llega tan lejos por azar en "
    "{trials} ensayos (LC-CUSUM).",
    "feedback.not competent": "{share:.0f} % del camino hacia la competencia demostrada (LC-CUSUM; "
    "ensayos hasta ahora: {trials}).",
}

SPANISH: Mapping[str, str] = MappingProxyType(
    {
        # What the trainee reads at the top of the picture.
        "idle": "Elija una tarea para empezar.",
        "start": "{trainee}, toque el punto {point}.",
        "touched": "{trainee}, el punto {label} está guardado. Ahora toque el punto {point}.",
        "undone": "{trainee}, el punto {label} se ha deshecho. Tóquelo otra vez.",
        "complete": "{trainee}, los {count} puntos están tocados. Regístrelos ahora.",
        # Tracing the skin, one point a millimeter.
        "trace": "{trainee}, las referencias están tocadas. Ahora pase la punta por la piel: "
        "{least} puntos o más, uno por milímetro.",
        "tracing": "{trainee}, pase la punta por la piel, también donde está orientada de otro "
        "modo.",
        "traced": "{trainee}, {traced} puntos están trazados. Siga: hacen falta {least}.",
        "traced enough": "{trainee}, {traced} puntos están trazados. Regístrelos, o siga trazando.",
        "traced all": "{trainee}, {traced} puntos están trazados, el máximo de un ensayo. "
        "Regístrelos ahora.",
        "paused": "{trainee}, el ensayo está en pausa. Reanúdelo cuando quiera.",
        "resumed": "{trainee}, siga con el punto {point}.",
        "registered": "{trainee}, sus puntos se están registrando y puntuando.",
        "scored": "{trainee}, su puntuación es {score:.0f} de 100: {fre:.2f} mm de error de "
        "registro, {tre:.2f} mm de error verdadero en el objetivo.",
        "aborted": "{trainee}, el ensayo se abandonó. Elija una tarea para empezar de nuevo.",
        # A procedure, from the registration to the placed instrument.
        "verifying": "{trainee}, sus puntos se están registrando.",
        "verify": "{trainee}, sus puntos están registrados: FRE {fre:.2f} mm. Toque puntos de "
        "control; después acepte el registro o repítalo.",
        "checked": "{trainee}, según su registro, {name} está desviado {error:.1f} mm. Compruebe "
        "otro punto, acepte el registro o repítalo.",
        "register again": "{trainee}, toque otra vez todos los puntos. Empiece por el punto "
        "{point}.",
        "align": "{trainee}, lleve la guía a la trayectoria planificada de {name} y bloquéela.",
        "align next": "{trainee}, el instrumento está colocado. Ahora lleve la guía a la "
        "trayectoria planificada de {name}.",
        "drill": "{trainee}, la guía está bloqueada. Perfore el cráneo a lo largo de {name}.",
        "realign": "{trainee}, la broca está fuera. Lleve otra vez la guía a la trayectoria "
        "planificada de {name}.",
        "insert": "{trainee}, avance el instrumento hasta el objetivo de {name} y suéltelo.",
        "procedure done": "{trainee}, el procedimiento ha terminado y se está puntuando.",
        "interrupted procedure": "{trainee}, este ensayo se interrumpió; todo está guardado. Siga "
        "con el procedimiento cuando quiera, o abandónelo.",
        # What a procedure does not allow.
        "no checkpoints": "Este procedimiento no tiene puntos de control: AcceptRegistration o "
        "RegisterAgain.",
        "too many checkpoints": "{most} puntos de control están tocados, el máximo de un ensayo: "
        "AcceptRegistration o RegisterAgain.",
        "too many attempts": "Los puntos se registraron {most} veces, el máximo de un ensayo: "
        "AcceptRegistration o Abort.",
        "too far from checkpoints": "Aquí no hay ningún punto de control: {name}, el más cercano "
        "según su registro, está a {distance:.1f} mm; uno cuenta hasta {radius:g} mm.",
        "above a checkpoint": "{height:.1f} mm por encima de la piel: baje la punta al punto de "
        "control.",
        "not in use yet": "Los puntos aún se están registrando: primero UseRegistration.",
        "already in use": "Otro registro está en uso: AcceptRegistration o RegisterAgain.",
        "not rigid": "UseRegistration necesita una transformación rígida: WorldToHead, fila por "
        "fila, en mm.",
        "off the head": "El eje de la guía no encuentra la cabeza: diríjalo a la cabeza antes de "
        "bloquearla.",
        "too far to lock": "La punta de la guía está a {distance:.0f} mm de la piel a lo largo de "
        "su eje: bloquéela a {limit:.0f} mm como máximo.",
        "no self-alignment": "Con esta configuración, el robot no alinea la guía por sí mismo: "
        "llévela a mano a la trayectoria.",
        "line out of reach": "El robot no puede sostener la guía en esta trayectoria a una "
        "distancia de {stand_off:g} mm: elija otra distancia o muévala a mano.",
        "bone is cut": "La broca ha cortado hueso: el orificio se queda donde está. Siga "
        "perforando y después inserte el instrumento.",
        "nothing drilled": "Aún no hay nada perforado: perfore antes de insertar el instrumento.",
        "still in the guide": "El instrumento está aún en la guía: aváncelo antes de soltarlo.",
        # Touches that do not count.
        "too far": "Demasiado lejos del punto {point}: un toque cuenta hasta {radius:g} mm.",
        "above the skin": "{height:.1f} mm por encima de la piel: baje la punta al punto {point}.",
        "wrong point": "Punto equivocado: es el punto {label}, a {nearest:.1f} mm; el siguiente es "
        "el punto {point}.",
        # Commands in the wrong phase.
        "no trial": "No hay ningún ensayo en marcha: empiece uno con StartTask.",
        "another trial is open": "Ese ensayo ha terminado. El que está abierto ahora, {task} de "
        "{trainee}, no se abandonó.",
        "trial is open": "{trainee} aún hace {task}: Register o Abort antes de StartTask.",
        "procedure is open": "{trainee} aún está en el procedimiento tras {task}: termínelo, o "
        "Abort, antes de StartTask.",
        "no other head in a trial": "Hay un ensayo en curso: Register o Abort antes de otro "
        "escenario.",
        "being set up": "El simulador aún está cargando otra cabeza u otra configuración: espere "
        "unos segundos.",
        "not at the procedure": "Esto viene después de Register, en un ensayo que StartTask empezó "
        "con un procedimiento.",
        "verifying now": "El registro se está comprobando: Capture para los puntos de control, "
        "después AcceptRegistration o RegisterAgain.",
        "aligning now": "La guía se está alineando: llévela a la trayectoria planificada y "
        "después LockGuide.",
        "drilling now": "La broca está en la guía y el brazo está sujeto: Feed para la broca, "
        "después StartInsertion.",
        "inserting now": "El instrumento está en la guía y el brazo está sujeto: Feed hasta su "
        "objetivo, después ReleaseInstrument.",
        "not all touched": "{kept} de {count} puntos están tocados: Register viene después del "
        "último; el siguiente es el punto {point}.",
        "nothing is traced": "En este ensayo no hay trazado: StartTask con el método surface o "
        "landmarks-surface empieza uno que lo tiene.",
        "landmarks first": "{kept} de {count} referencias están tocadas: Capture para el punto "
        "{point} antes de Trace.",
        "landmarks touched": "Las {count} referencias están tocadas: ahora Trace por la piel, o "
        "Undo para la última.",
        "trace is full": "{traced} puntos están trazados, el máximo de un ensayo: Register, o Undo "
        "para el último trazo.",
        "all traced": "{traced} puntos están trazados: Register, Trace para seguir, o Undo para el "
        "último trazo.",
        "still tracing": "Hay un trazo en marcha: termínelo con Trace antes de Register.",
        "too few traced": "{traced} puntos están trazados: Register necesita {least}, así que siga "
        "con Trace.",
        "not paused trace": "El ensayo no está en pausa: Trace por la piel, o primero Pause.",
        "not paused": "El ensayo no está en pausa: Capture para el punto {point}, o primero Pause.",
        "is paused": "El ensayo está en pausa: primero Resume.",
        "already paused": "El ensayo ya está en pausa: Resume o Abort.",
        "all touched": "Los {count} puntos están tocados: Register, o Undo para el último.",
        "is registered": "El ensayo está registrado y guardado: StartTask empieza el siguiente.",
        "nothing to undo": "Aún no hay ningún punto tocado: toque primero el punto {point}.",
        "not registered": "El ensayo aún no está registrado: primero Capture para sus {count} "
        "puntos y Register.",
        "no registration": "El ensayo aún no tiene registro: SubmitRegistration viene antes de "
        "TrialScored.",
        "registration is final": "Este registro es definitivo: el error verdadero se ha revelado, "
        "por lo que no se acepta ningún otro.",
        "no such trial": "Aquí no hay ningún ensayo {trial_id}: GetTrial, SubmitRegistration y "
        "TrialScored toman el ID que devolvió StartTask.",
        "not a simulation command": "{command} no es un comando de la simulación.",
        # When the record cannot be written.
        "not recorded": "El ensayo no se puede grabar ({reason}). Lo que no se grabó no cuenta; "
        "haga sitio o elija otra carpeta y después reanude.",
        # When the simulator had ended in the middle of a trial and is there again.
        "interrupted": "{trainee}, este ensayo se interrumpió; {kept} de {count} puntos están "
        "guardados. Siga con el punto {point} cuando quiera, o abandónelo.",
        "interrupted complete": "{trainee}, este ensayo se interrumpió; los {count} puntos están "
        "guardados. Regístrelos ahora.",
        "interrupted trace": "{trainee}, este ensayo se interrumpió; {traced} puntos trazados "
        "están guardados. Siga trazando cuando quiera, o abandónelo; con {least} puntos se puede "
        "registrar.",
        # When nobody could see the trial, which pauses it.
        "unseen.left": "En pausa: la vista que mostraba el ensayo se cerró o se perdió.",
        "unseen.unplugged": "En pausa: el mando se desconectó.",
        "unseen.hidden": "En pausa: el ensayo no estaba a la vista.",
        "unseen.instructor": "En pausa por su instructor.",
        "instructor.says": "Su instructor: {text}",
        "instructor.nothing runs": "En este puesto no hay nada en marcha que se pueda pausar.",
        "instructor.no result": "Una repetición se puede mostrar mientras el resultado de un "
        "ensayo está en la pantalla del puesto.",
        "unseen.still": "En pausa: la imagen se quedó parada unos segundos porque este ordenador "
        "estaba demasiado ocupado para dibujarla. Si vuelve a ocurrir, cierre otros programas.",
        # The simulator's menus.
        "start.title": "RASTrainer",
        "start.text": "Entrene el registro del paciente asistido por robot con un KUKA LBR iiwa 7 "
        "virtual. No apto para uso clínico.",
        "start.train": "Empezar a entrenar",
        "start.introduction": "Introducción",
        "start.controls": "Controles",
        "start.settings": "Configuración",
        "start.quit": "Salir",
        "quit.title": "¿Salir de RASTrainer?",
        "quit.text": "El simulador termina para todos los que están conectados a él.",
        "quit.stay": "Quedarse",
        "quit.leave": "Salir",
        "introduction.title.1": "Qué se entrena",
        "introduction.text.1": "Antes de poder ayudar en una operación del cerebro, un robot tiene "
        "que saber dónde está la cabeza. Usted se lo muestra: con la herramienta del robot toca "
        "quince puntos numerados de la cabeza, uno tras otro, con la mayor exactitud posible.",
        "introduction.title.2": "Cómo es una tarea",
        "introduction.text.2": "Siga los números y las flechas de la piel del punto 1 al punto 15. "
        "A menos de 20 mm de la cabeza suena un tono, y un anillo alrededor de la punta se cierra "
        "a medida que se acerca. Se pone verde donde un toque cuenta: guarde allí el punto. El "
        "rojo indica que algo va mal. Un desliz se puede deshacer.",
        "introduction.title.3": "Qué obtiene",
        "introduction.text.3": "Después del último punto, registra: 3D Slicer hace corresponder "
        "sus puntos con la RM y le muestra el error y su puntuación. Cuentan tanto la exactitud "
        "como el tiempo. Empieza con un tutorial de dos minutos y cinco minutos de práctica libre; "
        "después vienen las tareas 1 a 5.",
        "introduction.sheet": "Página {sheet} de {sheets}",
        "introduction.next": "Siguiente",
        "introduction.skip": "Ir a los controles",
        "introduction.back": "Atrás",
        "controls.title": "Controles",
        "controls.text": "El mando, el teclado y los controladores de un visor hacen todos lo "
        "mismo.",
        "controls.move_along": "Mover adelante, atrás",
        "controls.move_across": "Mover a la izquierda, derecha",
        "controls.move_vertically": "Mover arriba, abajo",
        "controls.fine": "Mover despacio (mantener)",
        "controls.touch": "Guardar un toque",
        "controls.undo": "Deshacer el último toque",
        "controls.camera": "Vista frontal: cerca o lejos",
        "controls.best_view": "Mejor vista del punto siguiente",
        "controls.turn_view": "Vista izquierda, derecha",
        "controls.tilt_view": "Vista desde arriba, abajo",
        "controls.zoom_view": "Vista más cerca, más lejos",
        "controls.pause": "Pausa",
        "controls.menu": "Menú",
        "controls.next": "Siguiente",
        "controls.test": "Probar los controles",
        "controls.rebind": "Cambiar los controles",
        "controls.back": "Atrás",
        "experiment.title": "Experimento",
        "experiment.trainee": "Su ID",
        "experiment.trainee help": "Su instructor le da este ID; se guarda con sus ensayos.",
        "experiment.clicked": "Introducir el ID con el ratón",
        "experiment.mode": "Modo",
        "mode.desktop": "Pantalla",
        "mode.hmd": "Visor",
        "experiment.done": "hecho",
        "experiment.task help": "Empezar esta tarea.",
        "experiment.no trainee": "Introduzca primero su ID.",
        "experiment.order": "Primero: {task}.",
        "experiment.trial run first": "Primero: {task}. Toque todos sus puntos, o practique hasta "
        "que se acabe su tiempo.",
        "experiment.tutorial": "Tutorial",
        "experiment.tutorial time": "2 minutos",
        "experiment.tutorial help": "Aprenda a mover el robot, un control tras otro.",
        "experiment.tutorial first": "Primero el tutorial, con el dispositivo que usa ahora: dura "
        "dos minutos.",
        "experiment.study": "Ahora no. {step} Solo su instructor puede saltarse un paso, en 3D "
        "Slicer y con un motivo.",
        # What a study that Slicer leads asks for next.
        "study.questionnaire": "Paso {number} de {count}: responda al cuestionario "
        "{questionnaire}, aquí o donde se ejecuta 3D Slicer.",
        "study.answered": "Sus respuestas a {questionnaire} van de camino a 3D Slicer, que dirá "
        "qué viene después.",
        "study.trial-run": "Paso {number} de {count}: haga la práctica libre {mode} durante "
        "{minutes:g} minutos.",
        "study.trial": "Paso {number} de {count}: haga {task} {mode}.",
        "study.break": "Paso {number} de {count}: descanse al menos {minutes:g} minutos, quedan "
        "{left}. Después, 3D Slicer dirá qué viene.",
        "study.all-done": "Todos los pasos del estudio están hechos. ¡Gracias!",
        "study.repeat": "Paso {number} de {count}: {task} se abandonó. El instructor debe "
        "introducir en 3D Slicer el motivo para repetirla.",
        "study.played": "Hecho: {task}. 3D Slicer dirá qué viene después.",
        "study.desktop": "en la pantalla",
        "study.hmd": "con el visor",
        "study.by landmarks": "por referencias de la cara",
        "study.by surface": "por un trazado en la piel",
        "study.by landmarks-surface": "por referencias y un trazado",
        "experiment.assignments": "Sus objetivos",
        "assignments.title": "Sus objetivos",
        "assignments.back": "Atrás",
        "assignments.with procedure": "{trial}, luego {procedure}",
        "assignments.summary": "{reached} de {count} alcanzados",
        "assignments.reached": "alcanzado",
        "assignments.just reached": "Alcanzado: {assignment}.",
        "assignments.locked": "bloqueado",
        "assignments.count": "{done} / {needed}",
        "assignments.percent": "{done} %",
        "assignments.one trial": "Se alcanza cuando un ensayo tiene {mark:g} puntos o más, dentro "
        "de todos los límites.",
        "assignments.trials": "Se alcanza cuando {needed} ensayos seguidos tienen {mark:g} puntos "
        "o más, dentro de todos los límites.",
        "assignments.competent": "Se alcanza cuando los ensayos muestran competencia (LC-CUSUM); "
        "un ensayo se aprueba con {mark:g} puntos o más.",
        "assignments.no mark": "No hay umbral de aprobado para la puntuación actual: pregunte a "
        "su instructor.",
        "assignments.gate": "Bloqueado. Primero alcance: {assignments}.",
        "assignments.other head": "Esta cabeza no tiene este objetivo: elija otra.",
        "assignments.all reached": "Todos los objetivos están alcanzados.",
        "assignments.next in brief": "Siguiente: {assignment} ({progress})",
        "assignments.next": "Siguiente: {assignment}, su punto más débil.",
        "assignments.next unplayed": "Siguiente: {assignment}, aún sin practicar.",
        "assignments.weakest": "Lo que más puntos cuesta: {part}.",
        "assignments.part time": "el tiempo",
        "assignments.part accuracy": "la precisión",
        "assignments.part common bias": "el sesgo común a todos los toques",
        "assignments.part safety": "el contacto no deseado y la presión",
        "assignments.part target": "el error en el objetivo",
        "assignments.part entry": "el error en la entrada",
        "assignments.part angle": "el ángulo",
        "assignments.part plunge": "taladrar demasiado hondo",
        "assignments.part distance": "muy poca distancia a estructuras prohibidas",
        "experiment.answer": "Responder al cuestionario",
        "questionnaire.text": "{trainee}, responda a cada línea: {lowest} significa {low}, "
        "{highest} significa {high}, si la línea no dice otra cosa. Su instructor tiene el "
        "formulario con el texto completo.",
        "questionnaire.ends": "{topic}: {lowest} = {low}, {highest} = {high}",
        "questionnaire.open": "Algunas líneas aún no tienen respuesta.",
        "questionnaire.keep": "Hecho",
        "questionnaire.back": "Atrás, sin respuestas",
        **_ITEMS,
        **_FEEDBACK,
        "experiment.trend": "Sus puntuaciones en este modo; la línea es el umbral de aprobado, "
        "{mark:.0f}.",
        "experiment.trend in study": "Sus puntuaciones en este modo.",
        "experiment.scores": "Puntuaciones, de la más antigua a la más reciente: {scores}.",
        "experiment.method": "Registro",
        "experiment.method help": "Con qué se registra la cabeza en el próximo ensayo. Las "
        "referencias no están marcadas en la piel: encuéntrelas por su nombre.",
        "method.fiducials": "fiduciales",
        "method.landmarks": "referencias de la cara",
        "method.surface": "trazado en la piel",
        "method.landmarks-surface": "referencias y un trazado",
        "experiment.procedure": "Después de los toques",
        "experiment.procedure help": "Qué sigue al registro: nada, o un procedimiento en el que "
        "sirve para colocar un instrumento. La práctica libre no tiene ninguno.",
        "experiment.touches alone": "Nada más",
        "experiment.scenario": "Cabeza",
        "experiment.back": "Atrás",
        "scenario.title": "Cabezas",
        "scenario.text": "¿Con qué cabeza quiere entrenar?",
        "scenario.looking": "Buscando cabezas.",
        "scenario.help": "Entrenar con esta cabeza a partir de ahora.",
        "scenario.loading": "se está cargando",
        "scenario.present": "en uso",
        "scenario.back": "Atrás",
        "task.trial-run": "Práctica libre",
        "task.task-1": "Tarea 1",
        "task.task-2": "Tarea 2",
        "task.task-3": "Tarea 3",
        "task.task-4": "Tarea 4",
        "task.task-5": "Tarea 5",
        "clicked-id.title": "Su ID",
        "clicked-id.delete": "Borrar",
        "clicked-id.done": "Hecho",
        "character.back": "Atrás",
        "pin.title": "PIN del instructor",
        "pin.text": "Desbloquea la configuración, el orden de las tareas y el paso del control, "
        "hasta que cambie el participante o empiece un ensayo.",
        "pin.too short": "Un PIN tiene de 6 a 12 cifras.",
        "pin.delete": "Borrar",
        "pin.unlock": "Desbloquear",
        "pin.cancel": "Cancelar",
        "pin.unlocked": "Desbloqueado hasta que cambie el participante o empiece un ensayo.",
        "pin.wrong": "Este no es el PIN de este puesto.",
        "pin.wait": "Hubo demasiados PIN erróneos: espere {seconds} s.",
        "keyboard.title": "Su ID",
        "keyboard.row": "Escribir",
        "keyboard.delete": "Borrar",
        "keyboard.done": "Hecho",
        "trial.title": "{task}",
        "trial.paused": "{trainee}, el ensayo está en pausa con {kept} puntos tocados. Su reloj "
        "está parado.",
        "trial.complete": "{trainee}, los {kept} puntos están tocados.",
        "trial.paused trace": "{trainee}, el ensayo está en pausa con {traced} puntos trazados. Su "
        "reloj está parado.",
        "trial.complete trace": "{trainee}, {traced} puntos están trazados.",
        "trial.resume": "Reanudar",
        "trial.register": "Registrar",
        "trial.controls": "Controles",
        "trial.settings": "Configuración",
        "trial.finish": "Terminar la práctica libre",
        "trial.abort": "Abandonar la tarea",
        "abort.title": "¿Abandonar la tarea?",
        "abort.text": "{trainee}, sus {kept} puntos tocados no se registrarían.",
        "abort.keep": "Continuar",
        "abort.abort": "Abandonar",
        "practice.title": "El tiempo de práctica ha terminado",
        "practice.text": "{trainee}, puede empezar ahora la tarea 1, o seguir practicando.",
        "practice.study": "{trainee}, termine la práctica libre para continuar el estudio, o siga "
        "practicando.",
        "practice.finish": "Terminar la práctica libre",
        "practice.resume": "Seguir practicando",
        "complete.title": "Todos los puntos están tocados",
        "complete.text": "{trainee}, registre sus {count} puntos para que se puntúen. Después ya "
        "no se pueden cambiar.",
        "complete.register": "Registrar",
        "complete.undo": "Deshacer el último toque",
        "complete.abort": "Abandonar la tarea",
        "match.title": "¿Aceptar este ajuste?",
        "match.looking": "El trazado se está ajustando a la piel …",
        "match.impossible": "El trazado no se puede ajustar: {reason} Siga trazando, o deshaga "
        "trazos.",
        "match.residual and error": "El residuo es la distancia del trazado a la piel. El error es "
        "la distancia del objetivo al lugar donde parece estar. Un residuo pequeño no significa un "
        "error pequeño. Una vez aceptado, los puntos no se pueden cambiar.",
        "match.residual": "Residuo",
        "match.counts": "Puntos que cuentan",
        "match.interval": "Intervalo del 95 % de ese error",
        "match.interval value": "de {low:.2f} a {high:.2f} mm",
        "match.slides": "El ajuste puede deslizarse: la cabeza puede estar desviada hasta "
        "{slide:.1f} mm, por pequeño que sea el residuo. Trace lugares orientados de otro modo, "
        "como nariz, cejas, sienes y mejillas.",
        "match.several-minima": "El trazado se ajusta en varios lugares. Trace más de la cara.",
        "match.not-converged": "El ajuste no se había estabilizado al detenerse. Trace más de la "
        "cara.",
        "match.few-inliers": "Muchos puntos no están en la piel. Mantenga la punta en la piel "
        "mientras traza.",
        "match.far-points": "Algunos puntos están lejos de la piel y no cuentan.",
        "match.poor-fit": "El trazado no se ajusta a esta cabeza. ¿Se intercambiaron referencias?",
        "match.accept": "Aceptar y registrar",
        "match.draw": "Seguir trazando",
        "waiting.title": "Registrado",
        "waiting.slicer": "{trainee}, 3D Slicer está puntuando sus puntos.",
        "waiting.nobody": "{trainee}, sus puntos están guardados. 3D Slicer no está conectado; los "
        "puntuará en cuanto lo esté.",
        "waiting.own": "{trainee}, 3D Slicer no está conectado: el propio simulador está "
        "registrando y puntuando sus puntos.",
        "waiting.problem": "El simulador no puede puntuarlos por sí mismo: {reason}",
        "result.own": "Esta puntuación es del simulador y no se guarda en ningún estudio. Cuando "
        "3D Slicer se conecte, puntuará y guardará el ensayo, y su puntuación sustituirá a esta.",
        "result.title": "{trainee}: {task}",
        "result.score": "Puntuación",
        "result.fre": "Error de registro (FRE)",
        "result.expected tre": "Error esperado en el objetivo (TRE)",
        "result.interval note": "El error esperado supone errores de toque independientes, sin "
        "sesgo y de igual tamaño. No detecta un desplazamiento común a todos los toques.",
        "result.true tre": "Error verdadero en el objetivo (TRE)",
        "result.region tre": "Error verdadero en el cerebro (TRE)",
        "result.common bias": "Sesgo común a todos los toques",
        "result.unacceptable score": "{score:.0f} / 100, no aceptable",
        "result.not accurate": "No aceptable: un instrumento guiado por este registro no acertaría "
        "en su objetivo. El error verdadero en el cerebro supera el límite.",
        "result.not unbiased": "No aceptable: todos los toques están desplazados en la misma "
        "dirección, más allá del límite.",
        "result.not safe": "No aceptable: la herramienta estuvo demasiado tiempo sobre la cabeza o "
        "se hundió demasiado.",
        "result.ctps": "CTPS",
        "result.of 100": "{score:.0f} / 100",
        "result.mm": "{error:.2f} mm",
        "result.points": "{points:.1f}",
        "result.time": "Tiempo",
        "result.repeated": "Toques rechazados / deshechos",
        "result.next": "Siguiente: {task}",
        "result.again": "Otra vez: {task}",
        "result.replay": "Volver a ver el ensayo",
        "result.errors": "Mostrar los errores en la cabeza",
        "result.procedure": "Errores del procedimiento",
        "procedure.title.verifying": "Comprobar el registro",
        "procedure.title.aligning": "Alinear la guía",
        "procedure.title.drilling": "Perforar",
        "procedure.title.inserting": "Insertar el instrumento",
        "procedure.accept": "Aceptar el registro",
        "procedure.accept help": "Desde entonces, el plan se muestra según él.",
        "procedure.again": "Repetir el registro",
        "procedure.again help": "Toque otra vez los quince puntos.",
        "procedure.waits": "Los puntos aún se están registrando.",
        "procedure.lock": "Bloquear la guía",
        "procedure.lock help": "Desde entonces, el brazo está sujeto y la broca está en la guía.",
        "procedure.align": "Dejar que el robot alinee la guía",
        "procedure.align help": "Lleva la guía a la trayectoria planificada, como la muestra su "
        "registro. Un stick lo detiene.",
        "procedure.insert": "Insertar el instrumento",
        "procedure.insert help": "Se saca la broca; el instrumento empieza en la punta de la guía.",
        "procedure.retract": "Sacar la broca y alinear de nuevo",
        "procedure.retract help": "Posible hasta que la broca haya cortado hueso.",
        "procedure.release": "Soltar el instrumento",
        "procedure.release help": "Se queda donde está; sigue la próxima trayectoria, o la "
        "puntuación.",
        "procedure.work": "Volver al trabajo",
        "procedure-errors.title": "Errores: {name}",
        "procedure-errors.text": "Respecto a la verdad. Entre paréntesis: lo que causó el registro "
        "/ lo que causó la mano. Estas longitudes no se suman: ambas pueden compensarse.",
        "procedure-errors.trajectory": "Trayectoria",
        "procedure-errors.lines": "Mostrar las trayectorias en la cabeza",
        "procedure-errors.back": "Atrás",
        "procedure-errors.score": "Puntuación del procedimiento",
        "procedure-errors.rms": "Error en el punto objetivo (RMS)",
        "procedure-errors.target": "Error en el punto objetivo",
        "procedure-errors.entry": "Error en el punto de entrada",
        "procedure-errors.radial": "Error radial",
        "procedure-errors.depth": "Error de profundidad",
        "procedure-errors.angle": "Desviación angular",
        "procedure-errors.plunge": "Sobrepaso de la broca",
        "procedure-errors.touches": "Puntuación de los toques",
        "procedure-errors.split mm": "{error:.2f} mm ({registration:.2f} / {hand:.2f})",
        "procedure-errors.split deg": "{error:.1f}° ({registration:.1f} / {hand:.1f})",
        "procedure-errors.no inner table": "al lado de la tabla interna",
        "procedure-errors.kept": "a {distance:.1f} mm",
        "procedure-errors.hit": "alcanzado",
        "procedure-lines.title": "Verde: plan. Amarillo: según su registro. Azul: colocado.",
        "procedure-lines.back": "Atrás",
        "errors.title": "Sus errores, {longer:.0f} veces más largos: verde hasta {good:.0f} mm, "
        "rojo desde {poor:.0f} mm",
        "errors.back": "Atrás",
        "result.worst": "Mostrar el peor toque",
        "result.menu": "Menú del experimento",
        # The tutorial: {control} is what the trainee presses or pushes, such as "Left stick up".
        "tutorial.title": "Tutorial",
        "tutorial.place": "Paso {step} de {steps}",
        "tutorial.done mm": "{done} de {goal} mm",
        "tutorial.done degrees": "{done} de {goal}°",
        "tutorial.done points": "{done} de {goal} puntos",
        "tutorial.homing": "El robot va al lugar donde usted empieza.",
        "tutorial.right": "Mueva la herramienta 30 mm a la derecha: {control}.",
        "tutorial.left": "30 mm a la izquierda: {control}.",
        "tutorial.forward": "30 mm adelante, alejándose de usted: {control}.",
        "tutorial.forward.robot": "30 mm adelante, según está el robot: {control}.",
        "tutorial.back": "30 mm atrás, hacia usted: {control}.",
        "tutorial.back.robot": "30 mm atrás, según está el robot: {control}.",
        "tutorial.up": "30 mm arriba: {control}.",
        "tutorial.down": "30 mm abajo: {control}.",
        "tutorial.slow": "Mantenga {control} y mueva la herramienta 10 mm: cerca de la piel debe "
        "ir despacio.",
        "tutorial.slow.touch screen": "Pulse {control} y mueva la herramienta 10 mm: cerca de la "
        "piel debe ir despacio. Pulse otra vez para ir rápido.",
        "tutorial.slow.mouse": "Haga clic en {control} y mueva la herramienta 10 mm: cerca de la "
        "piel debe ir despacio. Haga clic otra vez para ir rápido.",
        "tutorial.turn view": "Gire la vista 20°: {control}.",
        "tutorial.turn view.keyboard": "Gire la vista 20°: {control}, o arrastre con el botón "
        "derecho del ratón.",
        "tutorial.turn view.mouse": "Gire la vista 20°: arrastre con el botón derecho del ratón.",
        "tutorial.turn view.touch screen": "Gire la vista 20°: arrastre un dedo por la imagen.",
        "tutorial.look around": "Gire la cabeza hacia un lado y empuje el stick izquierdo: sus "
        "direcciones giran con usted.",
        "tutorial.best view": "Mejor vista del punto {point}: {control}.",
        "tutorial.lower": "Baje la punta al punto {point}: el anillo se cierra y se pone verde en "
        "la piel.",
        "tutorial.touch": "Guarde el toque: {control}. Solo cuentan los toques a menos de 10 mm "
        "del punto.",
        "tutorial.undo": "Cualquiera tiene un desliz. Deshaga el toque: {control}.",
        "tutorial.pause": "Abra el menú: {control}. Mientras tanto todo espera; después reanude.",
        "tutorial.guided": "Ahora toque {count} puntos, cada uno con la mayor exactitud posible. "
        "El primero es el punto {point}.",
        "tutorial.praise": "Bien hecho.",
        "tutorial.recorded": "Guardado, a {error:.1f} mm del punto.",
        "tutorial.touched": "Punto {label}: desviación de {error:.1f} mm. Ahora toque el punto "
        "{point}.",
        "tutorial.head is gone": "El tutorial ha terminado: otra cabeza está en uso.",
        "tutorial is open": "{trainee} está haciendo el tutorial: deje que termine, o salga de él "
        "en el menú del simulador.",
        "tutorial.paused": "El tutorial espera en el paso {step} de {steps}.",
        "tutorial.resume": "Continuar",
        "tutorial.controls": "Controles",
        "tutorial.restart": "Empezar de nuevo",
        "tutorial.leave": "Salir del tutorial",
        "tutorial.skip": "Saltar el tutorial",
        "tutorial.mm": "{error:.1f} mm",
        "tutorial-done.title": "Ya sabe manejar el robot",
        "tutorial-done.text": "{trainee}, lo siguiente es la práctica libre: quince puntos para "
        "practicar mientras dure su tiempo.",
        "tutorial-done.time": "Tiempo",
        "tutorial-done.first": "Error de su primer toque",
        "tutorial-done.touches": "Errores de los tres últimos",
        "tutorial-done.trial-run": "Empezar la práctica libre",
        "tutorial-done.again": "Repetir el tutorial",
        "tutorial-done.menu": "Menú del experimento",
        # Settings.
        "settings.title": "Configuración",
        "settings.back": "Atrás",
        "settings.unlock": "PIN del instructor",
        "settings.lock": "Bloquear de nuevo",
        "settings.locked": "Bloqueado: un instructor introduce abajo el PIN.",
        "settings.waits": "Esto no se puede cambiar hasta que termine el ensayo.",
        "settings.language": "Idioma",
        "settings.language help": "Idioma de todas las pantallas.",
        "settings.language.en": "English",
        "settings.language.de": "Deutsch",
        "settings.language.fr": "Français",
        "settings.language.es": "Español",
        "settings.language.zh-Hans": "简体中文",
        "settings.volume": "Volumen",
        "settings.volume help": "Volumen de todos los sonidos.",
        "settings.muted": "Silencio",
        "settings.muted help": "Apagar todos los sonidos.",
        "settings.muted.yes": "Sí",
        "settings.muted.no": "No",
        "settings.speech": "Lectura en voz alta",
        "settings.speech help": "La página y el visor leen instrucciones, avisos y menús "
        "con la voz del navegador.",
        "settings.speech.yes": "Sí",
        "settings.speech.no": "No",
        "settings.order": "Orden de las tareas",
        "settings.order help": "Si las tareas deben hacerse en su orden. Los instructores lo "
        "cambian con su PIN o en el archivo {file}.",
        "settings.order.fixed": "Una tras otra",
        "settings.order.any": "Cualquiera",
        "settings.coarse": "Velocidad",
        "settings.coarse help": "Velocidad de la punta con un stick empujado a fondo.",
        "settings.fine": "Velocidad lenta",
        "settings.fine help": "Velocidad de la punta mientras se mantiene el control del "
        "movimiento lento.",
        "settings.axes": "Direcciones",
        "settings.axes help": "Si la derecha, adelante y arriba son las de la vista o las del "
        "robot.",
        "settings.axes.camera": "Como las muestra la vista",
        "settings.axes.robot": "Como está el robot",
        "settings.touch": "Un toque cuenta",
        "settings.touch help": "Solo en la piel, o en cualquier lugar a menos de 10 mm del punto, "
        "como en el estudio publicado. Consta en la grabación.",
        "settings.self_alignment": "Guía alineada por el robot",
        "settings.self_alignment help": "Si el robot puede llevar por sí mismo la guía de un "
        "procedimiento a la trayectoria planificada, como los robots clínicos.",
        "settings.self_alignment.yes": "A petición",
        "settings.self_alignment.no": "Nunca",
        "settings.touch.on skin": "En la piel",
        "settings.touch.within radius": "A menos de 10 mm",
        "settings.view": "Mejor vista del punto siguiente",
        "settings.view help": "Si la vista gira automáticamente hacia cada punto siguiente "
        "mientras los sticks están sueltos. Consta en la grabación. El control de la mejor vista "
        "funciona siempre.",
        "settings.view.practice": "Salvo en estudios",
        "settings.view.always": "Automática",
        "settings.view.never": "Solo a petición",
        "settings.guidance": "Guiado al punto siguiente",
        "settings.guidance help": "Direcciones en palabras, una flecha o ninguna de las dos; al "
        "trazar la piel, también qué está cubierto y dónde seguir. Un estudio puede fijar el suyo. "
        "Consta en la grabación.",
        "settings.guidance.fading": "Menos de tarea en tarea",
        "settings.guidance.words": "Palabras y flecha",
        "settings.guidance.arrow": "Flecha",
        "settings.guidance.none": "Ninguno",
        "settings.ghost": "Fantasma junto al brazo",
        "settings.ghost help": "Muestra la herramienta de un ensayo anterior de la misma tarea, "
        "según el tiempo desde el inicio. Ninguno en los estudios, salvo que su protocolo lo "
        "prevea. Consta en la grabación. El ID del experto está en el archivo {file}.",
        "settings.ghost.off": "Ninguno",
        "settings.ghost.own best": "Su mejor ensayo",
        "settings.ghost.expert": "El mejor ensayo del experto",
        "ghost.none": "Sin fantasma: aún no hay ningún ensayo aceptable de esta tarea que mostrar.",
        "settings.tutorial": "Tutorial",
        "settings.tutorial help": "Si la práctica libre lo espera. Un estudio puede fijar el suyo. "
        "Los instructores lo cambian con su PIN o en el archivo {file}.",
        "settings.tutorial.required": "Antes de la práctica libre",
        "settings.tutorial.optional": "Se puede saltar",
        "settings.tutorial.skipped": "Ninguno",
        "settings.direction": "Dirección de la herramienta",
        "settings.direction help": "Quién decide hacia dónde apunta la herramienta: el brazo, "
        "usted o la piel.",
        "settings.direction.free": "Libre (solo posición)",
        "settings.direction.clear": "Libre, sin rozar la cabeza",
        "settings.direction.held": "Dirigida por usted",
        "settings.direction.normal": "Perpendicular a la piel",
        "settings.direction.pose": "Dirigida por usted, sin giro",
        # Controls: what they do, and what they are called.
        "bindings.title": "Cambiar los controles",
        "bindings.device": "Dispositivo",
        "bindings.preset": "Distribución",
        "bindings.preset.two hands": "Dos manos",
        "bindings.preset.left-handed": "Zurdo",
        "bindings.preset.right alone": "Solo mano derecha",
        "bindings.preset.left alone": "Solo mano izquierda",
        "bindings.preset.own": "Propia",
        "bindings.group": "Controles para",
        "bindings.group.work": "El trabajo",
        "bindings.group.movement": "Mover la herramienta",
        "bindings.group.view": "La vista",
        "bindings.group.menus": "Los menús",
        "bindings.defaults": "Restablecer los controles",
        "bindings.back": "Atrás",
        "bindings.are default": "Todos los controles vuelven a ser los predeterminados.",
        "bindings.changed": "{control}: ahora es {input}.",
        "bindings.impossible": "Estos dos no se pueden intercambiar: uno de ellos haría dos cosas "
        "a la vez.",
        "listen.title": "{control}",
        "listen.gamepad": "Pulse el nuevo botón o empuje el nuevo eje para {control} ({seconds} "
        "s).",
        "listen.keyboard": "Pulse la nueva tecla para {control} ({seconds} s).",
        "listen.cancel": "Cancelar",
        "conflict.title": "Ya está en uso",
        "conflict.text": "{input} ahora es {other}. ¿Intercambiar con {control}?",
        "conflict.exchange": "Intercambiar",
        "conflict.another": "Elegir otra",
        "conflict.cancel": "Cancelar",
        "test.title": "Probar los controles",
        "test.text": "Empuje y pulse todo; cada entrada se muestra y se siente. {menu} vuelve "
        "atrás.",
        "test.back": "Atrás",
        "test.yes": "Sí",
        "test.no": "No",
        "test.nothing": "nada",
        "control.touch": "Tocar",
        "control.undo": "Deshacer",
        "control.camera": "Vista frontal",
        "control.fine": "Lento",
        "control.pause": "Pausa",
        "control.menu": "Menú",
        "control.move_left": "Mover a la izquierda",
        "control.move_right": "Mover a la derecha",
        "control.move_back": "Mover atrás",
        "control.move_forward": "Mover adelante",
        "control.move_down": "Mover abajo",
        "control.move_up": "Mover arriba",
        "control.turn_left": "Girar a la izquierda",
        "control.turn_right": "Girar a la derecha",
        "control.turn_down": "Girar abajo",
        "control.turn_up": "Girar arriba",
        "control.best_view": "Mejor vista",
        "control.view_left": "Vista desde la izquierda",
        "control.view_right": "Vista desde la derecha",
        "control.view_lower": "Vista desde abajo",
        "control.view_higher": "Vista desde arriba",
        "control.view_farther": "Vista desde más lejos",
        "control.view_nearer": "Vista desde más cerca",
        "control.accept": "Aceptar",
        "control.back": "Atrás",
        "control.up": "Arriba",
        "control.down": "Abajo",
        "control.left": "Izquierda",
        "control.right": "Derecha",
        "control.taken": "Ahora controla: {source}.",
        "control.held": "Controla: {source}. Para tomar el control, pulse {menu} tras "
        "{seconds:.0f} s sin entradas.",
        "control.locked": "Controla: {source}. Solo un instructor puede pasar el control: {menu}, "
        "Configuración, PIN del instructor.",
        "control.holder": "Controla: {source}",
        "control.nobody": "Controla: nadie",
        "source.gamepad": "mando",
        "source.keyboard": "teclado",
        "source.mouse": "ratón",
        "source.touch screen": "pantalla táctil",
        "source.browser's gamepad": "mando del navegador",
        "source.headset's controllers": "controladores del visor",
        "device.gamepad": "Mando",
        "device.keyboard": "Teclado",
        "gamepad.a": "A",
        "gamepad.b": "B",
        "gamepad.x": "X",
        "gamepad.y": "Y",
        "gamepad.back": "Botón Back",
        "gamepad.guide": "Botón del logotipo",
        "gamepad.start": "Botón Start",
        "gamepad.leftstick": "Stick izquierdo pulsado",
        "gamepad.rightstick": "Stick derecho pulsado",
        "gamepad.leftshoulder": "LB",
        "gamepad.rightshoulder": "RB",
        "gamepad.dpup": "Cruceta arriba",
        "gamepad.dpdown": "Cruceta abajo",
        "gamepad.dpleft": "Cruceta izquierda",
        "gamepad.dpright": "Cruceta derecha",
        "gamepad.-leftx": "Stick izquierdo a la izquierda",
        "gamepad.+leftx": "Stick izquierdo a la derecha",
        "gamepad.-lefty": "Stick izquierdo arriba",
        "gamepad.+lefty": "Stick izquierdo abajo",
        "gamepad.-rightx": "Stick derecho a la izquierda",
        "gamepad.+rightx": "Stick derecho a la derecha",
        "gamepad.-righty": "Stick derecho arriba",
        "gamepad.+righty": "Stick derecho abajo",
        "gamepad.-lefttrigger": "LT suelto",
        "gamepad.+lefttrigger": "LT",
        "gamepad.-righttrigger": "RT suelto",
        "gamepad.+righttrigger": "RT",
        # Where a headset's controllers differ from a gamepad.
        "headset.fine": "Gatillo",
        "headset.menu": "X",
        "headset.pause": "X",
        "headset.up": "Stick arriba",
        "headset.down": "Stick abajo",
        "headset.left": "Stick a la izquierda",
        "headset.right": "Stick a la derecha",
        "headset.tilt": "Gatillo derecho + stick",
        # What is clicked among the hints while the sticks on the screen are dragged.
        "mouse.touch": "Tocar",
        "mouse.undo": "Deshacer",
        "mouse.camera": "Vista frontal",
        "mouse.best_view": "Mejor vista",
        "mouse.fine": "Lento",
        "mouse.menu": "Menú",
        "mouse.pause": "Menú",
        "mouse.view_left": "Clic derecho y arrastrar a la izquierda",
        "mouse.view_right": "Clic derecho y arrastrar a la derecha",
        # What is written on the buttons that the page has on a touch screen.
        "touch screen.touch": "Tocar",
        "touch screen.undo": "Deshacer",
        "touch screen.camera": "Vista frontal",
        "touch screen.best_view": "Mejor vista",
        "touch screen.fine": "Lento",
        "touch screen.menu": "Pausa",
        "touch screen.pause": "Pausa",
        "touch screen.accept": "Pulsar",
        "touch screen.back": "Atrás",
        "keyboard.Space": "Espacio",
        "keyboard.Enter": "Intro",
        "keyboard.NumpadEnter": "Intro del teclado numérico",
        "keyboard.Backspace": "Retroceso",
        "keyboard.Escape": "Esc",
        "keyboard.Tab": "Tab",
        "keyboard.ShiftLeft": "Mayús izquierda",
        "keyboard.ShiftRight": "Mayús derecha",
        "keyboard.ControlLeft": "Ctrl izquierda",
        "keyboard.ControlRight": "Ctrl derecha",
        "keyboard.AltLeft": "Alt izquierda",
        "keyboard.AltRight": "Alt derecha",
        "keyboard.ArrowLeft": "Flecha izquierda",
        "keyboard.ArrowRight": "Flecha derecha",
        "keyboard.ArrowUp": "Flecha arriba",
        "keyboard.ArrowDown": "Flecha abajo",
        "keyboard.PageUp": "Re Pág",
        "keyboard.PageDown": "Av Pág",
        # While the trainee works.
        "work.complete": "{trainee}, los {count} puntos están tocados. Pulse {touch} para "
        "registrarlos.",
        "work.on skin": "En la piel: pulse {touch}.",
        "work.off the way": "{trainee}, se aparta del camino al punto {point}.",
        "warning.shaft": "El vástago toca la cabeza: levante la herramienta.",
        "warning.elsewhere": "La punta toca la piel fuera del punto: levántela.",
        "warning.pressing": "Hunde la punta {depth:.1f} mm: afloje.",
        "warning.reach": "El brazo no llega más lejos en esta dirección.",
        "warning.obstacle.links": "La cabeza estorba al brazo: vaya por otro lado.",
        "warning.obstacle.self": "El brazo se estorba a sí mismo: cambie de dirección.",
        "warning.obstacle.table": "La mesa estorba al brazo: venga desde arriba.",
        "warning.nobody registers": "Aquí nadie registra los puntos: conecte 3D Slicer.",
        "felt.bone": "La broca está en el hueso.",
        "felt.through": "La broca ha atravesado el hueso: deténgase.",
        "felt.blocked": "El instrumento topa con hueso que no está perforado del todo.",
        "warning.slicer": "Se perdió la conexión con 3D Slicer. Continúe: todo se graba aquí y se "
        "puntúa más tarde.",
        "warning.unplugged": "El mando {name} está desconectado: el robot está parado. Conéctelo "
        "de nuevo o siga con el teclado.",
        "warning.unmapped": "El mando {name} tiene una disposición desconocida: use otro o el "
        "teclado.",
        "warning.no SDL": "En este ordenador no se pueden leer mandos ({reason}): use el teclado.",
        "warning.settings": "{reason} Se usa la configuración predeterminada.",
        # What the window says itself, because the simulator cannot.
        "window.left stick": "Izquierda, derecha, adelante, atrás",
        "window.right stick": "Arriba, abajo, girar",
        "window.title": "RASTrainer",
        "window.connecting": "La ventana se está conectando al simulador.",
        "window.lost": "Se perdió la conexión con el simulador. Se restablecerá en cuanto el "
        "simulador responda.",
        "window.unknown": "El simulador no conoce esta ventana: ciérrela y abra una con el código "
        "de emparejamiento que el simulador muestra ahora.",
        "window.refused": "Está abierto el número máximo de vistas: cierre una.",
        "window.no font": "Este ordenador no tiene ninguna fuente con caracteres chinos, así que "
        "su ventana no puede mostrar el chino: instale una, como WenQuanYi Micro Hei, y vuelva a "
        "iniciar.",
        "window.pairing": "Para emparejar un navegador o un visor: código {code} en {addresses}",
        "status.points": "{kept} de {count} puntos",
        "status.traced": "{traced} de {least}–{most} puntos trazados",
        "coverage": "A menos de {distance} mm de puntos trazados",
        "status.line": "Trayectoria {number} de {count}",
        "status.checkpoint": "{name}: desviación de {error:.1f} mm",
        "status.entry": "Entrada: a {distance:.1f} mm del eje",
        "status.angle": "Ángulo: {angle:.1f}°",
        "status.stand off": "Distancia: {distance:.0f} mm",
        "status.to inner": "{left:.1f} mm hasta la tabla interna",
        "status.past inner": "{past:.1f} mm más allá de la tabla interna",
        "status.to target": "{left:.1f} mm hasta el objetivo",
        "status.past target": "{past:.1f} mm más allá del objetivo",
        "panel.mm": "{value:.1f} mm",
        "panel.deg": "{value:.1f}°",
        "status.left": "quedan {time}",
        "status.point": "Punto {point}",
        "status.next place": "Siguiente",
        "status.near": "{name}: a menos de {distance} mm",
        "status.toward": "{name}: {distance} mm {direction}",
        "way.left": "a la izquierda",
        "way.right": "a la derecha",
        "way.back": "atrás",
        "way.forward": "adelante",
        "way.down": "abajo",
        "way.up": "arriba",
        "hint.move": "Mover",
        "hint.up_and_down": "Arriba, abajo",
        "hint.touch": "Tocar",
        "hint.register": "Registrar",
        "hint.trace": "Empezar o terminar un trazo",
        "hint.undo": "Deshacer",
        "hint.fine": "Lento",
        "hint.best_view": "Mejor vista",
        "hint.on": "sí",
        "hint.off": "no",
        "hint.mouse": "Ratón",
        "hint.sticks": "Mostrar sticks",
        "hint.hide sticks": "Ocultar sticks",
        "hint.right stick": "Stick derecho",
        "hint.turn_view": "Girar la vista",
        "hint.camera": "Cámara",
        "hint.front": "Vista frontal",
        "hint.menu": "Menú",
        "hint.choose": "Elegir",
        "hint.accept": "Aceptar",
        "hint.back": "Atrás",
        "hint.play": "Reproducir, pausa",
        "hint.seek": "5 s atrás, adelante",
        "hint.worst": "Peor toque",
        "hint.end": "Terminar",
        "hint.rate": "Evaluar",
        "rating.replay": "Repetición {number} de {count}: véala y después evalúela",
        "rating.title": "{form}: {domain}",
        "rating.text": "Repetición {number} de {count}. 1 es la peor nota, 5 la mejor; 2 y 4 están "
        "entre las frases.",
        "rating.mark": "{mark}: {sentence}",
        "rating.undo": "Deshacer la última nota",
        "rating.watch": "Ver otra vez la repetición",
        "rating.previous": "La repetición anterior",
        "rating.next": "Repetición siguiente",
        "rating.leave": "Salir; todas las notas se conservan",
        "rated.title": "La repetición {number} de {count} está evaluada",
        "rated.text": "{rated} de {count} repeticiones están evaluadas.",
        "rated.all": "Las {count} repeticiones están evaluadas",
        "rated.all text": "Gracias. {rated} de {count} repeticiones están evaluadas; el informe "
        "del estudio dice en qué medida coinciden los evaluadores.",
        "rating-loading.title": "Repetición {number} de {count}",
        "rating-loading.text": "Se está cargando la repetición.",
        "rate.gears_depth": "Percepción de la profundidad",
        "rate.gears_depth.low": "Yerra la profundidad una y otra vez; muy lejos o hundido",
        "rate.gears_depth.middle": "La profundidad falla a veces y se corrige enseguida",
        "rate.gears_depth.high": "Se detiene directamente en la piel",
        "rate.gears_efficiency": "Eficiencia",
        "rate.gears_efficiency.low": "Rodeos y pausas; apenas avanza",
        "rate.gears_efficiency.middle": "Sin prisa, casi siempre hacia la meta",
        "rate.gears_efficiency.high": "Derecho a cada meta, sin dudar",
        "rate.gears_force": "Sensibilidad a la fuerza",
        "rate.gears_force.low": "Presiona o arrastra repetidamente sobre la piel",
        "rate.gears_force.middle": "Toca a veces con demasiada fuerza",
        "rate.gears_force.high": "Cada toque es ligero",
        "rate.gears_control": "Dominio del robot",
        "rate.gears_control.low": "El brazo va adonde no debe, o a tirones",
        "rate.gears_control.middle": "Casi siempre como se quiere; alguna postura desfavorable",
        "rate.gears_control.high": "El brazo va con suavidad, siempre en buena postura",
        "rate.osats_tissue": "Respeto por los tejidos",
        "rate.osats_tissue.low": "Muchos contactos innecesarios o demasiado profundos",
        "rate.osats_tissue.middle": "Cuidadoso, con algunos deslices",
        "rate.osats_tissue.high": "Solo los contactos que la tarea necesita",
        "rate.osats_motion": "Tiempo y movimientos",
        "rate.osats_motion.low": "La mayoría de los movimientos no sirve de nada",
        "rate.osats_motion.middle": "Algunos movimientos podrían evitarse",
        "rate.osats_motion.high": "Nada podría evitarse",
        "rate.osats_handling": "Manejo del instrumento",
        "rate.osats_handling.low": "La herramienta se lleva con inseguridad",
        "rate.osats_handling.middle": "Llevada con seguridad, pero sin soltura",
        "rate.osats_handling.high": "Llevada con fluidez y precisión",
        "rate.osats_flow": "Desarrollo y planificación",
        "rate.osats_flow.low": "Se detiene como si no conociera el paso siguiente",
        "rate.osats_flow.middle": "Avanza con regularidad, anticipándose un poco",
        "rate.osats_flow.high": "Cada gesto prepara el siguiente",
        "hint.checkpoint": "Tocar el punto de control",
        "hint.next step": "Paso siguiente",
        "hint.feed": "Avanzar, retroceder",
        "hint.turn": "Girar",
        "hint.tilt": "Inclinar",
        "hint.result": "Resultado",
        "replay.title": "{task} de {trainee}, otra vez",
        "replay.worst": "Punto {point}, el peor toque, a media velocidad",
        "replay.paused": "En pausa",
        "replay.loading": "Se está cargando su ensayo",
        "replay.back": "Volver al resultado",
        "replay.no worst": "No se puede determinar el peor toque de este ensayo.",
        "replay.no journal": "El ensayo no se puede volver a mostrar: su diario ya no está en la "
        "carpeta de grabaciones.",
        # What a learning platform's users read after a launch.
        "lti.you are": "Su seudónimo en el simulador",
        "lti.what to do": "Qué hacer",
        "lti.go": "Vaya a un simulador de su laboratorio y haga que elijan {pseudonym} en 3D "
        "Slicer, en «Trainees».",
        "lti.play": "Haga {task} {mode}, tantas veces como quiera.",
        "lti.any task": "cualquier tarea",
        "lti.any mode": "en la pantalla o con el visor",
        "lti.return": "Abra de nuevo el enlace en su curso para ver aquí sus nuevas puntuaciones.",
        "lti.scores": "Sus ensayos",
        "lti.seconds": "{seconds:.0f} s",
        "lti.no trials": "Todavía no hay ninguno que cuente para este enlace.",
        "lti.grade best": "Su mejor puntuación aceptable se envía a su curso: {score:.1f} / 100.",
        "lti.grade latest": "La puntuación de su último ensayo aceptable se envía a su curso: "
        "{score:.1f} / 100.",
        "lti.no grade yet": "Su curso recibirá una calificación en cuanto un ensayo sea aceptable.",
        "lti.no grade": "Este enlace no devuelve ninguna calificación al curso.",
        "lti.data": "Sus datos",
        "lti.data text": "{platform} recibe como mucho su calificación y el momento de su envío. "
        "Este laboratorio guarda su identificador de usuario en {platform} junto con su seudónimo "
        "en un archivo privado, pero ni su nombre ni su correo electrónico. En el laboratorio se "
        "le pregunta si sus ensayos pueden usarse para la investigación.",
        "lti.no learner": "Usted no participa en este curso como alumno, por lo que no recibe "
        "seudónimo ni calificación.",
        "lti.link works": "El enlace funciona y las calificaciones pueden devolverse al curso.",
        "lti.refused": "Este inicio no se puede usar",
        "lti.refused help": "Abra de nuevo el enlace en su curso. Si vuelve a ver esta página, "
        "muestre lo que sigue a quienes llevan el curso o el simulador.",
        "decimal sign": ",",
        "list separator": ", ",
    }
)
