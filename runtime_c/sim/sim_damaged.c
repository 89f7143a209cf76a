/* Filled rubber of Ogden and Roxburgh (sim_damaged.h). */
#include "sim_damaged.h"

#include "sim_contact.h"
#include <math.h>

/* A neo-Hookean column under a punch of 6 mm, uniaxial and incompressible. */
static const double column_m = 0.035;
static const double column_n = 8.48; /* modulus, 0.3 MPa, times area */
static const double bottom_m = 0.034;

/* Ogden and Roxburgh's r, of their fit to a filled rubber; ours are m, of this column's energies,
 * which are 0.03 J at 10 N, and the time of healing. */
static const double damage_r = 2.104;
static const double damage_m_j = 0.01;
static const double healing_s = 60.0;

/* Beside it, two Maxwell branches on the undamaged force: adaptation and drift.
 * Times and strengths are ours. */
static const double branch_s[SIM_DAMAGED_BRANCHES] = {0.3, 300.0};
static const double branch_strength[SIM_DAMAGED_BRANCHES] = {0.2, 0.3};

static double squeezed(double depth_m)
{
    return 1.0 - fmin(depth_m, bottom_m) / column_m;
}

static double undamaged_n(double depth_m)
{
    double stretch = squeezed(depth_m);
    return column_n * (1.0 / (stretch * stretch) - stretch);
}

static double energy_j(double depth_m)
{
    double stretch = squeezed(depth_m);
    return 0.5 * column_n * column_m * (stretch * stretch + 2.0 / stretch - 3.0);
}

/* Healing at depth gives back energy, but never more than the damage took: with it, the energy
 * that may still come out is int_0^W eta(w, Wm) dw + Wm - int_0^Wm eta(w, Wm) dw. Its derivative
 * by Wm is -int_W^Wm d eta / d Wm dw >= 0, and Wm only falls while it is above W. */
static double healed_j(const sim_damaged *damaged)
{
    return damaged->damage_j -
           damaged->healing * (damaged->damage_j - energy_j(damaged->surface_m));
}

static double relaxed_branch_n(const sim_damaged *damaged, int branch, double after_n)
{
    double memory_n = damaged->memory[branch];
    double mean_n = 0.5 * (undamaged_n(damaged->surface_m) + after_n);
    return memory_n + damaged->gain[branch] * (mean_n - memory_n);
}

/* Force at depth_m with the present damage (Ogden and Roxburgh 1999: softer below the greatest
 * energy so far) and the relaxing branches, N. */
static double damaged_force_n(const void *material, double depth_m)
{
    const sim_damaged *damaged = material;
    double after_n = undamaged_n(depth_m);
    double below_j = fmax(healed_j(damaged) - energy_j(depth_m), 0.0);
    double force_n = (1.0 - erf(below_j / damage_m_j) / damage_r) * after_n;
    for (int branch = 0; branch < SIM_DAMAGED_BRANCHES; branch++) {
        double stretched_n = after_n - relaxed_branch_n(damaged, branch, after_n);
        force_n += branch_strength[branch] * stretched_n;
    }
    return damaged->stiffer * force_n;
}

/* An object at rest that was never pressed. */
void sim_damaged_init(void *material, double stiffer, double step_s)
{
    sim_damaged *damaged = material;
    *damaged = (sim_damaged){.stiffer = stiffer, .healing = -expm1(-step_s / healing_s)};
    for (int branch = 0; branch < SIM_DAMAGED_BRANCHES; branch++) {
        damaged->gain[branch] = -expm1(-step_s / branch_s[branch]);
    }
}

/* One step with the tool at tool_m: the surface follows the tool, or recovers to where the force is
 * 0 if the tool has left it; then the material relaxes. Returns the force on the tool, N. */
double sim_damaged_step(void *material, double tool_m)
{
    sim_damaged *damaged = material;
    sim_contact contact =
        sim_contact_solve(damaged_force_n, damaged, tool_m, damaged->surface_m, bottom_m);
    double after_n = undamaged_n(contact.depth_m);
    for (int branch = 0; branch < SIM_DAMAGED_BRANCHES; branch++) {
        damaged->memory[branch] = relaxed_branch_n(damaged, branch, after_n);
    }
    damaged->damage_j = fmax(healed_j(damaged), energy_j(contact.depth_m));
    damaged->surface_m = contact.depth_m;
    return contact.force_n;
}
