/* What a fit computes tick by tick, in double, from tables that it gives: the force of a passive
 * model along a motion, by the units of the emitted C in the order of the emitted C, and the values
 * of the terms that such a model is fitted from. In numpy, tick by tick, it took most of a fit. */
#include <stddef.h>

#include "sp_damage.h"
#include "sp_depth.h"
#include "sp_flow.h"
#include "sp_hammerstein.h"
#include "sp_poles.h"
#include "sp_surface.h"

/* springpot declarations begin */
typedef struct {
    double bias_n;
    uint32_t n_intervals, n_branches, n_stops, n_constant, n_cubic, n_flow, n_linear, n_damage;
    const double *spring, *branches, *loss, *depth_loss, *stops, *radius;
    const double *flow_loss, *flow_n, *damage, *healed;
    const double *max_slope_n; /* NULL: the tool never leaves the object */
    const uint8_t *flow_function;
} sp_fit_model;

/* From tick to tick, of the model's counts; values: [n_branches + n_damage], of no meaning after.
 */
typedef struct {
    double *before, *held, *play, *flow_before, *flow, *deepest, *values;
    double u, force_n; /* where the model is, and what it gives there */
} sp_fit_state;

/* The tool at u of each of n ticks: the force on it, N, and where the model is. The first
 * n_constant branches have one rate at any depth. */
void sp_fit_motion(const sp_fit_model *model, sp_fit_state *state, uint32_t n, const double *u,
                   double *force_n, double *model_u);

/* Terms: curves of hats, functions of u with a slope at one node, as they are, behind poles of a
 * constant rate, and of stops, if plain; behind poles with a rate by depth, and of damage. */
typedef struct {
    uint32_t plain, n_nodes, n_constant, n_stops, n_depth, n_damage, n_pauses;
    const double *hats, *radius, *depth_loss, *healed;
    const double *kept, *gain; /* of a tick: h becomes kept h + gain rise */
    const double *pause_kept, *pause_gain, *pause_healed; /* of one longer tick, a row each */
    const int32_t *pause_at;                              /* their numbers */
    const uint8_t *cubic;                                 /* [n_damage]: power 3, else 1 */
} sp_fit_terms;

/* Each at rest; values: the hats at u before, rise: [n_nodes]; kept, gain: [n_constant + n_depth];
 * h: [n_constant + n_depth][n_nodes], 0; play: [n_stops], at u; deepest: [n_damage]. */
typedef struct {
    double *values, *rise, *kept, *gain, *h, *play, *deepest;
} sp_fit_work;

/* Values at the n_rows rows of n ticks at u, of each curve the hats: [n_rows][curves][n_nodes]. */
void sp_fit_columns(const sp_fit_terms *terms, sp_fit_work *work, uint32_t n, const double *u,
                    uint32_t n_rows, const int32_t *rows, double *columns);

/* h of branches that flow, at rows: [n_rows][n_flow]. loss_ps: of a second; steps_s: before each
 * tick. flow_before: of the functions at u before; h: [n_flow]. */
void sp_fit_flow(uint32_t n, const double *u, const double *steps_s, uint32_t n_flow,
                 uint32_t n_cubic, const double *loss_ps, const uint8_t *function,
                 double *flow_before, double *h, uint32_t n_rows, const int32_t *rows,
                 double *columns);
/* springpot declarations end */

/* Force of the passive model at depth u, N, and its state one tick on: spring, branches,
 * sliders, flow and damage, the sum that the emitted C makes. */
static double next_force(const sp_fit_model *m, const sp_hammerstein_config *config,
                         const sp_hammerstein_tables *tables, sp_fit_state *s, double u)
{
    const uint32_t constant = m->n_constant;
    const sp_curve_position place = sp_curve_locate(u, m->n_intervals);
    double *intact = s->values + m->n_branches;
    sp_curve(m->branches, m->n_branches, place, s->values);
    sp_poles_separate(m->loss, constant, s->values, s->before, s->held);
    sp_poles_by_depth(m->depth_loss, m->n_branches - constant, place, s->values + constant,
                      s->before + constant, s->held + constant);
    double force_n = sp_hammerstein_force(config, tables, u, place, s->held, s->play);
    force_n += sp_flow(m->flow_loss, m->flow_n, m->flow_function, m->n_cubic, m->n_flow, u,
                       s->flow_before, s->flow);
    sp_curve(m->damage, m->n_damage, place, intact);
    return force_n + sp_damage(m->healed, m->n_linear, m->n_damage, u, intact, s->deepest);
}

/* Simulate the model over n depths u (1 is the depth of training). Where the tool leaves faster
 * than the surface recovers, model_u is the surface and the force 0. */
void sp_fit_motion(const sp_fit_model *model, sp_fit_state *state, uint32_t n, const double *u,
                   double *force_n, double *model_u)
{
    const sp_hammerstein_config config = {
        0.0, 1.0, model->bias_n, model->n_intervals, model->n_branches, model->n_stops};
    const sp_hammerstein_tables tables = {model->spring, model->branches, model->stops,
                                          model->radius};
    for (uint32_t i = 0; i < n; i++) {
        const sp_surface_state surface = {state->u, state->force_n};
        state->u = model->max_slope_n == NULL
                       ? u[i]
                       : sp_surface_model_u(model->max_slope_n, model->n_intervals, &surface, u[i]);
        state->force_n = next_force(model, &config, &tables, state, state->u);
        model_u[i] = state->u;
        force_n[i] = state->u > u[i] ? 0.0 : state->force_n;
    }
}

/* Factors of this tick's recursion h = kept h + gain rise for each relaxation: constant ones
 * are copied, those that depend on depth are interpolated at `place`. */
