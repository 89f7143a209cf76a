/* libFuzzer's target of all that reads bytes from a device: the first byte says which reader.
 *
 * clang -fsanitize=fuzzer,address,undefined; fuzz.py builds and runs it. Any bytes: no invalid
 * access, no undefined behaviour, no frame that is longer than its body, and each frame that is
 * taken is what it would be encoded to. */
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "declared_links.h" /* made by targets.py */
#include "sp_wire.h"

enum { RAW, SEALED, SERIAL, CAN, KINDS, CAPACITY = 8 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(int fits)
{
    if (!fits) {
        abort();
    }
}

/* What was taken has every field of its type, and says the same when it is sent again. */
static void check(const sp_wire_frame *frame)
{
    uint8_t bytes[SP_WIRE_MAX_BYTES];
    uint32_t sequence = frame->sequence - 1;
    require(frame->size <= SP_WIRE_MAX_BODY);
#define CHECK(number, NAME, name)                                                                  \
    {                                                                                              \
        sp_wire_##name message;                                                                    \
        if (sp_wire_get_##name(frame, &message)) {                                                 \
            sp_wire_frame again = {0};                                                             \
            sp_wire_receiver receiver = {0};                                                       \
            const uint32_t count = sp_wire_send_##name(&sequence, &message, bytes);                \
            int kind = SP_WIRE_NONE;                                                               \
            require(count <= SP_WIRE_MAX_BYTES);                                                   \
            for (uint32_t i = 0; i < count; i++) {                                                 \
                kind = sp_wire_receive(&receiver, bytes[i], &again);                               \
            }                                                                                      \
            require(kind == SP_WIRE_NEW && again.size == frame->size);                             \
            require(memcmp(again.body, frame->body, frame->size) == 0);                            \
        }                                                                                          \
    }
    SP_WIRE_TABLE(CHECK)
}

static void receive(sp_wire_receiver *receiver, const uint8_t *bytes, size_t count)
{
    sp_wire_frame frame;
    for (size_t i = 0; i < count; i++) {
        if (sp_wire_receive(receiver, bytes[i], &frame) != SP_WIRE_NONE) {
            check(&frame);
        }
    }
}

/* Frames with the right checksum, so that what lies behind it is reached: type, version, sequence,
 * size, body. */
static void sealed(sp_wire_receiver *receiver, const uint8_t *data, size_t size)
{
    uint8_t bytes[SP_WIRE_MAX_BYTES];
    while (size >= 4) {
        sp_wire_frame frame = {.type = data[0], .version = data[1], .sequence = data[2]};
        frame.size = data[3] % (SP_WIRE_MAX_BODY + 1u);
        data += 4;
        size -= 4;
        frame.size = frame.size <= size ? frame.size : (uint32_t)size;
        memcpy(frame.body, data, frame.size);
        data += frame.size;
        size -= frame.size;
        receive(receiver, bytes, sp_wire_encode(&frame, bytes));
    }
}

/* A link whose device sends these bytes, and then nothing. */
static void through_link(int kind, const uint8_t *data, size_t size)
{
    static const sp_odrive drive = {
        .m_per_turn = 0.1, .sign = 1.0, .with_torque = 1, .max_torque_nm = 1.0, .node = 1};
    sp_motion motions[CAPACITY];
    int ends[2];
    const uint32_t bytes = kind == SERIAL ? sp_link_serial_size() : sp_link_odrive_size();
    void *memory = calloc(1, bytes);
    require(memory != NULL && socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends) == 0);
    sp_link *link = kind == SERIAL ? sp_link_serial_init(memory, ends[0], 0.0, 0.1f, 1000.0f, 1)
                                   : sp_link_odrive_init(memory, ends[0], &drive);
    link->reset(link, 0);
    for (uint64_t now_ns = 1; size > 0; now_ns += 1000000) {
        const size_t part = size < 97 ? size : 97; /* as bytes come: not whole frames at a time */
        require(write(ends[1], data, part) == (ssize_t)part);
        data += part;
        size -= part;
        (void)link->read(link, now_ns, motions, CAPACITY);
        (void)link->write(link, now_ns, 1.0);
    }
    (void)close(ends[0]);
    (void)close(ends[1]);
    free(memory);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const sp_wire_receiver fresh;
    sp_wire_receiver receiver = fresh;
    if (size == 0) {
        return 0;
    }
    const int kind = data[0] % KINDS;
    if (kind == RAW) {
        receive(&receiver, data + 1, size - 1);
    } else if (kind == SEALED) {
        sealed(&receiver, data + 1, size - 1);
    } else {
        through_link(kind, data + 1, size - 1);
    }
    return 0;
}
