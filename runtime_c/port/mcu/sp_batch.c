/* Calls of a scene out of a file ("calls.bin"), what each returned and how many instructions it
 * took into another ("returns.bin"): for an emulator. Beside them nothing runs. */
#include "sp_scene.h"
#include "sp_semihosting.h"

enum { CALL_IDLE = 1, CALL_RESET = 2, BLOCK = 64 };

#define OVERFLOWED 0xffffffffu /* of the counter: more instructions than it holds */

typedef struct {
    uint32_t call;
    sp_real position_m;
    sp_real velocity_mps;
    sp_real dt_s;
} call_row;

typedef struct {
    sp_real force_n;
    int32_t notes;
    uint32_t counts;
} return_row;

int main(void);

static sp_state state;
static call_row calls[BLOCK];
static return_row returns[BLOCK];

/* Rises by a fixed number for each instruction when the emulator counts them. */
#if defined(__arm__)
#define SYST_CSR (*(volatile uint32_t *)0xe000e010u)
#define SYST_RVR (*(volatile uint32_t *)0xe000e014u)
#define SYST_CVR (*(volatile uint32_t *)0xe000e018u)

enum { COUNTER_MASK = 0xffffff, PASSED_ZERO = 1 << 16 };

static void restart_counter(void)
{
    SYST_RVR = COUNTER_MASK;
    SYST_CSR = 5; /* the core's clock, no interrupt */
    SYST_CVR = 0;
}

static inline uint32_t counter(void)
{
    return 0u - SYST_CVR;
}

static int overflowed(void)
{
    return (SYST_CSR & PASSED_ZERO) != 0;
}
#else
#define COUNTER_MASK 0xffffffffu

static uint64_t start_count;

static inline uint32_t counter(void)
{
    uint32_t count;
    __asm__ volatile("csrr %0, minstret" : "=r"(count)::"memory");
    return count;
}

/* Count of executed instructions since the start, 64 bits. */
static uint64_t whole_counter(void)
{
    uint32_t high, low, again;
    do {
        __asm__ volatile("csrr %0, minstreth" : "=r"(high)::"memory");
        low = counter();
        __asm__ volatile("csrr %0, minstreth" : "=r"(again)::"memory");
    } while (high != again); /* the upper half has changed between the reads */
    return (uint64_t)high << 32 | low;
}

static void restart_counter(void)
{
    start_count = whole_counter();
}

static int overflowed(void)
{
    return whole_counter() - start_count > COUNTER_MASK;
}
#endif

/* Make one recorded call of the scene and count its instructions. */
static return_row execute_call(const call_row *call)
{
    return_row row = {0};
    if (call->call & CALL_RESET) {
        sp_reset(&state);
    }
    restart_counter();
    const uint32_t before = counter();
    row.notes = call->call & CALL_IDLE
                    ? sp_idle(&state, call->dt_s, &row.force_n)
                    : sp_step(&state, call->position_m, call->velocity_mps, &row.force_n);
    row.counts = (counter() - before) & COUNTER_MASK;
    if (overflowed()) {
        row.counts = OVERFLOWED;
    }
    return row;
}

/* Run recorded calls on an emulated board: read rows from a file of the host (semihosting),
 * write force, notes and instructions of each back. */
int main(void)
{
    static const char in[] = "calls.bin", out[] = "returns.bin";
    const uint32_t from = sp_semihosting_open(in, sizeof in - 1, SP_SEMIHOSTING_READ_BINARY);
    const uint32_t to = sp_semihosting_open(out, sizeof out - 1, SP_SEMIHOSTING_WRITE_BINARY);
    /* The first row: the self-test, and the cost of looking at the counter. */
    restart_counter();
    const uint32_t before = counter();
    const uint32_t after = counter();
    return_row first = {.counts = (after - before) & COUNTER_MASK};
    first.notes = sp_selftest();
    sp_semihosting_write(to, &first, sizeof first);
    sp_init(&state);
    uint32_t left = 0;
    while (left == 0) {
        left = sp_semihosting_read(from, calls, sizeof calls);
        const uint32_t n = (uint32_t)((sizeof calls - left) / sizeof calls[0]);
        for (uint32_t i = 0; i < n; i++) {
            returns[i] = execute_call(&calls[i]);
        }
        sp_semihosting_write(to, returns, n * (uint32_t)sizeof returns[0]);
    }
    sp_semihosting_exit();
    return 0;
}
