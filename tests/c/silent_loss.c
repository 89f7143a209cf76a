/* A loop that sends the last force again and does not tell the scene that time has passed. */
#include "sp_notes.h"
#include "sp_real.h"

int silent_loss(void *state, sp_real dt_s, sp_real *force_n);

int silent_loss(void *state, sp_real dt_s, sp_real *force_n)
{
    (void)state;
    (void)dt_s;
    (void)force_n;
    return SP_NOTE_HELD;
}
