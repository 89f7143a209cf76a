/* A scene that gives 1 N, latches after twenty ticks without a motion, and is reset by a reset. */
#ifndef SP_SCENE_H
#define SP_SCENE_H

typedef float sp_real;

typedef struct {
    int silent;
    int resets;
    int steps; /* since the last reset */
} sp_state;

enum { STUB_LATCHED = 32, STUB_WATCHDOG = 20 };

static inline int sp_selftest(void)
{
    return 0;
}

static inline void sp_init(sp_state *state)
{
    state->silent = 0;
}

static inline void sp_reset(sp_state *state)
{
    state->silent = 0;
    state->steps = 0;
    state->resets++;
}

static inline int stub_notes(const sp_state *state, sp_real *force_n)
{
    const int latched = state->silent >= STUB_WATCHDOG;
    *force_n = latched ? 0.0f : 1.0f;
    return latched ? STUB_LATCHED : 0;
}

static inline int sp_step(sp_state *state, sp_real position_m, sp_real velocity_mps,
                          sp_real *force_n)
{
    (void)position_m;
    (void)velocity_mps;
    state->steps++;
    state->silent = state->silent < STUB_WATCHDOG ? 0 : state->silent;
    return stub_notes(state, force_n);
}

static inline int sp_idle(sp_state *state, sp_real dt_s, sp_real *force_n)
{
    (void)dt_s;
    state->silent++;
    return stub_notes(state, force_n);
}

#endif
