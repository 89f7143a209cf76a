/* A stand-in for Force Dimension's SDK: the functions that springpot calls, with the meaning that
 * CHAI3D's public header and its users show, over a simulated device.
 *
 * The device's other half, its firmware, is another process (dhd_device.py): they share the page
 * NAME.state beside this library NAME. It has the page made, keeps the watchdog, says what goes
 * wrong and when; it outlives the program that this library is loaded into. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "sim.h"

/* The page: doubles, in this order. */
enum {
    CONNECTED, /* on USB */
    POWERED,
    CALIBRATED,
    IN_USE,
    ENABLED,
    CAUSE,
    WATCHDOG_S, /* 0: off */
    HAS_WATCHDOG,
    FORCE_S, /* when the last force came, s of CLOCK_MONOTONIC */
    FORCE_X,
    FORCE_Y,
    FORCE_Z,
    FAILS,   /* every call fails */
    HANGS_S, /* the next call takes as long */
    STALE,   /* what was read before is read again, and said so */
    REFUSES, /* no force is taken */
    SATURATED_N,
    BUTTON,
    PRESSES, /* into the object, nobody holds it */
    OBJECT,
    HAND,
    PRESSES_HZ,
    INTENDED_M,
    SEED,
    SURFACE_M, /* height of the object's surface */
    SIDEWAYS_N,
    PLACE_X,
    PLACE_Y,
    PLACE_Z,
    OBJECT_N, /* between tool and object */
    MAX_FORCE_N,
    MASS_KG, /* of the effector, as it was set */
    STATES
};
static const double press_step_s = 125e-6, mass_kg = 0.3, damping_nspm = 4.0, handle_nspm = 6.0;
enum { NO_ERROR = 0, COM = 2, NO_DEVICE = 5, NO_EXPERT = 9, NOT_IMPLEMENTED = 10, IN_USE_ERROR = 20 };
enum { TIMEGUARD = 1, SATURATED = 2, OMEGA3 = 33 };

static volatile double *page;
static _Thread_local int last_error;
static double memory[16384], object_memory[65536];
static double speed[3], began_s, simulated_s, seen[6];
static int started, expert;

