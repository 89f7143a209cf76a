/* One end of springpot serial against frames that are made and read here, bit by bit. */
#include <string.h>

#include "check.h"

#include "../../runtime_c/port/wire/sp_wire.c"

enum { ROOM = 300 };

/* CRC-32C as its definition has it, a bit at a time. */
static uint32_t checksum(const uint8_t *bytes, uint32_t size)
{
    uint32_t crc = 0xffffffffu;
    for (uint32_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = crc & 1u ? crc >> 1 ^ 0x82f63b78u : crc >> 1;
        }
    }
    return crc ^ 0xffffffffu;
}

/* Bytes on the line for what a frame holds, checksum left out: how many. */
static uint32_t on_line(const uint8_t *plain, uint32_t size, uint8_t *line)
{
    uint8_t all[ROOM];
    memcpy(all, plain, size);
    const uint32_t crc = checksum(plain, size);
    for (uint32_t i = 0; i < 4; i++) {
        all[size + i] = (uint8_t)(crc >> 8 * i);
    }
    uint32_t used = 0;
    line[used++] = 0;
    for (uint32_t from = 0; from <= size + 4; from++) {
        uint32_t run = 0;
        while (from + run < size + 4 && all[from + run] != 0) {
            run++;
        }
        line[used++] = (uint8_t)(run + 1);
        memcpy(line + used, all + from, run);
        used += run;
        from += run;
    }
    line[used++] = 0;
    return used;
}

static uint32_t head(uint8_t *plain, uint8_t type, uint8_t version, uint32_t sequence)
{
    plain[0] = type;
    plain[1] = version;
    for (uint32_t i = 0; i < 4; i++) {
        plain[2 + i] = (uint8_t)(sequence >> 8 * i);
    }
    return 6;
}

/* The last answer of the receiver to so many bytes. */
static int given(sp_wire_receiver *receiver, const uint8_t *line, uint32_t size,
                 sp_wire_frame *frame)
{
    int last = -1;
    for (uint32_t i = 0; i < size; i++) {
        CHECK(last <= SP_WIRE_NONE); /* a frame is decode_frame at its last byte only */
        last = sp_wire_receive(receiver, line[i], frame);
    }
    return last;
}

static int arrives(sp_wire_receiver *receiver, uint8_t type, uint32_t sequence)
{
    uint8_t plain[ROOM], line[ROOM];
    sp_wire_frame frame;
    const uint32_t size = head(plain, type, SP_WIRE_VERSION, sequence);
    return given(receiver, line, on_line(plain, size, line), &frame);
}

TEST(checksums_are_those_of_the_definition)
{
    uint8_t bytes[256];
    for (uint32_t i = 0; i < 256; i++) {
        bytes[i] = (uint8_t)i;
        CHECK(sp_wire_crc32c(bytes + i, 1) == checksum(bytes + i, 1));
        CHECK(sp_wire_crc32c(bytes, i) == checksum(bytes, i));
    }
    static const char check[] = "123456789";
    CHECK(sp_wire_crc32c((const uint8_t *)check, 9) == 0xe3069283u);
}

/* What the layout's checksum covers: the end of the table and no byte after it. */
TEST(the_layout_covers_the_table_to_its_last_field)
{
    static const char text[] = SP_WIRE_TABLE(TEXT_MESSAGE);
    CHECK(strcmp(text + strlen(text) - 12, "f32 force_n;") == 0);
    CHECK(sp_wire_layout() == checksum((const uint8_t *)text, (uint32_t)strlen(text)));
}

