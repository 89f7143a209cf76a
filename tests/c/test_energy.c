/* The account of energy, by hand: an object that stores 2 J a metre. */
#include <math.h>

#include "check.h"
#include "sp_energy.h"

static const sp_energy_config config = {
    .push_n = (sp_real)2, .look_ticks = (sp_real)4, .keep = (sp_real)0.5};

TEST(the_most_is_a_parabola_from_a_depth_on)
{
    const sp_energy_config other = {.from_m = (sp_real)-4,
                                    .most_j = (sp_real)1,
                                    .push_n = (sp_real)2,
                                    .stiffness_npm = (sp_real)3};
    const struct {
        double x, most_j;
    } cases[] = {{-9, 1}, {-4, 1}, {-3, 6}, {-2, 17}, {0, 57}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CHECK((double)sp_energy_most(&other, (sp_real)cases[i].x) == cases[i].most_j);
    }
}

/* A sample at x without a silence before it; the step that the tool may go on by. */
static double pay(const sp_energy_config *how, sp_energy_state *state, double given_n, double x)
{
    const sp_real force_n = (sp_real)given_n;
    return (double)sp_energy_pay(how, state, force_n, force_n, (sp_real)x, (sp_real)1, (sp_real)7,
                                 (sp_real)0);
}

TEST(the_hand_pays_by_the_force_that_was_given)
{
    sp_energy_state state;
    sp_energy_restart(&config, &state, (sp_real)0);
    CHECK(state.left_j == (sp_real)0);
    (void)pay(&config, &state, 1.5, 2);
    CHECK(state.left_j == (sp_real)3 && state.position_m == (sp_real)2);
    (void)pay(&config, &state, 1, 1);
    CHECK(state.left_j == (sp_real)2);
    (void)pay(&config, &state, 1, 0.5);
    CHECK(state.left_j == (sp_real)1); /* of the 1.5 J left, what 0.5 m store */
    (void)pay(&config, &state, 4, -0.5);
    CHECK(state.left_j == (sp_real)-3); /* more than was paid: the next press owes it */
    sp_energy_restart(&config, &state, (sp_real)3);
    CHECK(state.left_j == (sp_real)6 && state.position_m == (sp_real)3);
}

TEST(the_devices_damping_pays_too)
{
    sp_energy_state state = {.position_m = (sp_real)4};
    (void)sp_energy_pay(&config, &state, (sp_real)0, (sp_real)0, (sp_real)6, (sp_real)4, (sp_real)0,
                        (sp_real)3);
    CHECK(state.left_j == (sp_real)3);
}

TEST(after_a_silence_the_hand_got_the_most_and_paid_the_least)
{
    const struct {
        double given_n, held_n, x, left_j;
    } cases[] = {{1, 3, 2, 2},   {1, 3, -1, 5},  {3, 1, 2, 2}, {3, 1, -1, 5},
                 {-1, -3, 6, 2}, {-1, -3, 1, 8}, {0, 3, 2, 2}, {0, 3, 6, 8}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_energy_state state = {.left_j = (sp_real)8, .position_m = (sp_real)4};
        sp_energy_config wide = config;
        wide.most_j = (sp_real)99;
        (void)sp_energy_pay(&wide, &state, (sp_real)cases[i].given_n, (sp_real)cases[i].held_n,
                            (sp_real)cases[i].x, (sp_real)3, (sp_real)0, (sp_real)0);
        const double way = cases[i].x - 4;
        const double of_given = cases[i].given_n * way, of_held = cases[i].held_n * way;
        CHECK((double)state.left_j == 8 + (of_given < of_held ? of_given : of_held));
    }
}

TEST(an_encoder_has_a_play)
{
    sp_energy_config coarse = config;
    coarse.slack_m = (sp_real)16; /* a play of 11 each way */
    const struct {
        double x, rest_m, step_m;
    } cases[] = {{11, 0, 0},   {-11, 0, 0},  {12, 1, 7},   {13, 2, 7},
                 {11, 2, 0},   {-9, 2, 0},   {-10, 1, 7},  {-30, -19, 7},
                 {-9, -19, 0}, {-8, -19, 0}, {-7, -18, 7}, {-29, -18, 0}};
    sp_energy_state state = {0};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CHECK(pay(&coarse, &state, 1, cases[i].x) == cases[i].step_m);
        CHECK((double)state.rest_m == cases[i].rest_m);
    }
    /* Where it has moved to, it is not found to move again, however the play is rounded. */
    coarse.slack_m = (sp_real)1.5e-5;
    sp_energy_state rests = {.rest_m = (sp_real)1};
    for (unsigned i = 0; i < 300; i++) {
        const double x = 1e-5 * (343 - i);
        (void)pay(&coarse, &rests, 1, x);
        CHECK(pay(&coarse, &rests, 1, x) == 0.0 && pay(&coarse, &rests, 1, x + 2e-5) == 0.0);
        CHECK(pay(&coarse, &rests, 1, x) == 0.0);
    }
}

