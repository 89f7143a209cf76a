/* springpot 0.1.0 6c8d0400ad24cd4d314af50f69b21443d983407c78cd768de8a86bdd53cd97d4 */
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

#endif
