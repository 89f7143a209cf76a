/* Objects by number: choose the material, and step it. */
#include "sim_object.h"

#include "sim_constants.h"
#include <math.h>
#include <stddef.h>

static const char *const silicones[] = {
    "ecoflex-00-10", "ecoflex-00-30", "ecoflex-00-50", "dragon-skin-fx", "dragon-skin-10",
};
enum { SILICONES = sizeof silicones / sizeof silicones[0], VARIANTS = 2 };

/* Of other physics than the silicones, and of one variant. */
static const struct {
    const char *name;
    void (*init)(void *material, double stiffer, double step_s);
    double (*step)(void *material, double tool_m);
} foreign[] = {
    {"bergstrom-boyce", sim_elastomer_init, sim_elastomer_step},
    {"stiffening-tissue", sim_tissue_init, sim_tissue_step},
    {"mullins", sim_damaged_init, sim_damaged_step},
    {"poro-viscoelastic", sim_porous_init, sim_porous_step},
    {"lump", sim_lump_init, sim_lump_step},
};
enum { OBJECTS = SILICONES + sizeof foreign / sizeof foreign[0] };

static const double friction_n = 0.03; /* 0.3 % of the protocol's 10 N */

/* Relaxation at 10 N is sinh(4)/4 = 6.8 times faster than at rest. */
static const double eyring_n = 2.5;

uint32_t sim_object_count(void)
{
    return OBJECTS;
}

const char *sim_object_name(uint32_t object)
{
    if (object < SILICONES) {
        return silicones[object];
    }
    return object < OBJECTS ? foreign[object - SILICONES].name : NULL;
}

uint32_t sim_object_size(void)
{
    return (uint32_t)sizeof(sim_object);
}

static double step_silicone(void *material, double tool_m)
{
    return sim_material_step(material, tool_m);
}

/* Make one of the calibrated silicones at rest; in variant 1 stress speeds up its relaxation
 * (Eyring). */
static void init_silicone(sim_object *state, uint32_t object, uint32_t variant, double stiffer)
{
    const sim_calibration *calibration = &sim_calibrations[object][variant];
    const sim_material_config config = {
        .branch_n = calibration->branch_n * stiffer,
        .relaxation = calibration->relaxation,
        .friction_n = friction_n * stiffer,
        .eyring_n = variant == 1 ? eyring_n * stiffer : 0.0,
        .step_s = state->step_s,
    };
    sim_material_init(&state->material.silicone, &config);
    state->step = step_silicone;
}

/* Make an object at rest, stepped every dt_s in `substeps` steps. */
int sim_object_init(sim_object *state, uint32_t object, uint32_t variant, double stiffer,
                    double dt_s, uint32_t substeps)
{
    if (state == NULL) {
        return SIM_NULL;
    }
    if (object >= OBJECTS || variant >= (object < SILICONES ? VARIANTS : 1) || substeps < 1 ||
        substeps > SIM_MAX_SUBSTEPS || !(stiffer > 0.0 && isfinite(stiffer)) ||
        !(dt_s > 0.0 && isfinite(dt_s))) {
        return SIM_RANGE;
    }
    state->dt_s = dt_s;
    state->substeps = substeps;
    state->step_s = dt_s / substeps;
    state->tool_m = 0.0;
    state->force_n = 0.0;
    if (object < SILICONES) {
        init_silicone(state, object, variant, stiffer);
    } else {
        foreign[object - SILICONES].init(&state->material, stiffer, state->step_s);
        state->step = foreign[object - SILICONES].step;
    }
    return SIM_OK;
}

/* Lift the tool off, and put it down at x and y, m, on an object that is at rest. Only the layer
 * with lumps differs from place to place. */
int sim_object_place(sim_object *state, double x_m, double y_m)
{
    if (state == NULL) {
        return SIM_NULL;
    }
    if (state->step != sim_lump_step || !isfinite(x_m) || !isfinite(y_m)) {
        return SIM_RANGE;
    }
    sim_lump_place(&state->material.lump, x_m, y_m);
    state->tool_m = 0.0;
    state->force_n = 0.0;
    return SIM_OK;
}

void sim_object_substep(sim_object *state, double tool_m)
{
    state->force_n = state->step(&state->material, tool_m);
}

/* Whether none of n values is NaN or infinite. */
int sim_all_finite(uint32_t n, const double *values)
{
    for (uint32_t i = 0; i < n; i++) {
        if (!isfinite(values[i])) {
            return 0;
        }
    }
    return 1;
}

/* Move the tool evenly to position_m in a tick. */
static void move_to(sim_object *state, double position_m)
{
    double from_m = state->tool_m;
    for (uint32_t i = 1; i <= state->substeps; i++) {
        double share = (double)i / state->substeps;
        sim_object_substep(state, from_m + share * (position_m - from_m));
    }
    state->tool_m = position_m;
}

/* Move the tool through n positions, one a tick; force_n: what it then feels, N. */
int sim_object_move(sim_object *state, uint32_t n, const double *position_m, double *force_n)
{
    if (state == NULL || position_m == NULL || force_n == NULL) {
        return SIM_NULL;
    }
    if (!sim_all_finite(n, position_m)) {
        return SIM_RANGE;
    }
    for (uint32_t i = 0; i < n; i++) {
        move_to(state, position_m[i]);
        force_n[i] = state->force_n;
    }
    return SIM_OK;
}
