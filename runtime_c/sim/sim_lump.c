/* Soft layer with stiffer lumps (sim_lump.h). */
#include "sim_lump.h"

#include <math.h>
#include <string.h>

static const double sphere_m = 0.008; /* its radius; the edge of its shaft too */
static const double pitch_m = 0.0005;
static const double stiffening_pm = 80.0; /* a column of 20 mm, squeezed by a quarter: + 40 % */

static const double foundation_npm3 = 9e6; /* 10 N at 6 mm, on the plain ground */
static const double column_share = 0.25;   /* of the slow stiffness, each */
static const double relaxes_s[SIM_LUMP_BRANCHES] = {0.02, 0.2, 2.0};

/* The ground itself is uneven by so much, in hills of 10 mm. */
static const double uneven = 0.03;
static const double hill_m = 0.020;

/* Within its radius a lump is so many times as stiff, and relaxes so many times as slowly. */
static const struct {
    double x_m, y_m, radius_m, stiffer, slower;
} lumps[] = {
    {0.010, 0.011, 0.0040, 2.5, 2.0},
    {0.021, 0.019, 0.0065, 1.7, 1.5},
};
enum { LUMPS = sizeof lumps / sizeof lumps[0] };

/* Stiffness and relaxation time of the layer at a site, relative to its own: waves everywhere,
 * and the lumps. */
static void ground(double x_m, double y_m, double *stiffness, double *slower)
{
    const double turn = 6.283185307179586 / hill_m;
    *stiffness = 1.0 + uneven * sin(turn * x_m) * cos(turn * y_m);
    *slower = 1.0;
    for (int i = 0; i < LUMPS; i++) {
        double far = hypot(x_m - lumps[i].x_m, y_m - lumps[i].y_m) / lumps[i].radius_m;
        double here = exp(-far * far);
        *stiffness += (lumps[i].stiffer - 1.0) * here;
        *slower += (lumps[i].slower - 1.0) * here;
    }
}

/* A layer at rest with the tool above its middle. */
void sim_lump_init(void *material, double stiffer, double step_s)
{
    sim_lump *lump = material;
    memset(lump, 0, sizeof *lump);
    lump->stiffer = stiffer;
    lump->step_s = step_s;
    sim_lump_place(lump, 0.0, 0.0);
}

/* Make column i of the foundation at rest: its stiffness and relaxation there, and how far the
 * sphere's surface is above it. */
static void put_column(sim_lump *lump, int i, double x_m, double y_m, double below_m)
{
    double stiffness;
    double slower;
    ground(x_m, y_m, &stiffness, &slower);
    lump->below_m[i] = below_m;
    lump->stiffness_npm[i] = foundation_npm3 * pitch_m * pitch_m * stiffness;
    lump->squeezed_m[i] = 0.0;
    lump->slope[i] = 1.0;
    for (int k = 0; k < SIM_LUMP_BRANCHES; k++) {
        lump->gain[k][i] = -expm1(-lump->step_s / (slower * relaxes_s[k]));
        lump->memory_m[k][i] = 0.0;
        lump->slope[i] += column_share * (1.0 - 0.5 * lump->gain[k][i]);
    }
    lump->per_slope[i] = 1.0 / lump->slope[i];
}

/* Put a resting layer's columns under a sphere above x_m, y_m. */
void sim_lump_place(sim_lump *lump, double x_m, double y_m)
{
    int n = 0;
    for (int i = 0; i < SIM_LUMP_ACROSS * SIM_LUMP_ACROSS; i++) {
        const double right_m = pitch_m * (i % SIM_LUMP_ACROSS - SIM_LUMP_ACROSS / 2);
        const double up_m = pitch_m * (i / SIM_LUMP_ACROSS - SIM_LUMP_ACROSS / 2);
        const double far_m = hypot(right_m, up_m);
        if (far_m < sphere_m && n < SIM_LUMP_COLUMNS) {
            const double below_m = sphere_m - sqrt(sphere_m * sphere_m - far_m * far_m);
            put_column(lump, n++, x_m + right_m, y_m + up_m, below_m);
        }
    }
    for (; n < SIM_LUMP_COLUMNS; n++) {
        lump->below_m[n] = HUGE_VAL;
    }
}

/* What the branches hold of each column as the step begins, m, into held_m. */
static void columns_hold(const sim_lump *lump, double *held_m)
{
    for (int i = 0; i < SIM_LUMP_COLUMNS; i++) {
        const double half_m = 0.5 * lump->squeezed_m[i];
        held_m[i] = 0.0;
        for (int k = 0; k < SIM_LUMP_BRANCHES; k++) {
            const double memory_m = lump->memory_m[k][i];
            held_m[i] += column_share * (memory_m + lump->gain[k][i] * (half_m - memory_m));
        }
    }
}

/* One step with the sphere at tool_m; returns the force on it, N. Every branch relaxes towards
 * the mean of the step. Where a column would pull it follows the sphere no farther than to no
 * force. */
double sim_lump_step(void *material, double tool_m)
{
    sim_lump *lump = material;
    double held_m[SIM_LUMP_COLUMNS];
    double inside_m[SIM_LUMP_COLUMNS];
    double mean_m[SIM_LUMP_COLUMNS];
    double pushes_n[SIM_LUMP_COLUMNS];
    double force_n = 0.0;
    columns_hold(lump, held_m);
    for (int i = 0; i < SIM_LUMP_COLUMNS; i++) {
        double under_m = tool_m - lump->below_m[i];
        inside_m[i] = under_m > 0.0 ? under_m : 0.0;
    }
    for (int i = 0; i < SIM_LUMP_COLUMNS; i++) {
        double free_m = held_m[i] * lump->per_slope[i];
        double pressed_m = inside_m[i] + stiffening_pm * inside_m[i] * inside_m[i];
        double after_m = pressed_m > free_m ? pressed_m : free_m;
        mean_m[i] = 0.5 * (lump->squeezed_m[i] + after_m);
        lump->squeezed_m[i] = after_m;
        pushes_n[i] = lump->stiffness_npm[i] * (lump->slope[i] * after_m - held_m[i]);
    }
    for (int k = 0; k < SIM_LUMP_BRANCHES; k++) {
        for (int i = 0; i < SIM_LUMP_COLUMNS; i++) {
            lump->memory_m[k][i] += lump->gain[k][i] * (mean_m[i] - lump->memory_m[k][i]);
        }
    }
    for (int i = 0; i < SIM_LUMP_COLUMNS; i++) {
        force_n += pushes_n[i];
    }
    return lump->stiffer * force_n;
}
