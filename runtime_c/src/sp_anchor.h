/* Friction: the place that is felt, a, is an anchor that a spring ties to the tool at x.
 *
 *     H = stick |e|^2 / 2 + S(u, a),   e: what the spring is stretched by,   on the tool: -stick e
 *
 * The anchor stays while its pull p = stick e - dS/da lies within the cone of friction; else it
 * goes along p, by at most
 *
 *     (|p| - friction f) / (stick + bend),   f: normal force,   bend: |d2S/dx dy| + drag's spring
 *
 * in all, and by no more than to the edge of its cell in each axis. Within a cell S is bilinear, so
 * that a part s_k along p_k of that way lowers H by |s_k| |p_k| / 2 at least. At an edge it changes
 * the cell and goes on from there: S is the same on both sides, its slope is not. Loaded, the
 * spring is the lateral stiffness of the contact, and what lies between a device and the slopes of
 * the map. (docs/explanation/passivity.md) */
#ifndef SP_ANCHOR_H
#define SP_ANCHOR_H

#include <stdint.h>

#include "sp_lateral.h"

typedef struct {
    sp_real friction;  /* coefficient, of the normal force */
    sp_real stick_npm; /* stiffness of the spring */
    sp_real drag_npm;  /* and of the drag's */
    uint32_t ways;     /* of the anchor in a tick at most: each ends at an edge but the last */
} sp_anchor_config;

typedef struct {
    sp_real at[2];        /* of the anchor, in steps from the first node */
    sp_real stretch_m[2]; /* of the spring */
    sp_real object_n[2];  /* of the object on the anchor in the last tick: -dS/da, and drag */
    sp_real normal_n;     /* force along the depth then */
    sp_real bend_npm;     /* what bounds how fast object_n changes within the cell */
    uint32_t cell[2];     /* k: before node k; the first and the last are beyond the grid */
    uint32_t touched;     /* 1: the object pushed the tool in the last tick */
} sp_anchor_state;

/* A dent is met again so near to where the tool left it, in steps of the grid. */
#define SP_ANCHOR_NEAR ((sp_real)0.125)

/* Where a place is: its cell, from its steps. */
static inline uint32_t sp_anchor_cell_of(sp_real at, uint32_t n)
{
    if (!(at >= (sp_real)0)) {
        return 0;
    }
    return at < (sp_real)(n - 1u) ? (uint32_t)at + 1u : n;
}

/* The anchor is where the tool is. */
static inline void sp_anchor_rest(const sp_map_config *map, sp_anchor_state *state,
                                  const sp_real *at)
{
    state->at[0] = sp_bounded((at[0] - map->first_x_m) * map->per_step_x);
    state->at[1] = sp_bounded((at[1] - map->first_y_m) * map->per_step_y);
    state->cell[0] = sp_anchor_cell_of(state->at[0], map->nodes_x);
    state->cell[1] = sp_anchor_cell_of(state->at[1], map->nodes_y);
    state->stretch_m[0] = (sp_real)0;
    state->stretch_m[1] = (sp_real)0;
    state->touched = 0u;
}

/* The tool, off the object, is too far from where it left it to meet its dent again. */
static inline int sp_anchor_left(const sp_map_config *map, const sp_anchor_state *state,
                                 const sp_real *at)
{
    const sp_real x = (at[0] - map->first_x_m) * map->per_step_x - state->at[0];
    const sp_real y = (at[1] - map->first_y_m) * map->per_step_y - state->at[1];
    return !(sp_abs(x) <= SP_ANCHOR_NEAR && sp_abs(y) <= SP_ANCHOR_NEAR);
}

/* The part of a way along one axis of n nodes that lies within its cell; 1: all of it, or none. */
static inline sp_real sp_anchor_part(sp_real at, uint32_t cell, uint32_t n, sp_real way)
{
    const uint32_t last = cell < n ? cell : n;
    const sp_real edge = (sp_real)last;
    const sp_real to = sp_bounded(at + way);
    sp_real part = (sp_real)1;
    if (last < n && to > edge && way > SP_SMALLEST) {
        part = (edge - at) / way;
    } else if (last > 0u && to < edge - (sp_real)1 && way < -SP_SMALLEST) {
        part = (edge - (sp_real)1 - at) / way;
    }
    return part > (sp_real)0 && part < (sp_real)1 ? part : (sp_real)1;
}

