/* The ring between a UART's interrupt and the main loop: order, room, and the overflow counter. */
#include "check.h"

#include "../../runtime_c/port/mcu/sp_bytes.h"

TEST(bytes_come_out_in_order_across_the_end)
{
    static sp_bytes ring;
    uint8_t next = 0;
    for (uint32_t i = 0; i < 10 * SP_BYTES_CAPACITY; i++) {
        uint8_t byte = 1;
        sp_bytes_put(&ring, (uint8_t)i);
        sp_bytes_put(&ring, (uint8_t)(i + 7));
        CHECK(sp_bytes_waiting(&ring) == 2);
        CHECK(sp_bytes_take(&ring, &byte) && byte == next);
        CHECK(sp_bytes_take(&ring, &byte) && byte == (uint8_t)(next + 7));
        CHECK(!sp_bytes_take(&ring, &byte));
        next++;
    }
    CHECK(ring.overflow == 0);
}

TEST(what_finds_no_room_is_counted_and_lost)
{
    static sp_bytes ring = {.put = 0xffffff00u, .taken = 0xffffff00u}; /* counters wrap */
    for (uint32_t i = 0; i < SP_BYTES_CAPACITY + 5; i++) {
        sp_bytes_put(&ring, (uint8_t)(i % 251));
    }
    CHECK(ring.overflow == 5);
    CHECK(sp_bytes_waiting(&ring) == SP_BYTES_CAPACITY);
    for (uint32_t i = 0; i < SP_BYTES_CAPACITY; i++) {
        uint8_t byte = 0;
        CHECK(sp_bytes_take(&ring, &byte) && byte == (uint8_t)(i % 251));
    }
    uint8_t byte;
    CHECK(!sp_bytes_take(&ring, &byte));
}
