/* What a tick says about itself: bits of a positive return value, and the negative errors. */
#ifndef SP_NOTES_H
#define SP_NOTES_H

/* springpot declarations begin */
enum {
    SP_NOTE_HELD = 1,     /* the sample was missing or not believable: the last good one was held */
    SP_NOTE_RESYNC = 2,   /* a new position was taken as true: history restarts at it */
    SP_NOTE_OUTSIDE = 4,  /* outside the trained depth: the model saw the nearest trained one */
    SP_NOTE_CLAMPED = 8,  /* the force was cut to the scene's limits */
    SP_NOTE_RAMPED = 16,  /* the force rises after a start or restart at depth, or a silence */
    SP_NOTE_LATCHED = 32, /* the watchdog tripped: the force goes to zero, until sp_reset */
    SP_NOTE_LIMITED = 64  /* the force grew faster than a touch makes it: held back */
};

enum {
    SP_ERROR_NULL = -1,      /* a pointer that is needed is null */
    SP_ERROR_TIME_STEP = -2, /* a time step that is not finite, not positive, or too long */
    SP_ERROR_STATE = -3      /* memory that is no state: call sp_init first */
};
/* springpot declarations end */

#endif