TEST(what_cannot_be_paid_is_cut)
{
    const struct {
        double left_j, step_m, in, out;
    } cases[] = {{8, -1, 4, 4},  {8, -1, 5, 4},   {8, -2, 5, 2}, {8, 2, 5, 5},
                 {0, -1, 5, 0},  {-1, -1, 5, 0},  {-1, 1, 5, 5}, {0, 0, 5, 5},
                 {8, 2, -5, -2}, {8, -2, -5, -5}, {0, 1, -5, 0}, {0.25, -1, 4, 0.125}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const sp_energy_state state = {.left_j = (sp_real)cases[i].left_j};
        int notes = SP_NOTE_RAMPED;
        const sp_real force_n =
            sp_energy_limit(&state, (sp_real)cases[i].step_m, (sp_real)cases[i].in, &notes);
        CHECK((double)force_n == cases[i].out);
        CHECK(notes == (SP_NOTE_RAMPED | (cases[i].in == cases[i].out ? 0 : SP_NOTE_ENERGY)));
    }
}

/* x after each tick, from 0: what is known after it of the step, its change, and the greatest. */
TEST(every_four_ticks_a_look_at_the_motion)
{
    const struct {
        double x, step_m, bend_m, turn_m, ticks;
    } cases[] = {{1, 0, 0, 0, 1},         {2, 0, 0, 0, 2},         {3, 0, 0, 0, 3},
                 {8, 2, 0.5, 0.5, 0},     {8, 2, 0.5, 0.5, 1},     {8, 2, 0.5, 0.5, 2},
                 {8, 2, 0.5, 0.5, 3},     {12, 1, -0.25, 0.25, 0}, {13, 1, -0.25, 0.25, 1},
                 {14, 1, -0.25, 0.25, 2}, {15, 1, -0.25, 0.25, 3}, {16, 1, 0, 0.125, 0}};
    sp_energy_state state = {0};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        (void)pay(&config, &state, 0, cases[i].x);
        CHECK((double)state.step_m == cases[i].step_m && (double)state.bend_m == cases[i].bend_m);
        CHECK((double)state.turn_m == cases[i].turn_m && (double)state.ticks == cases[i].ticks);
    }
    sp_energy_config coarse = config;
    coarse.slack_m = (sp_real)2;
    sp_energy_state still = {.ticks = (sp_real)3, .step_m = (sp_real)1};
    (void)pay(&coarse, &still, 0, 2);
    CHECK(still.step_m == (sp_real)0 && still.looked_m == (sp_real)2);
    sp_energy_state later = {.ticks = (sp_real)3};
    (void)sp_energy_pay(&config, &later, (sp_real)0, (sp_real)0, (sp_real)8, (sp_real)5, (sp_real)0,
                        (sp_real)0);
    CHECK(later.step_m == (sp_real)1 && later.ticks == (sp_real)0);
}

TEST(the_force_falls_with_the_square_of_the_depth)
{
    const struct {
        double from_m, to_m, share;
    } cases[] = {{4, 2, 0.25}, {4, 4, 1},  {4, 5, 1},   {4, 0, 0},
                 {4, -1, 0},   {0, -1, 1}, {-1, -2, 1}, {0.5, 0.25, 0.25}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CHECK((double)sp_energy_share((sp_real)cases[i].from_m, (sp_real)cases[i].to_m) ==
              cases[i].share);
    }
}

static double wait(sp_energy_state *state, double silent, double ticks, double given_n, int *notes)
{
    return (double)sp_energy_wait(&config, state, (sp_real)silent, (sp_real)ticks, (sp_real)given_n,
                                  (sp_real)given_n, notes);
}

