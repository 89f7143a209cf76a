/* What the processor itself gives: interrupts held back, sleep until the next one. */
#ifndef SP_CPU_H
#define SP_CPU_H

/* Keep interrupts back: what follows is seen whole by them or not at all. */
static inline void sp_cpu_disable_interrupts(void)
{
#if defined(__arm__)
    __asm__ volatile("cpsid i" ::: "memory");
#else
    __asm__ volatile("csrc mstatus, 8" ::: "memory");
#endif
}

/* Let interrupts in again. */
static inline void sp_cpu_enable_interrupts(void)
{
#if defined(__arm__)
    __asm__ volatile("cpsie i" ::: "memory");
#else
    __asm__ volatile("csrs mstatus, 8" ::: "memory");
#endif
}

/* Returns when an interrupt waits, also one that is held back. */
static inline void sp_cpu_sleep(void)
{
    __asm__ volatile("wfi" ::: "memory");
}

#endif
