/* Files of the machine that runs the emulator, through the processor's debug trap. */
#ifndef SP_SEMIHOSTING_H
#define SP_SEMIHOSTING_H

#include <stdint.h>

enum {
    SP_SEMIHOSTING_OPEN = 0x01,
    SP_SEMIHOSTING_WRITE = 0x05,
    SP_SEMIHOSTING_READ = 0x06,
    SP_SEMIHOSTING_EXIT = 0x18,
    SP_SEMIHOSTING_READ_BINARY = 1, /* modes of open */
    SP_SEMIHOSTING_WRITE_BINARY = 5,
    SP_SEMIHOSTING_DONE = 0x20026 /* reasons of exit */
};

/* Ask the debugger or emulator for an operation on the host (Arm's semihosting; RISC-V has
 * taken it over). */
static inline uint32_t sp_semihosting(uint32_t operation, uintptr_t argument)
{
#if defined(__arm__)
    register uint32_t op __asm__("r0") = operation;
    register uintptr_t arg __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(op) : "r"(arg) : "memory");
    return op;
#else
    register uint32_t op __asm__("a0") = operation;
    register uintptr_t arg __asm__("a1") = argument;
    __asm__ volatile(".option push\n.option norvc\n.balign 16\n"
                     "slli x0, x0, 0x1f\nebreak\nsrai x0, x0, 7\n.option pop"
                     : "+r"(op)
                     : "r"(arg)
                     : "memory");
    return op;
#endif
}

/* A handle, or -1. */
static inline uint32_t sp_semihosting_open(const char *name, uint32_t length, uint32_t mode)
{
    const uintptr_t block[3] = {(uintptr_t)name, mode, length};
    return sp_semihosting(SP_SEMIHOSTING_OPEN, (uintptr_t)block);
}

/* Bytes that were not read. */
static inline uint32_t sp_semihosting_read(uint32_t file, void *bytes, uint32_t n)
{
    const uintptr_t block[3] = {file, (uintptr_t)bytes, n};
    return sp_semihosting(SP_SEMIHOSTING_READ, (uintptr_t)block);
}

static inline void sp_semihosting_write(uint32_t file, const void *bytes, uint32_t n)
{
    const uintptr_t block[3] = {file, (uintptr_t)bytes, n};
    (void)sp_semihosting(SP_SEMIHOSTING_WRITE, (uintptr_t)block);
}

static inline void sp_semihosting_exit(void)
{
    (void)sp_semihosting(SP_SEMIHOSTING_EXIT, SP_SEMIHOSTING_DONE);
}

#endif
