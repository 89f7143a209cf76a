/* Link to a device of ours over a serial port (sp_wire.h). */
#include <math.h>

#include "sp_link.h"
#include "sp_wire.h"

/* springpot declarations begin */
/* springpot serial: position in, force out. surface_m: position of the undeformed
 * surface in the device's own counting. watchdog_s: of the device. */
uint32_t sp_link_serial_size(void);
sp_link *sp_link_serial_init(void *memory, int fd, double surface_m, float watchdog_s,
                             float rate_hz, uint32_t next_sequence);
/* springpot declarations end */

typedef struct {
    sp_link link;
    sp_wire_receiver receiver;
    uint32_t sequence;
    double surface_m;
    sp_wire_command command;   /* under way until its ack */
    uint32_t command_sequence; /* of all its copies: it acts once */
    uint64_t command_ns;
    int tripped;
} serial;

/* A device that floods does not keep a tick: what is more waits for the next. The system keeps
 * less than so many readings. */
enum { CAPACITY = 4096, MAX_READINGS = 16 };
static const uint64_t command_again_ns = 50000000;

/* Send the pending command (again): the device acts once for a sequence number and acknowledges
 * every copy. */
static void send_command(serial *self, uint64_t now_ns)
{
    uint8_t bytes[SP_WIRE_MAX_BYTES];
    uint32_t sequence = self->command_sequence;
    self->command_ns = now_ns;
    const uint32_t count = sp_wire_send_command(&sequence, &self->command, bytes);
    (void)sp_link_write_bytes(self->link.fd, bytes, count);
}

/* Take one frame from the device: the acknowledgement of a command, or a sample, which goes to
 * motions. Returns the number of samples. */
static int take_frame(serial *self, const sp_wire_frame *frame, uint64_t now_ns, sp_motion *motions,
                      uint32_t capacity, int count)
{
    sp_wire_sample sample;
    sp_wire_ack ack;
    if (sp_wire_get_ack(frame, &ack) && !ack.refused && ack.command == self->command_sequence) {
        self->link.ready = 1;
    }
    if (!sp_wire_get_sample(frame, &sample)) {
        return 0;
    }
    sp_motion *motion = sp_link_next_slot(motions, capacity, count);
    self->link.samples++;
    /* Samples from before the ack tell of the trip that the reset takes back. */
    self->tripped = self->link.ready && (sample.status & SP_WIRE_TRIPPED);
    motion->position_m = (double)sample.position_m - self->surface_m;
    motion->velocity_mps = (double)sample.velocity_mps;
    motion->measured_n =
        sample.status & SP_WIRE_LOAD_CELL ? (double)sample.measured_n : (double)NAN;
    motion->arrived_ns = now_ns;
    return 1;
}

/* Read all bytes that have come and decode their frames; repeat a command that was not
 * acknowledged. Returns the number of samples, or what ended the loop. */
static int read_serial(sp_link *link, uint64_t now_ns, sp_motion *motions, uint32_t capacity)
{
    serial *self = (serial *)link;
    uint8_t bytes[CAPACITY];
    int fresh = 0, count = CAPACITY;
    for (int k = 0; k < MAX_READINGS && count == CAPACITY; k++) {
        count = sp_link_read_bytes(link->fd, bytes, sizeof bytes);
        for (int i = 0; i < count; i++) {
            sp_wire_frame frame;
            if (sp_wire_receive(&self->receiver, bytes[i], &frame) == SP_WIRE_NEW) {
                fresh += take_frame(self, &frame, now_ns, motions, capacity, fresh);
            }
        }
    }
    link->crc_errors = self->receiver.crc_errors;
    link->sequence_gaps = self->receiver.gaps;
    if (!link->ready && now_ns - self->command_ns > command_again_ns) {
        send_command(self, now_ns);
    }
    if (count < 0) {
        return SP_LINK_GONE;
    }
    return self->tripped ? SP_LINK_TRIPPED : fresh;
}

/* Send a force. Returns 0, 1 where the system took it in part only, or that the device is gone. */
static int write_serial(sp_link *link, uint64_t now_ns, double force_n)
{
    serial *self = (serial *)link;
    uint8_t bytes[SP_WIRE_MAX_BYTES];
    const sp_wire_force force = {(float)force_n};
    (void)now_ns;
    const uint32_t count = sp_wire_send_force(&self->sequence, &force, bytes);
    const int put = sp_link_write_bytes(link->fd, bytes, count);
    if (put < 0) {
        return SP_LINK_GONE;
    }
    link->unsent += put < (int)count;
    return put < (int)count;
}

/* Ask the device to leave its trip. */
static void reset_serial(sp_link *link, uint64_t now_ns)
{
    serial *self = (serial *)link;
    self->command.action = SP_WIRE_RESET;
    self->command_sequence = self->sequence++;
    self->tripped = 0;
    link->ready = 0;
    send_command(self, now_ns);
}

uint32_t sp_link_serial_size(void)
{
    return (uint32_t)sizeof(serial);
}

/* Make the link of a serial device in the caller's memory. */
sp_link *sp_link_serial_init(void *memory, int fd, double surface_m, float watchdog_s,
                             float rate_hz, uint32_t next_sequence)
{
    serial *self = (serial *)memory;
    *self = (serial){.link = {.fd = fd,
                              .ready = 1,
                              .read = read_serial,
                              .write = write_serial,
                              .reset = reset_serial},
                     .sequence = next_sequence,
                     .surface_m = surface_m,
                     .command = {.watchdog_s = watchdog_s, .rate_hz = rate_hz}};
    sp_wire_restart(&self->receiver);
    return &self->link;
}
