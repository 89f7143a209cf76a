/* Account of energy of a tool of three axes: sp_energy.h along the direction of the force.
 *
 * unit is that direction: the force pushes along x and y, and out of the object, so that over a way
 * d the hand pays
 *
 *     F (unit_z d_z - unit_x d_x - unit_y d_y)
 *
 * The direction turns from tick to tick. So what is kept are ways, axis by axis, and how the tool
 * goes on is looked at along the force that is held. */
#ifndef SP_ENERGY3_H
#define SP_ENERGY3_H

#include "sp_energy.h"

typedef struct {
    sp_energy_state along; /* E; position, step and bend in a silence alone */
    sp_real paid_m[3];     /* x, y, depth up to which it is paid */
    sp_real looked_m[3];   /* where the tool was at the last look */
    sp_real rest_m[3];     /* where it is but for its encoders' noise at rest */
    sp_real step_m[3];     /* mean way of the tool in a tick */
    sp_real bend_m[3];     /* mean change of that in a tick */
} sp_energy3_state;

/* Way against the force. */
static inline sp_real sp_energy3_way(const sp_real *unit, const sp_real *way_m)
{
    return unit[2] * way_m[2] - (unit[0] * way_m[0] + unit[1] * way_m[1]);
}

/* Square of a way, m^2; of sizes, so that each part shows as positive. */
static inline sp_real sp_energy3_square(const sp_real *way_m)
{
    sp_real square = (sp_real)0;
    for (uint32_t k = 0; k < 3; k++) {
        const sp_real size_m = sp_abs(way_m[k]);
        square += size_m * size_m;
    }
    return square;
}

/* What was pressed before is not known. */
static inline void sp_energy3_restart(const sp_energy_config *config, sp_energy3_state *state,
                                      const sp_real *at)
{
    sp_energy_restart(config, &state->along, at[2]);
    for (uint32_t k = 0; k < 3; k++) {
        state->paid_m[k] = at[k];
        state->looked_m[k] = at[k];
        state->rest_m[k] = at[k];
        state->step_m[k] = (sp_real)0;
        state->bend_m[k] = (sp_real)0;
    }
}

/* How the tool moved since the last look. */
SP_RARE void sp_energy3_look(const sp_energy_config *config, sp_energy3_state *state,
                             const sp_real *at)
{
    const sp_real per_tick = (sp_real)1 / state->along.ticks;
    for (uint32_t k = 0; k < 3; k++) {
        const sp_real way_m = at[k] - state->looked_m[k];
        const sp_real moved_m = sp_abs(way_m) > config->slack_m ? way_m : (sp_real)0;
        const sp_real step_m = moved_m * per_tick;
        state->bend_m[k] = (step_m - state->step_m[k]) * per_tick;
        state->step_m[k] = step_m;
        state->looked_m[k] = at[k];
    }
    const sp_real bent_m = sp_sqrt(sp_energy3_square(state->bend_m));
    const sp_real turn_m = sp_flushed(state->along.turn_m * config->keep);
    state->along.turn_m = bent_m > turn_m ? bent_m : turn_m;
    state->along.ticks = (sp_real)0;
}

/* Under forces from held_n to given_n along unit the tool came to `at`, so many ticks after the
 * last sample; damped_j went into the device's own friction. step: the last one, becomes that which
 * the tool may go on by. */
static inline void sp_energy3_pay(const sp_energy_config *config, sp_energy3_state *state,
                                  const sp_real *unit, sp_real given_n, sp_real held_n,
                                  const sp_real *at, sp_real ticks, sp_real damped_j, sp_real *step)
{
    sp_real moved_m[3];
    for (uint32_t k = 0; k < 3; k++) {
        const sp_real way_m = at[k] - state->paid_m[k];
        const int moves = sp_abs(way_m) > config->slack_m;
        moved_m[k] = moves ? way_m : (sp_real)0;
        state->paid_m[k] = moves ? at[k] : state->paid_m[k];
        step[k] = sp_energy_on(config, &state->rest_m[k], at[k], step[k]);
    }
    const sp_real against_m = sp_energy3_way(unit, moved_m);
    const sp_real paid_j = given_n * against_m;
    const sp_real least_j = held_n * against_m;
    const sp_real left_j = (state->along.left_j + damped_j) + (least_j < paid_j ? least_j : paid_j);
    const sp_real most_j = sp_energy_most(config, at[2]);
    state->along.left_j = sp_bounded(left_j < most_j ? left_j : most_j);
    state->along.ticks += ticks;
    if (state->along.ticks >= config->look_ticks) {
        sp_energy3_look(config, state, at);
    }
}

/* sp_energy_wait along the force that is held. */
static inline sp_real sp_energy3_wait(const sp_energy_config *config, sp_energy3_state *state,
                                      const sp_real *unit, sp_real silent, sp_real ticks,
                                      sp_real held_n, sp_real given_n, int *notes)
{
    state->along.step_m = sp_energy3_way(unit, state->step_m);
    state->along.bend_m = sp_energy3_way(unit, state->bend_m);
    state->along.position_m = state->paid_m[2];
    given_n = sp_energy_wait(config, &state->along, silent, ticks, held_n, given_n, notes);
    const sp_real on_m = state->along.position_m - state->paid_m[2];
    state->paid_m[0] = sp_bounded(state->paid_m[0] - unit[0] * on_m);
    state->paid_m[1] = sp_bounded(state->paid_m[1] - unit[1] * on_m);
    state->paid_m[2] = sp_bounded(state->paid_m[2] + unit[2] * on_m);
    return given_n;
}

#endif