TEST(without_samples_the_tool_is_taken_to_go_on)
{
    /* Pressing in, and slower: still after two ticks, out by 4 m in the third. */
    sp_energy_state state = {.left_j = (sp_real)24,
                             .position_m = (sp_real)8,
                             .step_m = (sp_real)8,
                             .bend_m = (sp_real)-4};
    int notes = 0;
    CHECK(wait(&state, 0, 2, 4, &notes) == 4.0);
    CHECK(state.left_j == (sp_real)24 && state.position_m == (sp_real)8);
    CHECK(wait(&state, 2, 1, 4, &notes) == 1.0);
    CHECK(state.left_j == (sp_real)8 && state.position_m == (sp_real)4 && notes == 0);
    /* The sample finds it 2 m further in: what was taken too much is given back. */
    sp_energy_state found = state;
    (void)pay(&config, &found, 1, 6);
    CHECK(found.left_j == (sp_real)10 && found.position_m == (sp_real)6);
    /* Or it goes on, out of the object. */
    CHECK(wait(&state, 3, 1, 1, &notes) == 0.0);
    CHECK(state.left_j == (sp_real)0 && state.position_m == (sp_real)-4);
}

TEST(a_hand_turns_as_fast_as_it_did)
{
    sp_energy_state state = {.left_j = (sp_real)26, .position_m = (sp_real)8, .turn_m = (sp_real)2};
    int notes = 0;
    /* 1.5 times 2 m, then twice that: the mean step is 0, and the depth's share 1. */
    CHECK(wait(&state, 0, 1, 2, &notes) == 2.0);
    CHECK(state.left_j == (sp_real)20 && state.position_m == (sp_real)5 && notes == 0);
    /* 2 N for 6 m leave 8 J: 6 m more may take 4 J. */
    CHECK(fabs(wait(&state, 1, 1, 2, &notes) - 2.0 / 3.0) < 1e-6 && notes == SP_NOTE_ENERGY);
    CHECK(state.left_j == (sp_real)8 && state.position_m == (sp_real)-1);
    sp_energy_state pulling = {
        .left_j = (sp_real)20, .position_m = (sp_real)8, .turn_m = (sp_real)2};
    (void)wait(&pulling, 0, 1, -4, &notes);
    CHECK(pulling.position_m == (sp_real)11 && pulling.left_j == (sp_real)8);
}

TEST(a_small_force_and_a_small_way_are_paid_as_great_ones)
{
    int notes = 0;
    sp_energy_state state = {.left_j = (sp_real)8, .position_m = (sp_real)8, .turn_m = (sp_real)2};
    (void)wait(&state, 0, 1, 0.5, &notes);
    CHECK(state.position_m == (sp_real)5 && state.left_j == (sp_real)6.5);
    sp_energy_state deeper = {
        .left_j = (sp_real)8, .position_m = (sp_real)8, .step_m = (sp_real)0.125};
    CHECK(wait(&deeper, 0, 1, 1, &notes) == 1.0);
    CHECK(deeper.position_m == (sp_real)8 && deeper.left_j == (sp_real)8 && notes == 0);
}

TEST(where_nothing_is_given_nothing_is_paid)
{
    int notes = 0;
    sp_energy_state state = {.left_j = (sp_real)8, .position_m = (sp_real)8, .step_m = (sp_real)-1};
    CHECK(wait(&state, 0, 2, 0, &notes) == 0.0 && state.position_m == (sp_real)8 && notes == 0);
}

TEST(the_depth_is_counted_from_where_the_object_begins)
{
    sp_energy_config other = config;
    other.from_m = (sp_real)4;
    sp_energy_state state = {
        .left_j = (sp_real)99, .position_m = (sp_real)8, .step_m = (sp_real)-2};
    int notes = 0;
    const sp_real force_n =
        sp_energy_wait(&other, &state, (sp_real)0, (sp_real)1, (sp_real)4, (sp_real)4, &notes);
    CHECK(force_n == (sp_real)1); /* half of 4 m, squared */
}

TEST(a_restart_forgets_the_motion)
{
    sp_energy_state state = {(sp_real)9, (sp_real)9, (sp_real)9, (sp_real)2, (sp_real)9,
                             (sp_real)9, (sp_real)9, (sp_real)9, (sp_real)9};
    sp_energy_restart(&config, &state, (sp_real)3);
    CHECK(state.looked_m == (sp_real)3 && state.ticks == (sp_real)0);
    CHECK(state.step_m == (sp_real)0 && state.bend_m == (sp_real)0 && state.turn_m == (sp_real)0);
    CHECK(state.held_n == (sp_real)0 && state.rest_m == (sp_real)3);
}

