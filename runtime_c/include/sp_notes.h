/* Return values of a tick: notes are bits of a positive value, errors are negative. */
#ifndef SP_NOTES_H
#define SP_NOTES_H

/* springpot declarations begin */
enum {
    SP_NOTE_HELD = 1,     /* the sample was missing or implausible: the last force was held */
    SP_NOTE_RESYNC = 2,   /* a position was accepted without a history, which restarts there */
    SP_NOTE_OUTSIDE = 4,  /* deeper than trained: the model got the nearest trained depth */
    SP_NOTE_CLAMPED = 8,  /* the force was clamped to the scene's limits */
    SP_NOTE_RAMPED = 16,  /* the start ramp scaled the force, after a start or restart at depth */
    SP_NOTE_LATCHED = 32, /* the watchdog has latched: the force falls to zero until sp_reset */
    SP_NOTE_LIMITED = 64  /* slew limit: the force grew faster than any touch can */
};

enum {
    SP_ERROR_NULL = -1,      /* a required pointer is null */
    SP_ERROR_TIME_STEP = -2, /* dt_s is not finite or not positive; sp_advance: negative */
    SP_ERROR_STATE = -3      /* not an initialised state: call sp_init first */
};
/* springpot declarations end */

#endif
