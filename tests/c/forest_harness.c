/* Sums of many feature vectors, for tests: the emitted C walks one at a time. */
#include <stdint.h>
#include <string.h>

#include "sp_bins.h"
#include "sp_forest_simd.h"

void compact_sums(const void *tables[5], const uint32_t sizes[3], uint32_t simd, uint32_t n,
                  const float *features, uint32_t *sums);
uint32_t forest_simd(void);

/* tables: top, nodes, roots, thresholds, their starts; sizes: trees, lanes, features. Without
 * thresholds a feature is its own bin_index. */
void compact_sums(const void *tables[5], const uint32_t sizes[3], uint32_t simd, uint32_t n,
                  const float *features, uint32_t *sums)
{
    const sp_forest forest = {tables[0], tables[1], tables[2], sizes[0], sizes[1]};
    uint32_t last[SP_FOREST_SLOTS] = {0};
    for (uint32_t i = 0; i < n; i++) {
        uint32_t bins[SP_FOREST_SLOTS] = {0};
        const float *feature = features + i * sizes[2];
        if (tables[3]) {
            sp_bins(tables[3], tables[4], sizes[2], feature, last);
            memcpy(bins + 1, last, sizes[2] * sizeof *last);
        } else {
            for (uint32_t k = 0; k < sizes[2]; k++) {
                bins[k + 1] = (uint32_t)feature[k];
            }
        }
        sums[i] = sp_forest_sum_simd(&forest, bins, simd);
    }
}

uint32_t forest_simd(void)
{
    return sp_forest_simd();
}
