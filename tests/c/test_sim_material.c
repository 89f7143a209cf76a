/* The simulated silicone by itself: closed forms, the free surface, states that carry. */
#include "sim_contact.c"
#include "sim_damaged.c"
#include "sim_elastomer.c"
#include "sim_material.c"
#include "sim_noise.c"
#include "sim_object.c"
#include "sim_porous.c"
#include "sim_root.c"
#include "sim_tissue.c"

#include <stdio.h>

static int failures;

static void expect(int holds, const char *what)
{
    if (!holds) {
        printf("test_sim_material: %s\n", what);
        failures++;
    }
}

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

static void check_closed_forms(void)
{
    sim_material material;
    sim_material_init(&material, &plain);
    double shapes = (pow(1.2, 1.15) + pow(1.2, 2.2)) / (1.0 - 12.0 / 35.0);
    double sudden_n = plain.branch_n * (1.0 + plain.relaxation) * shapes + plain.friction_n;
    expect(fabs(hold(&material, 0.012, 1) / sudden_n - 1.0) < 0.02, "sudden force");
    double relaxed_n = plain.branch_n * shapes + plain.friction_n;
    double late_n = hold(&material, 0.012, 8000000); /* 800 s, eight times the slowest mode */
    expect(fabs(late_n / relaxed_n - 1.0) < 1e-4, "relaxed force");
}

static void check_free_surface(void)
{
    sim_material material;
    sim_material_init(&material, &plain);
    (void)hold(&material, 0.012, 20000);
    expect(sim_material_step(&material, 0.0) == 0.0, "no force at the surface");
    double dent_m = material.surface_m;
    expect(dent_m > 0.001 && dent_m < 0.012, "a fast release leaves a dent");
    expect(sim_material_step(&material, 0.5 * dent_m) == 0.0, "no force within the dent");
    (void)hold(&material, -0.01, 20000);
    expect(material.surface_m < 0.5 * dent_m, "the dent recovers");
    sim_material touching = material;
    expect(sim_material_step(&touching, material.surface_m + 0.001) > 0.0, "force below the dent");
}

static void check_finite_at_the_table(void)
{
    sim_material material;
    sim_material_config stressed = plain;
    stressed.eyring_n = 2.5;
    sim_material_init(&material, &stressed);
    expect(isfinite(hold(&material, 0.050, 10)) && hold(&material, 0.050, 10) > 100.0,
           "finite force beyond the thickness");
    expect(isfinite(hold(&material, 0.005, 10)), "finite force after it");
}

static void check_two_halves(void)
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
        expect(sim_object_init(&object, 1, variant, 1.0, 0.001, 16) == SIM_OK, "init");
        expect(sim_object_move(&object, N, position_m, whole_n) == SIM_OK, "move");
        expect(sim_object_init(&object, 1, variant, 1.0, 0.001, 16) == SIM_OK, "init again");
        (void)sim_object_move(&object, 150, position_m, halves_n);
        (void)sim_object_move(&object, N - 150, position_m + 150, halves_n + 150);
        expect(memcmp(whole_n, halves_n, sizeof whole_n) == 0, "two halves differ from one run");
        expect(whole_n[N / 2] > 1.0, "a press is felt");
    }
}

static void check_misuse(void)
{
    sim_object object;
    double position_m[2] = {0.001, (double)NAN};
    double force_n[2] = {7.0, 7.0};
    expect(sim_object_init(&object, sim_object_count(), 0, 1.0, 0.001, 16) == SIM_RANGE,
           "object out of range");
    expect(sim_object_init(&object, 0, 2, 1.0, 0.001, 16) == SIM_RANGE, "variant out of range");
    expect(sim_object_init(&object, 0, 0, 0.0, 0.001, 16) == SIM_RANGE, "stiffer 0");
    expect(sim_object_init(&object, 0, 0, 1.0, 0.0, 16) == SIM_RANGE, "no time step");
    expect(sim_object_init(&object, 0, 0, 1.0, 0.001, 0) == SIM_RANGE, "no substeps");
    expect(sim_object_init(NULL, 0, 0, 1.0, 0.001, 16) == SIM_NULL, "null state");
    expect(sim_object_init(&object, 0, 0, 1.0, 0.001, 16) == SIM_OK, "init");
    sim_object before = object;
    expect(sim_object_move(&object, 2, position_m, force_n) == SIM_RANGE, "position not finite");
    expect(memcmp(&before, &object, sizeof object) == 0 && force_n[0] == 7.0, "state unchanged");
    expect(sim_object_init(&object, 5, 1, 1.0, 0.001, 16) == SIM_RANGE, "silicones have variants");
    expect(sim_object_name(sim_object_count()) == NULL, "no name beyond the last");
}

static void check_noise(void)
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
    expect(fabs(sum / N) < 0.01, "noise has a mean");
    expect(fabs(squares / N - 1.0) < 0.02, "noise is not of variance 1");
    expect(fabs(fourths / N - 3.0) < 0.1, "noise is not normal");
}

int main(void)
{
    check_closed_forms();
    check_free_surface();
    check_finite_at_the_table();
    check_two_halves();
    check_misuse();
    check_noise();
    return failures != 0;
}