/* Move the anchor along one axis of n nodes, to the edge of its cell at most; returns its way. */
static inline sp_real sp_anchor_along(sp_real *at, uint32_t *cell, uint32_t n, sp_real way)
{
    const sp_real from = *at;
    const sp_real to = sp_bounded(from + way);
    const uint32_t last = *cell < n ? *cell : n;
    const sp_real edge = (sp_real)last;
    *at = to;
    *cell = last;
    if (last < n && to > edge) {
        *at = edge;
        *cell = last + 1u;
    }
    if (last > 0u && to < edge - (sp_real)1) {
        *at = edge - (sp_real)1;
        *cell = last - 1u;
    }
    return *at - from;
}

/* Where the anchor is on one axis of the grid. */
static inline void sp_anchor_axis(const sp_anchor_state *state, uint32_t k, uint32_t n,
                                  sp_real per_m, sp_lateral_cell *cell)
{
    const uint32_t index = state->cell[k];
    const int inside = index > 0u && index < n;
    const uint32_t before = index > 0u ? index - 1u : 0u;
    cell->node[k] = before < n - 1u ? before : n - 2u;
    cell->way[k] = sp_map_way(state->at[k], cell->node[k]);
    cell->per_m[k] = inside ? per_m : (sp_real)0;
}

/* Where the anchor is. */
static inline sp_lateral_cell sp_anchor_cell(const sp_map_config *map, const sp_anchor_state *state)
{
    sp_lateral_cell cell;
    sp_anchor_axis(state, 0, map->nodes_x, map->per_step_x, &cell);
    sp_anchor_axis(state, 1, map->nodes_y, map->per_step_y, &cell);
    return cell;
}

/* d2S/dx dy of one material that has stored_j, N/m. */
static inline sp_real sp_anchor_bend(const sp_map_config *map, const sp_lateral_cell *cell,
                                     const sp_real *amounts, uint32_t r, sp_real stored_j)
{
    const uint32_t n = map->n_materials;
    const sp_real *near = amounts + (cell->node[0] * map->nodes_y + cell->node[1]) * n + r;
    const sp_real *far = near + map->nodes_y * n;
    const sp_real twist = (far[n] - far[0]) - (near[n] - near[0]);
    return twist * cell->per_m[0] * cell->per_m[1] * stored_j;
}

/* Let the anchor slip out of the cone; adds its way to moved_m. Returns whether it came to an edge.
 */
static inline int sp_anchor_slip(const sp_map_config *map, const sp_anchor_config *config,
                                 sp_anchor_state *state, sp_real *moved_m)
{
    sp_real pull_n[2];
    for (uint32_t k = 0; k < 2; k++) {
        pull_n[k] = sp_bounded(config->stick_npm * state->stretch_m[k] + state->object_n[k]);
    }
    const sp_real x_n = sp_abs(pull_n[0]);
    const sp_real y_n = sp_abs(pull_n[1]);
    const sp_real total_n = sp_sqrt(x_n * x_n + y_n * y_n);
    const sp_real excess_n = total_n - config->friction * state->normal_n;
    if (!(excess_n > (sp_real)0) || !(total_n > SP_SMALLEST)) {
        return 0;
    }
    const sp_real excess = excess_n / total_n;
    const sp_real share = excess < (sp_real)1 ? excess : (sp_real)1;
    const sp_real m_per_n = share / (config->stick_npm + state->bend_npm);
    const sp_real per_m[2] = {map->per_step_x, map->per_step_y};
    const uint32_t nodes[2] = {map->nodes_x, map->nodes_y};
    sp_real ways[2];
    sp_real parts[2];
    for (uint32_t k = 0; k < 2; k++) {
        ways[k] = sp_bounded(m_per_n * pull_n[k] * per_m[k]);
        parts[k] = sp_anchor_part(state->at[k], state->cell[k], nodes[k], ways[k]);
    }
    int came = 0;
    for (uint32_t k = 0; k < 2; k++) {
        const sp_real way = ways[k] * parts[1u - k]; /* straight up to the first edge */
        const uint32_t cell = state->cell[k];
        const sp_real went = sp_anchor_along(&state->at[k], &state->cell[k], nodes[k], way);
        const sp_real went_m = went / per_m[k];
        state->stretch_m[k] = sp_flushed(sp_bounded(state->stretch_m[k] - went_m));
        moved_m[k] = sp_bounded(moved_m[k] + went_m);
        came |= state->cell[k] != cell && sp_abs(went) > (sp_real)0;
    }
    return came;
}

