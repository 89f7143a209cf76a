/* A map: an object that is not the same everywhere, of materials that are mixed at each place.
 *
 *     curve at a place = sum over materials r of amount_r(place) curve_r
 *
 * The amounts are given at the nodes of a regular grid, are bilinear within a cell, and never
 * negative. The place changes only while the tool is off the object, which then has rested there
 * for ever: stored energy falls to 0 (docs/explanation/model.md). */
#ifndef SP_MAP_H
#define SP_MAP_H

#include <stdint.h>

#include "sp_real.h"

typedef struct {
    sp_real first_x_m; /* of the first node */
    sp_real first_y_m;
    sp_real steps_per_m_x; /* 1/m */
    sp_real steps_per_m_y;
    uint32_t nodes_x; /* 2 at least */
    uint32_t nodes_y;
    uint32_t n_materials;
    uint32_t n_curves; /* numbers of a material: those of all its curves */
} sp_map_config;

typedef struct {
    sp_real x; /* in steps from the first node, on the grid */
    sp_real y;
    uint32_t pending; /* 1: for the tool to be off the object */
} sp_map_state;

/* As many materials as a map may have. */
enum { SP_MAP_MAX_MATERIALS = 8 };

/* In steps from the first of n nodes; beyond the grid its edge. A NaN is at the first node. */
static inline sp_real sp_map_grid_coordinate(sp_real at_m, sp_real first_m, sp_real per_step,
                                             uint32_t n)
{
    const sp_real passed = (at_m - first_m) * per_step;
    const sp_real last = (sp_real)(n - 1u);
    if (passed == passed && passed > (sp_real)0) { /* a NaN is not itself */
        return passed < last ? passed : last;
    }
    return (sp_real)0;
}

/* The place of the next contact, m; the one that is felt already changes nothing. */
static inline void sp_map_set_site(const sp_map_config *config, sp_map_state *state, sp_real x_m,
                                   sp_real y_m)
{
    const sp_real x =
        sp_map_grid_coordinate(x_m, config->first_x_m, config->steps_per_m_x, config->nodes_x);
    const sp_real y =
        sp_map_grid_coordinate(y_m, config->first_y_m, config->steps_per_m_y, config->nodes_y);
    if (x != state->x || y != state->y) {
        state->x = x;
        state->y = y;
        state->pending = 1u;
    }
}

/* The node before a place. */
static inline uint32_t sp_map_cell(sp_real steps, uint32_t n)
{
    const uint32_t node = (uint32_t)steps;
    return node < n - 1u ? node : n - 2u;
}

/* Way from there to the next node, 0 to 1: the bounds act on no place, and show to a proof. */
static inline sp_real sp_map_cell_fraction(sp_real steps, uint32_t node)
{
    const sp_real way = steps - (sp_real)node;
    if (!(way > (sp_real)0)) {
        return (sp_real)0;
    }
    return way < (sp_real)1 ? way : (sp_real)1;
}

/* A number of all materials, of which those of the next one lie n_curves further. */
static inline sp_real sp_map_mix(const sp_map_config *config, const sp_real *amount,
                                 const sp_real *first_material)
{
    sp_real mixed = amount[0] * first_material[0];
    for (uint32_t r = 1; r < config->n_materials; r++) {
        mixed += amount[r] * first_material[r * config->n_curves];
    }
    return mixed;
}

/* Raise what is divided by to `least`: all amounts of a place may be 0. */
static inline void sp_map_clamp_below(sp_real *values, uint32_t n, sp_real least)
{
    for (uint32_t i = 0; i < n; i++) {
        values[i] = values[i] > least ? values[i] : least;
    }
}

/* Mix the curves of the place that pending, if one does. amounts: [nodes_x][nodes_y][n_materials];
 * materials: [n_materials][n_curves]; curves: [n_curves]. */
static inline void sp_map_apply_site(const sp_map_config *config, sp_map_state *state,
                                     const sp_real *amounts, const sp_real *materials,
                                     sp_real *curves)
{
    if (state->pending == 0u) {
        return;
    }
    state->pending = 0u;
    const uint32_t i = sp_map_cell(state->x, config->nodes_x);
    const uint32_t j = sp_map_cell(state->y, config->nodes_y);
    const sp_real x = sp_map_cell_fraction(state->x, i);
    const sp_real y = sp_map_cell_fraction(state->y, j);
    const uint32_t n = config->n_materials;
    const sp_real *near = amounts + (i * config->nodes_y + j) * n;
    const sp_real *far = near + config->nodes_y * n;
    sp_real amount[SP_MAP_MAX_MATERIALS];
    for (uint32_t r = 0; r < SP_MAP_MAX_MATERIALS; r++) {
        amount[r] = (sp_real)0;
    }
    for (uint32_t r = 0; r < n; r++) {
        const sp_real low = ((sp_real)1 - x) * ((sp_real)1 - y) * near[r];
        const sp_real left = ((sp_real)1 - x) * y * near[r + n];
        const sp_real right = x * ((sp_real)1 - y) * far[r];
        amount[r] = low + left + right + x * y * far[r + n];
    }
    for (uint32_t k = 0; k < config->n_curves; k++) {
        curves[k] = sp_map_mix(config, amount, materials + k);
    }
}

#endif
