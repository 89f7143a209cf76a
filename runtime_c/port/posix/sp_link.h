/* A device as the loop sees it: the newest motion in, a force out. The caller owns the memory of
 * each kind of link (the ..._size functions say how much, aligned as for double) and the file
 * descriptor, which does not block. Counters only grow; another thread may look at them. What the
 * host calls of a kind of link, its own file declares between lines "springpot declarations". */
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

    /* Take all that has come: how many samples were new, the newest `capacity` of them at
     * motions, in order; or negative. */
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
/* springpot declarations end */

/* Where the next sample goes, `count` having come: the oldest makes room. */
sp_motion *sp_link_next_slot(sp_motion *motions, uint32_t capacity, int count);

/* Wait until there is something to read, or for so long: above 0 where it is worth a look. */
int sp_link_wait(int fd, uint64_t max_ns);
/* Read what is there; how many bytes, 0 for none, or SP_LINK_GONE. */
int sp_link_read_bytes(int fd, uint8_t *bytes, uint32_t capacity);
/* Write all of it or say how far it got; or SP_LINK_GONE. */
int sp_link_write_bytes(int fd, const uint8_t *bytes, uint32_t count);

#endif
