/* springpot 0.1.0 e9450291b20558f9423f16bd37bd6ffa5574750fb352ce2f13b7feed6a2bc3cb */
#ifndef SP_TABLES_H
#define SP_TABLES_H

#include <stddef.h>

#include "sp_scene.h"

enum {
    N_TAPS = 16,
    N_ORDERS = 1
};
/* c(r, k), newest first, 4 and padding: a row each of 0.5. */
static const sp_real taps[1 * 16] = {
    32.0f, -16.0f, -4.0f, -2.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f,
    0.0f
};

#endif