/* Of every length, with zero bytes at either end and in a row. */
TEST(frames_are_the_bytes_of_the_protocol_and_come_back)
{
    for (uint32_t size = 0; size <= SP_WIRE_MAX_BODY; size++) {
        for (uint32_t zeros = 0; zeros < 4; zeros++) {
            sp_wire_frame sent = {.type = zeros % 2 ? SP_WIRE_TYPE_FORCE : 0};
            sent.version = SP_WIRE_VERSION;
            sent.sequence = 0x01020304u << zeros;
            sent.size = size;
            uint8_t plain[ROOM], line[ROOM], expected[ROOM];
            (void)head(plain, sent.type, sent.version, sent.sequence);
            for (uint32_t i = 0; i < size; i++) {
                sent.body[i] = i % 4 < zeros ? 0 : (uint8_t)(i + 100);
                plain[6 + i] = sent.body[i];
            }
            memset(line, 0xaa, sizeof line);
            const uint32_t count = sp_wire_encode(&sent, line);
            CHECK(count == on_line(plain, 6 + size, expected));
            CHECK(memcmp(line, expected, count) == 0);

            sp_wire_receiver receiver = {0};
            sp_wire_frame frame;
            memset(&frame, 0xaa, sizeof frame);
            CHECK(given(&receiver, line, count, &frame) == SP_WIRE_NEW);
            CHECK(frame.type == sent.type && frame.version == sent.version);
            CHECK(frame.sequence == sent.sequence && frame.size == size);
            CHECK(memcmp(frame.body, sent.body, size) == 0);
            CHECK(size == SP_WIRE_MAX_BODY || frame.body[size] == 0xaa);
            CHECK(receiver.frames == 1 && receiver.crc_errors == 0 && receiver.gaps == 0);
        }
    }
}

/* Not a byte after them: the next field, or another's memory. */
TEST(fields_are_as_long_as_they_are)
{
    uint8_t bytes[8];
    memset(bytes, 0xaa, sizeof bytes);
    CHECK(put_u32(bytes, 0x04030201u) == bytes + 4 && bytes[3] == 4 && bytes[4] == 0xaa);
}

TEST(what_is_no_cobs_is_of_no_length)
{
    uint8_t too_far[] = {5, 1, 2}, ends_early[] = {2, 1, 2}, good[] = {3, 1, 2};
    CHECK(cobs_decode(too_far, 3) == 0 && cobs_decode(ends_early, 3) == 0 &&
          cobs_decode(good, 0) == 0);
    CHECK(cobs_decode(good, 3) == 2 && good[0] == 1 && good[1] == 2);
}

TEST(no_more_is_kept_than_the_longest_frame)
{
    sp_wire_receiver receiver = {0};
    sp_wire_frame frame;
    for (uint32_t i = 1; i < 1000; i++) {
        CHECK(sp_wire_receive(&receiver, 7, &frame) == SP_WIRE_NONE);
        CHECK(receiver.used == (i < SP_WIRE_MAX_BYTES ? i : SP_WIRE_MAX_BYTES - 1));
        CHECK(receiver.overlong == (i >= SP_WIRE_MAX_BYTES));
    }
    CHECK(sp_wire_receive(&receiver, 0, &frame) == SP_WIRE_NONE && receiver.crc_errors == 1);
    CHECK(receiver.used == 0 && receiver.overlong == 0);
}

TEST(every_message_comes_back_as_it_was_sent)
{
    uint32_t sequence = 7;
    uint8_t line[SP_WIRE_MAX_BYTES];
    sp_wire_receiver receiver = {0};
    sp_wire_frame frame;
    const sp_wire_hello hello = {.layout = 0x80f0e0d1u, .rate_hz = 1000.5f, .max_n = -3.25f};
    sp_wire_hello heard;
    memset(&heard, 0, sizeof heard);
    uint32_t count = sp_wire_send_hello(&sequence, &hello, line);
    CHECK(sequence == 8 && given(&receiver, line, count, &frame) == SP_WIRE_NEW);
    CHECK(frame.sequence == 7 && frame.size == SP_WIRE_BODY_HELLO);
    CHECK(sp_wire_get_hello(&frame, &heard) == 1);
    CHECK(heard.layout == hello.layout);
    CHECK(heard.rate_hz == hello.rate_hz && heard.max_n == hello.max_n);

    const sp_wire_sample sample = {3, 0.5f, -0.25f, 7.5f};
    sp_wire_sample felt = {0};
    count = sp_wire_send_sample(&sequence, &sample, line);
    CHECK(sequence == 9 && given(&receiver, line, count, &frame) == SP_WIRE_NEW);
    CHECK(sp_wire_get_sample(&frame, &felt) == 1);
    CHECK(felt.status == 3 && felt.position_m == 0.5f && felt.velocity_mps == -0.25f);
    CHECK(felt.measured_n == 7.5f);
    CHECK(receiver.gaps == 0);

    sp_wire_force force = {2.0f};
    CHECK(sp_wire_get_hello(&frame, &heard) == 0 && sp_wire_get_force(&frame, &force) == 0);
    frame.type = SP_WIRE_TYPE_FORCE; /* of another size */
    CHECK(sp_wire_get_force(&frame, &force) == 0);
    frame.type = SP_WIRE_TYPE_ASK; /* of the same size, but another one */
    frame.size = SP_WIRE_BODY_FORCE;
    CHECK(sp_wire_get_force(&frame, &force) == 0 && force.force_n == 2.0f);
}

