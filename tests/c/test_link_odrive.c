/* The link of an ODrive on a line that takes what a test lets it take: what arms the drive goes out
 * in order, each frame once, whatever was refused; a torque only after it. */
#include "../../runtime_c/port/posix/sp_link_odrive.c"

#include "check.h"

enum { ROUNDS = 20000, WRITES = 60, MS = 1000000, WIRE = 1 << 14, CAN_FRAME = 16 };

static struct {
    uint8_t bytes[WIRE];
    uint32_t used;
    uint32_t room; /* of the next write */
    uint32_t seed;
} line;

static uint32_t any(uint32_t below)
{
    line.seed = line.seed * 1664525u + 1013904223u;
    return (line.seed >> 8) % below;
}

int sp_link_write_bytes(int fd, const uint8_t *bytes, uint32_t count)
{
    const uint32_t put = line.room >= count ? count : 0;
    (void)fd;
    CHECK(line.used + put <= WIRE);
    memcpy(line.bytes + line.used, bytes, put);
    line.used += put;
    line.room -= put;
    return (int)put;
}

int sp_link_read_bytes(int fd, uint8_t *bytes, uint32_t capacity)
{
    (void)fd;
    (void)bytes;
    (void)capacity;
    return 0;
}

sp_motion *sp_link_next_slot(sp_motion *motions, uint32_t capacity, int count)
{
    (void)capacity;
    (void)count;
    return motions;
}

/* The command of the next whole frame on the line and its first byte of data; -1 for none. */
static int next_command(uint32_t *at, int *first)
{
    can_frame frame;
    if (*at + CAN_FRAME > line.used) {
        return -1;
    }
    memcpy(&frame, line.bytes + *at, sizeof frame);
    *at += CAN_FRAME;
    *first = frame.data[0];
    return (int)(frame.id & 31u);
}

/* Frames of one reset are a beginning of `arming`, and torques come after the whole of it. */
static int is_in_order(int *armings)
{
    uint32_t at = 0, next = ARMING_STEPS;
    int command, first = 0, fine = 1;
    while ((command = next_command(&at, &first)) >= 0) {
        if (command == CLEAR_ERRORS) {
            next = 1; /* also where another reset cut the last one short */
        } else if (command == INPUT_TORQUE) {
            fine = fine && next == ARMING_STEPS;
        } else {
            fine = fine && next < ARMING_STEPS && command == (int)arming[next];
            next++;
        }
        *armings += command == AXIS_STATE && first == CLOSED_LOOP;
    }
    return fine;
}

static sp_link *new_link(odrive *memory)
{
    const sp_odrive drive = {.m_per_turn = 0.05, .sign = 1.0, .max_torque_nm = 0.5};
    line.used = 0;
    return sp_link_odrive_init(memory, 0, &drive);
}

TEST(a_reset_arms_in_order_whatever_is_refused)
{
    odrive memory;
    for (uint32_t round = 0; round < ROUNDS; round++) {
        sp_link *link = new_link(&memory);
        int armings = 0, resets = 1;
        line.seed = round;
        const uint32_t most = 1 + any(120);
        line.room = any(most);
        link->reset(link, MS);
        for (uint32_t k = 0; k < WRITES; k++) {
            line.room = any(most);
            (void)link->write(link, (2 + k) * MS, 0.001 * k);
            if (k < WRITES / 2 && any(20) == 0) {
                link->reset(link, (2 + k) * MS);
                resets++;
            }
        }
        line.room = 1024;
        (void)link->write(link, (2 + WRITES) * MS, 0.0);
        line.room = 1024;
        CHECK(link->write(link, (2 + WRITES) * MS, 0.0) == 0);
        CHECK(is_in_order(&armings) && armings >= 1 && armings <= resets);
    }
}

TEST(a_drive_that_was_given_up_is_not_armed)
{
    odrive memory;
    for (uint64_t after_ms = 0; after_ms < 2000; after_ms += 50) {
        sp_link *link = new_link(&memory);
        int armings = 0;
        line.room = 0;
        link->reset(link, 5 * MS);
        line.room = 1024;
        CHECK(link->write(link, (5 + after_ms) * MS, 0.0) == 0);
        (void)is_in_order(&armings);
        CHECK(armings == (after_ms <= 1000));
    }
}

TEST(every_error_of_a_heartbeat_trips)
{
    for (uint32_t at = 0; at < BYTES; at++) {
        odrive memory;
        uint8_t data[BYTES] = {[4] = CLOSED_LOOP};
        (void)new_link(&memory);
        handle_frame(&memory, HEARTBEAT, data, BYTES);
        CHECK(memory.link.ready && !memory.tripped);
        data[at] ^= 1u;
        handle_frame(&memory, HEARTBEAT, data, BYTES);
        CHECK(memory.tripped);
    }
}
