/* Map of an object that differs from site to site: a mixture of materials.
 *
 *     curve at a site = sum over materials r of amount_r(site) curve_r
 *
 * The amounts are non-negative at the nodes of a regular grid, and bilinear within a cell. The site
 * changes only while the tool is off the object, which then counts as rested: the stored energy
 * falls to 0 (docs/explanation/model.md). */
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
    uint32_t n_curves; /* values of one material: those of all its curves */
} sp_map_config;

typedef struct {
    sp_real x; /* grid coordinate: steps from the first node */
    sp_real y;
    uint32_t pending; /* 1: a new site waits until the tool is off the object */
} sp_map_state;

/* Most materials of a map. */
enum { SP_MAP_MAX_MATERIALS = 8 };

/* Steps from the first of n nodes; clamped to the grid. NaN becomes the first node. */
static inline sp_real sp_map_grid_coordinate(sp_real at_m, sp_real first_m, sp_real per_step,
                                             uint32_t n)
{
    const sp_real steps = (at_m - first_m) * per_step;
    const sp_real last = (sp_real)(n - 1u);
    if (steps == steps && steps > (sp_real)0) { /* false for NaN */
        return steps < last ? steps : last;
    }
    return (sp_real)0;
}

/* Set the site of the next contact, m. The site that is rendered already changes nothing. */
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

/* Index of the node below a grid coordinate: of the cell that holds it. */
static inline uint32_t sp_map_cell(sp_real steps, uint32_t n)
{
    const uint32_t node = (uint32_t)steps;
    return node < n - 1u ? node : n - 2u;
}

/* Fraction of the cell, 0 to 1. The clamps never act; they give the static analyser its range. */
static inline sp_real sp_map_cell_fraction(sp_real steps, uint32_t node)
{
    const sp_real fraction = steps - (sp_real)node;
    if (!(fraction > (sp_real)0)) {
        return (sp_real)0;
    }
    return fraction < (sp_real)1 ? fraction : (sp_real)1;
}

/* Weighted sum over the materials, whose values are n_curves apart. */
static inline sp_real sp_map_mix(const sp_map_config *config, const sp_real *amount,
                                 const sp_real *first_material)
{
    sp_real mixed = amount[0] * first_material[0];
    for (uint32_t r = 1; r < config->n_materials; r++) {
        mixed += amount[r] * first_material[r * config->n_curves];
    }
    return mixed;
}

/* Raise divisors to min_value: all amounts of a site may be 0. */
static inline void sp_map_clamp_below(sp_real *values, uint32_t n, sp_real min_value)
{
    for (uint32_t i = 0; i < n; i++) {
        values[i] = values[i] > min_value ? values[i] : min_value;
    }
}

/* Mix the curves of a new site, if one is pending. amounts: [nodes_x][nodes_y][n_materials];
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
