/* The output's arithmetic, step by step, by hand: what is left of the force, and what it remembers.
 */
#include <math.h>

#include "check.h"
#include "sp_output.h"

/* To either side, unlike most scenes: a force may pull. */
static const sp_output_config config = {.min_n = (sp_real)-12,
                                        .max_n = (sp_real)16,
                                        .slew_n = (sp_real)4,
                                        .rise = (sp_real)0.25,
                                        .fall_n = (sp_real)1.5,
                                        .return_n = (sp_real)0.5};
enum { OTHER_NOTE = SP_NOTE_HELD }; /* said before by another unit: it stays */

static int is_about(sp_real a, double b)
{
    return fabs((double)a - b) < 1e-6;
}

static void a_restart_forgets_the_motion_but_not_the_force(void)
{
    sp_output_state state = {.force_n = (sp_real)3,
                             .share = (sp_real)1,
                             .model_n = (sp_real)2,
                             .slope_n = (sp_real)0.5,
                             .pace_n = (sp_real)0.75};
    sp_output_restart(&state);
    CHECK(state.share == (sp_real)0 && state.slope_n == (sp_real)0 && state.pace_n == (sp_real)0);
    CHECK(state.force_n == (sp_real)3 && state.model_n == (sp_real)2);
}

static void without_contact_nothing_is_left(void)
{
    sp_output_state state = {.force_n = (sp_real)3,
                             .model_n = (sp_real)2,
                             .slope_n = (sp_real)0.5,
                             .pace_n = (sp_real)0.75};
    sp_output_free(&state);
    CHECK(state.share == (sp_real)1 && state.force_n == (sp_real)0);
    CHECK(state.model_n == (sp_real)0);
    CHECK(state.slope_n == (sp_real)0 && state.pace_n == (sp_real)0);
}

static void a_latched_force_falls_for_as_many_ticks_as_passed(void)
{
    const struct {
        sp_real from, ticks, to;
    } cases[] = {
        {(sp_real)8, (sp_real)2, (sp_real)5},      {(sp_real)-8, (sp_real)2, (sp_real)-5},
        {(sp_real)2, (sp_real)0.5, (sp_real)1.25}, {(sp_real)0.5, (sp_real)0.25, (sp_real)0.125},
        {(sp_real)3, (sp_real)2, (sp_real)0},      {(sp_real)0, (sp_real)1, (sp_real)0}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_output_state state = {.force_n = cases[i].from};
        int notes = OTHER_NOTE;
        const sp_real force_n = sp_output_fall(&config, &state, cases[i].ticks, &notes);
        CHECK(force_n == cases[i].to && state.force_n == force_n);
        CHECK(!signbit(force_n) == !signbit(cases[i].from));
        CHECK(notes == (OTHER_NOTE | SP_NOTE_LATCHED));
    }
    sp_output_state pulling = {.force_n = (sp_real)-1};
    int notes = 0;
    CHECK(sp_output_fall(&config, &pulling, (sp_real)1, &notes) == (sp_real)0);
    CHECK(notes == SP_NOTE_LATCHED);
}

static void a_pulling_force_has_a_limit_of_its_own(void)
{
    const struct {
        sp_real in, out;
        int notes;
    } cases[] = {{(sp_real)-12, (sp_real)-12, 0},
                 {(sp_real)16, (sp_real)16, 0},
                 {(sp_real)-13, (sp_real)-12, SP_NOTE_CLAMPED},
                 {(sp_real)17, (sp_real)16, SP_NOTE_CLAMPED},
                 {(sp_real)NAN, (sp_real)0, SP_NOTE_CLAMPED}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        int notes = OTHER_NOTE;
        CHECK(sp_output_clamp(&config, cases[i].in, &notes) == cases[i].out);
        CHECK(notes == (OTHER_NOTE | cases[i].notes));
    }
}

