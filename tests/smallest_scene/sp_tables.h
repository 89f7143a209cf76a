/* springpot 0.1.0 55c4227d8bae79067de13cb9fd840f263318e50d16e8ced7ef60e871c453d162 */
#ifndef SP_TABLES_H
#define SP_TABLES_H

#include <stdint.h>

#include "sp_real.h"

/* Taps, newest first: a row a tap, a lane each for the orders 0.5. */
static const sp_real taps[4 * 4] = {
    32.0f, 0.0f, 0.0f, 0.0f, -16.0f, 0.0f, 0.0f, 0.0f, -4.0f, 0.0f, 0.0f, 0.0f, -2.0f, 0.0f, 0.0f,
    0.0f
};

#include "sp_forest.h"

/* Trees, one after the other: threshold or leaf, link (sp_forest.h). */
static const sp_forest_node nodes[6] = {
    {0.02f, 16u}, {1.048576e+06f, 31u}, {0.06999999f, 48u}, {4.194304e+06f, 63u},
    {1.048576e+07f, 79u}, {0.0f, 95u}
};
static const uint32_t roots[8] = {
    0u, 5u, 5u, 5u, 5u, 5u, 5u, 5u
};

#endif
