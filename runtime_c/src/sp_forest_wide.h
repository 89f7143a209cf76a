/* Forest: the sum of the leaves that a feature vector reaches, one in each tree.
 *
 * scikit-learn goes left where float32(feature) <= threshold (a double). The thresholds here are
 * the largest float32 not above it, which decides alike for every float32.
 *
 * A node is 8 bytes: `value` is the threshold; `link` holds the feature's slot in its low bits and
 * the left child above them; the right child is next to the left one. A leaf's value is its force
 * in whole steps (an exact float integer), its slot is SP_WIDE_LEAF, whose feature is below
 * every value, and its left child is itself: traversing on stays there. So sixteen trees are
 * traversed at once, without a branch that depends on data, and wait for memory together. Sums are
 * integers: the same in any order. */
#ifndef SP_FOREST_WIDE_H
#define SP_FOREST_WIDE_H

#include <float.h>
#include <stdint.h>

enum {
    SP_WIDE_SLOT_BITS = 4,
    SP_WIDE_SLOTS = 1 << SP_WIDE_SLOT_BITS,
    SP_WIDE_LEAF = SP_WIDE_SLOTS - 1,
    SP_WIDE_WIDTH = 16 /* trees traversed at once; the number of roots is a multiple of it */
};

typedef struct {
    float value;
    uint32_t link;
} sp_wide_node;

/* features: SP_WIDE_SLOTS, the last one free for us. Returns steps of force. */
static inline int32_t sp_wide_sum(const sp_wide_node *nodes, const uint32_t *roots,
                                  uint32_t n_roots, uint32_t depth, float *features)
{
    int32_t sum = 0;
    features[SP_WIDE_LEAF] = -FLT_MAX;
    for (uint32_t tree = 0; tree < n_roots; tree += SP_WIDE_WIDTH) {
        uint32_t at[SP_WIDE_WIDTH];
#pragma GCC unroll 16
        for (uint32_t i = 0; i < SP_WIDE_WIDTH; i++) {
            at[i] = roots[tree + i];
        }
        uint32_t moved = 1;
        for (uint32_t level = 0; level < depth && moved; level++) {
            moved = 0;
#pragma GCC unroll 16
            for (uint32_t i = 0; i < SP_WIDE_WIDTH; i++) {
                const sp_wide_node node = nodes[at[i]];
                const float feature = features[node.link & SP_WIDE_LEAF];
                const uint32_t next =
                    (node.link >> SP_WIDE_SLOT_BITS) + (uint32_t)!(feature <= node.value);
                moved |= next ^ at[i];
                at[i] = next;
            }
        }
#pragma GCC unroll 16
        for (uint32_t i = 0; i < SP_WIDE_WIDTH; i++) {
            sum += (int32_t)nodes[at[i]].value;
        }
    }
    return sum;
}

#endif