static void a_step_of_the_way_back_has_either_sign_and_arrives(void)
{
    sp_output_state state = {.force_n = (sp_real)2, .aim_n = (sp_real)5, .pace_n = (sp_real)1};
    sp_output_return(&config, &state);
    CHECK(is_about(state.force_n, 2 + 1.2 + 0.5) && state.pace_n == (sp_real)1);
    state.force_n = (sp_real)8;
    sp_output_return(&config, &state);
    CHECK(is_about(state.force_n, 8 - 1.2 - 0.5) && state.pace_n == (sp_real)1);
    for (int side = -1; side <= 1; side++) { /* as far as it may go, to either side, or there */
        sp_output_state last = {.force_n = (sp_real)(5 + 0.5 * side), .aim_n = (sp_real)5};
        last.pace_n = side ? (sp_real)0 : (sp_real)1;
        sp_output_return(&config, &last);
        CHECK(last.force_n == (sp_real)5 && last.pace_n == (sp_real)0);
    }
    sp_output_state exact = {.force_n = (sp_real)0, .pace_n = (sp_real)1};
    exact.aim_n = (sp_real)1.2 * exact.pace_n + config.return_n;
    sp_output_return(&config, &exact);
    CHECK(exact.force_n == exact.aim_n && exact.pace_n == (sp_real)0);
    sp_output_state down = {.force_n = (sp_real)0, .pace_n = (sp_real)1};
    down.aim_n = -exact.aim_n;
    sp_output_return(&config, &down);
    CHECK(down.force_n == down.aim_n && down.pace_n == (sp_real)0);
}

/* pace: the greater of the model's change before and in the silence; on the way it hurries by 3 %
 * a tick at most, and never slows down. */
static void the_pace_of_the_way_back_is_that_of_the_model(void)
{
    const struct {
        sp_real slope, pace, ticks, in;
        double slope_after, pace_after;
    } cases[] = {{(sp_real)0, (sp_real)0, (sp_real)4, (sp_real)6, 1, 1},
                 {(sp_real)-2, (sp_real)0, (sp_real)4, (sp_real)6, 1, 2},
                 {(sp_real)0.5, (sp_real)0, (sp_real)4, (sp_real)-6, -2, 2},
                 {(sp_real)0, (sp_real)0, (sp_real)2, (sp_real)6, 2, 2},
                 {(sp_real)0, (sp_real)0.5, (sp_real)1, (sp_real)6, 4, 0.515},
                 {(sp_real)0, (sp_real)0.5, (sp_real)1.2, (sp_real)8, 5, 0.515},
                 {(sp_real)0, (sp_real)0.5, (sp_real)1, (sp_real)2.5, 0.5, 0.5},
                 {(sp_real)0, (sp_real)2, (sp_real)1, (sp_real)3, 1, 2}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_output_state state = {.force_n = (sp_real)-9,
                                 .share = (sp_real)1,
                                 .model_n = (sp_real)2,
                                 .slope_n = cases[i].slope,
                                 .pace_n = cases[i].pace};
        int notes = OTHER_NOTE;
        const sp_real force_n =
            sp_output_after_silence(&config, &state, cases[i].ticks, cases[i].in, &notes);
        const double step_n = fmin(1.2 * cases[i].pace_after + 0.5, (double)cases[i].in + 9);
        CHECK(is_about(state.slope_n, cases[i].slope_after));
        CHECK(state.aim_n == cases[i].in && state.model_n == cases[i].in);
        CHECK(is_about(state.pace_n, force_n == cases[i].in ? 0 : cases[i].pace_after));
        CHECK(is_about(force_n, -9 + step_n) && state.force_n == force_n);
        CHECK(notes == (OTHER_NOTE | (force_n == cases[i].in ? 0 : SP_NOTE_LIMITED)));
    }
}

static void a_fault_grows_by_so_much_from_where_the_force_was(void)
{
    const struct {
        sp_real last, in, out;
    } cases[] = {
        {(sp_real)3, (sp_real)9, (sp_real)7},     {(sp_real)3, (sp_real)7, (sp_real)7},
        {(sp_real)-3, (sp_real)9, (sp_real)4},    {(sp_real)-3, (sp_real)4, (sp_real)4},
        {(sp_real)-3, (sp_real)-9, (sp_real)-7},  {(sp_real)-3, (sp_real)-7, (sp_real)-7},
        {(sp_real)3, (sp_real)-9, (sp_real)-4},   {(sp_real)3, (sp_real)-4, (sp_real)-4},
        {(sp_real)9, (sp_real)0.5, (sp_real)0.5}, {(sp_real)9, (sp_real)0, (sp_real)0},
        {(sp_real)0, (sp_real)0.5, (sp_real)0.5}, {(sp_real)0, (sp_real)-0.5, (sp_real)-0.5}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        int notes = OTHER_NOTE;
        CHECK(sp_output_slew((sp_real)4, cases[i].last, cases[i].in, &notes) == cases[i].out);
        CHECK(notes == (OTHER_NOTE | (cases[i].in == cases[i].out ? 0 : SP_NOTE_LIMITED)));
    }
}

