/* Filled elastomer of Bergström and Boyce (sim_elastomer.h). */
#include "sim_elastomer.h"

#include "sim_contact.h"
#include <math.h>

/* A column of the layer below the punch, uniaxial and incompressible: its stretch is
 * 1 - depth / height, the force its nominal stress times the area. */
static const double height_m = 0.035;
static const double area_m2 = 12.566e-6; /* of a punch of 4 mm */
static const double deepest_m = 0.033;   /* deeper, the force stays finite */

/* The equilibrium network: modulus and locking of the order of a filled chloroprene rubber's. */
static const double modulus_mpa = 0.6;
static const double locking_squared = 8.0; /* links of a chain: its greatest stretch, squared */

/* The creeping network, typical of common elastomers (Bergström and Boyce 1998, 2001, in the form
 * of the Abaqus manual, "Hysteresis in elastomers"): creep strain rate
 * A (chain stretch - 1)^C stress^m. */
static const double stiffness_ratio = 1.6;
static const double creep_rate_psmpa = 5.0 / 9.0; /* A = 5 / sqrt(3)^m, 1/s at 1 MPa */
static const double stress_exponent = 4.0;        /* m */
static const double chain_exponent = -1.0;        /* C */
static const double chain_floor = 0.01;           /* added to the chain stretch less 1 */

/* Of the eight chains of Arruda and Boyce (1993), squared. */
static double chain_stretch_squared(double stretch)
{
    return (stretch * stretch + 2.0 / stretch) / 3.0;
}

/* True stress of a network of modulus_mpa; the inverse Langevin function as Cohen's (1991)
 * L^-1(y) = y (3 - y^2) / (1 - y^2). */
static double stress_mpa(double stretch)
{
    double y_squared = fmin(chain_stretch_squared(stretch) / locking_squared, 0.99);
    double chain = (3.0 - y_squared) / (3.0 * (1.0 - y_squared));
    return modulus_mpa * chain * (stretch * stretch - 1.0 / stretch);
}

typedef struct {
    double strain;       /* 1, logarithmic, of the creeping network were it not to creep */
    double creep_at_mpa; /* 1, creep within the step at 1 MPa */
} creep_step;

/* Implicit in the stress: an elastic strain is what is left of the strain after the step's creep.
 */
static double excess_strain(const void *context, double elastic)
{
    const creep_step *step = context;
    double stress = stiffness_ratio * stress_mpa(exp(elastic));
    double creep = step->creep_at_mpa * pow(fabs(stress), stress_exponent);
    return elastic + copysign(creep, stress) - step->strain;
}

/* Strain of the elastic network after a step, from the total stretch: an implicit step of
 * creep, solved for its root. */
static double elastic_strain(const sim_elastomer *elastomer, double stretch)
{
    const creep_step step = {.strain = log(stretch) - elastomer->creep,
                             .creep_at_mpa = elastomer->step_s * elastomer->rate_psmpa};
    double excess = excess_strain(&step, step.strain);
    if (fabs(excess) <= 1e-6 * fabs(step.strain)) {
        return step.strain - excess; /* hardly any creep: a step back is exact enough */
    }
    double low = fmin(step.strain, 0.0);
    double low_value = step.strain < 0.0 ? excess : -step.strain;
    double high = fmax(step.strain, 0.0);
    double high_value = step.strain < 0.0 ? -step.strain : excess;
    return sim_root(excess_strain, &step, low, low_value, high, high_value, 1e-13, 1e-12);
}

static double column_stretch(double depth_m)
{
    return 1.0 - fmin(depth_m, deepest_m) / height_m;
}

/* Force of the column pressed to depth_m at the end of this step, N. */
static double column_force_n(const void *material, double depth_m)
{
    const sim_elastomer *elastomer = material;
    double stretch = column_stretch(depth_m);
    double elastic = elastic_strain(elastomer, stretch);
    double true_mpa = stress_mpa(stretch) + stiffness_ratio * stress_mpa(exp(elastic));
    return -elastomer->stiffer * 1e6 * area_m2 * true_mpa / stretch;
}

void sim_elastomer_init(void *material, double stiffer, double step_s)
{
    sim_elastomer *elastomer = material;
    *elastomer = (sim_elastomer){.stiffer = stiffer, .step_s = step_s};
}

/* One step with the tool at tool_m: the surface follows the tool, or recovers to where the force is
 * 0 if the tool has left it; then the material relaxes. Returns the force on the tool, N. */
double sim_elastomer_step(void *material, double tool_m)
{
    sim_elastomer *elastomer = material;
    /* The chain stretch of the step's beginning: with it, force rises with depth for certain. */
    double chain = sqrt(chain_stretch_squared(exp(elastomer->creep))) - 1.0 + chain_floor;
    elastomer->rate_psmpa = creep_rate_psmpa * pow(chain, chain_exponent);
    sim_contact contact =
        sim_contact_solve(column_force_n, elastomer, tool_m, elastomer->surface_m, deepest_m);
    double stretch = column_stretch(contact.depth_m);
    elastomer->creep = log(stretch) - elastic_strain(elastomer, stretch);
    elastomer->surface_m = contact.depth_m;
    return contact.force_n;
}
