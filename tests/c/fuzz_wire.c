/* Frames of known content through a noisy line, read back: usage: fuzz_wire COUNT SEED.
 *
 * Each FORCE carries a force that is a function of its sequence number. Some are flipped, cut,
 * doubled, swapped with the next, or followed by garbage. No wrong value may be taken, and
 * the next good frame comes through, whatever was before it. Prints the counts as JSON. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../runtime_c/port/wire/sp_wire.c"

static uint64_t noise;

static uint32_t draw(uint32_t below)
{
    noise = noise * 6364136223846793005ull + 1442695040888963407ull;
    return (uint32_t)((noise >> 33) % below);
}

static float value_of(uint32_t sequence)
{
    return (float)((sequence * 2654435761u) >> 8) * 1e-6f;
}

typedef struct {
    sp_wire_receiver receiver;
    unsigned long wrong, accepted, old;
    int last; /* whether the last good frame came through */
    uint32_t last_sequence;
} end;

static void feed(end *to, const uint8_t *bytes, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        sp_wire_frame frame;
        sp_wire_force force;
        const int kind = sp_wire_receive(&to->receiver, bytes[i], &frame);
        if (kind == SP_WIRE_NONE) {
            continue;
        }
        if (!sp_wire_get_force(&frame, &force) || force.force_n != value_of(frame.sequence)) {
            to->wrong++;
            continue;
        }
        to->accepted += kind == SP_WIRE_NEW;
        to->old += kind == SP_WIRE_OLD;
        to->last = 1;
        to->last_sequence = frame.sequence;
    }
}

static uint32_t next(uint32_t *sequence, uint8_t *bytes)
{
    const sp_wire_force force = {value_of(*sequence)};
    return sp_wire_send_force(sequence, &force, bytes);
}

static void damaged(end *to, uint32_t *sequence)
{
    uint8_t bytes[2 * SP_WIRE_MAX_BYTES + 300], other[SP_WIRE_MAX_BYTES];
    uint32_t count = next(sequence, bytes), more;
    switch (draw(6)) {
    case 0: /* flipped bits */
        for (uint32_t flips = 1 + draw(4); flips > 0; flips--) {
            bytes[draw(count)] ^= (uint8_t)(1u << draw(8));
        }
        break;
    case 1: /* cut at the end */
        count = draw(count);
        break;
    case 2: /* cut in the middle */
        more = 1 + draw(count - 1);
        memmove(bytes + more - 1, bytes + more, count - more);
        count--;
        break;
    case 3: /* doubled */
        memcpy(bytes + count, bytes, count);
        count *= 2;
        break;
    case 4: /* garbage */
        for (count = draw(300), more = 0; more < count; more++) {
            bytes[more] = (uint8_t)draw(256);
        }
        break;
    default: /* reordered */
        more = next(sequence, other);
        feed(to, other, more);
        break;
    }
    feed(to, bytes, count);
}

int main(int argc, char **argv)
{
    const unsigned long count = argc > 1 ? strtoul(argv[1], NULL, 10) : 1000;
    unsigned long not_back = 0;
    static end to;
    uint32_t sequence = 0;
    uint8_t bytes[SP_WIRE_MAX_BYTES];
    noise = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    if (sp_wire_crc32c((const uint8_t *)"123456789", 9) != 0xe3069283u) {
        printf("CRC-32C is wrong\n");
        return 1;
    }
    for (unsigned long i = 0; i < count; i++) {
        damaged(&to, &sequence);
        const uint32_t sent = sequence;
        to.last = 0;
        feed(&to, bytes, next(&sequence, bytes));
        not_back += !(to.last && to.last_sequence == sent);
    }
    printf("{\"damaged\": %lu, \"wrong\": %lu, \"not_resynchronised\": %lu, "
           "\"accepted\": %lu, \"old\": %lu, \"crc_errors\": %lu, \"gaps\": %lu}\n",
           count, to.wrong, not_back, to.accepted, to.old, (unsigned long)to.receiver.crc_errors,
           (unsigned long)to.receiver.gaps);
    return to.wrong || not_back ? 1 : 0;
}
