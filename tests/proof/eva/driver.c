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

#include "sp_scene.c"

static sp_state state;

static sp_real anything(void)
{
    sp_real x;
    Frama_C_make_unknown((char *)&x, sizeof x);
    return x;
}

void prove(void)
{
    //@ widen_hints "all", @FLOATS@;
    //@ widen_hints "all", @WHOLE@;
    sp_init(&state);
    while (Frama_C_interval(0, 1)) {
        sp_real force_n = (sp_real)0;
        switch (Frama_C_interval(0, @CALLS@)) {
        case 0:
            (void)sp_step(&state, anything(), anything(), &force_n);
            break;
        case 1:
            (void)sp_idle(&state, anything(), &force_n);
            break;
#if @CALLS@ == 2
        case 2:
            (void)sp_step_dt(&state, anything(), anything(), anything(), &force_n);
            break;
#endif
        }
        //@ assert finite: \is_finite(force_n);
        //@ assert limit: output.min_n <= force_n <= output.max_n;
    }
}
