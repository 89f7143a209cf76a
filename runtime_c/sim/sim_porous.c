/* Soaked sponge under a porous punch (sim_porous.h). */
#include "sim_porous.h"

#include "sim_contact.h"
#include <math.h>

/* Far softer and more permeable than cartilage, so that seconds drain it: modulus times area,
 * modulus times permeability (the layer drains in layer^2 / diffusion = 4 s), and M. */
static const double layer_m = 0.020;
static const double modulus_n = 8.0;
static const double diffusion_m2ps = 1e-4;
static const double closing = 4.0;

static const double skin_npm = 4000.0; /* in series: without it, a sudden press would be rigid */
static const double densest = 0.95;    /* strain beyond which the force no longer rises */
static const double cell_m = 0.020 / (double)SIM_POROUS_CELLS;

/* Of the solid, rising without bound as its pores close. */
static double solid_n(double strain)
{
    double squeezed = fmin(strain, densest);
    return modulus_n * squeezed / (1.0 - squeezed);
}

static double strain_at(const sim_porous *porous, int cell)
{
    return (porous->moved_m[cell] - porous->moved_m[cell + 1]) / cell_m;
}

/* Let fluid pass between neighbouring cells for a step: the solid goes as fast as the fluid
 * lets it (Darcy). Explicit: at the densest the diffusion is nine times faster than at rest,
 * and a step may be a quarter of its time. */
static void drain(sim_porous *porous, double step_s)
{
    double strain = strain_at(porous, 0);
    double force_n = solid_n(strain);
    for (int end = 1; end < SIM_POROUS_CELLS; end++) {
        double next = strain_at(porous, end);
        double next_n = solid_n(next);
        double open = exp(-closing * fmax(0.5 * (strain + next), 0.0));
        double rate_mps = diffusion_m2ps * open * (force_n - next_n) / (modulus_n * cell_m);
        porous->moved_m[end] += step_s * rate_mps;
        strain = next;
        force_n = next_n;
    }
}

/* Top of the sponge where the force of the skin, pressed to depth_m, is that of the first cell:
 * a root of skin (depth - top) = solid(strain). */
static double sponge_m(const sim_porous *porous, double depth_m)
{
    double pressed_n = skin_npm * (depth_m - porous->moved_m[1]);
    double cell_n = skin_npm * cell_m;
    double sum_n = pressed_n + cell_n + modulus_n;
    double strain = 2.0 * pressed_n / (sum_n + sqrt(sum_n * sum_n - 4.0 * pressed_n * cell_n));
    return porous->moved_m[1] + cell_m * strain;
}

static double surface_force_n(const void *material, double depth_m)
{
    const sim_porous *porous = material;
    return porous->stiffer * skin_npm * (depth_m - sponge_m(porous, depth_m));
}

void sim_porous_init(void *material, double stiffer, double step_s)
{
    sim_porous *porous = material;
    *porous = (sim_porous){.stiffer = stiffer, .step_s = step_s};
}

/* One step with the tool at tool_m: the surface follows the tool, or recovers to where the force is
 * 0 if the tool has left it; then the material relaxes. Returns the force on the tool, N. */
double sim_porous_step(void *material, double tool_m)
{
    sim_porous *porous = material;
    double steps = ceil(porous->step_s * 9.0 * diffusion_m2ps / (0.25 * cell_m * cell_m));
    for (double step = 0.0; step < steps; step += 1.0) {
        drain(porous, porous->step_s / steps);
    }
    sim_contact contact =
        sim_contact_solve(surface_force_n, porous, tool_m, porous->moved_m[0], layer_m);
    porous->moved_m[0] = sponge_m(porous, contact.depth_m);
    return contact.force_n;
}
