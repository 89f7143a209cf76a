/* Soft tissue over a stiff bed (sim_tissue.h). */
#include "sim_tissue.h"

#include "sim_contact.h"
#include <math.h>

/* Elastic response T: soft, then stiffening as exp(depth) (Fung 1967: stiffness grows linearly with
 * stress), then straight, as collagen once it is stretched (Viidik 1968). Its depths and stiffness
 * are ours. */
static const double soft_npm = 40.0;
static const double toe_m = 0.0020; /* soft up to here, */
static const double heel_m =
    0.0026; /* a hundred times stiffer from here on: a tenth of the depth */
static const double stiffening = 100.0;
static const double floor_m = 0.1; /* the force is positive there, whatever came before */

/* Reduced relaxation function of Fung (1972) with a box spectrum C / tau from tau1 to tau2:
 * G(t) = (1 + C int_tau1^tau2 exp(-t / tau) / tau dtau) / (1 + C ln(tau2 / tau1)). The times are of
 * articular cartilage (Woo, Simon, Kuei, Akeson, J. Biomech. Eng. 102 (1980) 85-90); its C of 2.02
 * would leave 6 % of the force after a long hold, 0.15 leaves 48 %. */
static const double spectrum = 0.15;
static const double shortest_s = 0.006;
static const double longest_s = 8.38;

static double elastic_n(double depth_m)
{
    double rate_pm = log(stiffening) / (heel_m - toe_m);
    double bent_m = fmin(fmax(depth_m - toe_m, 0.0), heel_m - toe_m);
    return soft_npm * (fmin(fmax(depth_m, 0.0), toe_m) + expm1(rate_pm * bent_m) / rate_pm +
                       stiffening * fmax(depth_m - heel_m, 0.0));
}

/* The box in equal steps of the logarithm of time, a branch at the middle of each. */
static double branch_width(void)
{
    return log(longest_s / shortest_s) / (double)SIM_TISSUE_BRANCHES;
}

/* Share of the elastic response that relaxes, of each branch. */
static double branch_share(void)
{
    return spectrum * branch_width() / (1.0 + spectrum * log(longest_s / shortest_s));
}

/* A tissue at rest: equal branches, their times even in logarithm. */
void sim_tissue_init(void *material, double stiffer, double step_s)
{
    sim_tissue *tissue = material;
    *tissue = (sim_tissue){.stiffer = stiffer};
    for (int branch = 0; branch < SIM_TISSUE_BRANCHES; branch++) {
        double time_s = shortest_s * exp((branch + 0.5) * branch_width());
        tissue->gain[branch] = -expm1(-step_s / time_s);
    }
}

/* Every branch relaxes towards the mean elastic response of the step. */
static double relaxed_n(const sim_tissue *tissue, int branch, double after_n)
{
    double memory_n = tissue->memory[branch];
    double mean_n = 0.5 * (tissue->elastic_n + after_n);
    return memory_n + tissue->gain[branch] * (mean_n - memory_n);
}

/* Force with the surface at depth_m at the end of this step, N: elastic force less what the
 * branches (quasi-linear viscoelasticity, Fung 1972) have relaxed. */
static double tissue_force_n(const void *material, double depth_m)
{
    const sim_tissue *tissue = material;
    double after_n = elastic_n(depth_m);
    double sum_n = 0.0;
    for (int branch = 0; branch < SIM_TISSUE_BRANCHES; branch++) {
        sum_n += relaxed_n(tissue, branch, after_n);
    }
    return tissue->stiffer * (after_n - branch_share() * sum_n);
}

/* One step with the tool at tool_m: the surface follows the tool, or recovers to where the force is
 * 0 if the tool has left it; then the material relaxes. Returns the force on the tool, N. */
double sim_tissue_step(void *material, double tool_m)
{
    sim_tissue *tissue = material;
    sim_contact contact =
        sim_contact_solve(tissue_force_n, tissue, tool_m, tissue->surface_m, floor_m);
    double after_n = elastic_n(contact.depth_m);
    for (int branch = 0; branch < SIM_TISSUE_BRANCHES; branch++) {
        tissue->memory[branch] = relaxed_n(tissue, branch, after_n);
    }
    tissue->elastic_n = after_n;
    tissue->surface_m = contact.depth_m;
    return contact.force_n;
}
