"""All texts of the simulator in English; translations have the same keys."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rastrainer.study.protocol.questionnaires import QUESTIONNAIRES
from rastrainer.trial import wording

_ITEMS: Mapping[str, str] = {
    **{item.name: item.topic for asked in QUESTIONNAIRES.values() for item in asked.items},
    **{
        f"{item.name}.{end}": word
        for asked in QUESTIONNAIRES.values()
        for item in asked.items
        for end, word in zip(("low", "high"), item.anchors, strict=False)
    },
    **{f"{asked.name}.low": asked.anchors[0] for asked in QUESTIONNAIRES.values()},
    **{f"{asked.name}.high": asked.anchors[1] for asked in QUESTIONNAIRES.values()},
}
"""What questionnaires ask about, by the items' names; the published wording is its authors'."""

_FEEDBACK: Mapping[str, str] = {f"feedback.{key}": text for key, text in wording.ENGLISH.items()}
"""Slicer sends a trial's feedback as keys and values, for others as English sentences."""

ENGLISH: Mapping[str, str] = MappingProxyType(
    {
        # What the trainee reads at the top of the picture.
        "idle": "Choose a task to start.",
        "start": "{trainee}, touch point {point}.",
        "touched": "{trainee}, point {label} is recorded. Now touch point {point}.",
        "undone": "{trainee}, point {label} was undone. Touch it again.",
        "complete": "{trainee}, all {count} points are touched. Register them now.",
        "paused": "{trainee}, the trial is paused. Resume when you are ready.",
        "resumed": "{trainee}, continue with point {point}.",
        "registered": "{trainee}, your points are being registered and scored.",
        "scored": "{trainee}, your score is {score:.0f} of 100: {fre:.2f} mm registration error, "
        "{tre:.2f} mm true error at the target.",
        "aborted": "{trainee}, the trial was aborted. Choose a task to start again.",
        # A procedure, from the registration to the placed instrument.
        "verifying": "{trainee}, your points are being registered.",
        "verify": "{trainee}, your points are registered: FRE {fre:.2f} mm. Touch checkpoints, "
        "then accept the registration or register again.",
        "checked": "{trainee}, {name} is {error:.1f} mm off by your registration. Check another "
        "point, accept the registration, or register again.",
        "register again": "{trainee}, touch all points again. Begin with point {point}.",
        "align": "{trainee}, bring the guide onto the planned line of {name}, then lock it.",
        "align next": "{trainee}, the instrument is placed. Now bring the guide onto the planned "
        "line of {name}.",
        "drill": "{trainee}, the guide is locked. Drill through the skull along {name}.",
        "realign": "{trainee}, the drill is out. Bring the guide onto the planned line of {name} "
        "again.",
        "insert": "{trainee}, advance the instrument to the target of {name}, then release it.",
        "procedure done": "{trainee}, the procedure is done and is being scored.",
        "interrupted procedure": "{trainee}, this trial was interrupted; everything is kept. "
        "Continue the procedure when you are ready, or abort it.",
        # What a procedure does not allow.
        "no checkpoints": "This procedure has no checkpoints: AcceptRegistration or RegisterAgain.",
        "too many checkpoints": "{most} checkpoints are touched, the most that a trial keeps: "
        "AcceptRegistration or RegisterAgain.",
        "too many attempts": "The points were registered {most} times, the most that a trial "
        "keeps: AcceptRegistration, or Abort.",
        "too far from checkpoints": "No checkpoint is here: {name}, the nearest by your "
        "registration, is {distance:.1f} mm away; one counts within {radius:g} mm.",
        "above a checkpoint": "{height:.1f} mm above the skin: lower the tip onto the checkpoint.",
        "not in use yet": "The points are still being registered: UseRegistration comes first.",
        "already in use": "Another registration is in use: AcceptRegistration or RegisterAgain.",
        "not rigid": "UseRegistration needs a rigid transform: WorldToHead, row by row, in mm.",
        "off the head": "The guide's axis does not meet the head: point it at the head before "
        "LockGuide.",
        "too far to lock": "The guide's tip is {distance:.0f} mm from the skin along its axis: "
        "LockGuide needs at most {limit:.0f} mm.",
        "no self-alignment": "The robot does not align the guide by itself in this setting: move "
        "it onto the line by hand.",
        "line out of reach": "The robot cannot hold the guide on this line with a stand-off of "
        "{stand_off:g} mm: choose another stand-off, or move it by hand.",
        "bone is cut": "The drill has cut bone: the hole stays where it is. Feed the drill, then "
        "StartInsertion.",
        "nothing drilled": "Nothing is drilled yet: Feed the drill before StartInsertion.",
        "still in the guide": "The instrument is still in the guide: Feed it before "
        "ReleaseInstrument.",
        # Touches that do not count.
        # How far is not said: pressing Touch again and again would replace looking.
        "too far": "Too far from point {point}: a touch counts within {radius:g} mm.",
        "above the skin": "{height:.1f} mm above the skin: lower the tip onto point {point}.",
        "wrong point": "Wrong point: that is point {label}, {nearest:.1f} mm away; point {point} "
        "is next.",
        # Commands in the wrong phase.
        "no trial": "No trial is running: begin one with StartTask.",
        "another trial is open": "That trial is over. The one that is open now, {task} of "
        "{trainee}, was not aborted.",
        "trial is open": "{trainee} is still doing {task}: Register or Abort it before StartTask.",
        "procedure is open": "{trainee} is still at the procedure after {task}: finish or Abort it "
        "before StartTask.",
        "not at the procedure": "This comes after Register, in a trial that StartTask began with a "
        "procedure.",
        "verifying now": "The registration is being verified: Capture checkpoints, then "
        "AcceptRegistration or RegisterAgain.",
        "aligning now": "The guide is being aligned: move it onto the planned line, then "
        "LockGuide.",
        "drilling now": "The drill is in the guide and the arm is held: Feed the drill, then "
        "StartInsertion.",
        "inserting now": "The instrument is in the guide and the arm is held: Feed it to its "
        "target, then ReleaseInstrument.",
        "not all touched": "{kept} of {count} points are touched: Register comes after the last; "
        "point {point} is next.",
        "not paused": "The trial is not paused: Capture point {point}, or Pause it first.",
        "is paused": "The trial is paused: Resume it first.",
        "already paused": "The trial is paused already: Resume or Abort it.",
        "all touched": "All {count} points are touched: Register them, or Undo the last one.",
        "is registered": "The trial is registered and stored: StartTask begins the next one.",
        "nothing to undo": "No point is touched yet: Capture point {point} first.",
        "not registered": "The trial is not registered yet: Capture its {count} points and "
        "Register them first.",
        "no registration": "The trial has no registration yet: SubmitRegistration comes before "
        "TrialScored.",
        "registration is final": "This registration is final: the true error has been revealed, "
        "so no other one is accepted.",
        "no such trial": "There is no trial {trial_id} here: GetTrial, SubmitRegistration and "
        "TrialScored take the ID that StartTask returned.",
        "not a simulation command": "{command} is not a command of the simulation.",
        # When the record cannot be written.
        "not recorded": "The trial cannot be recorded ({reason}). What was not recorded does not "
        "count; make room or choose another folder, then resume.",
        # When the simulator had ended in the middle of a trial and is there again.
        "interrupted": "{trainee}, this trial was interrupted; {kept} of {count} points are kept. "
        "Continue with point {point} when you are ready, or abort it.",
        "interrupted complete": "{trainee}, this trial was interrupted; all {count} points are "
        "kept. Register them now.",
        # When nobody could see the trial, which pauses it.
        "unseen.left": "Paused: the view that showed the trial was closed or lost.",
        "unseen.unplugged": "Paused: the gamepad was unplugged.",
        "unseen.hidden": "Paused: the trial was out of sight.",
        "unseen.still": "Paused: the picture stood still for some seconds, because this computer "
        "was too busy to draw it. If that happens again, close other programs.",
        # The simulator's menus.
        "start.title": "RASTrainer",
        "start.text": "Train robot-assisted patient registration on a virtual KUKA LBR iiwa 7. "
        "Not for clinical use.",
        "start.train": "Start training",
        "start.introduction": "Introduction",
        "start.controls": "Controls",
        "start.settings": "Settings",
        "start.quit": "Quit",
        "quit.title": "Quit RASTrainer?",
        "quit.text": "The simulator ends for everyone who is connected to it.",
        "quit.stay": "Stay",
        "quit.leave": "Quit",
        "introduction.title.1": "What you train",
        "introduction.text.1": "Before a robot can help in brain surgery, it has to know where "
        "the head lies. You show it: with the robot's tool you touch fifteen numbered points on "
        "the head, one after the other, as accurately as you can.",
        "introduction.title.2": "How a task goes",
        "introduction.text.2": "Follow the numbers and the arrows on the skin from point 1 to "
        "point 15. Within 20 mm of the head a tone sounds, and a ring around the tip closes as "
        "you come nearer. It turns green where a touch counts: record the point there. Red means "
        "that something is wrong. A slip can be undone.",
        "introduction.title.3": "What you get",
        "introduction.text.3": "After the last point you register: 3D Slicer matches your points "
        "with the MRI and shows you the error and your score. Accuracy and time both count. You "
        "begin with a tutorial of two minutes and five minutes of free practice, then come Tasks "
        "1 to 5.",
        "introduction.sheet": "Page {sheet} of {sheets}",
        "introduction.next": "Next",
        "introduction.skip": "Skip to the controls",
        "introduction.back": "Back",
        "controls.title": "Controls",
        "controls.text": "The gamepad, the keyboard and a headset's controllers all do the same.",
        "controls.move_along": "Move forward, back",
        "controls.move_across": "Move left, right",
        "controls.move_vertically": "Move up, down",
        "controls.fine": "Move slowly (hold)",
        "controls.touch": "Record a touch",
        "controls.undo": "Undo the last touch",
        "controls.camera": "View from the front: near or far",
        "controls.best_view": "Best view of the next point",
        "controls.turn_view": "View from the left, from the right",
        "controls.tilt_view": "View from above, from below",
        "controls.zoom_view": "View from nearer, from farther away",
        "controls.pause": "Pause",
        "controls.menu": "Menu",
        "controls.next": "Next",
        "controls.test": "Try the controls",
        "controls.rebind": "Change the controls",
        "controls.back": "Back",
        "experiment.title": "Experiment",
        "experiment.trainee": "Your ID",
        "experiment.trainee help": "Your instructor gives you this ID; it is stored with your "
        "trials.",
        "experiment.mode": "Mode",
        "mode.desktop": "Desktop",
        "mode.hmd": "Headset",
        "experiment.done": "done",
        "experiment.task help": "Begin this task.",
        "experiment.no trainee": "Enter your ID first.",
        "experiment.being set up": "The simulator is applying its new settings.",
        "experiment.order": "{task} comes first.",
        "experiment.trial run first": "{task} comes first: touch all its points, or practice until "
        "its time is over.",
        "experiment.tutorial": "Tutorial",
        "experiment.tutorial time": "2 minutes",
        "experiment.tutorial help": "Learn to move the robot, one control at a time.",
        "experiment.tutorial first": "The tutorial comes first, with the device that you use now: "
        "it takes two minutes.",
        "experiment.study": "Not now. {step} Only your instructor can skip a step, in 3D Slicer "
        "and with a reason.",
        # What a study that Slicer leads asks for next.
        "study.questionnaire": "Step {number} of {count}: answer the questionnaire "
        "{questionnaire}, here or where 3D Slicer runs.",
        "study.answered": "Your answers to {questionnaire} are on their way to 3D Slicer, which "
        "will say what comes next.",
        "study.trial-run": "Step {number} of {count}: get to know the trial run {mode} for "
        "{minutes:g} minutes.",
        "study.trial": "Step {number} of {count}: play {task} {mode}.",
        "study.break": "Step {number} of {count}: take a break of at least {minutes:g} minutes, "
        "{left} more. Then 3D Slicer will say what comes next.",
        "study.all-done": "All steps of the study are done. Thank you!",
        "study.repeat": "Step {number} of {count}: {task} was aborted. The instructor must enter "
        "a reason for repeating it in 3D Slicer.",
        "study.played": "{task} is done. 3D Slicer will say what comes next.",
        "study.desktop": "on the desktop screen",
        "study.hmd": "with the headset",
        "experiment.answer": "Answer the questionnaire",
        "questionnaire.text": "{trainee}, answer every line: {lowest} is {low}, {highest} is "
        "{high}, unless the line says otherwise. Your instructor has the form with the full "
        "wording.",
        "questionnaire.ends": "{topic}: {lowest} is {low}, {highest} is {high}",
        "questionnaire.open": "Some lines are not answered yet.",
        "questionnaire.keep": "Done",
        "questionnaire.back": "Back, without answers",
        **_ITEMS,
        **_FEEDBACK,
        "experiment.trend": "Your scores in this mode; the line is the pass mark, {mark:.0f}.",
        "experiment.trend in study": "Your scores in this mode.",
        "experiment.scores": "Scores, oldest first: {scores}.",
        "experiment.scenario": "Head",
        "experiment.back": "Back",
        "scenario.title": "Heads",
        "scenario.text": "Which head do you want to train on?",
        "scenario.looking": "Looking for heads.",
        "scenario.help": "Train on this head from now on.",
        "scenario.loading": "is being loaded",
        "scenario.present": "in use",
        "scenario.back": "Back",
        "task.trial-run": "Trial run",
        "task.task-1": "Task 1",
        "task.task-2": "Task 2",
        "task.task-3": "Task 3",
        "task.task-4": "Task 4",
        "task.task-5": "Task 5",
        "keyboard.title": "Your ID",
        "keyboard.row": "Type",
        "keyboard.delete": "Delete",
        "keyboard.done": "Done",
        "trial.title": "{task}",
        "trial.paused": "{trainee}, the trial is paused with {kept} points touched. Its clock is "
        "stopped.",
        "trial.complete": "{trainee}, all {kept} points are touched.",
        "trial.resume": "Resume",
        "trial.register": "Register",
        "trial.controls": "Controls",
        "trial.settings": "Settings",
        "trial.finish": "End the trial run",
        "trial.abort": "Abort the task",
        "abort.title": "Abort the task?",
        "abort.text": "{trainee}, your {kept} touched points would not be registered.",
        "abort.keep": "Keep going",
        "abort.abort": "Abort",
        "practice.title": "Practice time is over",
        "practice.text": "{trainee}, you can start Task 1 now, or keep practicing.",
        "practice.study": "{trainee}, end the trial run to continue the study, or keep practicing.",
        "practice.finish": "End the trial run",
        "practice.resume": "Keep practicing",
        "complete.title": "All points are touched",
        "complete.text": "{trainee}, register your {count} points to have them scored. After that "
        "they cannot be changed.",
        "complete.register": "Register",
        "complete.undo": "Undo the last touch",
        "complete.abort": "Abort the task",
        "waiting.title": "Registered",
        "waiting.slicer": "{trainee}, 3D Slicer is scoring your points.",
        "waiting.nobody": "{trainee}, your points are saved. 3D Slicer is not connected; it will "
        "score them as soon as it is.",
        "waiting.own": "{trainee}, 3D Slicer is not connected: the simulator is registering and "
        "scoring your points itself.",
        "waiting.problem": "The simulator cannot score them itself: {reason}",
        "result.own": "This score is the simulator's own and is not stored in a study. When 3D "
        "Slicer connects, it scores and stores the trial, and its score replaces this one.",
        "result.title": "{trainee}: {task}",
        "result.score": "Score",
        "result.fre": "Registration error (FRE)",
        "result.expected tre": "Expected error at the target (TRE)",
        "result.interval note": "The expected error assumes independent, unbiased, equally large "
        "touch errors. It cannot detect an offset that all touches share.",
        "result.true tre": "True error at the target (TRE)",
        "result.region tre": "True error in the brain (TRE)",
        "result.common bias": "Bias that all touches share",
        "result.unacceptable score": "{score:.0f} / 100, not acceptable",
        "result.not accurate": "Not acceptable: an instrument guided by this registration would "
        "miss its target. The true error in the brain is beyond the limit.",
        "result.not unbiased": "Not acceptable: all touches are off in the same direction, by more "
        "than the limit.",
        "result.not safe": "Not acceptable: the tool rested on the head too long or was pressed "
        "in too deeply.",
        "result.ctps": "CTPS",
        "result.of 100": "{score:.0f} / 100",
        "result.mm": "{error:.2f} mm",
        "result.points": "{points:.1f}",
        "result.time": "Time",
        "result.repeated": "Touches refused / taken back",
        "result.next": "Next: {task}",
        "result.again": "Again: {task}",
        "result.replay": "Show the trial again",
        "result.errors": "Show the errors on the head",
        "errors.title": "Your error at each point, {longer:.0f} times as long: green up to "
        "{good:.0f} mm, red from {poor:.0f} mm",
        "errors.back": "Back",
        "result.worst": "Show the worst touch",
        "result.menu": "Experiment menu",
        # The tutorial: {control} is what the trainee presses or pushes, such as "Left stick up".
        "tutorial.title": "Tutorial",
        "tutorial.place": "Step {step} of {steps}",
        "tutorial.done mm": "{done} of {goal} mm",
        "tutorial.done degrees": "{done} of {goal}°",
        "tutorial.done points": "{done} of {goal} points",
        "tutorial.homing": "The robot moves to where you begin.",
        "tutorial.right": "Move the tool 30 mm to the right: {control}.",
        "tutorial.left": "30 mm to the left: {control}.",
        "tutorial.forward": "30 mm forward, away from you: {control}.",
        "tutorial.forward.robot": "30 mm forward, as the robot stands: {control}.",
        "tutorial.back": "30 mm back, toward you: {control}.",
        "tutorial.back.robot": "30 mm back, as the robot stands: {control}.",
        "tutorial.up": "30 mm up: {control}.",
        "tutorial.down": "30 mm down: {control}.",
        "tutorial.slow": "Hold {control} and move the tool 10 mm: near the skin it should be slow.",
        "tutorial.slow.touch screen": "Press {control} and move the tool 10 mm: near the skin it "
        "should be slow. Press again to be fast.",
        "tutorial.turn view": "Turn the view by 20°: {control}.",
        "tutorial.turn view.keyboard": "Turn the view by 20°: {control}, or drag with the right "
        "mouse button.",
        "tutorial.turn view.touch screen": "Turn the view by 20°: drag a finger over the picture.",
        "tutorial.look around": "Turn your head to the side, and push the left stick: its "
        "directions turn with you.",
        "tutorial.best view": "Best view of point {point}: {control}.",
        "tutorial.lower": "Lower the tip onto point {point}: the ring closes, and turns green on "
        "the skin.",
        "tutorial.touch": "Record the touch: {control}. Only touches within 10 mm of the point "
        "count.",
        "tutorial.undo": "Everyone slips. Take the touch back: {control}.",
        "tutorial.pause": "Open the menu: {control}. Everything waits meanwhile; then resume.",
        "tutorial.guided": "Now touch {count} points, each as exactly as you can. Point {point} is "
        "first.",
        "tutorial.praise": "Well done.",
        "tutorial.recorded": "Recorded, {error:.1f} mm from the point.",
        "tutorial.touched": "Point {label}: {error:.1f} mm off. Now touch point {point}.",
        "tutorial.head is gone": "The tutorial has ended: another head is in use.",
        "tutorial is open": "{trainee} is doing the tutorial: let it be finished, or leave it in "
        "the simulator's menu.",
        "tutorial.paused": "The tutorial waits at step {step} of {steps}.",
        "tutorial.resume": "Continue",
        "tutorial.controls": "Controls",
        "tutorial.restart": "Begin again",
        "tutorial.leave": "Leave the tutorial",
        "tutorial.skip": "Skip the tutorial",
        "tutorial.mm": "{error:.1f} mm",
        "tutorial-done.title": "You can drive the robot",
        "tutorial-done.text": "{trainee}, next is the trial run: fifteen points, to practice as "
        "long as its time lasts.",
        "tutorial-done.time": "Time",
        "tutorial-done.first": "Error of your first touch",
        "tutorial-done.touches": "Errors of the last three",
        "tutorial-done.trial-run": "Start the trial run",
        "tutorial-done.again": "Do the tutorial again",
        "tutorial-done.menu": "Experiment menu",
        # Settings.
        "settings.title": "Settings",
        "settings.back": "Back",
        "settings.waits": "This cannot be changed until the trial has ended.",
        "settings.language": "Language",
        "settings.language help": "Language of all screens.",
        "settings.language.en": "English",
        "settings.language.de": "Deutsch",
        "settings.volume": "Volume",
        "settings.volume help": "Volume of all sounds.",
        "settings.muted": "Mute",
        "settings.muted help": "Turn all sounds off.",
        "settings.muted.yes": "Yes",
        "settings.muted.no": "No",
        "settings.order": "Order of the tasks",
        "settings.order help": "Whether tasks must be done in their order. Instructors change "
        "this in the file {file}.",
        "settings.order.fixed": "One after the other",
        "settings.order.any": "Any",
        "settings.coarse": "Speed",
        "settings.coarse help": "Speed of the tip while a stick is fully pushed.",
        "settings.fine": "Slow speed",
        "settings.fine help": "Speed of the tip while the control for slow motion is held.",
        "settings.axes": "Directions",
        "settings.axes help": "Whether right, forward and up are those of the view or the robot's.",
        "settings.axes.camera": "As the view shows them",
        "settings.axes.robot": "As the robot stands",
        "settings.touch": "A touch counts",
        "settings.touch help": "On the skin only, or anywhere within 10 mm of the point, as in the "
        "published study. The record says which.",
        "settings.touch.on skin": "On the skin",
        "settings.touch.within radius": "Within 10 mm",
        "settings.view": "Best view of the next point",
        "settings.view help": "Whether the view turns to each next point automatically while the "
        "sticks are released. The record says so. The control for the best view always works.",
        "settings.view.practice": "Automatically, except in studies",
        "settings.view.always": "Automatically",
        "settings.view.never": "Only on request",
        "settings.guidance": "Guidance to the next point",
        "settings.guidance help": "Directions in words, an arrow, or neither. A study may set its "
        "own. The record says which.",
        "settings.guidance.fading": "Less from task to task",
        "settings.guidance.words": "Words and arrow",
        "settings.guidance.arrow": "Arrow",
        "settings.guidance.none": "None",
        "settings.ghost": "Ghost beside the arm",
        "settings.ghost help": "Shows the tool of an earlier trial of the same task, by the time "
        "since the start. None in studies, unless their protocol has one. The record says so. The "
        "expert's ID is in the file {file}.",
        "settings.ghost.off": "None",
        "settings.ghost.own best": "Your own best trial",
        "settings.ghost.expert": "The expert's best trial",
        "ghost.none": "No ghost: there is no acceptable trial of this task to show yet.",
        "settings.tutorial": "Tutorial",
        "settings.tutorial help": "Whether the trial run waits for it. A study may set its own. "
        "Instructors change this in the file {file}.",
        "settings.tutorial.required": "Before the trial run",
        "settings.tutorial.optional": "May be skipped",
        "settings.tutorial.skipped": "None",
        "settings.direction": "Direction of the tool",
        "settings.direction help": "Who decides where the tool points: the arm, you or the skin.",
        "settings.direction.free": "Free (position only)",
        "settings.direction.clear": "Free, keeping clear of the head",
        "settings.direction.held": "Steered by you",
        "settings.direction.normal": "Straight onto the skin",
        "settings.direction.pose": "Steered by you, without roll",
        # Controls: what they do, and what they are called.
        "bindings.title": "Change the controls",
        "bindings.device": "Device",
        "bindings.group": "Controls for",
        "bindings.group.work": "Working",
        "bindings.group.movement": "Moving the tool",
        "bindings.group.view": "The view",
        "bindings.group.menus": "Menus",
        "bindings.defaults": "Restore the defaults",
        "bindings.back": "Back",
        "bindings.are default": "All controls are back to their defaults.",
        "bindings.changed": "{control} is now {input}.",
        "bindings.impossible": "These two cannot be exchanged: one of them would do two things at "
        "once.",
        "listen.title": "{control}",
        "listen.gamepad": "Press the new button or push the new axis for {control} ({seconds} s).",
        "listen.keyboard": "Press the new key for {control} ({seconds} s).",
        "listen.cancel": "Cancel",
        "conflict.title": "Already in use",
        "conflict.text": "{input} is {other} now. Exchange it with {control}?",
        "conflict.exchange": "Exchange",
        "conflict.another": "Choose another",
        "conflict.cancel": "Cancel",
        "test.title": "Try the controls",
        "test.text": "Push and press everything; each input is shown and felt. {menu} goes back.",
        "test.back": "Back",
        "test.yes": "On",
        "test.no": "Off",
        "test.nothing": "nothing",
        "control.touch": "Touch",
        "control.undo": "Undo",
        "control.camera": "Front view",
        "control.fine": "Slow",
        "control.pause": "Pause",
        "control.menu": "Menu",
        "control.move_left": "Move left",
        "control.move_right": "Move right",
        "control.move_back": "Move back",
        "control.move_forward": "Move forward",
        "control.move_down": "Move down",
        "control.move_up": "Move up",
        "control.turn_left": "Turn left",
        "control.turn_right": "Turn right",
        "control.turn_down": "Turn down",
        "control.turn_up": "Turn up",
        "control.best_view": "Best view",
        "control.view_left": "View from the left",
        "control.view_right": "View from the right",
        "control.view_lower": "View from below",
        "control.view_higher": "View from above",
        "control.view_farther": "View from farther away",
        "control.view_nearer": "View from nearer",
        "control.accept": "Accept",
        "control.back": "Back",
        "control.up": "Up",
        "control.down": "Down",
        "control.left": "Left",
        "control.right": "Right",
        "control.taken": "The {source} has taken control.",
        "control.held": "The {source} is in control. Someone else can take over with {menu} after "
        "{seconds:.0f} s without input.",
        "control.holder": "Control: {source}",
        "control.nobody": "Control: nobody",
        "source.gamepad": "gamepad",
        "source.keyboard": "keyboard",
        "source.mouse": "mouse",
        "source.touch screen": "touch screen",
        "source.browser's gamepad": "browser's gamepad",
        "source.headset's controllers": "headset's controllers",
        "device.gamepad": "Gamepad",
        "device.keyboard": "Keyboard",
        "gamepad.a": "A",
        "gamepad.b": "B",
        "gamepad.x": "X",
        "gamepad.y": "Y",
        "gamepad.back": "Back button",
        "gamepad.guide": "Logo button",
        "gamepad.start": "Start button",
        "gamepad.leftstick": "Left stick pressed",
        "gamepad.rightstick": "Right stick pressed",
        "gamepad.leftshoulder": "LB",
        "gamepad.rightshoulder": "RB",
        "gamepad.dpup": "D-pad up",
        "gamepad.dpdown": "D-pad down",
        "gamepad.dpleft": "D-pad left",
        "gamepad.dpright": "D-pad right",
        "gamepad.-leftx": "Left stick left",
        "gamepad.+leftx": "Left stick right",
        "gamepad.-lefty": "Left stick up",
        "gamepad.+lefty": "Left stick down",
        "gamepad.-rightx": "Right stick left",
        "gamepad.+rightx": "Right stick right",
        "gamepad.-righty": "Right stick up",
        "gamepad.+righty": "Right stick down",
        "gamepad.-lefttrigger": "LT released",
        "gamepad.+lefttrigger": "LT",
        "gamepad.-righttrigger": "RT released",
        "gamepad.+righttrigger": "RT",
        # Where a headset's controllers differ from a gamepad.
        "headset.fine": "Trigger",
        "headset.menu": "X",
        "headset.pause": "X",
        "headset.up": "Stick up",
        "headset.down": "Stick down",
        "headset.left": "Stick left",
        "headset.right": "Stick right",
        # What is written on the buttons that the page has on a touch screen.
        "touch screen.touch": "Touch",
        "touch screen.undo": "Undo",
        "touch screen.camera": "Front view",
        "touch screen.best_view": "Best view",
        "touch screen.fine": "Slow",
        "touch screen.menu": "Pause",
        "touch screen.pause": "Pause",
        "touch screen.accept": "Tap",
        "touch screen.back": "Back",
        "keyboard.Space": "Space",
        "keyboard.Enter": "Enter",
        "keyboard.NumpadEnter": "Enter on the number pad",
        "keyboard.Backspace": "Backspace",
        "keyboard.Escape": "Esc",
        "keyboard.Tab": "Tab",
        "keyboard.ShiftLeft": "Left Shift",
        "keyboard.ShiftRight": "Right Shift",
        "keyboard.ControlLeft": "Left Ctrl",
        "keyboard.ControlRight": "Right Ctrl",
        "keyboard.AltLeft": "Left Alt",
        "keyboard.AltRight": "Right Alt",
        "keyboard.ArrowLeft": "Arrow left",
        "keyboard.ArrowRight": "Arrow right",
        "keyboard.ArrowUp": "Arrow up",
        "keyboard.ArrowDown": "Arrow down",
        "keyboard.PageUp": "Page up",
        "keyboard.PageDown": "Page down",
        # While the trainee works.
        "work.complete": "{trainee}, all {count} points are touched. Press {touch} to register "
        "them.",
        "work.on skin": "On the skin: press {touch}.",
        "work.off the way": "{trainee}, you are off the path to point {point}.",
        "warning.shaft": "The shaft touches the head: lift the tool.",
        "warning.elsewhere": "The tip is on the skin away from the point: lift it.",
        "warning.pressing": "Pressing {depth:.1f} mm: ease off.",
        "warning.reach": "The arm cannot reach farther this way.",
        "warning.obstacle.links": "The head is in the arm's way: approach from another side.",
        "warning.obstacle.self": "The arm is in its own way: move in another direction.",
        "warning.obstacle.table": "The table is in the arm's way: approach from above.",
        "warning.slicer": "The connection to 3D Slicer is lost. Continue: everything is recorded "
        "here and scored later.",
        "warning.unplugged": "The gamepad {name} is unplugged: the robot stands still. Plug it in "
        "again or continue with the keyboard.",
        "warning.unmapped": "The gamepad {name} has an unknown layout: use another one or the "
        "keyboard.",
        "warning.no SDL": "Gamepads cannot be read on this computer ({reason}): use the keyboard.",
        "warning.settings": "{reason} The defaults are used.",
        # What the window says itself, because the simulator cannot.
        "window.title": "RASTrainer",
        "window.connecting": "The window is connecting to the simulator.",
        "window.lost": "The connection to the simulator was lost. It will be restored as soon as "
        "the simulator answers.",
        "window.unknown": "The simulator does not know this window: close it and open one with the "
        "pairing code that the simulator shows now.",
        "window.refused": "The maximum number of views is open: close one.",
        "window.pairing": "To pair a browser or a headset: code {code} at {addresses}",
        "status.points": "{kept} of {count} points",
        "status.left": "{time} left",
        "status.toward": "Point {point}: {distance} mm {direction}",
        "way.left": "left",
        "way.right": "right",
        "way.back": "back",
        "way.forward": "forward",
        "way.down": "down",
        "way.up": "up",
        "hint.move": "Move",
        "hint.up_and_down": "Up, down",
        "hint.touch": "Touch",
        "hint.register": "Register",
        "hint.undo": "Undo",
        "hint.fine": "Slow",
        "hint.best_view": "Best view",
        "hint.turn_view": "Turn the view",
        "hint.camera": "Camera",
        "hint.front": "Front view",
        "hint.menu": "Menu",
        "hint.choose": "Choose",
        "hint.accept": "Accept",
        "hint.back": "Back",
        "hint.play": "Play, pause",
        "hint.seek": "5 s back, forth",
        "hint.worst": "Worst touch",
        "hint.end": "End",
        "hint.result": "Result",
        "replay.title": "{task} of {trainee}, shown again",
        "replay.worst": "Point {point}, the worst touch, at half speed",
        "replay.paused": "Paused",
        "replay.loading": "Your trial is being loaded",
        "replay.back": "Back to the result",
        "replay.no worst": "The worst touch of this trial cannot be determined.",
        "replay.no journal": "The trial cannot be replayed: its journal is no longer in the "
        "records folder.",
        "decimal sign": ".",
    }
)