static double now_s(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static int share_page(void)
{
    Dl_info own;
    char name[4096];
    if (page != NULL) {
        return 1;
    }
    if (!dladdr((void *)&began_s, &own)) {
        return 0;
    }
    snprintf(name, sizeof name, "%s.state", own.dli_fname);
    const int fd = open(name, O_RDWR | O_CLOEXEC);
    if (fd < 0) {
        return 0;
    }
    void *shared = mmap(NULL, STATES * sizeof(double), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    close(fd);
    page = shared == MAP_FAILED ? NULL : shared;
    return page != NULL;
}

static int fail(int error)
{
    last_error = error;
    return -1;
}

/* What every call of a device begins with. */
static int call(void)
{
    if (page == NULL || page[CONNECTED] == 0 || page[FAILS] != 0) {
        return fail(COM);
    }
    if (page[HANGS_S] > 0) {
        const double hang_s = page[HANGS_S];
        page[HANGS_S] = 0;
        struct timespec left = {(time_t)hang_s, (long)(1e9 * (hang_s - floor(hang_s)))};
        while (nanosleep(&left, &left) < 0 && errno == EINTR) {
        }
    }
    return 0;
}

static void begin(void)
{
    const uint32_t seed = (uint32_t)page[SEED];
    const sim_tool_device held = {mass_kg, damping_nspm, 0.0, 10e-6, 3e-6, 0};
    sim_tool_init((sim_tool *)memory, (uint32_t)page[HAND], &held, 4, 1, seed, 0.0);
    sim_object_init((sim_object *)object_memory, (uint32_t)page[OBJECT], 0, 1.0, press_step_s, 2);
    memset(speed, 0, sizeof speed);
    page[PLACE_X] = page[PLACE_Y] = 0;
    page[PLACE_Z] = page[SURFACE_M];
    began_s = simulated_s = now_s();
    started = 1;
}

/* The tool alone on the object, for one step. */
static void press(double step_s)
{
    double depth_m = page[SURFACE_M] - page[PLACE_Z], object_n;
    sim_object_move((sim_object *)object_memory, 1, &depth_m, &object_n);
    const double push_n = -page[FORCE_Z] - object_n - damping_nspm * speed[2];
    speed[2] += step_s * push_n / mass_kg;
    page[PLACE_Z] = page[PLACE_Z] - step_s * speed[2];
    page[OBJECT_N] = object_n;
    seen[2] = page[PLACE_Z];
    seen[5] = -speed[2];
}

/* The tool in a hand that presses to and fro, for one step. */
static void hold(double step_s)
{
    const double turn = 6.283185307179586 * page[PRESSES_HZ] * (simulated_s - began_s);
    const double intended_m = 0.5 * page[INTENDED_M] * (1 - cos(turn));
    double depth_m, depth_mps;
    sim_tool_step((sim_tool *)memory, step_s, intended_m, page[FORCE_Z], &depth_m, &depth_mps);
    seen[2] = page[SURFACE_M] - depth_m;
    seen[5] = -depth_mps;
    page[PLACE_Z] = seen[2];
}

static void slide(int axis, double step_s)
{
    const double turn = 3.0 * (simulated_s - began_s);
    const double push_n = page[FORCE_X + axis] + page[SIDEWAYS_N] * sin(turn);
    speed[axis] += step_s * (push_n - handle_nspm * speed[axis]) / mass_kg;
    page[PLACE_X + axis] = page[PLACE_X + axis] + step_s * speed[axis];
    seen[axis] = page[PLACE_X + axis];
    seen[3 + axis] = speed[axis];
}

/* Catch up with the clock; after a pause of more than 25 ms time has stood still. */
static void simulate(void)
{
    const double until_s = now_s();
    if (!started) {
        begin();
    }
    if (until_s - simulated_s > 0.025) {
        began_s += until_s - simulated_s - 0.025;
        simulated_s = until_s - 0.025;
    }
    while (simulated_s + press_step_s <= until_s) {
        const double step_s =
            page[PRESSES] != 0 ? press_step_s : fmin(until_s - simulated_s, 1e-3);
        simulated_s += step_s;
        slide(0, step_s);
        slide(1, step_s);
        if (page[PRESSES] != 0) {
            press(step_s);
        } else {
            hold(step_s);
        }
    }
}

#pragma GCC visibility push(default)

int dhdGetDeviceCount(void)
{
    return share_page() && page[CONNECTED] != 0;
}

int dhdOpenID(signed char id)
{
    if (id != 0 || dhdGetDeviceCount() == 0) {
        return fail(NO_DEVICE);
    }
    if (page[IN_USE] != 0) {
        return fail(IN_USE_ERROR);
    }
    if (call() < 0) {
        return -1;
    }
    started = 0;
    page[WATCHDOG_S] = page[ENABLED] = 0;
    page[FORCE_X] = page[FORCE_Y] = page[FORCE_Z] = 0;
    return OMEGA3;
}

int dhdOpen(void)
{
    return dhdOpenID(0);
}

int dhdGetDeviceID(void)
{
    return 0;
}

const char *dhdGetSystemName(signed char id)
{
    return "omega.3 (simulated)";
}

int dhdClose(signed char id)
{
    return page == NULL ? fail(NO_DEVICE) : 0;
}

int dhdGetStatus(int *status, signed char id)
{
    if (call() < 0) {
        return -1;
    }
    status[0] = page[POWERED] != 0;
    status[1] = 1;
    status[3] = page[CALIBRATED] != 0;
    status[5] = page[ENABLED] != 0;
    status[6] = page[ENABLED] == 0;
    status[14] = (int)page[CAUSE];
    return 0;
}

int dhdGetButton(int index, signed char id)
{
    return call() < 0 ? -1 : index == 0 && page[BUTTON] != 0;
}

static int answer(double *x, double *y, double *z, const double *three)
{
    *x = three[0];
    *y = three[1];
    *z = three[2];
    return page[STALE] != 0 ? TIMEGUARD : 0;
}

int dhdGetPosition(double *x, double *y, double *z, signed char id)
{
    if (call() < 0) {
        return -1;
    }
    if (page[STALE] == 0) {
        simulate();
    }
    return answer(x, y, z, seen);
}

int dhdGetLinearVelocity(double *x, double *y, double *z, signed char id)
{
    return call() < 0 ? -1 : answer(x, y, z, seen + 3);
}

int dhdSetForce(double x, double y, double z, signed char id)
{
    if (call() < 0) {
        return -1;
    }
    if (page[REFUSES] != 0) {
        return fail(COM);
    }
    page[FORCE_S] = now_s();
    if (page[ENABLED] == 0) {
        return 0;
    }
    const double most_n = page[SATURATED_N], size_n = sqrt(x * x + y * y + z * z);
    const double part = most_n > 0 && size_n > most_n ? most_n / size_n : 1.0;
    page[FORCE_X] = part * x;
    page[FORCE_Y] = part * y;
    page[FORCE_Z] = part * z;
    return part < 1.0 ? SATURATED : 0;
}

int dhdEnableForce(unsigned char on, signed char id)
{
    if (call() < 0) {
        return -1;
    }
    page[CAUSE] = on ? 0 : 4;
    page[FORCE_S] = now_s();
    page[ENABLED] = on && page[POWERED] != 0;
    if (!on) {
        page[FORCE_X] = page[FORCE_Y] = page[FORCE_Z] = 0;
    }
    return 0;
}

int dhdSetEffectorMass(double mass, signed char id)
{
    page[MASS_KG] = mass;
    return call();
}

int dhdSetGravityCompensation(int on, signed char id)
{
    return call();
}

int dhdSetMaxForce(double limit, signed char id)
{
    page[MAX_FORCE_N] = limit;
    return call();
}

int dhdEnableExpertMode(void)
{
    expert = 1;
    return 0;
}

int dhdDisableExpertMode(void)
{
    expert = 0;
    return 0;
}

int dhdSetWatchdog(unsigned char duration, signed char id)
{
    if (!expert) {
        return fail(NO_EXPERT);
    }
    if (page == NULL || page[HAS_WATCHDOG] == 0) {
        return fail(NOT_IMPLEMENTED);
    }
    page[WATCHDOG_S] = 125e-6 * duration;
    return call();
}

int dhdErrorGetLast(void)
{
    return last_error;
}

const char *dhdErrorGetStr(int error)
{
    static const char *const words[] = {
        [NO_ERROR] = "no error",
        [COM] = "communication error",
        [NO_DEVICE] = "no device found",
        [NOT_IMPLEMENTED] = "feature not available",
        [NO_EXPERT] = "expert mode disabled",
        [IN_USE_ERROR] = "device already in use",
    };
    const int known = error >= 0 && error <= IN_USE_ERROR && words[error] != NULL;
    return known ? words[error] : "error";
}