static void set_poles(const sp_fit_terms *t, sp_fit_work *w, sp_curve_position place)
{
    const double *at = t->depth_loss + place.interval * t->n_depth;
    for (uint32_t k = 0; k < t->n_constant; k++) {
        w->kept[k] = t->kept[k];
        w->gain[k] = t->gain[k];
    }
    for (uint32_t k = 0; k < t->n_depth; k++) {
        const double loss = at[k] + place.fraction * (at[t->n_depth + k] - at[k]);
        w->kept[t->n_constant + k] = 1.0 - loss;
        w->gain[t->n_constant + k] = 1.0 - 0.5 * loss;
    }
}

/* Advance every regressor of the linear fit by a tick to depth u: for each relaxation a state a
 * node of the curve, for each stop (a slider) its play, for each damage curve the deepest depth. */
static void step_terms(const sp_fit_terms *t, sp_fit_work *w, double u, const double *healed)
{
    double *h = w->h;
    for (uint32_t j = 0; j < t->n_nodes; j++) {
        w->rise[j] = w->values[j];
    }
    sp_curve(t->hats, t->n_nodes, sp_curve_locate(u, t->n_nodes), w->values);
    for (uint32_t j = 0; j < t->n_nodes; j++) {
        w->rise[j] = w->values[j] - w->rise[j];
    }
    for (uint32_t k = 0; k < t->n_constant + t->n_depth; k++) {
        for (uint32_t j = 0; j < t->n_nodes; j++, h++) {
            *h = sp_flush_denormal(w->kept[k] * *h + w->gain[k] * w->rise[j]);
        }
    }
    for (uint32_t k = 0; k < t->n_stops; k++) {
        w->play[k] = sp_stops_play(w->play[k], u, t->radius[k]);
    }
    for (uint32_t k = 0; k < t->n_damage; k++) {
        (void)sp_damage_ratio(healed[k], u > 0.0 ? u : 0.0, &w->deepest[k]);
    }
}

/* Put n values times a factor; return where the next ones go. */
static double *put(double *columns, double factor, const double *values, uint32_t n)
{
    for (uint32_t j = 0; j < n; j++) {
        columns[j] = factor * values[j];
    }
    return columns + n;
}

/* Write the regressors of one row of the linear fit to columns; returns the place behind them.
 * The unknown weights are forces at the nodes, so each term is the row of hat functions times
 * its state. */
static double *put_terms(const sp_fit_terms *t, const sp_fit_work *w, double u, double *columns)
{
    const uint32_t nodes = t->n_nodes, constant = t->n_constant * nodes;
    if (t->plain) {
        columns = put(columns, 1.0, w->values, nodes);
    }
    columns = put(columns, 1.0, w->h, constant);
    for (uint32_t k = 0; k < t->n_stops; k++) {
        sp_curve(t->hats, nodes, sp_curve_locate(w->play[k], nodes), columns);
        for (uint32_t j = 0; j < nodes; j++, columns++) {
            *columns = w->values[j] - *columns;
        }
    }
    columns = put(columns, 1.0, w->h + constant, t->n_depth * nodes);
    for (uint32_t k = 0; k < t->n_damage; k++) {
        const double share = w->deepest[k] > 0.0 ? (u > 0.0 ? u : 0.0) / w->deepest[k] : 1.0;
        columns = put(columns, t->cubic[k] ? share * share * share : share, w->values, nodes);
    }
    return columns;
}

/* Build the matrix of the linear fit: run the regressors over n depths and write a row at each
 * index of `rows`. A pause between two recordings is one step with factors of its own. */
void sp_fit_columns(const sp_fit_terms *terms, sp_fit_work *work, uint32_t n, const double *u,
                    uint32_t n_rows, const int32_t *rows, double *columns)
{
    const uint32_t n_poles = terms->n_constant + terms->n_depth;
    for (uint32_t i = 0, row = 0, paused = 0; i < n && row < n_rows; i++) {
        if (paused < terms->n_pauses && terms->pause_at[paused] == (int32_t)i) {
            put(work->kept, 1.0, terms->pause_kept + paused * n_poles, n_poles);
            put(work->gain, 1.0, terms->pause_gain + paused * n_poles, n_poles);
            step_terms(terms, work, u[i], terms->pause_healed + paused++ * terms->n_damage);
        } else {
            set_poles(terms, work, sp_curve_locate(u[i], terms->n_nodes));
            step_terms(terms, work, u[i], terms->healed);
        }
        if (rows[row] == (int32_t)i) {
            row++;
            columns = put_terms(terms, work, u[i], columns);
        }
    }
}

/* Columns of the nonlinear dashpots (sp_flow.h) at the indices of `rows`: the state of each
 * branch over n depths, whose weights the fit looks for. */
void sp_fit_flow(uint32_t n, const double *u, const double *steps_s, uint32_t n_flow,
                 uint32_t n_cubic, const double *loss_ps, const uint8_t *function,
                 double *flow_before, double *h, uint32_t n_rows, const int32_t *rows,
                 double *columns)
{
    double rises[SP_FLOW_FUNCTIONS];
    for (uint32_t i = 0, row = 0; i < n && row < n_rows; i++) {
        sp_flow_half_increments(u[i], flow_before, rises);
        for (uint32_t k = 0; k < n_flow; k++) {
            h[k] = sp_flow_relax(h[k], rises[function[k]], loss_ps[k] * steps_s[i], k < n_cubic);
        }
        if (rows[row] == (int32_t)i) {
            row++;
            for (uint32_t k = 0; k < n_flow; k++) {
                *columns++ = h[k];
            }
        }
    }
}
