/* springpot 0.1.0 c7c26e87fe241efbd59e009a750e83c6598fca6677b7ffb816d2e5796197f0ab */
#ifndef SP_REGRESSOR_H
#define SP_REGRESSOR_H

#include <stddef.h>

#include "sp_scene.h"

enum {
    N_FEATURES = 1,
    N_ROOTS = 16,
    DEPTH = 3
};
static const sp_real quantum_n = 9.536743e-07f;
static const sp_real forest_bias_n = 0.0f;
/* Trees, one after the other: threshold or leaf, link (sp_forest.h). */
static const sp_forest_node nodes[6] = {
    {0.02f, 16u}, {1.048576e+06f, 31u}, {0.06999999f, 48u}, {4.194304e+06f, 63u},
    {1.048576e+07f, 79u}, {0.0f, 95u}
};
static const uint32_t roots[16] = {
    0u, 5u, 5u, 5u, 5u, 5u, 5u, 5u, 5u, 5u, 5u, 5u, 5u, 5u, 5u, 5u
};

#endif
