/* springpot 0.1.0 55c4227d8bae79067de13cb9fd840f263318e50d16e8ced7ef60e871c453d162 */
#ifndef SP_SCENE_H
#define SP_SCENE_H

#include <stdint.h>

#include "sp.h"
#include "sp_real.h"
#include "sp_number.h"
#include "sp_guard.h"
#include "sp_range.h"
#include "sp_window.h"
#include "sp_frac.h"
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

#endif
