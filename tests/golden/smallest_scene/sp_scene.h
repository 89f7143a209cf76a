/* springpot 0.1.0 efcc0d0b6550e8845c9e6f8237a007a7574fa758c56d8f0d3613675127c04dd5 */
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

/* smallest: what one tick hands to the next. */
struct sp_state {
    sp_silence_state silence;
    sp_guard_state guard;
    sp_real history[2 * 16];
    uint32_t newest;
    uint32_t simd;
    uint32_t bins[1];
    sp_output_state output;
};

/* Fails where a header of another number type or version was included first. */
typedef char sp_state_is_as_planned[sizeof(struct sp_state) == 188 ? 1 : -1];

#endif
