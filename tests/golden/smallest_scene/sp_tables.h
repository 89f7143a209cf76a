/* springpot 0.1.0 2b4902213c66541a3fc851712d4aec7bd1ebb90ec5ada6b9809c33e98519c489 */
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
