#include "passive_run.h"

#include "sp_damage.h"
#include "sp_depth.h"
#include "sp_flow.h"
#include "sp_hammerstein.h"
#include "sp_poles.h"
#include "sp_surface.h"

enum { MOST = 32 };

typedef struct {
    double before[MOST], held[MOST], play[MOST], flow_before[SP_FLOW_FUNCTIONS], flow[MOST];
    double deepest[MOST];
    sp_surface_state surface;
} passive_state;

static double next(const passive_model *m, const sp_hammerstein_config *config,
                   const sp_hammerstein_tables *tables, passive_state *s, double depth_m)
{
    const uint32_t constant = m->n_constant;
    const double tool = sp_hammerstein_u(config, depth_m);
    const double u =
        m->recovers ? sp_surface_model_u(m->stiffest, m->n_intervals, &s->surface, tool) : tool;
    const sp_curve_position place = sp_curve_locate(u, m->n_intervals);
    double g[MOST];
    double worn[MOST];
    sp_curve(m->branches, m->n_branches, place, g);
    sp_poles_separate(m->loss, constant, g, s->before, s->held);
    sp_poles_by_depth(m->depth_loss, m->n_branches - constant, place, g + constant,
                   s->before + constant, s->held + constant);
    double force_n = sp_hammerstein_force(config, tables, u, place, s->held, s->play);
    force_n += sp_flow(m->flow_loss, m->flow_n, m->flow_function, m->n_cubic, m->n_flow, u,
                       s->flow_before, s->flow);
    sp_curve(m->damage, m->n_damage, place, worn);
    force_n += sp_damage(m->healed, m->n_linear, m->n_damage, u, worn, s->deepest);
    s->surface.u = u;
    s->surface.force_n = force_n;
    return m->pulls || (force_n > 0.0 && !(u > tool)) ? force_n : 0.0;
}

int passive_run(const passive_model *model, uint32_t n, const double *depth_m, double *force_n)
{
    const sp_hammerstein_config config = {model->origin_m, model->u_per_m,   model->bias_n,
                                          model->n_intervals, model->n_branches, model->n_stops};
    const sp_hammerstein_tables tables = {model->spring, model->branches, model->stops,
                                          model->radius};
    if (n == 0 || model->n_branches > MOST || model->n_stops > MOST || model->n_flow > MOST ||
        model->n_damage > MOST) {
        return 1;
    }
    passive_state state = {0};
    const double u = sp_hammerstein_u(&config, depth_m[0]);
    sp_hammerstein_rest(&config, &tables, u, state.before, state.held, state.play);
    sp_flow_rest(u, model->n_flow, state.flow_before, state.flow);
    sp_damage_rest(model->n_damage, u, state.deepest);
    state.surface.u = u;
    for (uint32_t i = 0; i < n; i++) {
        force_n[i] = next(model, &config, &tables, &state, depth_m[i]);
    }
    return 0;
}
