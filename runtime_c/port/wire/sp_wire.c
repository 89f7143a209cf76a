/* Frames: CRC-32C, COBS, sequence numbers, and packing from the table of messages. */
#include "sp_wire.h"

/* CRC-32C (Castagnoli), reflected, a nibble at a time: 64 bytes of table. */
static const uint32_t crc_nibbles[16] = {0x00000000u, 0x105ec76fu, 0x20bd8edeu, 0x30e349b1u,
                                         0x417b1dbcu, 0x5125dad3u, 0x61c69362u, 0x7198540du,
                                         0x82f63b78u, 0x92a8fc17u, 0xa24bb5a6u, 0xb21572c9u,
                                         0xc38d26c4u, 0xd3d3e1abu, 0xe330a81au, 0xf36e6f75u};

/* CRC-32C (Castagnoli) of size bytes, four bits a step. */
uint32_t sp_wire_crc32c(const uint8_t *bytes, uint32_t size)
{
    uint32_t crc = 0xffffffffu;
    for (uint32_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        crc = (crc >> 4) ^ crc_nibbles[crc & 15u];
        crc = (crc >> 4) ^ crc_nibbles[crc & 15u];
    }
    return ~crc;
}

#define TEXT_FIELD(type, name) #type " " #name ";"
#define TEXT_MESSAGE(number, NAME, name) #number " " #name ":" SP_WIRE_##NAME(TEXT_FIELD)

uint32_t sp_wire_layout(void)
{
    static const char text[] = SP_WIRE_TABLE(TEXT_MESSAGE);
    return sp_wire_crc32c((const uint8_t *)text, sizeof text - 1);
}

static uint8_t *put_u8(uint8_t *at, uint8_t value)
{
    *at = value;
    return at + 1;
}

static const uint8_t *get_u8(const uint8_t *at, uint8_t *value)
{
    *value = *at;
    return at + 1;
}

static uint8_t *put_u32(uint8_t *at, uint32_t value)
{
    for (uint32_t i = 0; i < 4; i++) {
        at[i] = (uint8_t)(value >> (8 * i));
    }
    return at + 4;
}

static const uint8_t *get_u32(const uint8_t *at, uint32_t *value)
{
    *value = at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
    return at + 4;
}

typedef union {
    float real;
    uint32_t bits;
} pattern;

static uint8_t *put_f32(uint8_t *at, float value)
{
    const pattern p = {.real = value};
    return put_u32(at, p.bits);
}

static const uint8_t *get_f32(const uint8_t *at, float *value)
{
    pattern p;
    at = get_u32(at, &p.bits);
    *value = p.real;
    return at;
}

/* Encode a frame as bytes for the line: head, body, CRC, in COBS, so that a 0 ends a frame and
 * nothing else. Returns their number. */
uint32_t sp_wire_encode(const sp_wire_frame *frame, uint8_t *bytes)
{
    uint8_t plain[SP_WIRE_MAX_PLAIN];
    uint8_t *at = put_u32(put_u8(put_u8(plain, frame->type), frame->version), frame->sequence);
    for (uint32_t i = 0; i < frame->size; i++) {
        *at++ = frame->body[i];
    }
    const uint32_t covered = (uint32_t)(at - plain);
    (void)put_u32(at, sp_wire_crc32c(plain, covered));
    /* COBS: each 0 becomes the distance to the next; frames are shorter than its blocks of 254. */
    uint32_t code = 1, used = 2;
    bytes[0] = 0;
    for (uint32_t i = 0; i < covered + SP_WIRE_CRC; i++) {
        if (plain[i] == 0) {
            bytes[code] = (uint8_t)(used - code);
            code = used;
        } else {
            bytes[used] = plain[i];
        }
        used++;
    }
    bytes[code] = (uint8_t)(used - code);
    bytes[used] = 0;
    return used + 1;
}

/* Undo COBS (Cheshire, Baker 1997) in place; returns the size, 0 where the bytes are no such
 * block. */
static uint32_t cobs_decode(uint8_t *bytes, uint32_t size)
{
    uint32_t next = 0;
    for (uint32_t i = 0; i < size; i++) {
        if (i == next) {
            next = i + bytes[i];
            if (i > 0) {
                bytes[i - 1] = 0;
            }
        } else {
            bytes[i - 1] = bytes[i];
        }
    }
    return next == size && size > 0 ? size - 1 : 0;
}

enum { SEQUENCE_WINDOW = 32 }; /* the newest of which it is known whether they came */

/* Whether a frame is new, by its sequence number; counts missing ones, and takes a late one off
 * that count. */