/* A right checksum does not make a frame of what is too short or too long for one. */
TEST(only_lengths_that_a_frame_can_have_are_taken)
{
    for (uint32_t size = 0; size < 200; size++) {
        sp_wire_receiver receiver = {0};
        sp_wire_frame frame;
        uint8_t plain[ROOM], line[ROOM];
        for (uint32_t i = 0; i < size; i++) {
            plain[i] = (uint8_t)(i + 1);
        }
        plain[1] = SP_WIRE_VERSION;
        const int possible = size >= SP_WIRE_HEAD && size <= SP_WIRE_HEAD + SP_WIRE_MAX_BODY;
        const int kind = given(&receiver, line, on_line(plain, size, line), &frame);
        CHECK(kind == (possible ? SP_WIRE_NEW : SP_WIRE_NONE));
        CHECK(receiver.crc_errors == (possible ? 0 : 1));
        CHECK(arrives(&receiver, 6, 0x06050403u + 1) == SP_WIRE_NEW);
        CHECK(receiver.crc_errors == (possible ? 0 : 1));
    }
}

/* Each bit of a frame; a 0 byte that is gone, or one too many. */
TEST(damage_is_counted_and_never_a_frame)
{
    uint8_t plain[ROOM], line[ROOM];
    sp_wire_frame frame;
    const uint32_t size = on_line(plain, head(plain, 6, SP_WIRE_VERSION, 0x00110022u), line);
    for (uint32_t bit = 8; bit < 8 * (size - 1); bit++) {
        sp_wire_receiver receiver = {0};
        line[bit / 8] ^= (uint8_t)(1u << bit % 8);
        CHECK(given(&receiver, line, size, &frame) == SP_WIRE_NONE);
        CHECK(receiver.frames == 0 && receiver.crc_errors >= 1 && receiver.crc_errors <= 2);
        line[bit / 8] ^= (uint8_t)(1u << bit % 8);
        CHECK(given(&receiver, line, size, &frame) == SP_WIRE_NEW);
    }
    sp_wire_receiver receiver = {0};
    CHECK(given(&receiver, line, size - 1, &frame) == SP_WIRE_NONE);
    CHECK(given(&receiver, line, 1, &frame) == SP_WIRE_NEW); /* the next one's first 0 ends it */
    CHECK(given(&receiver, line + 1, size - 1, &frame) == SP_WIRE_OLD);
    CHECK(receiver.frames == 2 && receiver.crc_errors == 0);
    const uint8_t zeros[5] = {0};
    CHECK(given(&receiver, zeros, 5, &frame) == SP_WIRE_NONE && receiver.crc_errors == 0);
    const uint8_t lost[] = {3, 1, 0};
    CHECK(given(&receiver, lost, 3, &frame) == SP_WIRE_NONE && receiver.crc_errors == 1);
    CHECK(given(&receiver, lost, 3, &frame) == SP_WIRE_NONE && receiver.crc_errors == 2);
}

