/* Link to an ODrive motor controller over CAN. */
#include <math.h>
#include <string.h>

#include "sp_link.h"

/* springpot declarations begin */
/* An ODrive: CAN Simple as struct can_frame through a raw CAN socket, or one like it.
 * position = sign * (turns - zero_turns) * m_per_turn - surface_m. with_torque: the firmware sends
 * 0x1C with torques (0.6); 0.5 has something else there. The two limits are the drive's own. */
typedef struct {
    uint32_t node;
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
/* springpot declarations end */

/* CAN Simple: identifier = node << 5 | command; all little-endian. */
enum {
    HEARTBEAT = 0x01,
    AXIS_STATE = 0x07,
    ENCODER = 0x09,
    CONTROLLER_MODE = 0x0b,
    INPUT_TORQUE = 0x0e,
    LIMITS = 0x0f,
    CLEAR_ERRORS = 0x18,
    TORQUES = 0x1c
};
enum { CLOSED_LOOP = 8, TORQUE_CONTROL = 1, PASSTHROUGH = 1 };
enum { BYTES = 8 };
/* A bus that is flooded does not keep a tick: what is more waits for the next. The system keeps
 * less than so many frames. */
enum { MAX_FRAMES = 512 };
/* struct can_frame of Linux, also where another system's bus comes through a bridge. */
typedef struct {
    uint32_t id; /* and flags above its eleven bits */
    uint8_t size;
    uint8_t padding[3];
    uint8_t data[BYTES];
} can_frame;
_Static_assert(sizeof(can_frame) == 16, "as the kernel and the bridge lay it out");
static const uint32_t standard_id = 0x7ff;
/* What a reset sends, in this order: the limits of the drive before it gives torque. */
static const uint32_t arming[] = {CLEAR_ERRORS, LIMITS, CONTROLLER_MODE, AXIS_STATE};
enum { ARMING_STEPS = sizeof arming / sizeof *arming };
/* For so long after the reset; then the loop has given the drive up. */
static const uint64_t max_arming_ns = 1000000000;
static const double two_pi = 6.283185307179586;
/* Of the greatest torque: the scene's forces are float32, and set up to a millionth. */
static const double rounding = 2e-6;

typedef struct {
    sp_link link;
    sp_odrive drive;
    uint32_t armed; /* of `arming`, how many were sent */
    uint64_t reset_ns;
    int tripped;
    double measured_n;

    /* Of the reading that is under way. */
    uint64_t now_ns;
    sp_motion *motions;
    uint32_t capacity;
    int fresh;
} odrive;

static float read_f32(const uint8_t *bytes)
{
    float value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

static void write_f32(uint8_t *bytes, double value)
{
    const float real = (float)value;
    memcpy(bytes, &real, sizeof real);
}

static void put_u32(uint8_t *bytes, uint32_t value)
{
    memcpy(bytes, &value, sizeof value);
}

/* Take one CAN frame from the drive: a heartbeat tells its health, an encoder frame is a
 * sample, a torque frame what the motor pushes. */
static void handle_frame(odrive *self, uint32_t id, const uint8_t *data, uint32_t size)
{
    const sp_odrive *drive = &self->drive;
    sp_motion *motion;
    int failed;
    if (id >> 5 != drive->node || size < BYTES) {
        return;
    }
    switch (id & 31u) {
    case HEARTBEAT:
        memcpy(&self->link.device_error, data, sizeof self->link.device_error);
        failed = self->link.device_error != 0 || data[4] != CLOSED_LOOP ||
                 (!drive->with_torque && ((data[5] | data[6] | data[7]) & 1));
        self->tripped = self->link.ready && failed;
        self->link.ready = self->link.ready || !failed;
        return;
    case TORQUES:
        if (drive->with_torque) {
            /* at rest the object pushes back what the motor pushes in */
            self->measured_n =
                drive->sign * (double)read_f32(data + 4) * two_pi / drive->m_per_turn;
        }
        return;
    case ENCODER:
        self->link.samples++;
        motion = sp_link_next_slot(self->motions, self->capacity, self->fresh++);
        motion->position_m =
            drive->sign * ((double)read_f32(data) - drive->zero_turns) * drive->m_per_turn -
            drive->surface_m;
        motion->velocity_mps = drive->sign * (double)read_f32(data + 4) * drive->m_per_turn;
        motion->measured_n = self->measured_n;
        motion->arrived_ns = self->now_ns;
        return;
    default:
        return;
    }
}

/* Read all frames that have come. Returns the number of samples, or what ended the loop. */
static int read_odrive(sp_link *link, uint64_t now_ns, sp_motion *motions, uint32_t capacity)
{
    odrive *self = (odrive *)link;
    int count = 1;
    self->now_ns = now_ns;
    self->motions = motions;
    self->capacity = capacity;
    self->fresh = 0;
    for (int k = 0; k < MAX_FRAMES && count > 0; k++) {
        can_frame frame;
        count = sp_link_read_bytes(link->fd, (uint8_t *)&frame, sizeof frame);
        if (count == (int)sizeof frame && frame.id <= standard_id) {
            handle_frame(self, frame.id, frame.data, frame.size);
        }
    }
    return count < 0 ? SP_LINK_GONE : self->tripped ? SP_LINK_TRIPPED : self->fresh;
}

/* Send one CAN frame to the drive. Returns 0, 1 where the system had no room, or that the bus
 * is gone. */
static int send_frame(odrive *self, uint32_t command, const uint8_t *data)
{
    const uint32_t id = self->drive.node << 5 | command;
    can_frame frame = {.id = id, .size = BYTES};
    memcpy(frame.data, data, BYTES);
    const int put = sp_link_write_bytes(self->link.fd, (const uint8_t *)&frame, sizeof frame);
    return put < 0 ? SP_LINK_GONE : put < (int)sizeof frame;
}

/* Send one step of the arming: limits, torque mode, or closed loop. */
static int send_arming(odrive *self, uint32_t command)
{
    uint8_t data[BYTES] = {0};
    if (command == LIMITS) {
        write_f32(data, self->drive.max_turns_per_s);
        write_f32(data + 4, self->drive.max_current_a);
    } else if (command == CONTROLLER_MODE) {
        put_u32(data, TORQUE_CONTROL);
        put_u32(data + 4, PASSTHROUGH);
    } else if (command == AXIS_STATE) {
        put_u32(data, CLOSED_LOOP);
    }
    return send_frame(self, command, data);
}

/* Send the steps of the arming that are left, in order. Returns 0, 1 where there was no room
 * for all, or negative. */
static int go_on_arming(odrive *self, uint64_t now_ns)
{
    int put = 0;
    if (now_ns - self->reset_ns > max_arming_ns) {
        self->armed = ARMING_STEPS;
    }
    while (put == 0 && self->armed < ARMING_STEPS) {
        put = send_arming(self, arming[self->armed]);
        self->armed += put == 0;
    }
    return put;
}

/* Send the force as a motor torque, and what is left of the arming before it. */
static int write_odrive(sp_link *link, uint64_t now_ns, double force_n)
{
    odrive *self = (odrive *)link;
    const sp_odrive *drive = &self->drive;
    uint8_t data[BYTES] = {0};
    const double most_nm = drive->max_torque_nm;
    const double torque_nm = -drive->sign * force_n * drive->m_per_turn / two_pi;
    if (!(fabs(torque_nm) <= most_nm * (1 + rounding))) {
        return SP_LINK_TRIPPED; /* the session was set up wrongly: no force is better than less */
    }
    write_f32(data, fmax(-most_nm, fmin(torque_nm, most_nm)));
    int put = go_on_arming(self, now_ns);
    put = put == 0 ? send_frame(self, INPUT_TORQUE, data) : put;
    link->unsent += put == 1;
    return put;
}

/* Arm the drive again after a trip. */
static void reset_odrive(sp_link *link, uint64_t now_ns)
{
    odrive *self = (odrive *)link;
    self->link.ready = 0;
    self->tripped = 0;
    self->armed = 0;
    self->reset_ns = now_ns;
    (void)go_on_arming(self, now_ns);
}

uint32_t sp_link_odrive_size(void)
{
    return (uint32_t)sizeof(odrive);
}

/* Make the link of an ODrive in the caller's memory. */
sp_link *sp_link_odrive_init(void *memory, int fd, const sp_odrive *drive)
{
    odrive *self = (odrive *)memory;
    *self = (odrive){
        .link = {.fd = fd, .read = read_odrive, .write = write_odrive, .reset = reset_odrive},
        .drive = *drive,
        .armed = ARMING_STEPS,
        .measured_n = (double)NAN};
    return &self->link;
}
