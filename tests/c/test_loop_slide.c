/* A scene that slides: x and y pass beside the depth, from the device to the scene, and the forces
 * along them back; limits are of the force's length, and silence is of all axes. */
#include "simulated_session.h"

static sp_slide slide;
static const sp_period period = {.begin_ns = START_NS, .deadline_ns = START_NS - 100000};

/* Between two ticks, with a sample that waits, and a scene that gives 3 and -4 N sideways. */
static void sliding(void)
{
    between_ticks();
    slide = (sp_slide){.lateral_n = {3.0, -4.0}};
    self.config.slide = &slide;
    self.waiting[0] = sim.motion;
    self.waiting[0].position_m = 0.3;
    self.waiting[0].velocity_mps = -0.6;
    self.waiting[0].lateral_m[0] = 0.1;
    self.waiting[0].lateral_m[1] = -0.7;
    self.waiting_count = 1;
}

TEST(x_and_y_reach_the_scene_and_their_forces_the_device)
{
    for (int reversed = 0; reversed <= 1; reversed++) {
        const double way = reversed ? -1.0 : 1.0;
        sliding();
        self.config.reversed = reversed;
        settle_current(&self, &period, 0, 1);
        CHECK(slide.lateral_m[0] == 0.1 && slide.lateral_m[1] == -0.7);
        CHECK(sp_loop_drain(&self, rows, 1) == 1);
        CHECK(rows[0].x_m == 0.1 && rows[0].y_m == -0.7);
        CHECK(rows[0].position_m == 0.3 && rows[0].velocity_mps == -0.6);
        CHECK(rows[0].x_n == 3.0 && rows[0].y_n == -4.0 && rows[0].returned_n == 2.0);
        CHECK(device.lateral_n[0] == way * 3.0 && device.lateral_n[1] == way * -4.0);
        CHECK(sim.written_n[0] == way * 2.0);
    }
}

TEST(without_a_sample_the_tool_is_where_it_was)
{
    sliding();
    slide.lateral_m[0] = 0.25;
    slide.lateral_m[1] = 0.5;
    self.waiting_count = 0;
    settle_current(&self, &period, 0, 0);
    CHECK(slide.lateral_m[0] == 0.25 && slide.lateral_m[1] == 0.5);
    CHECK(self.row.x_m == 0.25 && self.row.y_m == 0.5);
    CHECK(device.lateral_n[0] == 3.0 && device.lateral_n[1] == -4.0);
}

TEST(a_scene_of_one_axis_has_none_beside_it)
{
    sliding();
    self.config.slide = NULL;
    settle_current(&self, &period, 0, 1);
    CHECK(self.row.x_m == 0.0 && self.row.y_m == 0.0 && slide.lateral_m[0] == 0.0);
    CHECK(device.lateral_n[0] == 0.0 && device.lateral_n[1] == 0.0);
}

TEST(silence_is_of_all_axes)
{
    for (int ends = 0; ends <= 1; ends++) {
        int put;
        sliding();
        self.row.x_n = self.row.y_n = (double)NAN;
        device.lateral_n[0] = device.lateral_n[1] = 9.0;
        if (ends) {
            self.reason = SP_STOP_ASKED;
            CHECK(send_force(&self, 0, &put) == 1 && put == 0);
        } else {
            self.paused = 1;
            settle_current(&self, &period, 0, 1);
            CHECK(self.row.x_n == 0.0 && self.row.y_n == 0.0);
        }
        CHECK(device.lateral_n[0] == 0.0 && device.lateral_n[1] == 0.0);
        CHECK(sim.written_n[0] == 0.0 && device.released);
    }
}

/* The scene limits the length of a force, whose parts it then rounds: a millionth is left. */
TEST(limits_are_of_the_length_of_the_force)
{
    const struct {
        double x_n, y_n, z_n;
        int slides, reason;
    } cases[] = {{8, 0, 6, 1, 0},
                 {0, -8, -6, 1, 0},
                 {8, 1, 6, 1, SP_STOP_FORCE},
                 {1, 8, 6, 1, SP_STOP_FORCE},
                 {0, 0, 10.000005, 1, 0},
                 {0, 0, 10.000015, 1, SP_STOP_FORCE},
                 {0, 0, 10.000005, 0, SP_STOP_FORCE},
                 {0, 0, 10, 0, 0},
                 {(double)NAN, 0, 1, 1, SP_STOP_FORCE},
                 {0, (double)INFINITY, 1, 1, SP_STOP_FORCE}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sliding();
        self.config.slide = cases[i].slides ? &slide : NULL;
        self.row = (sp_row){.x_n = cases[i].x_n,
                            .y_n = cases[i].y_n,
                            .returned_n = cases[i].z_n,
                            .measured_n = (double)NAN};
        check_limits(&self);
        CHECK(self.reason == cases[i].reason);
    }
}