TEST(another_version_is_counted_and_not_handed_on)
{
    sp_wire_receiver receiver = {0};
    uint8_t plain[ROOM], line[ROOM];
    sp_wire_frame frame;
    for (uint32_t i = 1; i <= 2; i++) {
        const uint8_t version = (uint8_t)(SP_WIRE_VERSION + i);
        const uint32_t size = on_line(plain, head(plain, 6, version, i), line);
        CHECK(given(&receiver, line, size, &frame) == SP_WIRE_NONE);
        CHECK(receiver.other_versions == i && receiver.other_version == version);
    }
    CHECK(receiver.frames == 0 && receiver.crc_errors == 0 && receiver.seen == 0);
}

TEST(the_newest_wins_and_what_is_missing_is_counted)
{
    sp_wire_receiver receiver = {0};
    const struct {
        uint32_t sequence;
        int kind;
        uint32_t gaps;
    } cases[] = {{100, SP_WIRE_NEW, 0},  {101, SP_WIRE_NEW, 0},  {105, SP_WIRE_NEW, 3},
                 {103, SP_WIRE_OLD, 2},  {103, SP_WIRE_OLD, 2},  {102, SP_WIRE_OLD, 1},
                 {104, SP_WIRE_OLD, 0},  {101, SP_WIRE_OLD, 0},  {105, SP_WIRE_OLD, 0},
                 {100, SP_WIRE_OLD, 0},  {99, SP_WIRE_OLD, 0},   {137, SP_WIRE_NEW, 31},
                 {106, SP_WIRE_OLD, 30}, {105, SP_WIRE_OLD, 30}, {104, SP_WIRE_OLD, 30},
                 {168, SP_WIRE_NEW, 60}, {137, SP_WIRE_OLD, 60}, {138, SP_WIRE_OLD, 59},
                 {136, SP_WIRE_OLD, 59}, {167, SP_WIRE_OLD, 58}, {169, SP_WIRE_NEW, 58}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CHECK(arrives(&receiver, SP_WIRE_TYPE_FORCE, cases[i].sequence) == cases[i].kind);
        CHECK(receiver.gaps == cases[i].gaps);
    }
    CHECK(receiver.newest == 169 && receiver.frames == sizeof cases / sizeof cases[0]);
}

/* Sequences wrap: half of all numbers are ahead, the other half, and the middle, behind. */
TEST(sequences_wrap)
{
    sp_wire_receiver receiver = {0};
    CHECK(arrives(&receiver, SP_WIRE_TYPE_FORCE, 0xfffffffeu) == SP_WIRE_NEW);
    CHECK(arrives(&receiver, SP_WIRE_TYPE_FORCE, 1) == SP_WIRE_NEW && receiver.gaps == 2);
    CHECK(arrives(&receiver, SP_WIRE_TYPE_FORCE, 0xffffffffu) == SP_WIRE_OLD && receiver.gaps == 1);
    CHECK(arrives(&receiver, SP_WIRE_TYPE_FORCE, 0x80000001u) == SP_WIRE_OLD);
    CHECK(arrives(&receiver, SP_WIRE_TYPE_FORCE, 0x80000002u) == SP_WIRE_OLD);
    CHECK(receiver.newest == 1 && receiver.gaps == 1);
    CHECK(arrives(&receiver, SP_WIRE_TYPE_FORCE, 0x80000000u) == SP_WIRE_NEW);
    CHECK(receiver.newest == 0x80000000u && receiver.gaps == 0x7fffffffu);
    /* it came alone: of those before it none has come */
    CHECK(arrives(&receiver, SP_WIRE_TYPE_FORCE, 0x7fffffffu) == SP_WIRE_OLD);
    CHECK(receiver.gaps == 0x7ffffffeu);
}

