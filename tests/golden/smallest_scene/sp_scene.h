/* springpot 0.1.0 2b4902213c66541a3fc851712d4aec7bd1ebb90ec5ada6b9809c33e98519c489 */
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
#include "sp_energy.h"
#include "sp_output.h"

/* smallest: what one tick hands to the next. */
struct sp_state {
    sp_silence_state silence;
    sp_guard_state guard;
    sp_real history[2 * 16];
    uint32_t newest;
    uint32_t simd;
    uint32_t bins[1];
    sp_energy_state energy;
    sp_output_state output;
};

/* Fails where a header of another number type or version was included first. */
typedef char sp_state_is_as_planned[sizeof(struct sp_state) == 208 ? 1 : -1];

#endif
