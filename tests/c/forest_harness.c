/* Many feature vectors through the forest unit, for the tests that compare it with scikit-learn. */
#include <stddef.h>
#include <string.h>

#include "sp_forest.h"

void forest_sums(const sp_forest_node *nodes, const uint32_t *roots, uint32_t n_roots,
                 uint32_t depth, uint32_t n, uint32_t n_features, const float *features,
                 int32_t *sums);

void forest_sums(const sp_forest_node *nodes, const uint32_t *roots, uint32_t n_roots,
                 uint32_t depth, uint32_t n, uint32_t n_features, const float *features,
                 int32_t *sums)
{
    for (uint32_t i = 0; i < n; i++) {
        float slots[SP_FOREST_SLOTS] = {0};
        memcpy(slots, features + (size_t)i * n_features, n_features * sizeof slots[0]);
        sums[i] = sp_forest_sum(nodes, roots, n_roots, depth, slots);
    }
}
