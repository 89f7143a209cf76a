/* springpot 0.1.0 bd65b972eeab3721bb9ecdcd5570baba1a6ad18784fffb3cabfbaff3a5c1a44d */
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
#include "sp_energy.h"
#include "sp_output.h"

/* proxy: what one tick hands to the next. */
struct sp_state {
    sp_silence_state silence;
    sp_guard_state guard;
    sp_real penetration_before[4];
    sp_real penetration_held[4];
    sp_real penetration_play[1];
    sp_surface_state penetration_surface;
    sp_tool_velocity_state tool_velocity;
    sp_couple_state couple;
    sp_energy_state energy;
    sp_output_state output;
};

/* Fails where a header of another number type or version was included first. */
typedef char sp_state_is_as_planned[sizeof(struct sp_state) == 132 ? 1 : -1];

#endif
