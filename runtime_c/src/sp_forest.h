/* Forest: sum of the leaves that a feature vector reaches, one in each tree.
 *
 * Features are bins (whole numbers), so a threshold has 16 bits and a node 4 bytes. A node sends
 * larger bins to the right. The first SP_FOREST_LEVELS levels of every tree are complete and lie
 * side by side, heap position by heap position; a leaf within these levels sends everything to the
 * left. Below, the high bits of `step` are the distance to the left child in nodes, its low bits
 * the feature's slot; the right child follows the left one, and three levels lie together. A leaf
 * has step 0 and its value as bin: slot 0 always has bin 0, so a traversal that goes on stays
 * there. Thus many trees are traversed at once without a branch that depends on data, and their
 * waits for memory overlap. Sums are integers: the same in any order, on any processor. */
#ifndef SP_FOREST_H
#define SP_FOREST_H

#include <stdint.h>

enum {
    SP_FOREST_SLOT_BITS = 4,
    SP_FOREST_SLOTS = 1 << SP_FOREST_SLOT_BITS,
    SP_FOREST_LEVELS = 4,
    SP_FOREST_ENTRIES = 1 << SP_FOREST_LEVELS, /* entries of a tree below its first levels */
    SP_FOREST_BLIND_LEVELS = 3                 /* levels traversed before looking for inner nodes */
};

/* Trees traversed at once: enough to hide the wait for memory; one on targets without a cache. */
#if defined(__x86_64__) || defined(__aarch64__) || defined(_M_X64)
enum { SP_FOREST_TRAVERSALS = 20, SP_FOREST_REMAINDER = 10 };
#elif defined(__wasm__) /* has fewer registers */
enum { SP_FOREST_TRAVERSALS = 10, SP_FOREST_REMAINDER = 10 };
#else
enum { SP_FOREST_TRAVERSALS = 1, SP_FOREST_REMAINDER = 1 };
#endif

typedef struct {
    uint16_t step;
    uint16_t bin_index;
} sp_forest_node;

typedef struct {
    const sp_forest_node *top;   /* [SP_FOREST_ENTRIES - 1][n_padded] */
    const sp_forest_node *nodes; /* tree after tree, each begins with SP_FOREST_ENTRIES */
    const uint32_t *roots;       /* [n_padded]: first entry of each tree */
    uint32_t n_trees;
    uint32_t n_padded; /* trees and padding: every traversal finds whole groups */
} sp_forest;

static inline uint32_t sp_forest_right(const sp_forest_node *node, const uint32_t *bins)
{
    /* 1 where the feature's bin is greater, without a flag: both are far below 2^31. */
    return (node->bin_index - bins[node->step & (SP_FOREST_SLOTS - 1)]) >> 31;
}

/* Sum of the leaves that `trees` trees from `tree` on give for these bins, in leaf steps. The
 * trees go down together, level by level, so that their loads overlap. `trees` is a constant
 * where this is inlined. */
static inline uint32_t sp_forest_traverse(const sp_forest *forest, uint32_t tree, uint32_t trees,
                                          const uint32_t *bins)
{
    uint32_t heap[SP_FOREST_TRAVERSALS];
#pragma GCC unroll 20
    for (uint32_t i = 0; i < trees; i++) {
        heap[i] = 1;
    }
#pragma GCC unroll 1
    for (uint32_t level = 0; level < SP_FOREST_LEVELS; level++) {
#pragma GCC unroll 20
        for (uint32_t i = 0; i < trees; i++) {
            const sp_forest_node *node = forest->top + (heap[i] - 1) * forest->n_padded + tree + i;
            heap[i] = 2 * heap[i] + sp_forest_right(node, bins);
        }
    }
    const sp_forest_node *at[SP_FOREST_TRAVERSALS];
#pragma GCC unroll 20
    for (uint32_t i = 0; i < trees; i++) {
        at[i] = forest->nodes + forest->roots[tree + i] + (heap[i] - SP_FOREST_ENTRIES);
    }
    uint32_t steps;
    do {
        steps = 0;
#pragma GCC unroll 3
        for (uint32_t level = 0; level < SP_FOREST_BLIND_LEVELS; level++) {
#pragma GCC unroll 20
            for (uint32_t i = 0; i < trees; i++) {
                //@ split at[i] - forest->nodes;
                const uint32_t right = sp_forest_right(at[i], bins);
                const uint32_t step = at[i]->step;
                steps |= level + 1 == SP_FOREST_BLIND_LEVELS ? step : 0;
                at[i] += (step >> SP_FOREST_SLOT_BITS) + right;
            }
        }
    } while (steps);
    uint32_t sum = 0;
#pragma GCC unroll 20
    for (uint32_t i = 0; i < trees; i++) {
        sum += at[i]->bin_index;
    }
    return sum;
}

/* Sum of the leaves of all trees, in leaf steps. bins: [SP_FOREST_SLOTS], all below 2^16, the
 * first one 0. */
static inline uint32_t sp_forest_sum(const sp_forest *forest, const uint32_t *bins)
{
    uint32_t sum = 0;
    uint32_t tree = 0;
    for (; tree + SP_FOREST_TRAVERSALS <= forest->n_trees; tree += SP_FOREST_TRAVERSALS) {
        sum += sp_forest_traverse(forest, tree, SP_FOREST_TRAVERSALS, bins);
    }
    for (; tree < forest->n_trees; tree += SP_FOREST_REMAINDER) {
        sum += sp_forest_traverse(forest, tree, SP_FOREST_REMAINDER, bins);
    }
    return sum;
}

#endif
