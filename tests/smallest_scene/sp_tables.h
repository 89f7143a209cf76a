/* springpot 0.1.0 871f569485c8a12e6b0ba6c4b46b7871ad0532d7b17f9b69bc16172cdedf6e24 */
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
