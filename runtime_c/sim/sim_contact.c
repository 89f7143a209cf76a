/* Steps of a tool on a surface that pushes and never pulls. */
#include "sim_contact.h"

#include <math.h>

/* Depth of a surface that recovers more slowly than the tool leaves: where no force is left.
 * Clipping the force alone would let the tool drag, without work, a surface that it does not
 * touch. */
static double free_surface_m(sim_rising force_at, const void *material, sim_contact at_tool,
                             double surface_m, double deepest_m)
{
    double high_m = fmax(surface_m, at_tool.depth_m);
    double high_n = force_at(material, high_m);
    if (high_n < 0.0) {
        high_m = deepest_m;
        high_n = force_at(material, high_m);
    }
    return sim_root(force_at, material, at_tool.depth_m, at_tool.force_n, high_m, high_n, 1e-12,
                    1e-10);
}

/* Depth of the surface and force on the tool, N, at tool_m: the surface follows the tool unless
 * that would take a pull. */
sim_contact sim_contact_solve(sim_rising force_at, const void *material, double tool_m,
                              double surface_m, double deepest_m)
{
    sim_contact contact = {.depth_m = fmax(tool_m, 0.0)};
    contact.force_n = force_at(material, contact.depth_m);
    if (contact.force_n < 0.0) {
        contact.depth_m = free_surface_m(force_at, material, contact, surface_m, deepest_m);
        contact.force_n = 0.0;
    } else if (tool_m <= 0.0) {
        contact.force_n = 0.0;
    }
    return contact;
}
