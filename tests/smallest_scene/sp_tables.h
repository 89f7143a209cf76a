/* springpot 0.1.0 c7c26e87fe241efbd59e009a750e83c6598fca6677b7ffb816d2e5796197f0ab */
#ifndef SP_TABLES_H
#define SP_TABLES_H

#include <stddef.h>

#include "sp_scene.h"

enum {
    N_TAPS = 4,
    N_LANES = 4
};
/* c(r, k), newest first: a row a tap, a lane each for the orders 0.5. */
static const sp_real taps[4 * 4] = {
    32.0f, 0.0f, 0.0f, 0.0f, -16.0f, 0.0f, 0.0f, 0.0f, -4.0f, 0.0f, 0.0f, 0.0f, -2.0f, 0.0f, 0.0f,
    0.0f
};

#endif
