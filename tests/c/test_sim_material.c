/* The simulated silicone by itself: closed forms, the free surface, states that carry. */
#include "sim_contact.c"
#include "sim_damaged.c"
#include "sim_elastomer.c"
#include "sim_lump.c"
#include "sim_material.c"
#include "sim_noise.c"
#include "sim_object.c"
#include "sim_porous.c"
#include "sim_root.c"
#include "sim_tissue.c"

#include "check.h"

static const sim_material_config plain = {
    .branch_n = 2.0, .relaxation = 0.8, .friction_n = 0.03, .eyring_n = 0.0, .step_s = 1e-4};

static double hold(sim_material *material, double depth_m, int steps)
{
    double force_n = 0.0;
    for (int i = 0; i < steps; i++) {
        force_n = sim_material_step(material, depth_m);
    }
    return force_n;
}

TEST(check_closed_forms)
{
    sim_material material;
    sim_material_init(&material, &plain);
    double shapes = (pow(1.2, 1.15) + pow(1.2, 2.2)) / (1.0 - 12.0 / 35.0);
    double sudden_n = plain.branch_n * (1.0 + plain.relaxation) * shapes + plain.friction_n;
    CHECK(fabs(hold(&material, 0.012, 1) / sudden_n - 1.0) < 0.02);
    double relaxed_n = plain.branch_n * shapes + plain.friction_n;
    double late_n = hold(&material, 0.012, 8000000); /* 800 s, eight times the slowest mode */
    CHECK(fabs(late_n / relaxed_n - 1.0) < 1e-4);
}

TEST(check_free_surface)
{
    sim_material material;
    sim_material_init(&material, &plain);
    (void)hold(&material, 0.012, 20000);
    CHECK(sim_material_step(&material, 0.0) == 0.0);
    double dent_m = material.surface_m;
    CHECK(dent_m > 0.001 && dent_m < 0.012);
    CHECK(sim_material_step(&material, 0.5 * dent_m) == 0.0);
    (void)hold(&material, -0.01, 20000);
    CHECK(material.surface_m < 0.5 * dent_m);
    sim_material touching = material;
    CHECK(sim_material_step(&touching, material.surface_m + 0.001) > 0.0);
}

TEST(check_finite_at_the_table)
{
    sim_material material;
    sim_material_config stressed = plain;
    stressed.eyring_n = 2.5;
    sim_material_init(&material, &stressed);
    CHECK(isfinite(hold(&material, 0.050, 10)) && hold(&material, 0.050, 10) > 100.0);
    CHECK(isfinite(hold(&material, 0.005, 10)));
}

TEST(check_two_halves)
{
    enum { N = 400 };
    double position_m[N];
    double whole_n[N];
    double halves_n[N];
    for (int i = 0; i < N; i++) {
        position_m[i] = 0.006 * (1.0 - cos(0.0157 * i));
    }
    for (uint32_t variant = 0; variant < 2; variant++) {
        sim_object object;
        CHECK(sim_object_init(&object, 1, variant, 1.0, 0.001, 16) == SIM_OK);
        CHECK(sim_object_move(&object, N, position_m, whole_n) == SIM_OK);
        CHECK(sim_object_init(&object, 1, variant, 1.0, 0.001, 16) == SIM_OK);
        (void)sim_object_move(&object, 150, position_m, halves_n);
        (void)sim_object_move(&object, N - 150, position_m + 150, halves_n + 150);
        CHECK(memcmp(whole_n, halves_n, sizeof whole_n) == 0);
        CHECK(whole_n[N / 2] > 1.0);
    }
}

TEST(check_misuse)
{
    sim_object object;
    double position_m[2] = {0.001, (double)NAN};
    double force_n[2] = {7.0, 7.0};
    CHECK(sim_object_init(&object, sim_object_count(), 0, 1.0, 0.001, 16) == SIM_RANGE);
    CHECK(sim_object_init(&object, 0, 2, 1.0, 0.001, 16) == SIM_RANGE);
    CHECK(sim_object_init(&object, 0, 0, 0.0, 0.001, 16) == SIM_RANGE);
    CHECK(sim_object_init(&object, 0, 0, 1.0, 0.0, 16) == SIM_RANGE);
    CHECK(sim_object_init(&object, 0, 0, 1.0, 0.001, 0) == SIM_RANGE);
    CHECK(sim_object_init(NULL, 0, 0, 1.0, 0.001, 16) == SIM_NULL);
    CHECK(sim_object_init(&object, 0, 0, 1.0, 0.001, 16) == SIM_OK);
    sim_object before = object;
    CHECK(sim_object_move(&object, 2, position_m, force_n) == SIM_RANGE);
    CHECK(memcmp(&before, &object, sizeof object) == 0 && force_n[0] == 7.0);
    CHECK(sim_object_init(&object, 5, 1, 1.0, 0.001, 16) == SIM_RANGE);
    CHECK(sim_object_name(sim_object_count()) == NULL);
}

TEST(check_noise)
{
    sim_noise noise;
    double sum = 0.0;
    double squares = 0.0;
    double fourths = 0.0;
    enum { N = 200000 };
    sim_noise_init(&noise, 3);
    for (int i = 0; i < N; i++) {
        double draw = sim_noise_normal(&noise);
        sum += draw;
        squares += draw * draw;
        fourths += draw * draw * draw * draw;
    }
    CHECK(fabs(sum / N) < 0.01);
    CHECK(fabs(squares / N - 1.0) < 0.02);
    CHECK(fabs(fourths / N - 3.0) < 0.1);
}
