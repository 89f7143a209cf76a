/* springpot 0.1.0 caa8d889b6e129711e4b8e490faf5c2c47d3c054226f74fe5f63b06f84f1df08 */
#ifndef SP_SCENE_H
#define SP_SCENE_H

#include <stdint.h>

#include "sp.h"
#include "sp_real.h"
#include "sp_number.h"
#include "sp_silence.h"
#include "sp_guard.h"
#include "sp_range.h"
#include "sp_curve.h"
#include "sp_stops.h"
#include "sp_hammerstein.h"
#include "sp_poles.h"
#include "sp_surface.h"
#include "sp_tool_velocity.h"
#include "sp_contact.h"
#include "sp_couple.h"
#include "sp_output.h"

/* A loop can check that the scene was made for it:
 * _Static_assert((int)SP_RATE_HZ == 1000, "emit the scene with the rate of this loop"); */
#define SP_RATE_HZ 1000
#define SP_DT_S 0.001f
#define SP_MAX_FORCE_N 10.955592f
#define SP_TRAINED_DEPTH_M 0.011998461f
#define SP_WATCHDOG_S 0.02f
#define SP_STATE_BYTES 108

/* proxy: what one tick hands to the next. */
struct sp_state {
    uint32_t begun;
    sp_silence_state silence;
    sp_guard_state guard;
    sp_real penetration_before[4];
    sp_real penetration_held[4];
    sp_real penetration_play[1];
    sp_surface_state penetration_surface;
    sp_tool_velocity_state tool_velocity;
    sp_couple_state couple;
    sp_output_state output;
};

/* Fails where a header of another number type or version was included first. */
typedef char sp_state_is_as_planned[sizeof(struct sp_state) == 108 ? 1 : -1];

#endif
