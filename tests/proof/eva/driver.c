/* Any number of ticks, in any order: samples of any bits, and silences of any length. */
#include <math.h>

#include "__fc_builtin.h"

/* The analyser knows no fabs: this is what it does to every number. */
static float any_fabsf(float x)
{
    return x < 0.0f ? -x : x;
}
static double any_fabs(double x)
{
    return x < 0.0 ? -x : x;
}
#define fabsf any_fabsf
#define fabs any_fabs

#include "sp.c"

static sp_state state;

static sp_real anything(void)
{
    sp_real x;
    Frama_C_make_unknown((char *)&x, sizeof x);
    return x;
}

static int call(sp_real x, sp_real *force_n)
{
@PLACE@    switch (Frama_C_interval(0, 1)) {
    case 0:
        return sp_step(&state, x, anything(), force_n);
    case 1:
        return sp_idle(&state, x, force_n);
    }
    return 0;
}

#if @LAWS@
/* Growth: the force given before, cut into pieces that the analyser keeps apart: within one, growth
 * is known to the piece's width. Latched, it falls by its step at least, and stays latched. */
#define PIECES 8
static const sp_real piece_n = (sp_scene_output.max_n - sp_scene_output.min_n) / PIECES;

static void any_call(void)
{
    sp_real force_n = (sp_real)0;
    const sp_real zero = (sp_real)0;
    const int piece = Frama_C_interval(0, PIECES - 1);
    //@ split piece;
    const sp_real low_n = sp_scene_output.min_n + (sp_real)piece * piece_n;
    const sp_real high_n = low_n + piece_n;
    const sp_real most_n = (high_n > zero ? high_n : zero) + sp_scene_output.slew_n;
    const sp_real lower_n = (low_n < zero ? low_n : zero) - sp_scene_output.slew_n;
    if (state.output.last_n >= low_n && state.output.last_n <= high_n) {
        (void)call(anything(), &force_n);
        //@ assert growth: force_n <= most_n;
        //@ assert pull: force_n >= lower_n;
        //@ assert finite: \is_finite(force_n);
        //@ assert limit: sp_scene_output.min_n <= force_n <= sp_scene_output.max_n;
    }
}

static void latched_call(void)
{
    sp_real force_n = (sp_real)0;
    const int piece = Frama_C_interval(0, PIECES - 1);
    //@ split piece;
    const sp_real low_n = sp_scene_output.min_n + (sp_real)piece * piece_n;
    const sp_real high_n = low_n + piece_n;
    const sp_real down_n = high_n - sp_scene_output.latch_fall_n;
    if (state.silence.latched == 1u && state.output.last_n >= low_n &&
        state.output.last_n <= high_n && down_n > (sp_real)0) {
        (void)sp_step(&state, anything(), anything(), &force_n);
        //@ assert fall: force_n <= down_n;
        //@ assert latch: state.silence.latched == 1;
    }
}

#else
static void any_call(void)
{
    sp_real force_n = (sp_real)0;
    (void)call(anything(), &force_n);
    //@ assert finite: \is_finite(force_n);
    //@ assert limit: sp_scene_output.min_n <= force_n <= sp_scene_output.max_n;
}
#endif

void prove(void)
{
    //@ widen_hints "all", @FLOATS@;
    //@ widen_hints "all", @WHOLE@;
    sp_init(&state);
    while (Frama_C_interval(0, 1)) {
        any_call();
#if @LAWS@
        if (Frama_C_interval(0, 1)) {
            latched_call();
        }
#endif
    }
}
