/* Silicone of two elastic branches with Maxwell modes (sim_material.h). */
#include "sim_material.h"

#include "sim_contact.h"
#include <math.h>
#include <string.h>

/* Nearly linear as a flat punch, and steeply as platens on whole blocks. */
static const double exponent[SIM_BRANCHES] = {1.15, 2.2};
static const double reference_m = 0.010;
static const double thickness_m = 0.035; /* edge of the cubes, paper III-A */

/* Relaxation spectrum: log-normal in time, NOT a power law, so that fractional derivatives get no
 * gift. Its place makes the modes' loss rise by 0.62, 1, 1.25 from 0.2 to 1 to 5 Hz; published for
 * Ecoflex 00-30 (fractional Kelvin-Voigt, order 0.32): 0.67, 1, 1.5. The second branch is ten
 * times slower, so that depth and relaxation do not separate. */
static const double spectrum_centre_s[SIM_BRANCHES] = {0.003, 0.030};
static const double spectrum_width_decades = 1.2;

static const double yield_m = 0.0002; /* travel over which the friction turns round */

static double mode_time_s(int mode)
{
    return pow(10.0, -3.0 + 0.5 * mode); /* 1 ms .. 100 s */
}

static double mode_weight(int branch, int mode)
{
    double decades = log10(mode_time_s(mode) / spectrum_centre_s[branch]);
    double deviation = decades / spectrum_width_decades;
    return exp(-0.5 * deviation * deviation);
}

/* Static force of a branch at depth_m, relative to its force at the reference depth: a power
 * law that steepens before the table. */
static double branch_shape(int branch, double depth_m)
{
    if (depth_m <= 0.0) {
        return 0.0;
    }
    /* The floor keeps a tool that is driven to the table at a finite force. */
    double space = fmax(1.0 - depth_m / thickness_m, 0.02);
    return pow(depth_m / reference_m, exponent[branch]) / space;
}

/* A silicone at rest: distribute each branch's relaxation over Maxwell modes. */
void sim_material_init(sim_material *material, const sim_material_config *config)
{
    memset(material, 0, sizeof *material);
    material->config = *config;
    for (int branch = 0; branch < SIM_BRANCHES; branch++) {
        double sum = 0.0;
        for (int mode = 0; mode < SIM_MODES; mode++) {
            sum += mode_weight(branch, mode);
        }
        double whole_n = config->branch_n * config->relaxation;
        for (int mode = 0; mode < SIM_MODES; mode++) {
            material->strength_n[branch][mode] = whole_n * mode_weight(branch, mode) / sum;
        }
    }
    for (int mode = 0; mode < SIM_MODES; mode++) {
        material->gain[mode] = -expm1(-config->step_s / mode_time_s(mode));
    }
}

/* Eyring: stress lowers the barrier of relaxation, which runs sinh(u)/u faster, u = f/eyring. */
static void update_gains(sim_material *material)
{
    const sim_material_config *config = &material->config;
    double u = fmin(material->force_n / config->eyring_n, 50.0);
    double faster = u > 1e-4 ? sinh(u) / u : 1.0;
    for (int mode = 0; mode < SIM_MODES; mode++) {
        material->gain[mode] = -expm1(-faster * config->step_s / mode_time_s(mode));
    }
}

/* Within one step the force of a branch is a line in its shape at the step's end:
 * slope_n * shape - offset_n, with every mode relaxing towards the step's mean shape. */
typedef struct {
    const sim_material *material;
    double slope_n[SIM_BRANCHES];
    double offset_n[SIM_BRANCHES];
} step_line;

/* Force at the end of the step as a line in each branch's static force: modes that relax
 * towards the mean of the step leave slope and offset. */
static step_line line_of_step(const sim_material *material)
{
    step_line line = {.material = material};
    for (int branch = 0; branch < SIM_BRANCHES; branch++) {
        double slope_n = material->config.branch_n;
        double offset_n = 0.0;
        double half = 0.5 * material->shape[branch];
        for (int mode = 0; mode < SIM_MODES; mode++) {
            double strength_n = material->strength_n[branch][mode];
            double gain = material->gain[mode];
            double memory = material->memory[branch][mode];
            slope_n += strength_n * (1.0 - 0.5 * gain);
            offset_n += strength_n * (memory + gain * (half - memory));
        }
        line.slope_n[branch] = slope_n;
        line.offset_n[branch] = offset_n;
    }
    return line;
}

static double stretch_at(const sim_material *material, double depth_m)
{
    double stretch_m = material->stretch_m + depth_m - material->surface_m;
    return fmin(fmax(stretch_m, -yield_m), yield_m);
}

/* Force at the end of the step if the surface is then at depth_m, N: branches and friction. */
static double force_at(const void *step, double depth_m)
{
    const step_line *line = step;
    const sim_material *material = line->material;
    double force_n = material->config.friction_n * stretch_at(material, depth_m) / yield_m;
    for (int branch = 0; branch < SIM_BRANCHES; branch++) {
        force_n += line->slope_n[branch] * branch_shape(branch, depth_m) - line->offset_n[branch];
    }
    return force_n;
}

/* Move the surface to depth_m, and relax every Maxwell mode for a step towards the mean of the
 * branch's curve over that step. */
static void move_surface(sim_material *material, double depth_m)
{
    material->stretch_m = stretch_at(material, depth_m);
    material->surface_m = depth_m;
    for (int branch = 0; branch < SIM_BRANCHES; branch++) {
        double before = material->shape[branch];
        double after = branch_shape(branch, depth_m);
        double mean = 0.5 * (before + after);
        for (int mode = 0; mode < SIM_MODES; mode++) {
            double *memory = &material->memory[branch][mode];
            *memory += material->gain[mode] * (mean - *memory);
        }
        material->shape[branch] = after;
    }
}

/* One step with the tool at tool_m; returns the force on the tool, N. */
double sim_material_step(sim_material *material, double tool_m)
{
    if (material->config.eyring_n > 0.0) {
        update_gains(material);
    }
    step_line line = line_of_step(material);
    sim_contact contact =
        sim_contact_solve(force_at, &line, tool_m, material->surface_m, thickness_m);
    move_surface(material, contact.depth_m);
    material->force_n = contact.force_n;
    return material->force_n;
}