TEST(steps_of_the_encoder_are_no_motion)
{
    sp_energy_config coarse = config;
    coarse.slack_m = (sp_real)1;
    sp_energy_state state = {
        .left_j = (sp_real)4, .position_m = (sp_real)4, .looked_m = (sp_real)4};
    for (int i = 0; i < 10; i++) {
        const sp_real x = (sp_real)(i % 2 ? 3 : 5);
        (void)pay(&coarse, &state, 1, (double)x);
        CHECK(state.left_j == (sp_real)4 && state.position_m == (sp_real)4);
    }
    (void)pay(&coarse, &state, 1, 2.5);
    CHECK(state.left_j == (sp_real)2.5 && state.position_m == (sp_real)2.5);
}

/* A call that comes late: the device has held its force until now, and falls from now on. */
TEST(late_the_hand_got_the_force_that_was_held)
{
    sp_energy_state state = {
        .left_j = (sp_real)99, .position_m = (sp_real)8, .step_m = (sp_real)-1};
    int notes = 0;
    const double left_n = wait(&state, 0, 4, 4, &notes);
    CHECK(state.left_j == (sp_real)(99 - 16) && state.position_m == (sp_real)4);
    CHECK(fabs(left_n - 1.0) < 1e-6 && state.held_n == (sp_real)4);
    /* Of a sample that is not taken, a share is felt from now on; until now all of it was. */
    sp_energy_state shared = {
        .left_j = (sp_real)99, .position_m = (sp_real)8, .step_m = (sp_real)-4};
    const double kept_n = (double)sp_energy_wait(&config, &shared, (sp_real)0, (sp_real)1,
                                                 (sp_real)4, (sp_real)2, &notes);
    CHECK(kept_n == 0.5 && shared.left_j == (sp_real)(99 - 16));
    CHECK(shared.held_n == (sp_real)4);
    /* Later calls of one silence do not forget what it began with. */
    (void)wait(&shared, 1, 1, 0.5, &notes);
    CHECK(shared.held_n == (sp_real)4);
    /* With nothing left over, nothing is given on. */
    sp_energy_state none = {.position_m = (sp_real)8, .step_m = (sp_real)-1};
    CHECK(wait(&none, 0, 1, 4, &notes) == 0.0 && notes == SP_NOTE_ENERGY);
}

/* However a time is told, so many whole ticks of it have passed. */
TEST(parts_add_up_to_ticks)
{
    const unsigned parts[] = {1, 2, 4, 8, 16};
    for (unsigned i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        sp_energy_state state = {.left_j = (sp_real)1e3, .step_m = (sp_real)-1};
        int notes = 0;
        const double part = 1.0 / parts[i];
        for (unsigned k = 0; k < 5 * parts[i]; k++) {
            (void)wait(&state, k * part, part, 1, &notes);
        }
        CHECK((double)state.position_m == -5.0);
    }
}

TEST(no_state_makes_a_wait_endless)
{
    const double wrong[] = {-1.0, (double)NAN, (double)INFINITY, 1e30};
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        sp_energy_state state = {.left_j = (sp_real)1e3, .step_m = (sp_real)-1};
        int notes = 0;
        (void)wait(&state, wrong[i], 1, 1, &notes);
        CHECK((double)state.position_m == 0.0 || (double)state.position_m == -1.0);
    }
    CHECK(sp_energy_ticks((sp_real)1e30) == (uint32_t)SP_SILENCE_MOST);
    CHECK(sp_energy_ticks(SP_SILENCE_MOST + (sp_real)0.75) == (uint32_t)SP_SILENCE_MOST);
    CHECK(sp_energy_ticks((sp_real)2.4) == 2u && sp_energy_ticks((sp_real)2.5) == 3u);
}

TEST(parts_of_a_tick_are_counted_to_the_nearest)
{
    const double ticks[] = {0, -1, 0.3, 0.5, 1.4, 1.6};
    const double ways_m[] = {0, 0, 0, 1, 1, 2};
    for (unsigned i = 0; i < sizeof ticks / sizeof ticks[0]; i++) {
        sp_energy_state state = {.left_j = (sp_real)1e3, .step_m = (sp_real)-1};
        int notes = 0;
        (void)wait(&state, 0, ticks[i], 1, &notes);
        CHECK((double)state.position_m == -ways_m[i]);
    }
}
