/* springpot 0.1.0 6c8d0400ad24cd4d314af50f69b21443d983407c78cd768de8a86bdd53cd97d4 */
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

enum {
    N_FEATURES = 1,
    N_ROOTS = 8,
    DEPTH = 3
};
static const sp_real quantum_n = 9.536743e-07f;
static const sp_real forest_bias_n = 0.0f;
/* Trees, one after the other: threshold or leaf, link (sp_forest.h). */
static const sp_forest_node nodes[6] = {
    {0.02f, 16u}, {1.048576e+06f, 31u}, {0.06999999f, 48u}, {4.194304e+06f, 63u},
    {1.048576e+07f, 79u}, {0.0f, 95u}
};
static const uint32_t roots[8] = {
    0u, 5u, 5u, 5u, 5u, 5u, 5u, 5u
};

#endif