/* A HELLO from far behind is a device that has started again; one that is a little late is not. */
TEST(a_device_that_starts_again_is_heard)
{
    const struct {
        uint8_t type;
        uint32_t back;
        int kind;
    } cases[] = {
        {SP_WIRE_TYPE_HELLO, 0, SP_WIRE_OLD},          {SP_WIRE_TYPE_HELLO, 31, SP_WIRE_OLD},
        {SP_WIRE_TYPE_HELLO, 32, SP_WIRE_NEW},         {SP_WIRE_TYPE_HELLO, 1000, SP_WIRE_NEW},
        {SP_WIRE_TYPE_FORCE, 32, SP_WIRE_OLD},         {SP_WIRE_TYPE_FORCE, 1000, SP_WIRE_OLD},
        {SP_WIRE_TYPE_HELLO, 0x80000000u, SP_WIRE_NEW}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        sp_wire_receiver receiver = {0};
        CHECK(arrives(&receiver, SP_WIRE_TYPE_SAMPLE, 1990) == SP_WIRE_NEW);
        CHECK(arrives(&receiver, SP_WIRE_TYPE_SAMPLE, 2000) == SP_WIRE_NEW);
        const uint32_t gaps = receiver.gaps;
        CHECK(gaps == 9);
        CHECK(arrives(&receiver, cases[i].type, 2000 - cases[i].back) == cases[i].kind);
        CHECK(receiver.gaps == gaps);
        if (cases[i].kind == SP_WIRE_NEW) { /* nothing before its start is missing */
            CHECK(receiver.newest == 2000 - cases[i].back);
            CHECK(arrives(&receiver, SP_WIRE_TYPE_SAMPLE, receiver.newest - 1) == SP_WIRE_OLD);
            CHECK(arrives(&receiver, SP_WIRE_TYPE_SAMPLE, receiver.newest - 31) == SP_WIRE_OLD);
            CHECK(receiver.gaps == gaps);
            CHECK(arrives(&receiver, SP_WIRE_TYPE_SAMPLE, receiver.newest + 1) == SP_WIRE_NEW);
        }
    }
    sp_wire_receiver receiver = {0}; /* one that is ahead is a frame like others */
    CHECK(arrives(&receiver, SP_WIRE_TYPE_SAMPLE, 2000) == SP_WIRE_NEW);
    CHECK(arrives(&receiver, SP_WIRE_TYPE_HELLO, 2010) == SP_WIRE_NEW && receiver.gaps == 9);
}

/* After a restart of this end the first bytes may be the end of a frame, which is no damage. */
TEST(a_restart_forgets_the_sequence_and_the_frame_under_way)
{
    const uint8_t torn[] = {3, 1, 0};
    uint8_t garbage[ROOM];
    memset(garbage, 7, sizeof garbage);
    for (int overlong = 0; overlong <= 1; overlong++) {
        sp_wire_receiver receiver = {0};
        sp_wire_frame frame;
        CHECK(arrives(&receiver, SP_WIRE_TYPE_SAMPLE, 2000) == SP_WIRE_NEW);
        (void)given(&receiver, garbage, overlong ? ROOM : 3, &frame);
        sp_wire_restart(&receiver);
        CHECK(receiver.used == 0 && receiver.overlong == 0 && receiver.frames == 1);
        CHECK(given(&receiver, torn, 3, &frame) == SP_WIRE_NONE && receiver.crc_errors == 0);
        CHECK(given(&receiver, torn, 3, &frame) == SP_WIRE_NONE && receiver.crc_errors == 1);
        CHECK(arrives(&receiver, SP_WIRE_TYPE_SAMPLE, 5) == SP_WIRE_NEW && receiver.gaps == 0);
        sp_wire_restart(&receiver);
        CHECK(arrives(&receiver, SP_WIRE_TYPE_SAMPLE, 5) == SP_WIRE_NEW);
        CHECK(given(&receiver, torn, 3, &frame) == SP_WIRE_NONE && receiver.crc_errors == 2);
        uint8_t plain[ROOM],
            line[ROOM]; /* the first bytes were a decode_frame frame: no end of one */
        const uint32_t size = on_line(plain, head(plain, 6, SP_WIRE_VERSION, 9), line);
        sp_wire_restart(&receiver);
        CHECK(given(&receiver, line + 1, size - 1, &frame) == SP_WIRE_NEW);
        CHECK(given(&receiver, torn, 3, &frame) == SP_WIRE_NONE && receiver.crc_errors == 3);
    }
}
