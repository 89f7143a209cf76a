/* springpot 0.1.0 caa8d889b6e129711e4b8e490faf5c2c47d3c054226f74fe5f63b06f84f1df08 */
#ifndef SP_TABLES_H
#define SP_TABLES_H

#include <stddef.h>

#include "sp_scene.h"

/* Curves: values and slopes at the nodes, a column a branch (sp_curve.h). */
static const sp_real spring[20] = {
    0.0f, 0.41273984f, 0.5010738f, 0.58940774f, 1.1820204f, 0.77248544f, 2.044955f, 0.9533838f,
    3.08545f, 1.1276062f, 4.303316f, 1.3081261f, 5.703667f, 1.492576f, 7.28427f, 1.6686296f,
    9.0454645f, 1.8537602f, 9.0454645f, 1.8537602f
};
static const sp_real branches[20 * 4] = {
    0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.04441721f, 0.01903994f, 0.017259978f, 0.004970012f,
    0.032855902f, 0.019350037f, 0.034519956f, 0.009940024f, 0.02129459f, 0.019660132f, 0.06891983f,
    0.018816372f, 0.04720332f, 0.042240627f, 0.06879976f, 0.017752698f, 0.0074002524f, 0.026121046f,
    0.1536101f, 0.03549022f, 0.05118135f, 0.07128427f, 0.10058078f, 0.0155949965f, 0.0005558048f,
    0.03196625f, 0.26837456f, 0.047015693f, 0.051459253f, 0.10412984f, 0.12894815f, 0.0074559497f,
    0.0f, 0.033724878f, 0.40947756f, 0.050967585f, 0.051459253f, 0.13745369f, 0.15325786f,
    0.0004478369f, 0.0f, 0.03292283f, 0.5730301f, 0.051191505f, 0.051459253f, 0.16970202f,
    0.17384727f, 0.0f, 0.0f, 0.031573843f, 0.75608265f, 0.051191505f, 0.051459253f, 0.19963248f,
    0.19225769f, 0.0f, 0.0f, 0.028287059f, 0.9572059f, 0.051191505f, 0.051459253f, 0.22618717f,
    0.20998879f, 0.0f, 0.0f, 0.024822311f, 0.9572059f, 0.051191505f, 0.051459253f, 0.22618717f,
    0.20998879f, 0.0f, 0.0f, 0.024822311f
};
static const sp_real branch_loss[4] = {
    0.39346933f, 0.07317967f, 0.0114841955f, 0.006145274f
};
/* At most so stiff is each piece of the depth, N a piece (sp_surface.h). */
static const sp_real stiffest[9] = {
    0.6748225f, 0.89255923f, 1.1020818f, 1.2977352f, 1.4947548f, 1.6979972f, 1.8891745f, 2.0885715f,
    2.0885715f
};
static const sp_real stops[1 * 20] = {
    0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.003419151f, 0.006838302f,
    0.015024306f, 0.016372008f, 0.032539934f, 0.018659245f, 0.050479703f, 0.017220294f, 0.050479703f,
    0.017220294f
};
static const sp_real stop_radius[1] = {
    0.5f
};
static const sp_hammerstein_config passive = {
    2.3093101e-07f, /* origin_m */
    83.34563f,      /* per_span */
    0.0f,           /* bias_n */
    9,              /* n_pieces */
    4,              /* n_branches */
    1,              /* n_stops */
};
static const sp_hammerstein_tables passive_tables = {
    spring,      /* spring */
    branches,    /* branches */
    stops,       /* stops */
    stop_radius, /* radius */
};

static const sp_real rate_hz = 1000.0f;
static const sp_real velocity_weight = 0.2f;

#endif
