/* A device as the loop sees it: the newest motion in, a force out. The caller owns the memory of
 * each kind of link (the ..._size functions say how much, aligned as for double) and the file
 * descriptor, which does not block. Counters only grow; another thread may look at them. */
#ifndef SP_LINK_H
#define SP_LINK_H

#include <stdint.h>

/* springpot declarations begin */
enum {
    SP_LINK_GONE = -1, /* unplugged, or the other end closed */
    SP_LINK_TRIPPED =
        -2,             /* the device switched its motor off by itself, and stays off until reset */
    SP_LINK_ENDED = -3, /* a replay has no more samples */
    SP_LINK_BUTTON = -4 /* the device's own button was pressed: stop */
};

typedef struct {
    double position_m;
    double velocity_mps;
    double measured_n;   /* NaN where the device measures no force */
    uint64_t arrived_ns; /* of CLOCK_MONOTONIC */
} sp_motion;

typedef struct sp_link sp_link;
struct sp_link {
    int fd;       /* to wait on, or -1: a sample is there whenever it is asked for */
    int ready;    /* takes forces; 0 until the device has answered a reset */
    int released; /* set by the loop: nothing holds the tool, no force acts on any axis */

    /* Take all that has come: how many samples were new, the newest `room` of them at motions, in
     * order; or negative. */
    int (*read)(sp_link *link, uint64_t now_ns, sp_motion *motions, uint32_t capacity);
    /* Send a force (N, positive pushes the tool out): 0, 1 where there was no room, or negative. */
    int (*write)(sp_link *link, uint64_t now_ns, double force_n);
    /* Ask a device that is not ready, or that tripped, to take forces. */
    void (*reset)(sp_link *link, uint64_t now_ns);

    uint32_t samples;       /* all that came, unused ones included */
    uint32_t crc_errors;    /* damaged frames, lines or answers */
    uint32_t sequence_gaps; /* frames that never came */
    uint32_t unsent;        /* forces for which there was no room */
    uint32_t saturated;     /* forces of which the motors gave less */
    uint32_t device_error;  /* what a device says is wrong with it; its own numbers */
};

/* springpot serial, a simple device: position in, force out. surface_m: position of the undeformed
 * surface in the device's own counting. watchdog_s: of the device. */
uint32_t sp_link_serial_size(void);
sp_link *sp_link_serial_init(void *memory, int fd, double surface_m, float watchdog_s,
                             float rate_hz, uint32_t next_sequence);

/* An ODrive: CAN Simple frames through a Lawicel adapter's text (slcan) or a raw CAN socket.
 * position = sign * (turns - zero_turns) * m_per_turn - surface_m. with_torque: the firmware sends
 * 0x1C with torques (0.6); 0.5 has something else there. The two limits are the drive's own. */
typedef struct {
    uint32_t node;
    int32_t slcan; /* 1: text of an adapter, 0: struct can_frame of a socket */
    int32_t with_torque;
    double m_per_turn;
    double sign;
    double zero_turns;
    double surface_m;
    double max_torque_nm;
    double max_turns_per_s;
    double max_current_a;
} sp_odrive;
uint32_t sp_link_odrive_size(void);
sp_link *sp_link_odrive_init(void *memory, int fd, const sp_odrive *drive);

/* A Force Dimension device through the functions of its SDK, which one thread calls at a time.
 * position = sign * p[axis] - surface_m. The other axes are free, or drawn to a line by springs of
 * wall_npm, each of max_n at most. weight_n acts upwards, along the last axis, beside all else; it
 * rises within a second. A call that takes longer than max_call_s trips the link: meanwhile the
 * last force stayed. */
typedef struct {
    int (*get_position)(double *, double *, double *, char);
    int (*get_linear_velocity)(double *, double *, double *, char);
    int (*set_force)(double, double, double, char);
    int (*get_status)(int *, char);
    int (*get_button)(int, char);
    int (*enable_force)(unsigned char, char);
    int (*error_get_last)(void);
    int32_t id;
    int32_t axis;
    double sign;
    double surface_m;
    double line_m[3];
    double wall_npm;
    double max_n;
    double weight_n;
    double max_call_s;
} sp_dhd;
enum { /* device_error of such a link, beyond the SDK's own numbers */
       SP_DHD_SLOW_CALL = 0x100,
       SP_DHD_FORCE_OFF = 0x200 /* and the SDK's number of the cause */
};
uint32_t sp_link_dhd_size(void);
sp_link *sp_link_dhd_init(void *memory, const sp_dhd *dhd);

/* A simulated hand (runtime_c/sim) that holds the device and presses to and fro: it intends to be
 * at depth_m / 2 * (1 - cos(2 pi frequency_hz t)). tool: a sim_tool, initialised. */
uint32_t sp_link_sim_size(void);
sp_link *sp_link_sim_init(void *memory, void *tool, double dt_s, double depth_m,
                          double frequency_hz);

/* A device that nobody holds. device: a sim_free, initialised for the period of the loop. */
uint32_t sp_link_free_size(void);
sp_link *sp_link_free_init(void *memory, void *device);

/* n samples that somebody recorded, one a tick. */
uint32_t sp_link_replay_size(void);
sp_link *sp_link_replay_init(void *memory, uint64_t n, const double *position_m,
                             const double *velocity_mps);
/* springpot declarations end */

/* Where the next sample goes, `count` having come: the oldest makes room. */
sp_motion *sp_link_place(sp_motion *motions, uint32_t capacity, int count);

/* Read what is there; how many bytes, 0 for none, or SP_LINK_GONE. */
int sp_link_take(int fd, uint8_t *bytes, uint32_t capacity);
/* Write all of it or say how far it got; or SP_LINK_GONE. */
int sp_link_put(int fd, const uint8_t *bytes, uint32_t count);

#endif
