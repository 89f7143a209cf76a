/* The place that is felt goes with a tool that touches.
 *
 * While the tool is away the place stays, for the tool would get what it is worth elsewhere for
 * nothing. Off the object the dent is left behind, and everything rests. With friction:
 * sp_anchor.h, which has the same calls. */
#ifndef SP_FOLLOW_H
#define SP_FOLLOW_H

#include <stdint.h>

#include "sp_lateral.h"

typedef struct {
    sp_real off_m[2]; /* of the place that is felt, from the tool of the last tick */
} sp_follow_state;

/* The place that is felt is the tool's. */
static inline void sp_follow_rest(sp_follow_state *state)
{
    state->off_m[0] = (sp_real)0;
    state->off_m[1] = (sp_real)0;
}

/* The tool, off the object, is too far from where it left it to meet its dent again. */
static inline int sp_follow_left(const sp_map_config *map, const sp_follow_state *state,
                                 const sp_lateral_state *last, const sp_real *at)
{
    return sp_lateral_far(map, state->off_m[0] + (last->at_m[0] - at[0]),
                          state->off_m[1] + (last->at_m[1] - at[1]));
}

/* The tool goes to `at`; moved_m: of the place. */
static inline void sp_follow_move(sp_follow_state *state, const sp_lateral_state *last,
                                  const sp_real *at, int touches, sp_real *moved_m)
{
    for (uint32_t k = 0; k < 2; k++) {
        const sp_real way_m = at[k] - last->at_m[k];
        moved_m[k] = way_m;
        state->off_m[k] = touches ? state->off_m[k] : sp_bounded(state->off_m[k] - way_m);
    }
}

/* Nodes per m within the grid of n nodes; 0 beyond it. */
static inline sp_real sp_follow_per_m(sp_real at_m, sp_real first_m, sp_real per_step, uint32_t n)
{
    const sp_real passed = (at_m - first_m) * per_step;
    return passed >= (sp_real)0 && passed <= (sp_real)(n - 1u) ? per_step : (sp_real)0;
}

/* Where the place is; last: where the tool was. */
static inline sp_lateral_cell sp_follow_cell(const sp_map_config *map, const sp_follow_state *state,
                                             const sp_lateral_state *last)
{
    const sp_real x_m = last->at_m[0] + state->off_m[0];
    const sp_real y_m = last->at_m[1] + state->off_m[1];
    const sp_real x = sp_map_steps(x_m, map->first_x_m, map->per_step_x, map->nodes_x);
    const sp_real y = sp_map_steps(y_m, map->first_y_m, map->per_step_y, map->nodes_y);
    const uint32_t i = sp_map_node(x, map->nodes_x);
    const uint32_t j = sp_map_node(y, map->nodes_y);
    const sp_lateral_cell cell = {
        {i, j},
        {sp_map_way(x, i), sp_map_way(y, j)},
        {sp_follow_per_m(x_m, map->first_x_m, map->per_step_x, map->nodes_x),
         sp_follow_per_m(y_m, map->first_y_m, map->per_step_y, map->nodes_y)}};
    return cell;
}

#endif
