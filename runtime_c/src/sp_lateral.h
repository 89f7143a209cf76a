/* The lateral force of an object that is not the same everywhere, for a tool that slides on it.
 *
 * Each material is a passive model of its own; all follow one depth, and what they remember goes
 * with the tool. With S_r, what material r has stored (sp_stored.h), and its force f_r:
 *
 *     S(u, a) = sum over r of amount_r(a) S_r,   normal force: sum over r of amount_r f_r,
 *                                                lateral force: -dS/da
 *
 * so that over a tick at one place the work is at least the change of S, as each material's is, and
 * over a move of the place a it is that change (docs/explanation/passivity.md). Where the place is:
 * sp_anchor.h. Fresh ground under the tool: sp_drag.h. */
#ifndef SP_LATERAL_H
#define SP_LATERAL_H

#include <stdint.h>

#include "sp_map.h"
#include "sp_notes.h"
#include "sp_number.h"

typedef struct {
    sp_real at_m[3];    /* of the tool in the last tick: x, y, depth */
    sp_real drawn_m[2]; /* how far the drag's spring is drawn (sp_drag.h) */
    sp_real renewed;    /* share of branches to renew, which that spring has paid for */
    sp_real paid_j;     /* what renewing all was taken to take */
    sp_real unit[3];    /* direction of the force that was given */
    uint32_t lost;      /* 1: one axis was taken as true without a history, the others were not */
} sp_lateral_state;

/* Where a place is on the grid; beyond the grid its edge. */
typedef struct {
    uint32_t node[2]; /* before it, in x and y */
    sp_real way[2];   /* from there to the next one, 0 to 1 */
    sp_real per_m[2]; /* nodes per m; 0 beyond the grid, where amounts are constant */
} sp_lateral_cell;

typedef struct {
    sp_real amount;
    sp_real by_x; /* its slope, 1/m */
    sp_real by_y;
} sp_lateral_amount;

/* The tool is at `at`, and draws nothing. */
static inline void sp_lateral_rest(sp_lateral_state *state, const sp_real *at)
{
    for (uint32_t k = 0; k < 3; k++) {
        state->at_m[k] = at[k];
    }
    state->drawn_m[0] = (sp_real)0;
    state->drawn_m[1] = (sp_real)0;
    state->renewed = (sp_real)0;
}

/* The tool goes to `at`, and the place by moved_m. Returns the share of branches to renew: after
 * the place has moved, for it moved along the slope of what was stored before. */
static inline sp_real sp_lateral_move(sp_lateral_state *state, const sp_real *at,
                                      const sp_real *moved_m, int touches)
{
    const sp_real renewed = state->renewed;
    state->renewed = (sp_real)0;
    for (uint32_t k = 0; k < 3; k++) {
        state->at_m[k] = at[k];
    }
    for (uint32_t k = 0; k < 2; k++) {
        state->drawn_m[k] = touches ? sp_bounded(state->drawn_m[k] + moved_m[k]) : (sp_real)0;
    }
    return renewed;
}

/* Of one material in a cell; near, far: its amounts at the nodes before and behind in x, and the
 * next one in y n_materials further. */
static inline sp_lateral_amount sp_lateral_amount_of(const sp_lateral_cell *cell,
                                                     const sp_real *near, const sp_real *far,
                                                     uint32_t n_materials)
{
    const sp_real x = cell->way[0];
    const sp_real y = cell->way[1];
    const sp_real left = ((sp_real)1 - y) * near[0] + y * near[n_materials];
    const sp_real right = ((sp_real)1 - y) * far[0] + y * far[n_materials];
    const sp_real low = ((sp_real)1 - x) * near[0] + x * far[0];
    const sp_real high = ((sp_real)1 - x) * near[n_materials] + x * far[n_materials];
    const sp_lateral_amount here = {((sp_real)1 - x) * left + x * right,
                                    (right - left) * cell->per_m[0], (high - low) * cell->per_m[1]};
    return here;
}

/* Of each material in a cell. amounts: as of sp_map_take; here: [n_materials]. Returns whether the
 * place is on the grid. */
static inline int sp_lateral_amounts(const sp_map_config *config, const sp_lateral_cell *cell,
                                     const sp_real *amounts, sp_lateral_amount *here)
{
    const uint32_t n = config->n_materials;
    const sp_real *near = amounts + (cell->node[0] * config->nodes_y + cell->node[1]) * n;
    const sp_real *far = near + config->nodes_y * n;
    for (uint32_t r = 0; r < n; r++) {
        here[r] = sp_lateral_amount_of(cell, near + r, far + r, n);
    }
    return cell->per_m[0] > (sp_real)0 && cell->per_m[1] > (sp_real)0;
}

