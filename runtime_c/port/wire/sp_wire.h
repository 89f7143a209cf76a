/* springpot serial, one end of it: frames to bytes and back. Freestanding: no heap, no libc, no
 * floating-point arithmetic; the same file serves a microcontroller and a PC.
 *
 * Sending:    n = sp_wire_send_force(&sequence, &force, bytes);      write n bytes
 * Receiving:  if (sp_wire_receive(&receiver, byte, &frame) == SP_WIRE_NEW)
 *                 sp_wire_get_force(&frame, &force);
 * A setpoint that comes again or late is SP_WIRE_OLD: it is not obeyed. Commands and ASK are.
 *
 * A frame is handed on only where length, version and CRC-32C are right; after damage the next 0
 * byte starts a new one.
 */
#ifndef SP_WIRE_H
#define SP_WIRE_H

#include <stdint.h>

#include "sp_wire_messages.h"

enum {
    SP_WIRE_HEAD = 6,
    SP_WIRE_CRC = 4,
    SP_WIRE_MAX_BODY = 48,
    SP_WIRE_MAX_PLAIN = SP_WIRE_HEAD + SP_WIRE_MAX_BODY + SP_WIRE_CRC,
    SP_WIRE_MAX_BYTES = SP_WIRE_MAX_PLAIN + 3 /* COBS and two 0 bytes */
};

/* A struct for each message (sp_wire_force, ...), its type number and the size of its body. */
#define SP_WIRE_C_u8 uint8_t
#define SP_WIRE_C_u32 uint32_t
#define SP_WIRE_C_f32 float
#define SP_WIRE_SIZE_u8 1
#define SP_WIRE_SIZE_u32 4
#define SP_WIRE_SIZE_f32 4

#define SP_WIRE_MEMBER(type, name) SP_WIRE_C_##type name;
#define SP_WIRE_ADD(type, name) +SP_WIRE_SIZE_##type
#define SP_WIRE_STRUCT(number, NAME, name)                                                         \
    typedef struct {                                                                               \
        SP_WIRE_##NAME(SP_WIRE_MEMBER)                                                             \
    } sp_wire_##name;                                                                              \
    enum { SP_WIRE_TYPE_##NAME = number, SP_WIRE_BODY_##NAME = 0 SP_WIRE_##NAME(SP_WIRE_ADD) };
SP_WIRE_TABLE(SP_WIRE_STRUCT)

typedef struct {
    uint8_t type;
    uint8_t version;
    uint32_t sequence;
    uint32_t size; /* of the body */
    uint8_t body[SP_WIRE_MAX_BODY];
} sp_wire_frame;

/* Zeroed is a good start. Counters wrap. */
typedef struct {
    uint8_t bytes[SP_WIRE_MAX_BYTES];
    uint32_t used;
    uint32_t overlong;
    uint32_t joining; /* after a restart: the first bytes may be the end of a frame */
    uint32_t newest;  /* sequence */
    uint32_t seen;    /* bit k: newest - k has come */
    uint32_t frames;
    uint32_t crc_errors;     /* bytes between two 0 bytes that are no frame */
    uint32_t gaps;           /* sequence numbers that never came */
    uint32_t other_versions; /* whole frames of another protocol version, not handed on */
    uint8_t other_version;   /* of the last of them */
} sp_wire_receiver;

/* What a frame is among those before it: newest wins, an old or repeated one is no setpoint. */
enum { SP_WIRE_NONE = 0, SP_WIRE_NEW = 1, SP_WIRE_OLD = 2 };

uint32_t sp_wire_crc32c(const uint8_t *bytes, uint32_t size);

/* Checksum of the table of messages: equal at two ends that understand each other. */
uint32_t sp_wire_layout(void);

/* Take one byte; SP_WIRE_NEW or SP_WIRE_OLD when it completes a good frame. */
int sp_wire_receive(sp_wire_receiver *receiver, uint8_t byte, sp_wire_frame *frame);

/* Forget the sequence, not the counters: the other end has started again. */
void sp_wire_restart(sp_wire_receiver *receiver);

/* Bytes of one frame, between two 0 bytes: the first parts it from whatever damage came before.
 * `bytes` has room for SP_WIRE_MAX_BYTES. */
uint32_t sp_wire_encode(const sp_wire_frame *frame, uint8_t *bytes);

/* For each message: encode with the next sequence number, returns the count of bytes; and unpack a
 * frame, returns 0 where it is of another type or size. */
#define SP_WIRE_DECLARE(number, NAME, name)                                                        \
    uint32_t sp_wire_send_##name(uint32_t *sequence, const sp_wire_##name *message,                \
                                 uint8_t *bytes);                                                  \
    int sp_wire_get_##name(const sp_wire_frame *frame, sp_wire_##name *message);
SP_WIRE_TABLE(SP_WIRE_DECLARE)

#endif
