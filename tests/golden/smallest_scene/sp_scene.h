/* springpot 0.1.0 e9450291b20558f9423f16bd37bd6ffa5574750fb352ce2f13b7feed6a2bc3cb */
#ifndef SP_SCENE_H
#define SP_SCENE_H

#include <stdint.h>

#include "sp.h"
#include "sp_real.h"
#include "sp_number.h"
#include "sp_silence.h"
#include "sp_guard.h"
#include "sp_range.h"
#include "sp_window.h"
#include "sp_taps.h"
#include "sp_bins.h"
#include "sp_forest.h"
#include "sp_forest_x86.h"
#include "sp_forest_simd.h"
#include "sp_contact.h"
#include "sp_output.h"

/* A loop can check that the scene was made for it:
 * _Static_assert((int)SP_RATE_HZ == 1000, "emit the scene with the rate of this loop"); */
#define SP_RATE_HZ 1000
#define SP_DT_S 0.001f
#define SP_MAX_FORCE_N 12.0f
#define SP_TRAINED_DEPTH_M 0.01f
#define SP_WATCHDOG_S 0.02f
#define SP_STATE_BYTES 184

/* smallest: what one tick hands to the next. */
struct sp_state {
    uint32_t begun;
    sp_silence_state silence;
    sp_guard_state guard;
    sp_real history[2 * 16];
    uint32_t newest;
    uint32_t simd;
    uint32_t bins[1];
    sp_output_state output;
};

/* Fails where a header of another number type or version was included first. */
typedef char sp_state_is_as_planned[sizeof(struct sp_state) == 184 ? 1 : -1];

#endif