static int classify_sequence(sp_wire_receiver *receiver, const sp_wire_frame *frame)
{
    const uint32_t sequence = frame->sequence;
    const uint32_t ahead = sequence - receiver->newest;
    const uint32_t behind = receiver->newest - sequence;
    const int is_hello = frame->type == SP_WIRE_TYPE_HELLO && behind >= SEQUENCE_WINDOW;
    if (receiver->seen == 0 || (is_hello && ahead >= 0x80000000u)) {
        receiver->seen = 0xffffffffu; /* nothing before the first frame of a start is missing */
    } else if (ahead != 0 && ahead < 0x80000000u) {
        receiver->gaps += ahead - 1;
        receiver->seen = ahead < SEQUENCE_WINDOW ? receiver->seen << ahead | 1u : 1u;
    } else {
        if (behind > 0 && behind < SEQUENCE_WINDOW && !(receiver->seen >> behind & 1u)) {
            receiver->seen |= 1u << behind;
            receiver->gaps--; /* it was late, not missing */
        }
        return SP_WIRE_OLD;
    }
    receiver->newest = sequence;
    return SP_WIRE_NEW;
}

/* Decode the bytes of one frame; returns whether size and CRC are right. */
static int decode_frame(sp_wire_receiver *receiver, sp_wire_frame *frame)
{
    uint8_t *plain = receiver->bytes;
    const uint32_t size = cobs_decode(plain, receiver->used);
    uint32_t crc;
    if (size < SP_WIRE_HEAD + SP_WIRE_CRC) {
        return 0;
    }
    const uint32_t covered = size - SP_WIRE_CRC;
    (void)get_u32(plain + covered, &crc);
    if (covered > SP_WIRE_HEAD + SP_WIRE_MAX_BODY || crc != sp_wire_crc32c(plain, covered)) {
        return 0;
    }
    const uint8_t *at = get_u8(get_u8(plain, &frame->type), &frame->version);
    at = get_u32(at, &frame->sequence);
    frame->size = covered - SP_WIRE_HEAD;
    //@ split frame->size;
    for (uint32_t i = 0; i < frame->size; i++) {
        frame->body[i] = at[i];
    }
    return 1;
}

/* Take one byte from the line. Returns SP_WIRE_NEW or SP_WIRE_OLD, and the frame, where it ends a
 * good one; else SP_WIRE_NONE. */
int sp_wire_receive(sp_wire_receiver *receiver, uint8_t byte, sp_wire_frame *frame)
{
    if (byte != 0) {
        if (receiver->used == SP_WIRE_MAX_BYTES - 1) {
            receiver->overlong = 1;
        } else {
            receiver->bytes[receiver->used++] = byte;
        }
        return SP_WIRE_NONE;
    }
    const int empty = receiver->used == 0;
    const int good = !receiver->overlong && !empty && decode_frame(receiver, frame);
    receiver->used = 0;
    receiver->overlong = 0;
    if (!good) {
        receiver->crc_errors += empty || receiver->joining ? 0 : 1;
        receiver->joining = 0;
        return SP_WIRE_NONE;
    }
    receiver->joining = 0;
    if (frame->version != SP_WIRE_VERSION) {
        receiver->other_versions++;
        receiver->other_version = frame->version;
        return SP_WIRE_NONE;
    }
    receiver->frames++;
    return classify_sequence(receiver, frame);
}

void sp_wire_restart(sp_wire_receiver *receiver)
{
    receiver->used = 0;
    receiver->overlong = 0;
    receiver->seen = 0;
    receiver->joining = 1;
}

#define PUT(type, name) at = put_##type(at, message->name);
#define GET(type, name) at = get_##type(at, &message->name);
#define DEFINE(number, NAME, name)                                                                 \
    uint32_t sp_wire_send_##name(uint32_t *sequence, const sp_wire_##name *message,                \
                                 uint8_t *bytes)                                                   \
    {                                                                                              \
        sp_wire_frame frame;                                                                       \
        frame.type = SP_WIRE_TYPE_##NAME;                                                          \
        frame.version = SP_WIRE_VERSION;                                                           \
        frame.sequence = (*sequence)++;                                                            \
        frame.size = SP_WIRE_BODY_##NAME;                                                          \
        uint8_t *at = frame.body;                                                                  \
        SP_WIRE_##NAME(PUT)(void) at;                                                              \
        return sp_wire_encode(&frame, bytes);                                                      \
    }                                                                                              \
    int sp_wire_get_##name(const sp_wire_frame *frame, sp_wire_##name *message)                    \
    {                                                                                              \
        const uint8_t *at = frame->body;                                                           \
        if (frame->type != SP_WIRE_TYPE_##NAME || frame->size != SP_WIRE_BODY_##NAME) {            \
            return 0;                                                                              \
        }                                                                                          \
        SP_WIRE_##NAME(GET)(void) at;                                                              \
        return 1;                                                                                  \
    }
SP_WIRE_TABLE(DEFINE)
