/* springpot 0.1.0 c7c26e87fe241efbd59e009a750e83c6598fca6677b7ffb816d2e5796197f0ab */
#ifndef SP_SCENE_H
#define SP_SCENE_H

#include <stdint.h>

#include "sp.h"
#include "sp_real.h"
#include "sp_number.h"
#include "sp_guard.h"
#include "sp_range.h"
#include "sp_window.h"
#include "sp_weigh.h"
#include "sp_forest.h"
#include "sp_contact.h"
#include "sp_output.h"

/* smallest: what one tick hands to the next. */
struct sp_state {
    sp_guard_state guard;
    sp_real history[2 * 4];
    uint32_t newest;
    sp_output_state output;
};

/* Fails where a header of another number type or version was included first. */
typedef char sp_state_is_as_planned[sizeof(struct sp_state) == 68 ? 1 : -1];

#endif
