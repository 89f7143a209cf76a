/* springpot 0.1.0 e14c5db9d0725a7070b2009d174c0392a31489c4a84f406cdd2c8ebeb6dd159f */
#ifndef SP_TABLES_H
#define SP_TABLES_H

#include <stddef.h>

#include "sp_scene.h"

/* Curves: piece by piece, highest power first, a column a branch (sp_curve.h). */
static const sp_real spring[4] = {
    0.0f, 5.74629f, 3.2974002f, 0.0f
};
static const sp_real branches[4 * 4] = {
    0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 1.5742528f, 0.25023308f, 0.0f, 0.0f, 0.0f, 0.0f,
    0.0f, 0.0f
};
static const sp_real branch_loss[4] = {
    0.39346933f, 0.006145274f, 1.0f, 1.0f
};
static const sp_hammerstein_config passive = {
    2.3093101e-07f, /* origin_m */
    83.34563f,      /* per_span */
    0.0f,           /* bias_n */
    1,              /* n_pieces */
    3,              /* degree */
    4,              /* n_branches */
    0,              /* n_stops */
};
static const sp_hammerstein_tables passive_tables = {
    spring,   /* spring */
    branches, /* branches */
    NULL,     /* stops */
    NULL,     /* radius */
};

static const sp_real rate_hz = 1000.0f;
static const sp_real velocity_weight = 0.2f;

#endif