/* What of_first is of all materials: `n` numbers, those of the next one n_curves further. */
static inline void sp_lateral_mixed(const sp_map_config *config, const sp_lateral_amount *here,
                                    const sp_real *of_first, uint32_t n, sp_real *mixed)
{
    for (uint32_t k = 0; k < n; k++) {
        mixed[k] = here[0].amount * of_first[k];
        for (uint32_t r = 1; r < config->n_materials; r++) {
            mixed[k] += here[r].amount * of_first[r * config->n_curves + k];
        }
    }
}

/* Add what one material gives: force_n and its stored energy, J. */
static inline void sp_lateral_add(sp_lateral_amount here, sp_real force_n, sp_real stored_j,
                                  sp_real *felt_n)
{
    felt_n[0] -= here.by_x * stored_j;
    felt_n[1] -= here.by_y * stored_j;
    felt_n[2] += here.amount * force_n;
}

/* A part of a length, -1 to 1: the bounds act on rounding alone. */
static inline sp_real sp_lateral_part(sp_real part_n, sp_real length_n)
{
    const sp_real part = length_n > SP_SMALLEST ? part_n / length_n : (sp_real)0;
    const sp_real below = part < (sp_real)1 ? part : (sp_real)1;
    return below > (sp_real)-1 ? below : (sp_real)-1;
}

/* Square of a vector; of sizes, so that each part shows as positive. */
static inline sp_real sp_lateral_square(const sp_real *vector)
{
    sp_real square = (sp_real)0;
    for (uint32_t k = 0; k < 3; k++) {
        const sp_real size = sp_abs(vector[k]);
        square += size * size;
    }
    return square;
}

/* Length of a force, N; keeps its direction. */
static inline sp_real sp_lateral_length(sp_lateral_state *state, const sp_real *felt_n)
{
    for (uint32_t k = 0; k < 3; k++) {
        state->unit[k] = sp_flushed(sp_bounded(felt_n[k]));
    }
    const sp_real length_n = sp_sqrt(sp_lateral_square(state->unit));
    for (uint32_t k = 0; k < 3; k++) {
        state->unit[k] = sp_lateral_part(state->unit[k], length_n);
    }
    return length_n;
}

/* A force of given_n in the direction that is kept; a part that a stray write made is none. */
static inline void sp_lateral_give(const sp_lateral_state *state, sp_real given_n, sp_real *force_n)
{
    for (uint32_t k = 0; k < 3; k++) {
        const sp_real part = state->unit[k];
        const int sound = part >= (sp_real)-1 && part <= (sp_real)1;
        force_n[k] = sound ? given_n * part : (sp_real)0;
    }
}

/* The length that a force of given_n in the direction that is kept may have, N. The vector grows by
 * slew_n at most, whichever way it turns: from what lies nearest to it between 0 and before_n,
 * which was given last. */
static inline sp_real sp_lateral_grown(sp_lateral_state *state, const sp_real *before_n,
                                       sp_real slew_n, sp_real given_n, int *notes)
{
    sp_real force_n[3];
    sp_real more_n[3];
    sp_lateral_give(state, given_n, force_n);
    const sp_real square = sp_lateral_square(before_n);
    const sp_real along =
        before_n[0] * force_n[0] + before_n[1] * force_n[1] + before_n[2] * force_n[2];
    const sp_real part = square > SP_SMALLEST ? along / square : (sp_real)0;
    const sp_real below = part < (sp_real)1 ? part : (sp_real)1;
    const sp_real stays = below > (sp_real)0 ? below : (sp_real)0;
    for (uint32_t k = 0; k < 3; k++) {
        more_n[k] = force_n[k] - stays * before_n[k];
    }
    const sp_real growth_n = sp_sqrt(sp_lateral_square(more_n));
    if (!(growth_n > slew_n)) {
        return given_n;
    }
    *notes |= SP_NOTE_LIMITED;
    for (uint32_t k = 0; k < 3; k++) {
        force_n[k] = stays * before_n[k] + slew_n / growth_n * more_n[k];
    }
    const sp_real length_n = sp_lateral_length(state, force_n);
    return length_n < given_n ? length_n : given_n;
}

#endif