/* What the object does to the anchor in the cell to which it came; stored_j: of each material,
 * drawn_m: of the drag's spring. */
static inline void sp_anchor_pulled(const sp_map_config *map, const sp_anchor_config *config,
                                    sp_anchor_state *state, const sp_real *amounts,
                                    const sp_real *stored_j, const sp_real *drawn_m)
{
    const sp_lateral_cell cell = sp_anchor_cell(map, state);
    const uint32_t n = map->n_materials;
    const sp_real *near = amounts + (cell.node[0] * map->nodes_y + cell.node[1]) * n;
    const sp_real *far = near + map->nodes_y * n;
    sp_real bend_npm = (sp_real)0;
    sp_real felt_n[3] = {(sp_real)0, (sp_real)0, (sp_real)0};
    for (uint32_t r = 0; r < n; r++) {
        const sp_lateral_amount here = sp_lateral_amount_of(&cell, near + r, far + r, n);
        sp_lateral_add(here, (sp_real)0, stored_j[r], felt_n);
        bend_npm += sp_anchor_bend(map, &cell, amounts, r, stored_j[r]);
    }
    state->bend_npm = sp_bounded(sp_abs(bend_npm) + config->drag_npm);
    for (uint32_t k = 0; k < 2; k++) {
        state->object_n[k] = sp_bounded(felt_n[k] - config->drag_npm * drawn_m[k]);
    }
}

/* The tool goes to `at`; moved_m: of the place. It stays while the tool is away, and as it comes.
 * stored_j: of each material in the last tick. */
static inline void sp_anchor_move(const sp_map_config *map, const sp_anchor_config *config,
                                  sp_anchor_state *state, const sp_lateral_state *last,
                                  const sp_real *amounts, const sp_real *stored_j,
                                  const sp_real *at, int touches, sp_real *moved_m)
{
    const int stays = !touches || state->touched == 0u;
    for (uint32_t k = 0; k < 2; k++) {
        const sp_real way_m = at[k] - last->at_m[k];
        moved_m[k] = (sp_real)0;
        state->stretch_m[k] = stays ? (sp_real)0 : sp_bounded(state->stretch_m[k] + way_m);
    }
    for (uint32_t i = 0; !stays && i < config->ways; i++) {
        if (!sp_anchor_slip(map, config, state, moved_m)) {
            break;
        }
        const sp_real drawn_m[2] = {last->drawn_m[0] + moved_m[0], last->drawn_m[1] + moved_m[1]};
        sp_anchor_pulled(map, config, state, amounts, stored_j, drawn_m);
    }
    state->touched = touches ? 1u : 0u;
}

/* Keep what the object does to the anchor, felt_n; in its place comes what the tool feels. */
static inline void sp_anchor_feel(const sp_anchor_config *config, sp_anchor_state *state,
                                  sp_real bend_npm, sp_real *felt_n)
{
    state->bend_npm = sp_bounded(sp_abs(bend_npm) + config->drag_npm);
    state->normal_n = felt_n[2];
    for (uint32_t k = 0; k < 2; k++) {
        state->object_n[k] = sp_bounded(felt_n[k]);
        felt_n[k] = -config->stick_npm * state->stretch_m[k];
    }
}

#endif
