-- The tables of a study, in SQL that SQLite reads; PostgreSQL reads it with a few other types.
CREATE TABLE trainees (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    pseudonym TEXT NOT NULL UNIQUE,
    consent INTEGER NOT NULL CHECK (consent IN (0, 1)),
    archived INTEGER NOT NULL CHECK (archived IN (0, 1)),
    created_utc TEXT NOT NULL
);
CREATE TABLE trials (
    id INTEGER PRIMARY KEY,
    trial_id TEXT NOT NULL UNIQUE,
    trainee_id INTEGER NOT NULL REFERENCES trainees (id) ON DELETE CASCADE,
    task TEXT NOT NULL,
    mode TEXT NOT NULL,
    scenario TEXT NOT NULL,
    method TEXT NOT NULL,
    started_utc TEXT NOT NULL,
    completion_time_s DOUBLE PRECISION NOT NULL,
    record_json TEXT NOT NULL,
    stored_utc TEXT NOT NULL
);
CREATE INDEX trials_of_trainee ON trials (trainee_id);
-- What was computed or revealed of a trial: its registrations by their kinds, 'score',
-- 'procedure', 'truth' (once). The latest of a kind counts. `value` is FRE, score or true error.
CREATE TABLE results (
    id INTEGER PRIMARY KEY,
    trial_id TEXT NOT NULL REFERENCES trials (trial_id) ON DELETE CASCADE,
    kind TEXT NOT NULL,
    value DOUBLE PRECISION NOT NULL,
    result_json TEXT NOT NULL,
    stored_utc TEXT NOT NULL
);
CREATE INDEX results_of_trial ON results (trial_id, kind);
-- So that a simulator that offers a deleted trial again does not bring its trainee back.
-- A hash, not the UUID: it can be recognized but identifies no one.
CREATE TABLE deleted_trials (trial_sha256 TEXT PRIMARY KEY NOT NULL) WITHOUT ROWID;
-- What the protocol requires of each trainee, and the outcome.
CREATE TABLE study_protocol (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    protocol_json TEXT NOT NULL,
    stored_utc TEXT NOT NULL
);
CREATE TABLE enrollments (
    trainee_id INTEGER PRIMARY KEY REFERENCES trainees (id) ON DELETE CASCADE,
    place INTEGER NOT NULL UNIQUE CHECK (place >= 0),
    stored_utc TEXT NOT NULL
);
CREATE TABLE steps (
    id INTEGER PRIMARY KEY,
    trainee_id INTEGER NOT NULL REFERENCES trainees (id) ON DELETE CASCADE,
    step TEXT NOT NULL,
    outcome TEXT NOT NULL CHECK (outcome IN ('done', 'skipped')),
    details_json TEXT NOT NULL,
    stored_utc TEXT NOT NULL,
    UNIQUE (trainee_id, step)
);
-- How long a trial run has been practiced, so that an interruption does not restart it.
CREATE TABLE practice (
    trainee_id INTEGER NOT NULL REFERENCES trainees (id) ON DELETE CASCADE,
    step TEXT NOT NULL,
    seconds DOUBLE PRECISION NOT NULL CHECK (seconds >= 0),
    PRIMARY KEY (trainee_id, step)
);
-- A virtual cohort: what is planned, when it was finished, and the trials that got stuck.
CREATE TABLE cohort (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    plan_json TEXT NOT NULL,
    planned_trials INTEGER NOT NULL CHECK (planned_trials > 0),
    stored_utc TEXT NOT NULL,
    finished_utc TEXT
);
CREATE TABLE stuck_trials (trial_id TEXT PRIMARY KEY NOT NULL) WITHOUT ROWID;
-- Trials that were aborted, and why the study's step was then played again.
CREATE TABLE aborted_trials (
    id INTEGER PRIMARY KEY,
    trial_id TEXT NOT NULL UNIQUE,
    trainee_id INTEGER NOT NULL REFERENCES trainees (id) ON DELETE CASCADE,
    record_json TEXT NOT NULL,
    stored_utc TEXT NOT NULL
);
CREATE INDEX aborted_trials_of_trainee ON aborted_trials (trainee_id);
CREATE TABLE repeats (
    trial_id TEXT PRIMARY KEY NOT NULL
        REFERENCES aborted_trials (trial_id) ON DELETE CASCADE,
    step TEXT NOT NULL,
    reason TEXT NOT NULL,
    stored_utc TEXT NOT NULL
) WITHOUT ROWID;
-- Drills of decisions: everything about one follows from its record.
CREATE TABLE drills (
    id INTEGER PRIMARY KEY,
    trial_id TEXT NOT NULL UNIQUE,
    trainee_id INTEGER NOT NULL REFERENCES trainees (id) ON DELETE CASCADE,
    started_utc TEXT NOT NULL,
    record_json TEXT NOT NULL,
    stored_utc TEXT NOT NULL
);
CREATE INDEX drills_of_trainee ON drills (trainee_id);
-- Which replays each rater marks, by the number that is shown instead of the trial; and the
-- marks. The latest mark of a domain counts, NULL is one that was taken back.
CREATE TABLE rated_replays (
    rater TEXT NOT NULL,
    number INTEGER NOT NULL CHECK (number > 0),
    trial_id TEXT NOT NULL REFERENCES trials (trial_id) ON DELETE CASCADE,
    stored_utc TEXT NOT NULL,
    PRIMARY KEY (rater, number),
    UNIQUE (rater, trial_id)
);
CREATE TABLE rating_marks (
    id INTEGER PRIMARY KEY,
    mark_id TEXT NOT NULL UNIQUE,
    rater TEXT NOT NULL,
    trial_id TEXT NOT NULL REFERENCES trials (trial_id) ON DELETE CASCADE,
    form TEXT NOT NULL,
    domain TEXT NOT NULL,
    mark INTEGER CHECK (mark BETWEEN 1 AND 5),
    stored_utc TEXT NOT NULL
);
CREATE INDEX rating_marks_of_trial ON rating_marks (trial_id, rater);
-- Which curriculum trainees follow, everybody where no trainee is named; NULL is none. The
-- last choice counts.
CREATE TABLE curriculum_choices (
    id INTEGER PRIMARY KEY,
    trainee_id INTEGER REFERENCES trainees (id) ON DELETE CASCADE,
    curriculum_json TEXT,
    stored_utc TEXT NOT NULL
);
CREATE INDEX curriculum_choices_of_trainee ON curriculum_choices (trainee_id);
-- How many trainees there have been: the numbers of deleted ones are not proposed again.
CREATE TABLE trainee_numbers (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    latest INTEGER NOT NULL
);
INSERT INTO trainee_numbers VALUES (1, 0);
-- Which trials of each simulator's folder have arrived, by their number alone: it remains when
-- a trainee is deleted, so that only what never arrived is a gap.
CREATE TABLE deliveries (
    series TEXT NOT NULL,
    number INTEGER NOT NULL CHECK (number > 0),
    PRIMARY KEY (series, number)
);
