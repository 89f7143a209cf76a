/* springpot 0.1.0 b5e9119d1855d110254c7187a3194cd7fbc4472705b0a681ccc403415f1380fa */
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