static void a_tick_that_is_shorter_grows_and_rises_less(void)
{
    sp_output_state state = {.share = (sp_real)1};
    int notes = OTHER_NOTE;
    CHECK(sp_output_force(&config, &state, (sp_real)0.5, (sp_real)9, &notes) == (sp_real)2);
    CHECK(notes == (OTHER_NOTE | SP_NOTE_LIMITED));
    CHECK(sp_output_force(&config, &state, (sp_real)1, (sp_real)9, &notes) == (sp_real)6);
    CHECK(state.slope_n == (sp_real)4 && state.model_n == (sp_real)6);

    sp_output_state ramp = {0};
    notes = OTHER_NOTE;
    CHECK(sp_output_force(&config, &ramp, (sp_real)0.5, (sp_real)8, &notes) == (sp_real)0);
    CHECK(notes == (OTHER_NOTE | SP_NOTE_RAMPED) && ramp.share == (sp_real)0.125);
    CHECK(sp_output_force(&config, &ramp, (sp_real)1, (sp_real)8, &notes) == (sp_real)1);
}

/* From 1.2 ticks on it was a silence: there and back, the force goes its way. */
static void a_tick_that_is_a_little_longer_is_no_silence(void)
{
    const sp_real longer[] = {(sp_real)1.2, (sp_real)2};
    for (int silent = 0; silent <= 1; silent++) {
        sp_output_state state = {.share = (sp_real)1};
        int notes = 0;
        const sp_real force_n =
            sp_output_force(&config, &state, longer[silent], (sp_real)3, &notes);
        CHECK(is_about(force_n, silent ? 1.2 * 1.5 + 0.5 : 3));
        CHECK(is_about(state.slope_n, silent ? 1.5 : 3));
        CHECK(notes == (silent ? SP_NOTE_LIMITED : 0));
    }
}

static void ticks_without_a_sample_are_counted_to_the_nearest(void)
{
    const struct {
        double ticks, force_n, slope_n;
    } cases[] = {{0.3, 5, 1}, {0.5, 6, 0.9}, {1.4, 6, 0.9}, {2, 6.9, 0.81}, {3, 7.71, 0.729}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_output_state state = {.force_n = (sp_real)5, .slope_n = (sp_real)1};
        sp_output_wait(&config, &state, (sp_real)cases[i].ticks);
        CHECK(is_about(state.force_n, cases[i].force_n));
        CHECK(is_about(state.slope_n, cases[i].slope_n));
    }
}

static void on_its_way_the_force_follows_where_the_model_goes(void)
{
    sp_output_state state = {
        .aim_n = (sp_real)5, .slope_n = (sp_real)1, .pace_n = (sp_real)0.5, .model_n = (sp_real)5};
    sp_output_wait(&config, &state, (sp_real)2);
    CHECK(is_about(state.aim_n, 5 + 1 + 0.9) && is_about(state.slope_n, 0.81));
    CHECK(is_about(state.force_n, 2 * (1.2 * 0.5 + 0.5)));
    CHECK(state.pace_n == (sp_real)0.5);
}

int main(void)
{
    a_restart_forgets_the_motion_but_not_the_force();
    without_contact_nothing_is_left();
    a_latched_force_falls_for_as_many_ticks_as_passed();
    a_pulling_force_has_a_limit_of_its_own();
    a_step_of_the_way_back_has_either_sign_and_arrives();
    the_pace_of_the_way_back_is_that_of_the_model();
    a_fault_grows_by_so_much_from_where_the_force_was();
    a_tick_that_is_shorter_grows_and_rises_less();
    a_tick_that_is_a_little_longer_is_no_silence();
    ticks_without_a_sample_are_counted_to_the_nearest();
    on_its_way_the_force_follows_where_the_model_goes();
    return failed;
}
